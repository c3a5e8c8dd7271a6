/* SPDX-License-Identifier: BSD-3-Clause */
/* delaunay.c -- by Qhull (C. B. Barber, D. P. Dobkin, H. Huhdanpaa, ACM Trans. Math.
 * Softw. 22, 1996): the one file that includes it. */
#include "program/cut/cut.h"

#include <libqhull_r/libqhull_r.h>
#include <stdio.h>
#include <stdlib.h>

static uint32_t *corners_of(qhT *qh, size_t *triangles)
{
    facetT *facet;
    vertexT *vertex, **vertexp;
    size_t corners = 0;
    uint32_t *out = malloc(((size_t)qh->num_facets + 1) * 3 * sizeof *out);
    FORALLfacets
    {
        if (out == NULL || facet->upperdelaunay || !facet->simplicial) {
            continue;
        }
        FOREACHvertex_(facet->vertices)
        {
            out[corners++] = (uint32_t)qh_pointid(qh, vertex->point);
        }
    }
    *triangles = corners / 3;
    return out;
}

uint32_t *cut_delaunay(size_t points, double *at, size_t *triangles)
{
    static char command[] = "qhull d Qt Qbb";
    FILE *silent = fopen("/dev/null", "w");
    uint32_t *out = NULL;
    int left, blocks;
    qhT qh;
    if (silent == NULL) {
        return NULL;
    }
    qh_zero(&qh, silent);
    if (qh_new_qhull(&qh, 2, (int)points, at, False, command, NULL, silent) == 0) {
        out = corners_of(&qh, triangles);
    }
    qh_freeqhull(&qh, !qh_ALL);
    qh_memfreeshort(&qh, &left, &blocks);
    (void)fclose(silent);
    return out;
}
