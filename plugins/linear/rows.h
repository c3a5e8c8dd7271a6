/* SPDX-License-Identifier: BSD-3-Clause */
/* rows.h -- what the levels of smoothed.h are made of, from the graph alone:
 * patterns of rows, and aggregates of the particles of a network. */
#pragma once

#include "network.h"

/* n rows of blocks; the columns of row i are column[start[i]] to column[start[i + 1]],
 * in the order in which they were found. */
typedef struct weft__rows {
    size_t n;
    size_t *start;
    uint32_t *column;
    double *block;
} weft__rows;

/* Adds the columns of row i of a pattern; those that it has already are passed over. */
typedef struct weft__pattern weft__pattern;
typedef void weft__list_fn(const void *ctx, size_t i, weft__pattern *to);
void weft__add_column(weft__pattern *to, uint32_t column);

/* Makes the pattern of to->n rows from columns below `columns`; takes start and column
 * from the pile. To be called whether a pile has failed or not, as the others are. */
void weft__make_pattern(weft__rows *to, size_t columns, weft__list_fn *list,
                        const void *ctx, weft__pile *pile, weft__pile *scratch);

/* The rows that have each of to->n columns. */
void weft__transpose(const weft__rows *of, weft__rows *to, weft__pile *pile);

/* The place in block of a column that row i has. */
size_t weft__place_of(const weft__rows *of, size_t i, uint32_t column);

/* The rows of the rows of b that row i of a has; with_own: and of row i of b. */
typedef struct weft__product {
    const weft__rows *a, *b;
    bool with_own;
} weft__product;
weft__list_fn weft__list_product;

/* Neighbours in aggregates: nodes whose neighbours are all free, with these; what is
 * left joins a neighbour's (P. Vanek, J. Mandel, M. Brezina, Computing 56, 1996).
 * Writes the aggregate of each node to to[n]; returns their number. late[n]: scratch.
 */
size_t weft__gather(const weft__rows *graph, uint32_t *to, uint32_t *late);
