/* SPDX-License-Identifier: BSD-3-Clause */
/* read.c -- a tree read by the table of keys. */
#include "scene/read.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/suggest.h"

/* ---- messages --------------------------------------------------------------- */

/* A list as [0, -9,81, 0]: blanks behind some of its commas, but not behind all. */
static bool has_decimal_comma(const weft__node *list)
{
    size_t tight = 0;
    const size_t count = weft__item_count(list);
    for (size_t i = 1; i < count; ++i) {
        double value;
        const weft__node *a = weft__item(list, i - 1);
        const weft__node *b = weft__item(list, i);
        if (!weft__number_of(a, &value) || !weft__number_of(b, &value)) {
            return false;
        }
        tight
            += b->at.line == a->at.line && b->at.column == a->at.column + a->count + 1;
    }
    return tight > 0 && tight + 1 < count;
}

void weft__refuse(weft__reader *reader, const weft__node *node, const char *name,
                  const char *wanted, bool number, const char *unit)
{
    char hint[128];
    if (node->type == WEFT__SCALAR && weft__is_null(node)) {
        ERROR_AT(reader, node, "%s must be %s, but there is no value", name, wanted);
        return;
    }
    ERROR_AT(
        reader, node, "%s must be %s, not %s%s", name, wanted, weft__show(node).text,
        node->type == WEFT__SCALAR ? weft__hint(node, number, unit, hint, sizeof hint)
        : has_decimal_comma(node)  ? " (write a decimal point)"
                                   : "");
}

void weft__refuse_value(weft__reader *reader, const weft__key *key,
                        const weft__node *node)
{
    char wanted[200];
    const bool number = key->kind == WEFT__NUMBER || key->kind == WEFT__INTEGER
                        || key->kind == WEFT__PAIR || key->kind == WEFT__WARP_WEFT
                        || key->kind == WEFT__ATOL || key->kind == WEFT__INDEX
                        || key->kind == WEFT__FRACTION;
    weft__refuse(reader, node, key->name,
                 weft__wanted(key, true, false, wanted, sizeof wanted), number,
                 weft__unit_of(key));
}

/* ---- plain values ----------------------------------------------------------- */

bool weft__read_number(weft__reader *reader, const weft__key *key, const char *name,
                       const weft__node *node, double *out)
{
    const bool fraction = key->kind == WEFT__ROW || key->kind == WEFT__ROWS;
    const weft__number *range = key->number;
    weft__key like = *key;
    double value;
    if (fraction
            ? weft__fraction_of(node, &value)
            : weft__number_of(node, &value)
                  && (range == NULL ? isfinite(value) : weft__in_range(range, value))) {
        *out = value;
        return true;
    }
    like.name = name;
    like.kind = fraction ? WEFT__FRACTION : WEFT__NUMBER;
    weft__refuse_value(reader, &like, node);
    return false;
}

bool weft__read_numbers(weft__reader *reader, const weft__key *key, const char *name,
                        const weft__node *list, double *out)
{
    bool good = true;
    for (size_t i = 0; i < weft__item_count(list); ++i) {
        char item[64];
        (void)snprintf(item, sizeof item, "%s[%zu]", name, i);
        good = weft__read_number(reader, key, item, weft__item(list, i), &out[i])
               && good;
    }
    return good;
}

double *weft__read_table(weft__reader *reader, const weft__key *key,
                         const weft__node *node, size_t width, const char *row)
{
    const weft__key plain
        = { .name = key->name, .kind = WEFT__NUMBER, .unit = key->unit };
    const size_t count = weft__item_count(node);
    double *table = weft__tree_take(reader->tree, (count + 1) * width, sizeof *table);
    bool good = table != NULL;
    for (size_t i = 0; i < count && table != NULL; ++i) {
        const weft__node *item = weft__item(node, i);
        char name[96];
        (void)snprintf(name, sizeof name, "%s[%zu]", key->name, i);
        if (weft__item_count(item) != width) {
            weft__refuse(reader, item, name, row, false, NULL);
            good = false;
        } else {
            good = weft__read_numbers(reader, &plain, name, item, table + i * width)
                   && good;
        }
    }
    return good ? table : NULL;
}

void weft__read_real(weft__reader *reader, const weft__key *key, const weft__node *node,
                     void *to)
{
    (void)weft__read_number(reader, key, key->name, node, to);
}

#define MANY 2147483647.0 /* the bound of integers that have no other */

void weft__read_integer(weft__reader *reader, const weft__key *key,
                        const weft__node *node, void *to)
{
    weft__number range = *key->number;
    weft__key shown = *key;
    long long value = 0;
    range.most = range.most == 0.0 ? MANY : range.most;
    shown.number = &range;
    if (!weft__integer_of(node, &value) || !weft__in_range(&range, (double)value)) {
        range.most
            = range.most > WEFT__MANY && (double)value <= range.most ? 0.0 : range.most;
        weft__refuse_value(reader, &shown, node);
    } else if (range.type == WEFT__INT) {
        *(int *)to = (int)value;
    } else {
        *(size_t *)to = (size_t)value;
    }
}

/* A vector, or a pair, or one number for both of it. */
void weft__read_vector(weft__reader *reader, const weft__key *key,
                       const weft__node *node, void *to)
{
    const size_t count = key->kind == WEFT__VECTOR ? 3 : 2;
    double value[3];
    bool good = false;
    if (count == 2 && node->type == WEFT__SCALAR && !weft__is_null(node)) {
        good = weft__read_number(reader, key, key->name, node, &value[0]);
        value[1] = value[0];
    } else if (weft__item_count(node) == count) {
        good = weft__read_numbers(reader, key, key->name, node, value);
    } else {
        weft__refuse_value(reader, key, node);
    }
    if (good) {
        memcpy(to, value, count * sizeof *value);
    }
}

enum { TO_WEFT = offsetof(weft_cloth_def, across) - offsetof(weft_cloth_def, springs) };

void weft__read_warp_weft(weft__reader *reader, const weft__key *key,
                          const weft__node *node, void *to)
{
    double pair[2] = { 0.0, 0.0 };
    weft__read_vector(reader, key, node, pair);
    memcpy(to, &pair[0], sizeof pair[0]);
    memcpy((char *)to + TO_WEFT, &pair[1], sizeof pair[1]);
}

void weft__read_atol(weft__reader *reader, const weft__key *key, const weft__node *node,
                     void *to)
{
    weft_stepper_config *config = &reader->scene->config;
    weft__key plain = *key;
    double value;
    (void)to;
    plain.unit = "m and m/s";
    if (node->type == WEFT__MAP) {
        weft__read_section(reader, key->section, key->name, node, config);
    } else if (node->type == WEFT__LIST || weft__is_null(node)) {
        weft__refuse_value(reader, key, node);
    } else if (weft__read_number(reader, &plain, key->name, node, &value)) {
        config->atol_position = config->atol_velocity = value;
    }
}

void weft__read_boolean(weft__reader *reader, const weft__key *key,
                        const weft__node *node, void *to)
{
    const weft__switch *found = weft__find_switch(weft__text_of(node));
    if (found == NULL) {
        weft__refuse_value(reader, key, node);
        return;
    }
    const bool quoted = node->style != YAML_PLAIN_SCALAR_STYLE;
    if (found->good && !quoted) {
        *(bool *)to = found->value;
        return;
    }
    ERROR_AT(reader, node, "%s must be true or false, not %s (%s)", key->name,
             weft__show(node).text,
             quoted && found->good ? "remove the quotes"
             : found->value        ? "write true"
                                   : "write false");
}

void weft__read_text(weft__reader *reader, const weft__key *key, const weft__node *node,
                     void *to)
{
    char **text = to;
    const char *value = weft__text_of(node);
    if (value == NULL) {
        weft__refuse_value(reader, key, node);
        return;
    }
    *text = weft__tree_text(reader->tree, value, node->count);
}

/* ---- names ------------------------------------------------------------------ */

bool weft__find_name(weft__reader *reader, const weft__key *key, const weft__node *node,
                     size_t *index)
{
    char wanted[200], near[80], hint[128];
    const char *text = weft__text_of(node);
    weft__guess guess = { 0 };
    for (*index = 0; text != NULL && key->names[*index] != NULL; ++*index) {
        if (strcmp(text, key->names[*index]) == 0) {
            return true;
        }
        weft__guess_try(&guess, text, key->names[*index]);
    }
    if (guess.name == NULL) {
        weft__refuse_value(reader, key, node);
    } else {
        ERROR_AT(reader, node, "%s must be %s, not %s%s%s", key->name,
                 weft__wanted(key, true, false, wanted, sizeof wanted),
                 weft__show(node).text, weft__guess_text(&guess, near, sizeof near),
                 weft__hint(node, false, NULL, hint, sizeof hint));
    }
    return false;
}

void weft__read_names(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    bool *listed = to;
    char title[64];
    (void)snprintf(title, sizeof title, "an item of %s", key->name);
    const weft__key element
        = { .name = title, .kind = WEFT__CHOICE, .names = key->names };
    if (node->type != WEFT__LIST || (key->some && node->count == 0)) {
        weft__refuse_value(reader, key, node);
    }
    for (size_t i = 0; i < weft__item_count(node); ++i) {
        size_t name;
        if (weft__find_name(reader, &element, weft__item(node, i), &name)) {
            listed[name] = true;
        }
    }
}

void weft__read_choice(weft__reader *reader, const weft__key *key,
                       const weft__node *node, void *to)
{
    size_t name;
    if (!weft__find_name(reader, key, node, &name)) {
        return;
    }
    if (key->kind == WEFT__EITHER) {
        *(bool *)to = name == 1;
    } else {
        const unsigned value = (unsigned)name + key->first;
        memcpy(to, &value, sizeof value);
    }
}

void weft__read_mapping(weft__reader *reader, const weft__key *key,
                        const weft__node *node, void *to)
{
    const char *title = key->section->title;
    weft__read_section(reader, key->section, title == NULL ? key->name : title, node,
                       to);
}

/* ---- values by kind --------------------------------------------------------- */

void weft__read_items(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    const struct weft__items *items = key->items;
    size_t count = weft__item_count(node);
    if (node->type != WEFT__LIST) {
        weft__refuse_value(reader, key, node);
    }
    char *array = count == 0 ? NULL : weft__tree_take(reader->tree, count, items->size);
    count = array == NULL ? 0 : count;
    memcpy(to, &array, sizeof array);
    memcpy((char *)to + items->count, &count, sizeof count);
    for (size_t i = 0; i < count; ++i) {
        items->read(reader, key, weft__item(node, i), array + i * items->size);
    }
}

void weft__read_value(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *base)
{
    reader->readers[key->kind](reader, key, node, (char *)base + weft__offset_of(key));
}

/* A plain value needs no parser, which would take most of the time of reading a scene.
 */
const weft__node *weft__fallback_node(weft__tree *tree, const char *text,
                                      weft__node *plain)
{
    const weft__source source = { .file = "", .text = text, .length = strlen(text) };
    const weft__node *node = plain;
    *plain = (weft__node){ .style = YAML_PLAIN_SCALAR_STYLE,
                           .text = text,
                           .count = source.length };
    return text[0] != '[' || weft__tree_parse(tree, &source, 0, &node) ? node : NULL;
}

/* ---- mappings --------------------------------------------------------------- */

/* What was found of a key; NULL: it is no key of the section. */
static weft__found *read_find(weft__match *match, const char *name)
{
    const weft__key *key = name == NULL ? NULL : weft__key_named(match->section, name);
    return key == NULL ? NULL : &match->found[key - match->section->keys];
}

const weft__found *weft__found_in(const weft__match *match, const char *name)
{
    return &match->found[weft__key_named(match->section, name) - match->section->keys];
}

const weft__node *weft__key_in(const weft__match *match, const char *name)
{
    return weft__found_in(match, name)->key;
}

const weft__node *weft__value_in(const weft__match *match, const char *name)
{
    return weft__found_in(match, name)->value;
}

bool weft__lacks(const weft__match *match, const char *name)
{
    const weft__found *found = weft__found_in(match, name);
    return found->key == NULL && !found->explained;
}

/* The key that was probably meant is not reported as missing. */
static void report_unknown(weft__reader *reader, weft__match *match,
                           const weft__node *node, const weft__node *value)
{
    const weft__section *section = match->section;
    const char *name = node->text, *meant = NULL;
    const weft__key *other
        = section->beside == NULL ? NULL : weft__key_named(section->beside, name);
    const weft__words shown = weft__show(node);
    char hint[300] = "";
    if (other != NULL && strcmp(name, "at") != 0) {
        meant = "at";
        ERROR_AT(reader, node, "%s %s", shown.text, section->beside_hint);
    } else {
        if (value != NULL && weft__is_null(value) && name[0] >= '0' && name[0] <= '9') {
            strcpy(hint, " (write a decimal point)"); /* {spacing: 1,0} */
        } else {
            meant = weft__unknown_hint(reader->root, section, match->title, name, hint,
                                       sizeof hint);
        }
        ERROR_AT(reader, node, "unknown key %s in %s%s", shown.text, match->title,
                 hint);
    }
    weft__found *found = read_find(match, meant);
    if (found != NULL) {
        found->explained = true;
    }
}

static void match_pair(weft__reader *reader, weft__match *match, weft__entry pair)
{
    const char *name = weft__text_of(pair.key);
    weft__found *found = read_find(match, name);
    if (name == NULL) {
        ERROR_AT(reader, pair.key, "%s where %s must have a key",
                 pair.key->type == WEFT__SCALAR ? "nothing"
                 : pair.key->type == WEFT__MAP  ? "a mapping"
                                                : "a list",
                 match->title);
    } else if (strcmp(name, "<<") == 0) {
        for (size_t i = 0; i < match->section->count; ++i) {
            match->found[i].explained = true;
        }
        ERROR_AT(reader, pair.key,
                 "merge keys ('<<') are not part of YAML 1.2: write the keys of %s out",
                 match->title);
    } else if (found == NULL) {
        report_unknown(reader, match, pair.key, pair.value);
    } else if (found->key != NULL) {
        ERROR_AT(reader, pair.key, "duplicate key '%s' in %s (the first is at %s)",
                 name, match->title,
                 weft__place_text(reader->report, found->key->at).text);
    } else if (pair.value != NULL) {
        found->key = pair.key;
        found->value = pair.value;
    }
}

/* Whether a key goes with the choice in the section's first key, which was read into
 * base; no key for some choices goes with a wrong one. */
static bool goes_with_choice(const weft__section *section, const weft__key *key,
                             const void *base, unsigned *choice)
{
    const unsigned with = key->of | key->also;
    if (with != 0) {
        memcpy(choice, (const char *)base + section->keys[0].at, sizeof *choice);
    }
    return with == 0 || (with >> *choice & 1U) != 0;
}

static void report_foreign(weft__reader *reader, const weft__match *match, size_t i,
                           unsigned choice)
{
    const weft__key *key = &match->section->keys[i];
    const char *const *names = match->section->keys[0].names;
    char others[80] = "";
    for (size_t k = 0, used = 0; names[k] != NULL && used < sizeof others; ++k) {
        if (((key->of | key->also) >> k & 1U) != 0) {
            used += (size_t)snprintf(others + used, sizeof others - used, "%s%s",
                                     used == 0 ? "" : ", ", names[k]);
        }
    }
    if (names[choice] != NULL && match->found[i].key != NULL) {
        ERROR_AT(reader, match->found[i].key,
                 "%s does not belong to a %s (it is a key of %s)", key->name,
                 names[choice], others);
    }
}

static void read_key(weft__reader *reader, weft__match *match, size_t i, void *base)
{
    const weft__key *key = &match->section->keys[i];
    weft__found *found = &match->found[i];
    unsigned choice = 0;
    if (!goes_with_choice(match->section, key, base, &choice)) {
        report_foreign(reader, match, i, choice);
    } else if (found->value != NULL) {
        const size_t mistakes = reader->report->mistakes;
        weft__read_value(reader, key, found->value, base);
        found->wrong = reader->report->mistakes > mistakes;
        match->wrong = match->wrong || found->wrong;
    } else if (key->required && (key->also >> choice & 1U) == 0 && !found->explained
               && match->map != NULL) {
        ERROR_AT(reader, match->map, "%s lacks the required key '%s'%s: %s",
                 match->title, key->name, weft__unit_text(key).text, key->meaning);
    } else if (key->fallback != NULL) {
        weft__node plain;
        const weft__node *node
            = weft__fallback_node(reader->tree, key->fallback, &plain);
        if (node != NULL) {
            weft__read_value(reader, key, node, base);
        }
    } else if (key->kind == WEFT__MAPPING) {
        weft__read_section(reader, key->section, key->name, NULL,
                           (char *)base + key->at);
    }
}

/* The entry of the key that fills a field: of several, the one that is there. */
static weft__found found_at(const weft__match *match, size_t field)
{
    weft__found found = { .key = NULL };
    for (size_t i = 0; i < match->section->count; ++i) {
        found = weft__offset_of(&match->section->keys[i]) == field && found.key == NULL
                    ? match->found[i]
                    : found;
    }
    return found;
}

static void report_fault(void *ctx, size_t field, size_t other, const char *message)
{
    const weft__match *match = ctx;
    const weft__found a = found_at(match, field);
    const weft__found b = found_at(match, other);
    const weft__node *node = a.value == NULL ? b.value : a.value;
    if (node != NULL && !a.wrong && !b.wrong) {
        weft__report_error(match->reader->report, node->at, "%s", message);
    }
}

/* Reports a key that stands without another one. */
static void check_together(weft__reader *reader, const weft__match *match,
                           const char *name, const char *other)
{
    const weft__node *key = weft__key_in(match, name);
    if (key != NULL && weft__lacks(match, other)) {
        ERROR_AT(reader, key, "%s has no effect without %s%s", name, other,
                 weft__unit_text(weft__key_named(match->section, other)).text);
    }
}

void weft__read_section(weft__reader *reader, const weft__section *section,
                        const char *title, const weft__node *node, void *base)
{
    weft__match match = { .reader = reader,
                          .faults = { report_fault, &match },
                          .section = section,
                          .title = title,
                          .map = node };
    if (node != NULL && node->type != WEFT__MAP) {
        char keys[200], wanted[sizeof keys + 16];
        (void)snprintf(wanted, sizeof wanted, "a mapping {%s}",
                       weft__key_names(section, keys, sizeof keys));
        weft__refuse(reader, node, title, wanted, false, NULL);
        return;
    }
    for (size_t i = 0; node != NULL && i < node->count; ++i) {
        match_pair(reader, &match, node->entries[i]);
    }
    for (size_t i = 0; i < section->count; ++i) {
        read_key(reader, &match, i, base);
    }
    if (node != NULL && section->one[0] != NULL) {
        weft__check_one(reader, &match, section->one);
    }
    for (size_t i = 0; i < 2 && section->together[i] != NULL; ++i) {
        check_together(reader, &match, section->together[i], section->together[1 - i]);
    }
    if (node != NULL && section->check != NULL) {
        section->check(reader, &match, base);
    }
}

const weft__node *weft__later(const weft__node *a, const weft__node *b)
{
    return a == NULL || (b != NULL && weft__mark_before(a->at, b->at)) ? b : a;
}

void weft__report_exclusive(weft__report *report, const weft__node *a,
                            const weft__node *b)
{
    const weft__node *second = weft__later(a, b), *first = second == a ? b : a;
    weft__report_error(report, second->at, "%s excludes %s (%s)", second->text,
                       first->text, weft__place_text(report, first->at).text);
}

bool weft__report_excluded(weft__reader *reader, const weft__match *match,
                           const char *const *names, const char *rule)
{
    bool found = false;
    for (; *names != NULL; ++names) {
        const weft__node *key = weft__key_in(match, *names);
        if (key != NULL) {
            ERROR_AT(reader, key, "'%s' %s", *names, rule);
            found = true;
        }
    }
    return found;
}

bool weft__check_exclusive(weft__reader *reader, const weft__match *match,
                           const char *const *names)
{
    const weft__node *first = NULL;
    bool lacks = true;
    for (; *names != NULL; ++names) {
        const weft__node *key = weft__key_in(match, *names);
        lacks = lacks && weft__lacks(match, *names);
        if (key != NULL && first != NULL) {
            weft__report_exclusive(reader->report, first, key);
        }
        first = first == NULL ? key : first;
    }
    return !lacks;
}

void weft__check_one(weft__reader *reader, const weft__match *match,
                     const char *const *names)
{
    char list[120] = "";
    size_t used = 0;
    if (weft__check_exclusive(reader, match, names)) {
        return;
    }
    for (size_t i = 0; names[i] != NULL && used < sizeof list; ++i) {
        used += (size_t)snprintf(
            list + used, sizeof list - used, "%s'%s'%s",
            i == 0                 ? ""
            : names[i + 1] == NULL ? " or "
                                   : ", ",
            names[i], weft__unit_text(weft__key_named(match->section, names[i])).text);
    }
    ERROR_AT(reader, match->map, "%s lacks %s: exactly one is required", match->title,
             list);
}

/* ---- notes --------------------------------------------------------------------- */

void weft__note_add(weft__reader *reader, const char *about, const char *format, ...)
{
    weft_scene *scene = reader->scene;
    weft__note *note = weft__tree_take(reader->tree, 1, sizeof *note);
    char text[512];
    va_list args;
    va_start(args, format);
    const size_t before = scene->part_name == NULL
                              ? 0
                              : (size_t)weft_text_format(text, sizeof text,
                                                         "%.60s: ", scene->part_name);
    (void)vsnprintf(text + before, sizeof text - before, format, args);
    va_end(args);
    char *kept = weft__tree_take(reader->tree, strlen(text) + 1, 1);
    if (note == NULL || kept == NULL) {
        return;
    }
    strcpy(kept, text);
    weft__note **end = &scene->notes;
    while (*end != NULL) {
        end = &(*end)->next;
    }
    *note = (weft__note){ .about = about, .text = kept };
    *end = note;
}
