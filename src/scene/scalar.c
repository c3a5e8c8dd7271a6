/* SPDX-License-Identifier: BSD-3-Clause */
/* scalar.c -- the types of plain values, close to the core schema of YAML 1.2.
 *
 * Number:  [-+]? ( digits ( . digits? )? | . digits ) ( [eE] [-+]? digits )?
 * where digits before the point have no leading zero, which YAML 1.1 and many people
 * read as octal. strtod and snprintf run in the "C" locale (scene.c sees to that). */
#include "scene/tree.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_plain(const weft__node *node)
{
    return node->type == WEFT__SCALAR && node->style == YAML_PLAIN_SCALAR_STYLE;
}

static const weft__switch switches[] = {
    { "true", true, true },   { "True", true, true },   { "TRUE", true, true },
    { "false", false, true }, { "False", false, true }, { "FALSE", false, true },
    { "yes", true, false },   { "Yes", true, false },   { "YES", true, false },
    { "no", false, false },   { "No", false, false },   { "NO", false, false },
    { "on", true, false },    { "On", true, false },    { "ON", true, false },
    { "off", false, false },  { "Off", false, false },  { "OFF", false, false },
    { "1", true, false },     { "0", false, false },
};

const weft__switch *weft__find_switch(const char *text)
{
    for (size_t i = 0; text != NULL && i < sizeof switches / sizeof switches[0]; ++i) {
        if (strcmp(text, switches[i].text) == 0) {
            return &switches[i];
        }
    }
    return NULL;
}

static bool is_one_of(const char *text, const char *const *names)
{
    for (; *names != NULL; ++names) {
        if (strcmp(text, *names) == 0) {
            return true;
        }
    }
    return false;
}

bool weft__is_null(const weft__node *node)
{
    static const char *const names[] = { "", "~", "null", "Null", "NULL", NULL };
    return is_plain(node) && is_one_of(node->text, names);
}

const char *weft__text_of(const weft__node *node)
{
    if (node->type != WEFT__SCALAR || weft__is_null(node)
        || strlen(node->text) != node->count) {
        return NULL;
    }
    return node->text;
}

static size_t digits(const char *text)
{
    return strspn(text, "0123456789");
}

/* Bytes of the longest decimal number at the start of text, 0 if there is none. A
 * leading zero is allowed here; has_leading_zero finds it. */
static size_t number_length(const char *text)
{
    const char *p = text;
    p += *p == '-' || *p == '+';
    const size_t whole = digits(p);
    p += whole;
    if (*p == '.' && (whole > 0 || digits(p + 1) > 0)) {
        p += 1 + digits(p + 1);
    } else if (whole == 0) {
        return 0;
    }
    if (*p == 'e' || *p == 'E') {
        const size_t sign = p[1] == '-' || p[1] == '+';
        const size_t power = digits(p + 1 + sign);
        p += power > 0 ? 1 + sign + power : 0;
    }
    return (size_t)(p - text);
}

static bool has_leading_zero(const char *text)
{
    text += *text == '-' || *text == '+';
    return text[0] == '0' && digits(text) > 1;
}

static bool is_infinity(const char *text)
{
    static const char *const names[] = { ".inf", ".Inf", ".INF", NULL };
    return is_one_of(text + (*text == '-' || *text == '+'), names);
}

/* The finite number at the start of a text, with blanks around it; returns its end, or
 * NULL if there is none. */
static const char *take_number(const char *text, double *out)
{
    text += strspn(text, " ");
    const size_t length = number_length(text);
    if (length == 0 || has_leading_zero(text)) {
        return NULL;
    }
    *out = strtod(text, NULL);
    text += length;
    return isfinite(*out) ? text + strspn(text, " ") : NULL;
}

static bool parse_number(const char *text, double *out)
{
    if (is_infinity(text)) {
        *out = text[0] == '-' ? -HUGE_VAL : HUGE_VAL;
        return true;
    }
    const char *end = take_number(text, out);
    return end != NULL && *end == '\0';
}

bool weft__number_of(const weft__node *node, double *out)
{
    return is_plain(node) && weft__text_of(node) != NULL
           && parse_number(weft__text_of(node), out);
}

bool weft__fraction_of(const weft__node *node, double *out)
{
    const char *text = weft__text_of(node);
    double below;
    const char *end = text == NULL ? NULL : take_number(text, out);
    if (end == NULL || *end != '/') {
        return weft__number_of(node, out) && isfinite(*out);
    }
    end = take_number(end + 1, &below);
    if (end == NULL || *end != '\0') {
        return false;
    }
    *out /= below;
    return isfinite(*out);
}

bool weft__integer_of(const weft__node *node, long long *out)
{
    const char *text = weft__text_of(node);
    if (!is_plain(node) || text == NULL) {
        return false;
    }
    const size_t sign = text[0] == '-' || text[0] == '+';
    const size_t length = digits(text + sign);
    if (length == 0 || text[sign + length] != '\0' || has_leading_zero(text)) {
        return false;
    }
    *out = strtoll(text, NULL, 10);
    return true;
}

weft__words weft__show(const weft__node *node)
{
    weft__words out = { "a mapping" };
    if (node->type == WEFT__LIST) {
        (void)snprintf(out.text, sizeof out.text, "a list of %zu", node->count);
    } else if (node->type == WEFT__SCALAR) {
        const int length = (int)strnlen(node->text, 40);
        (void)snprintf(out.text, sizeof out.text, "%s'%.*s%s'",
                       is_plain(node) ? "" : "the text ", length, node->text,
                       node->text[length] == '\0' ? "" : "...");
    }
    return out;
}

static bool is_not_finite(const char *text)
{
    static const char *const names[] = { ".nan", ".NaN", ".NAN", "nan", "NaN", NULL };
    const size_t length = number_length(text);
    return is_infinity(text) || is_one_of(text, names)
           || (length > 0 && text[length] == '\0' && isinf(strtod(text, NULL)));
}

/* A hint for a plain scalar that should be a number. */
static const char *number_hint(const char *text)
{
    const size_t sign = text[0] == '-' || text[0] == '+';
    const size_t length = number_length(text);
    const char next = text[length];
    const bool grouped = digits(text + sign) > 0
                         && strspn(text + sign, "0123456789_.") == strlen(text + sign);
    return is_not_finite(text) && text[0] != '-' ? "it must be finite"
           : length == 0                         ? ""
           : text[sign] == '0' && strchr("xXoObB", text[sign + 1]) != NULL
                   && text[sign + 1] != '\0'
               ? "write it in decimal digits"
           : has_leading_zero(text) ? "write it without leading zeros"
           : grouped && next == '_' ? "write it without '_'"
           : next == ','            ? "write a decimal point"
           : next == '/'            ? "write it as a decimal number"
                                    : "";
}

const char *weft__hint(const weft__node *node, bool number, const char *unit, char *out,
                       size_t size)
{
    const char *text = weft__text_of(node);
    const char *hint = "";
    double value;
    out[0] = '\0';
    if (text == NULL) {
        if (node->type == WEFT__SCALAR && !weft__is_null(node)) {
            (void)snprintf(out, size, " (it holds a NUL character)");
        }
        return out;
    }
    const size_t length = number_length(text);
    const char *rest = text + length + (text[length] == ' ');
    if (!is_plain(node)) {
        hint = number && parse_number(text, &value) ? "remove the quotes" : "";
    } else if (strchr("01", text[0]) == NULL && weft__find_switch(text) != NULL) {
        hint = "this key takes no yes or no, on or off, true or false";
    } else if (number) {
        hint = number_hint(text);
    }
    if (hint[0] != '\0') {
        (void)snprintf(out, size, " (%s)", hint);
    } else if (number && is_plain(node) && length > 0
               && strspn(rest, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ%")
                      > 0) {
        (void)snprintf(out, size, " (write the number alone%s%s)",
                       unit == NULL ? "" : ": it is in ", unit == NULL ? "" : unit);
    }
    return out;
}
