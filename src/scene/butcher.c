/* SPDX-License-Identifier: BSD-3-Clause */
/* butcher.c -- the Runge-Kutta table of a scene. */
#include <math.h>

#include "scene/checks.h"

#define MAX_STAGES 256

/* Allows for coefficients that are written with fewer digits than a double has. */
#define SUM_TOLERANCE 1e-9

/* Room for as many values as there are stages, or the square of that, in a list; false:
 * it was refused, or no memory. */
static bool take_values(weft__reader *reader, const weft__key *key,
                        const weft__node *node, weft__list *list)
{
    const size_t count = weft__item_count(node);
    const size_t all = key->kind == WEFT__ROWS ? count * count : count;
    if (count == 0) {
        weft__refuse_value(reader, key, node);
    } else if (count > MAX_STAGES) {
        ERROR_AT(reader, node, "%s has %zu stages; the most is %d", key->name, count,
                 MAX_STAGES);
    } else {
        list->values = weft__tree_take(reader->tree, all, sizeof *list->values);
        list->side = count;
    }
    return list->values != NULL;
}

void weft__read_row(weft__reader *reader, const weft__key *key, const weft__node *node,
                    void *to)
{
    weft__list *list = to;
    if (take_values(reader, key, node, list)) {
        const bool good
            = weft__read_numbers(reader, key, key->name, node, list->values);
        list->count = good ? list->side : 0;
    }
}

/* Row i of A into values[side], which are 0: on and above the diagonal they stay so. */
static bool read_matrix_row(weft__reader *reader, const weft__key *key,
                            const weft__node *row, size_t i, size_t side,
                            double *values)
{
    const size_t count = weft__item_count(row);
    weft__key like = *key;
    char name[64], item[32];
    (void)snprintf(name, sizeof name, "row %zu of A", i);
    (void)snprintf(item, sizeof item, "A[%zu]", i);
    like.name = name;
    like.kind = WEFT__ROW;
    if (row->type != WEFT__LIST) {
        weft__refuse_value(reader, &like, row);
        return false;
    }
    if (count > side) {
        ERROR_AT(reader, row, "%s has %zu values, but A has %zu rows", name, count,
                 side);
        return false;
    }
    bool good = weft__read_numbers(reader, key, item, row, values);
    for (size_t j = i; j < count; ++j) {
        if (values[j] != 0.0) {
            ERROR_AT(
                reader, weft__item(row, j),
                "%s[%zu] must be 0: the table is explicit, A strictly lower triangular",
                item, j);
            good = false;
        }
    }
    return good;
}

void weft__read_rows(weft__reader *reader, const weft__key *key, const weft__node *node,
                     void *to)
{
    weft__list *list = to;
    const size_t side = weft__item_count(node);
    bool good = true;
    if (!take_values(reader, key, node, list)) {
        return;
    }
    for (size_t i = 0; i < side; ++i) {
        good = read_matrix_row(reader, key, weft__item(node, i), i, side,
                               list->values + i * side)
               && good;
    }
    list->count = good ? side * side : 0;
}

static void check_length(weft__reader *reader, const weft__match *match,
                         const char *name, const weft__list *list, size_t stages)
{
    const weft__node *node = weft__value_in(match, name);
    if (list->side > 0 && stages > 0 && list->side != stages) {
        ERROR_AT(reader, node, "%s has %zu values, but A has %zu rows", name,
                 list->side, stages);
    }
}

static void check_sum(weft__reader *reader, weft__mark at, const char *what,
                      const double *values, size_t count, double wanted)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += values[i];
    }
    if (!(fabs(sum - wanted) <= SUM_TOLERANCE)) {
        weft__report_warning(reader->report, at, "%s adds up to %.10g instead of %.10g",
                             what, sum, wanted);
    }
}

/* The conditions of order 1, and of treating time as a component of the state. */
static void check_sums(weft__reader *reader, const weft__match *match,
                       const weft__tableau *table)
{
    const size_t stages = table->a.side;
    const weft__node *rows = weft__value_in(match, "A");
    const weft__node *embedded = weft__value_in(match, "b_embedded");
    if (table->a.count == 0 || table->b.count != stages || table->c.count != stages) {
        return;
    }
    for (size_t i = 0; i < stages; ++i) {
        char name[64];
        (void)snprintf(name, sizeof name, "row %zu of A", i);
        check_sum(reader, weft__item(rows, i)->at, name, table->a.values + i * stages,
                  stages, table->c.values[i]);
    }
    check_sum(reader, weft__value_in(match, "b")->at, "b", table->b.values, stages,
              1.0);
    if (embedded != NULL && table->b_embedded.count == stages) {
        check_sum(reader, embedded->at, "b_embedded", table->b_embedded.values, stages,
                  1.0);
    }
}

void weft__check_butcher(weft__reader *reader, const weft__match *match, void *base)
{
    weft__tableau *table = base;
    const size_t stages = table->a.side;
    check_length(reader, match, "b", &table->b, stages);
    check_length(reader, match, "c", &table->c, stages);
    check_length(reader, match, "b_embedded", &table->b_embedded, stages);
    check_sums(reader, match, table);
    table->set.stages = (int)stages;
    table->set.a = table->a.values;
    table->set.b = table->b.values;
    table->set.c = table->c.values;
    table->set.b_embedded = table->b_embedded.values;
    reader->scene->config.butcher = &table->set;
}
