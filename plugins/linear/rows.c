/* SPDX-License-Identifier: BSD-3-Clause */
#include "rows.h"

#define NONE UINT32_MAX

struct weft__pattern {
    weft__rows *to;
    uint32_t *seen; /* of each column: the last row that has it */
    size_t row, end;
    bool fill; /* else it counts */
};

void weft__add_column(weft__pattern *to, uint32_t column)
{
    if (to->seen[column] != (uint32_t)to->row) {
        to->seen[column] = (uint32_t)to->row;
        if (to->fill) {
            to->to->column[to->end] = column;
        }
        ++to->end;
    }
}

void weft__make_pattern(weft__rows *to, size_t columns, weft__list_fn *list,
                        const void *ctx, weft__pile *pile, weft__pile *scratch)
{
    uint32_t *seen = weft__pile_take(scratch, columns, sizeof *seen);
    to->start = weft__pile_take(pile, to->n + 1, sizeof *to->start);
    for (int pass = 0; pass < 2 && !pile->failed && !scratch->failed; ++pass) {
        weft__pattern of = { to, seen, 0, 0, pass == 1 };
        memset(seen, 0xff, columns * sizeof *seen);
        for (; of.row < to->n; ++of.row) {
            to->start[of.row] = of.end;
            list(ctx, of.row, &of);
        }
        to->start[to->n] = of.end;
        if (pass == 0) {
            to->column = weft__pile_take(pile, of.end, sizeof *to->column);
        }
    }
}

void weft__transpose(const weft__rows *of, weft__rows *to, weft__pile *pile)
{
    to->start = weft__pile_take(pile, to->n + 1, sizeof *to->start);
    to->column = pile->failed
                     ? NULL
                     : weft__pile_take(pile, of->start[of->n], sizeof *to->column);
    if (pile->failed) {
        return;
    }
    memset(to->start, 0, (to->n + 1) * sizeof *to->start);
    for (size_t e = 0; e < of->start[of->n]; ++e) {
        ++to->start[of->column[e]];
    }
    for (size_t i = 0; i < to->n; ++i) {
        to->start[i + 1] += to->start[i];
    }
    for (size_t i = of->n; i-- > 0;) {
        for (size_t e = of->start[i]; e < of->start[i + 1]; ++e) {
            to->column[--to->start[of->column[e]]] = (uint32_t)i;
        }
    }
}

size_t weft__place_of(const weft__rows *of, size_t i, uint32_t column)
{
    size_t e = of->start[i];
    while (of->column[e] != column) {
        ++e;
    }
    return e;
}

static void add_row(const weft__rows *of, size_t i, weft__pattern *to)
{
    for (size_t e = of->start[i]; e < of->start[i + 1]; ++e) {
        weft__add_column(to, of->column[e]);
    }
}

void weft__list_product(const void *ctx, size_t i, weft__pattern *to)
{
    const weft__product *of = ctx;
    if (of->with_own) {
        add_row(of->b, i, to);
    }
    for (size_t e = of->a->start[i]; e < of->a->start[i + 1]; ++e) {
        add_row(of->b, of->a->column[e], to);
    }
}

size_t weft__gather(const weft__rows *graph, uint32_t *to, uint32_t *late)
{
    size_t count = 0;
    memset(to, 0xff, graph->n * sizeof *to);
    for (size_t i = 0; i < graph->n; ++i) {
        bool clear = to[i] == NONE;
        for (size_t e = graph->start[i]; clear && e < graph->start[i + 1]; ++e) {
            clear = to[graph->column[e]] == NONE;
        }
        for (size_t e = graph->start[i]; clear && e < graph->start[i + 1]; ++e) {
            to[graph->column[e]] = (uint32_t)count;
        }
        if (clear) {
            to[i] = (uint32_t)count++;
        }
    }
    memcpy(late, to, graph->n * sizeof *to);
    for (size_t i = 0; i < graph->n; ++i) { /* it has such a neighbour */
        for (size_t e = graph->start[i]; to[i] == NONE && e < graph->start[i + 1];
             ++e) {
            to[i] = late[graph->column[e]];
        }
    }
    return count;
}
