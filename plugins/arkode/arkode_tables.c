/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_tables.c -- Butcher tables: ARKODE's, the classics, and the user's own after a
 * check of their shape and order. */
#include "arkode_plugin.h"

#include <math.h>

#define LIST(...) ((const double[]){ __VA_ARGS__ })

const weft_butcher weft__ark_euler = { .stages = 1,
                                       .order = 1,
                                       .a = LIST(0),
                                       .b = LIST(1),
                                       .c = LIST(0),
                                       .b_embedded = NULL };

const weft_butcher weft__ark_midpoint = {
    .stages = 2,
    .order = 2,
    .a = LIST(0, 0, 0.5, 0),
    .b = LIST(0, 1),
    .c = LIST(0, 0.5),
    .b_embedded = NULL,
};

const weft_butcher weft__ark_heun = {
    .stages = 2,
    .order = 2,
    .a = LIST(0, 0, 1, 0),
    .b = LIST(0.5, 0.5),
    .c = LIST(0, 1),
    .b_embedded = NULL,
};

const weft_butcher weft__ark_rk4 = {
    .stages = 4,
    .order = 4,
    .a = LIST(0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1, 0),
    .b = LIST(1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6),
    .c = LIST(0, 0.5, 0.5, 1),
    .b_embedded = NULL,
};

const weft_butcher weft__ark_rk38 = {
    .stages = 4,
    .order = 4,
    .a = LIST(0, 0, 0, 0, 1.0 / 3, 0, 0, 0, -1.0 / 3, 1, 0, 0, 1, -1, 1, 0),
    .b = LIST(0.125, 0.375, 0.375, 0.125),
    .c = LIST(0, 1.0 / 3, 2.0 / 3, 1),
    .b_embedded = NULL,
};

/* Row sums of coefficients that were rounded when they were written. */
#define SUM_TOLERANCE 1e-9

/* The fault of the shape, or NULL. */
static const char *misshapen(const weft_butcher *t)
{
    return t->stages < 1 || t->stages > WEFT__ARK_MAX_STAGES ? "stages must be 1 to 256"
           : t->a == NULL || t->b == NULL || t->c == NULL ? "a, b and c must be given"
           : t->order < 1                                 ? "order must be >= 1"
           : t->embedded_order < 0 ? "embedded_order must be >= 0"
           : (t->embedded_order > 0) != (t->b_embedded != NULL)
               ? "embedded_order and b_embedded must come together"
               : NULL;
}

/* Explicit, finite, and rows of A that add up to c. */
static weft_status check_rows(const weft_butcher *t, weft_error *err)
{
    const size_t s = (size_t)t->stages;
    for (size_t i = 0; i < s; ++i) {
        double sum = 0.0;
        for (size_t j = 0; j < s; ++j) {
            const double a = t->a[i * s + j];
            if (j >= i && a != 0.0) {
                return weft_error_set(err, WEFT_INVALID,
                                      "custom: A[%zu][%zu] must be 0: the table is "
                                      "explicit, A strictly lower triangular",
                                      i, j);
            }
            sum += a;
        }
        if (!(fabs(sum - t->c[i]) <= SUM_TOLERANCE)) {
            return weft_error_set(
                err, WEFT_INVALID,
                "custom: row %zu of A adds up to %.10g, but c[%zu] is "
                "%.10g",
                i, sum, i, t->c[i]);
        }
    }
    return WEFT_OK;
}

static weft_status check_order(const weft_butcher *t, const double *weights, int order,
                               const char *name, weft_error *err)
{
    const char *what = NULL;
    double is = 0.0, wanted = 0.0;
    if (weft__ark_has_order(t, weights, order, &what, &is, &wanted)) {
        return WEFT_OK;
    }
    return weft_error_set(
        err, WEFT_INVALID,
        "custom: %s is not of order %d: %s does not hold: it is %.10g "
        "instead of %.10g",
        name, order, what, is, wanted);
}

/* An estimate that is 0 would accept every step. */
static bool estimates(const weft_butcher *t)
{
    for (int i = 0; i < t->stages; ++i) {
        if (t->b[i] != t->b_embedded[i]) {
            return true;
        }
    }
    return false;
}

static weft_status check_custom(const weft_butcher *t, weft_error *err)
{
    const char *wrong = misshapen(t);
    if (wrong != NULL) {
        return weft_error_set(err, WEFT_INVALID, "custom: %s", wrong);
    }
    weft_status status = check_rows(t, err);
    if (status == WEFT_OK) {
        status = check_order(t, t->b, t->order, "b", err);
    }
    if (status != WEFT_OK || t->b_embedded == NULL) {
        return status;
    }
    if (!estimates(t)) {
        return weft_error_set(err, WEFT_INVALID, "custom: b_embedded is b");
    }
    return check_order(t, t->b_embedded, t->embedded_order, "b_embedded", err);
}

/* ARKODE chooses h by the embedded order: by the lower one, should that be the order of
 * the solution carried on. */
static ARKodeButcherTable build(const weft_butcher *t)
{
    const size_t s = (size_t)t->stages;
    ARKodeButcherTable out = ARKodeButcherTable_Alloc(t->stages, t->b_embedded != NULL);
    if (out == NULL) {
        return NULL;
    }
    out->q = t->order;
    out->p = t->embedded_order < t->order ? t->embedded_order : t->order;
    for (size_t i = 0; i < s; ++i) {
        for (size_t j = 0; j < s; ++j) {
            out->A[i][j] = t->a[i * s + j];
        }
        out->b[i] = t->b[i];
        out->c[i] = t->c[i];
        if (t->b_embedded != NULL) {
            out->d[i] = t->b_embedded[i];
        }
    }
    return out;
}

weft_status weft__ark_table(const ark_method *method, const weft_butcher *custom,
                            ARKodeButcherTable *out, weft_error *err)
{
    const bool wanted = (method->type.flags & WEFT_STEPPER_BUTCHER) != 0;
    const char *name = method->type.name;
    *out = NULL;
    const weft_status status = wanted ? check_custom(custom, err) : WEFT_OK;
    if (status != WEFT_OK) {
        return status;
    }
    if (method->stabilised) {
        return WEFT_OK;
    }
    *out = wanted                  ? build(custom)
           : method->table != NULL ? build(method->table)
           : (method->type.flags & WEFT_STEPPER_IMPLICIT) != 0
               ? ARKodeButcherTable_LoadDIRK(method->dirk)
               : ARKodeButcherTable_LoadERK(method->id);
    return *out != NULL ? WEFT_OK
                        : weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", name);
}

bool weft__ark_table_is_fsal(ARKodeButcherTable table)
{
    const int s = table->stages;
    bool same = s > 1 && table->c[s - 1] == 1.0;
    for (int j = 0; same && j < s; ++j) {
        same = table->A[s - 1][j] == table->b[j];
    }
    return same;
}

bool weft__ark_table_hides(ARKodeButcherTable table, bool adaptive)
{
    const int s = table->stages;
    bool hidden = false;
    for (int j = 0; j < s && !hidden; ++j) {
        hidden = table->b[j] == 0.0 && !(adaptive && table->d[j] != 0.0);
        for (int i = j + 1; i < s; ++i) {
            hidden = hidden && table->A[i][j] == 0.0;
        }
    }
    return hidden;
}
