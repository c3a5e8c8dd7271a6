/* SPDX-License-Identifier: BSD-3-Clause */
/* main.c -- the program behind `make verify`: a table on stdout; exit status 1 if a row
 * of it is out of bounds. What is out of bounds is marked with a !. With the id of a
 * plugin as its argument it judges the methods of that one alone. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "study/conformance/oscillators.h"
#include "verify/verify.h"

typedef struct report {
    weft_registry *registry;
    const char *only;                              /* a plugin's id; NULL: all */
    verify_reference references[VERIFY_SCENES][2]; /* as shipped, small */
    char shipped[VERIFY_SHIPPED_MOST][VERIFY_NAME];
    verify_counts counts;
} report;

static const char *mark(report *self, bool good)
{
    ++self->counts.judged;
    self->counts.failed += good ? 0 : 1;
    return good ? " " : "!";
}

/* What cannot be had in this build is no failure. */
static void print_failure(report *self, const weft_error *err)
{
    const bool lacks = err->status == WEFT_UNSUPPORTED;
    printf(" %s %s\n", lacks ? "not judged:" : mark(self, false), err->message);
}

static bool judges(const report *self, const stepper_method *method)
{
    return self->only == NULL || strcmp(self->only, method->plugin->id) == 0;
}

static void print_plugins(const report *self)
{
    for (size_t i = 0; i < weft_registry_count(self->registry); ++i) {
        const weft_plugin *plugin = weft_registry_at(self->registry, i);
        printf("%s %s%s%s%s", i == 0 ? "plugins:" : ",", plugin->id,
               plugin->solver[0] == '\0' ? "" : " (", plugin->solver,
               plugin->solver[0] == '\0' ? "" : ")");
    }
    printf("\n");
}

/* ---- references ------------------------------------------------------------------ */

static void print_reference(report *self, const verify_scene *scene,
                            verify_reference *reference)
{
    weft_error err = { 0 };
    const weft_status status
        = verify_reference_make(self->registry, scene, reference, &err);
    const verify_stepper *by = reference->by;
    printf("  %-12s", scene->name);
    if (status != WEFT_OK) {
        print_failure(self, &err);
        return;
    }
    const double tightest = verify_tolerance(by[0].method.type);
    printf(" %4zu particles: %s %s, cross-checked by %s %s, both at %.0e: apart by "
           "%.1e%s\n",
           reference->frames.dim / 6, by[0].method.plugin->id, by[0].method.type->name,
           by[1].method.plugin->id, by[1].method.type->name, by[0].tolerance,
           reference->apart,
           mark(self, reference->apart <= VERIFY_REFERENCE_BOUND * tightest));
}

static void print_references(report *self)
{
    printf("\nReferences: must agree to %g of the tolerance judged\n",
           VERIFY_REFERENCE_BOUND);
    for (int small = 0; small < 2; ++small) {
        for (size_t i = 0; i < VERIFY_SCENES; ++i) {
            print_reference(self, verify_scene_at(i, small != 0),
                            &self->references[i][small]);
        }
    }
}

/* ---- order and accuracy ---------------------------------------------------------- */

static void print_order(report *self, const weft_stepper_type *type)
{
    const int claimed = weft__order_claimed(type);
    weft_error err = { 0 };
    double order = 0.0;
    if (claimed == 0) {
        printf(" var    -  ");
    } else if (weft__order(type, claimed, &order, &err) != WEFT_OK) {
        print_failure(self, &err);
    } else {
        printf(" %3d %5.2f%s", claimed, order,
               mark(self, fabs(order - claimed) <= WEFT__ORDER_BOUND));
    }
}

static void print_accuracy(report *self, const stepper_method *method, size_t i)
{
    const bool small = verify_small(method->type);
    const verify_reference *reference = &self->references[i][small ? 1 : 0];
    weft_error err = { 0 };
    verify_accuracy a;
    const weft_status status
        = reference->frames.y == NULL
              ? weft_error_set(&err, WEFT_UNSUPPORTED, "no reference")
              : verify_accuracy_of(self->registry, verify_scene_at(i, small), method,
                                   reference, &a, &err);
    if (status != WEFT_OK) {
        print_failure(self, &err);
        return;
    }
    printf(" | %6.2g%s%6llu %4llu %6llu", a.error,
           mark(self, a.error <= VERIFY_ERROR_BOUND), (unsigned long long)a.stats.steps,
           (unsigned long long)a.stats.rejected, (unsigned long long)a.stats.rhs_calls);
}

static void print_methods(report *self)
{
    stepper_method m;
    printf(
        "\nOrder, measured within %g of the claim; error after a short run, within %g "
        "tolerances of the\nreference (*: with %zu, %zu and %zu particles)\n",
        WEFT__ORDER_BOUND, VERIFY_ERROR_BOUND, self->references[0][1].frames.dim / 6,
        self->references[1][1].frames.dim / 6, self->references[2][1].frames.dim / 6);
    printf("%-35s order      tol", "");
    for (size_t i = 0; i < VERIFY_SCENES; ++i) {
        printf(" | %-24s", verify_scene_at(i, false)->name);
    }
    printf("\n%-8s %-20s claimed measured  ", "plugin", "method");
    for (size_t i = 0; i < VERIFY_SCENES; ++i) {
        printf(" | error  steps  rej    rhs");
    }
    printf("\n");
    for (size_t k = 0; method_at(self->registry, k, &m); ++k) {
        if (!judges(self, &m)) {
            continue;
        }
        printf("%-8s %-24s", m.plugin->id, m.type->name);
        print_order(self, m.type);
        if (!method_adapts(m.type) || !verify_any_damping(m.type)) {
            printf("   -   %s\n",
                   method_adapts(m.type) ? "damped cloth only" : "fixed steps only");
            continue;
        }
        printf(" %.0e%s", verify_tolerance(m.type), verify_small(m.type) ? "*" : " ");
        for (size_t i = 0; i < VERIFY_SCENES; ++i) {
            print_accuracy(self, &m, i);
        }
        printf("\n");
        fflush(stdout);
    }
}

/* ---- stages ---------------------------------------------------------------------- */

static void print_stages(const report *self)
{
    stepper_method m;
    printf("\nMethods that evaluate the forces outside of their step of h\n");
    for (size_t k = 0; method_at(self->registry, k, &m); ++k) {
        weft_error err = { 0 };
        double range[2];
        if (judges(self, &m) && verify_stages_of(m.type, range, &err) == WEFT_OK
            && verify_stages_outside(range)) {
            printf("  %-8s %-20s from %5.2f h to %.2f h\n", m.plugin->id, m.type->name,
                   range[0], range[1]);
        }
    }
}

/* ---- pairs ----------------------------------------------------------------------- */

static void print_pairs(report *self)
{
    const verify_pair *pair;
    printf(
        "\nThe same table in two plugins, %d equal fixed steps of a cloth of 17 x 17: "
        "apart by at most %g\n",
        VERIFY_PAIR_STEPS, VERIFY_PAIR_BOUND);
    for (size_t i = 0; (pair = verify_pair_at(i)) != NULL; ++i) {
        weft_error err = { 0 };
        double apart = 0.0;
        const weft_status status
            = verify_pair_apart(self->registry, pair, &apart, &err);
        printf("  %s %s, %s %s:", pair->names[0][0], pair->names[0][1],
               pair->names[1][0], pair->names[1][1]);
        if (status == WEFT_OK) {
            printf(" %.1e%s\n", apart, mark(self, apart <= VERIFY_PAIR_BOUND));
        } else {
            print_failure(self, &err);
        }
    }
}

/* ---- shipped scenes -------------------------------------------------------------- */

static void print_shipped_run(report *self, const verify_scene *scene,
                              const stepper_method *method,
                              const verify_frames *reference)
{
    weft_error err = { 0 };
    verify_shipped_result r = { 0 };
    printf("  %-8s %-20s", method->plugin->id, method->type->name);
    if (verify_shipped_run(self->registry, scene, method, reference, &r, &err)
        != WEFT_OK) {
        print_failure(self, &err);
    } else {
        printf(" %6llu steps, energy within %5.2f %%%s", (unsigned long long)r.steps,
               100.0 * r.energy, mark(self, r.energy <= VERIFY_ENERGY_BOUND));
        printf(r.fixed_step > 0.0 ? " fixed: %.1e s\n" : "\n", r.fixed_step);
    }
    fflush(stdout);
}

static void print_shipped_scene(report *self, const char *name)
{
    weft_error err = { 0 };
    verify_scene scene;
    verify_frames reference;
    stepper_method m;
    const weft_status status = verify_shipped_reference(self->registry, name, false,
                                                        &scene, &reference, &err);
    printf("%s, %zu particles%s%s\n", name, reference.dim / 6,
           scene.sets[0] == NULL ? "" : ", cut short: ",
           scene.sets[0] == NULL ? "" : scene.sets[0]);
    if (status != WEFT_OK) {
        print_failure(self, &err);
    }
    for (size_t k = 0; status == WEFT_OK && method_at(self->registry, k, &m); ++k) {
        if (judges(self, &m) && verify_shipped_suits(m.type, &reference)) {
            print_shipped_run(self, &scene, &m, &reference);
        }
    }
    verify_frames_free(&reference);
}

static void print_shipped_part(void *ctx, size_t i, verify_counts *counts)
{
    report *self = ctx;
    self->counts = (verify_counts){ 0 };
    print_shipped_scene(self, self->shipped[i]);
    *counts = self->counts;
}

static void print_shipped(report *self)
{
    const size_t count = verify_shipped(self->shipped);
    printf("\nEvery shipped scene by every method without dense matrices (multistep: "
           "without "
           "a limit): adaptive\nat %g (order 1: a tenth), or with the first of 2^-8, "
           "2^-9, ... s that is stable; energy within %g %%\nof what is at play\n",
           VERIFY_SHIPPED_TOLERANCE, 100.0 * VERIFY_ENERGY_BOUND);
    if (count == 0 || !verify_apart(count, print_shipped_part, self, &self->counts)) {
        printf("not all scenes were found and run%s\n", mark(self, false));
    }
}

int main(int argc, char **argv)
{
    report self = { .registry = verify_registry(), .only = argc > 1 ? argv[1] : NULL };
    if (self.registry == NULL) {
        return EXIT_FAILURE;
    }
    print_plugins(&self);
    print_references(&self);
    print_methods(&self);
    print_stages(&self);
    print_pairs(&self);
    print_shipped(&self);
    printf("\n%zu facts, %zu out of bounds\n", self.counts.judged, self.counts.failed);
    for (size_t i = 0; i < VERIFY_SCENES; ++i) {
        verify_reference_free(&self.references[i][0]);
        verify_reference_free(&self.references[i][1]);
    }
    weft_registry_destroy(self.registry);
    return self.counts.failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
