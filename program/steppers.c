/* SPDX-License-Identifier: BSD-3-Clause */
/* steppers.c -- weft steppers: the methods of all plugins that are found. */
#include "program/cli.h"
#include "program/record/yaml_out.h"

bool method_at(const weft_registry *registry, size_t i, stepper_method *out)
{
    for (size_t p = 0; p < weft_registry_count(registry); ++p) {
        out->plugin = weft_registry_at(registry, p);
        for (size_t m = 0; out->plugin->types[m] != NULL; ++m) {
            if (i-- == 0) {
                out->type = out->plugin->types[m];
                return true;
            }
        }
    }
    return false;
}

size_t method_count(const weft_registry *registry)
{
    stepper_method m;
    size_t count = 0;
    while (method_at(registry, count, &m)) {
        ++count;
    }
    return count;
}

bool method_adapts(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0;
}

bool method_best(const weft_registry *registry, const stepper_method *but,
                 stepper_method *out)
{
    const uint32_t unfit = WEFT_STEPPER_FIXED_ONLY | WEFT_STEPPER_MULTISTEP
                           | WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_DENSE;
    stepper_method m;
    int best = 0;
    for (size_t i = 0; method_at(registry, i, &m); ++i) {
        const bool other = but == NULL || m.plugin != but->plugin;
        const int rank = m.type->order + (other ? 100 : 0);
        if ((m.type->flags & unfit) == 0 && m.type->order > 0 && rank > best
            && (but == NULL || m.type != but->type)) {
            best = rank;
            *out = m;
        }
    }
    return best > 0;
}

/* ---- the verb ----------------------------------------------------------------- */

typedef struct flag_name {
    uint32_t flag;
    const char *name;
    bool common; /* not a word in lists for people */
} flag_name;

static const flag_name flag_names[] = {
    { WEFT_STEPPER_FIXED_ONLY, "fixed-step", false },
    { WEFT_STEPPER_FSAL, "fsal", false },
    { WEFT_STEPPER_MULTISTEP, "multistep", false },
    { WEFT_STEPPER_IMPLICIT, "implicit", false },
    { WEFT_STEPPER_LEGACY, "legacy", false },
    { WEFT_STEPPER_BUTCHER, "custom-table", false },
    { WEFT_STEPPER_DENSE, "small-cloths", false },
    { WEFT_STEPPER_CONTROLLER, "controller", true },
    { WEFT_STEPPER_QUADRATURES, "quadratures", true },
    { WEFT_STEPPER_DISTRIBUTED, "bands", true },
    { WEFT_STEPPER_STRUCTURE, "structure", true },
    { WEFT_STEPPER_LINEAR, "linear-solver", true },
    { WEFT_STEPPER_COUPLINGS, "links", true },
    { WEFT_STEPPER_PASS, "sweep", true },
    { WEFT_STEPPER_LIBM, "libm", false },
    { WEFT_STEPPER_ADAPTIVE_ONLY, "adaptive", false },
};

#define FLAG_NAMES (sizeof flag_names / sizeof flag_names[0])

static sentence flags_text(uint32_t flags)
{
    sentence out = { "" };
    for (size_t i = 0; i < FLAG_NAMES; ++i) {
        if ((flags & flag_names[i].flag) != 0 && !flag_names[i].common) {
            say(&out, "%s%s", out.text[0] != '\0' ? " " : "", flag_names[i].name);
        }
    }
    return out;
}

/* 0 stands for "varies" of an order and for "none" of the error's. */
static const char *number(int value, const char *zero, char text[16])
{
    (void)snprintf(text, 16, "%d", value);
    return value == 0 ? zero : text;
}

static void print_text(const weft_registry *registry)
{
    enum { KIND = 47 }; /* the column */
    stepper_method m;
    printf("%-8s %-17s %5s %5s %6s  kind\n", "plugin", "method", "order", "error",
           "stages");
    for (size_t i = 0; method_at(registry, i, &m); ++i) {
        char order[16], error_order[16], stages[16];
        printf("%-8s %-17s %5s %5s %6s", m.plugin->id, m.type->name,
               number(m.type->order, "var", order),
               number(m.type->error_order, "-", error_order),
               number(m.type->stages, "var", stages));
        const sentence kind = flags_text(m.type->flags);
        fputs(kind.text[0] == '\0' ? "" : "  ", stdout);
        print_wrapped(KIND, KIND, PAGE_WIDTH, kind.text);
    }
    puts("\nreferences and the methods' full names: weft steppers --yaml");
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        const weft_plugin *plugin = weft_registry_at(registry, i);
        printf("%s %s: %s%s%s, %s\n", plugin->id, plugin->version, plugin->solver,
               plugin->solver[0] == '\0' ? "" : ", ", plugin->types[0]->license,
               weft_registry_file(registry, i));
    }
}

/* The first method with the reference of method i. */
static size_t first_with_reference(const weft_registry *registry, size_t i)
{
    stepper_method mine, other;
    size_t first = 0;
    (void)method_at(registry, i, &mine);
    while (first < i && method_at(registry, first, &other)
           && strcmp(other.type->reference, mine.type->reference) != 0) {
        ++first;
    }
    return first;
}

/* References are numbered from 1 in the order in which the methods have them. */
static size_t reference_number(const weft_registry *registry, size_t i)
{
    const size_t first = first_with_reference(registry, i);
    size_t number_of = 0;
    for (size_t k = 0; k <= first; ++k) {
        number_of += first_with_reference(registry, k) == k;
    }
    return number_of;
}

/* As the literature writes it: 5(4) continues the solution of order 5, and compares it
 * with one of order 4. */
static void print_orders(const weft_stepper_type *type)
{
    char order[16], error_order[16];
    printf(type->error_order > 0 ? "%s(%s)" : "%s", number(type->order, "var", order),
           number(type->error_order, "", error_order));
}

static void print_markdown(const weft_registry *registry)
{
    stepper_method m;
    puts("| plugin | method | order | stages | kind | source "
         "|\n|---|---|---|---|---|---|");
    for (size_t i = 0; method_at(registry, i, &m); ++i) {
        char stages[16];
        printf("| %s | `%s` | ", m.plugin->id, m.type->name);
        print_orders(m.type);
        printf(" | %s | %s | %zu |\n", number(m.type->stages, "var", stages),
               flags_text(m.type->flags).text, reference_number(registry, i));
    }
    puts("");
    for (size_t i = 0; method_at(registry, i, &m); ++i) {
        if (first_with_reference(registry, i) == i) {
            printf("%zu. %s\n", reference_number(registry, i), m.type->reference);
        }
    }
}

static void method_yaml(yaml_out *out, const weft_stepper_type *type)
{
    yaml_out_write(out, "{ name: \"%s\"", type->name);
    if (weft_stepper_full_name(type) != NULL) {
        yaml_out_write(out, "full_name: \"%s\"", weft_stepper_full_name(type));
    }
    yaml_out_write(out, "order: %d, error_order: %d, stages: %d", type->order,
                   type->error_order, type->stages);
    for (size_t i = 0; i < FLAG_NAMES; ++i) {
        yaml_out_write(out, "%s: %s", flag_names[i].name,
                       yaml_bool((type->flags & flag_names[i].flag) != 0));
    }
    yaml_out_write(out, "reference: \"%s\", license: \"%s\" }", type->reference,
                   type->license);
}

static int print_yaml(const weft_registry *registry)
{
    yaml_out out;
    yaml_out_begin(&out, stdout);
    yaml_out_write(&out, "plugins: [");
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        const weft_plugin *plugin = weft_registry_at(registry, i);
        yaml_out_write(&out,
                       "{ id: \"%s\", version: \"%s\", solver: \"%s\", file: \"%s\", "
                       "methods: [",
                       plugin->id, plugin->version, plugin->solver,
                       weft_registry_file(registry, i));
        for (size_t m = 0; plugin->types[m] != NULL; ++m) {
            method_yaml(&out, plugin->types[m]);
        }
        yaml_out_write(&out, "] }");
    }
    yaml_out_write(&out, "]");
    return yaml_out_end(&out) ? EXIT_DONE : EXIT_FILE;
}

static int steppers_verb(const arguments *given)
{
    weft_error err = { 0 };
    if (load_plugins(given->registry, &err) != WEFT_OK) {
        return report_error(&err);
    }
    if (given->yaml) {
        return print_yaml(given->registry);
    }
    (given->markdown ? print_markdown : print_text)(given->registry);
    return EXIT_DONE;
}

static const verb_option options[] = {
    SHARED(yaml, "yaml", NULL, "as YAML, with references and full names"),
    SHARED(markdown, "markdown", NULL, "the table of the documentation"),
    OPTION_PLUGIN_PATH,
};

const verb verb_steppers = {
    .name = "steppers",
    .summary = "list the methods of all plugins",
    .help = "usage: weft steppers [OPTIONS]\n"
            "\n"
            "Lists every method of every plugin: order of the solution, order of the "
            "solution it is compared with, evaluations of the forces per step, kind, "
            "source.\n",
    OPTIONS(options),
    .more = "kinds: fixed-step (no error control), fsal (the last stage is the first "
            "of the next step), multistep, implicit, small-cloths (dense matrices), "
            "legacy, libm (uses powers of libm: the same bits on every machine are "
            "likely, not guaranteed)\n"
            "\n"
            "Plugin arkode has more methods with later versions of SUNDIALS; rkc and "
            "rkl, stabilised, need 7.2.\n",
    .operands = { 0, 0, "takes no file", NULL },
    .run = steppers_verb,
};
