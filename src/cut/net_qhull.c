/* SPDX-License-Identifier: BSD-3-Clause */
/* net_qhull.c -- the Delaunay triangulation of points by Qhull (C. B. Barber, D. P.
 * Dobkin, H. Huhdanpaa, ACM Trans. Math. Softw. 22, 1996): the one file that includes
 * it. */
#include <libqhull_r/libqhull_r.h>
#include <stdio.h>
#include <stdlib.h>

#include "cut/net.h"

static uint32_t *corners_of(qhT *qh, size_t *triangles)
{
    facetT *facet;
    vertexT *vertex, **vertexp;
    size_t count = 0, corner = 0;
    FORALLfacets
    {
        count += !facet->upperdelaunay;
    }
    uint32_t *out = malloc((count + 1) * 3 * sizeof *out);
    *triangles = count;
    if (out == NULL) {
        return NULL;
    }
    FORALLfacets
    {
        if (!facet->upperdelaunay && qh_setsize(qh, facet->vertices) != 3) {
            free(out);
            return NULL;
        }
        if (!facet->upperdelaunay) {
            FOREACHvertex_(facet->vertices)
            {
                out[corner++] = (uint32_t)qh_pointid(qh, vertex->point);
            }
        }
    }
    return out;
}

uint32_t *net_qhull(size_t points, const int32_t (*grid)[2], size_t *triangles)
{
    static char command[] = "qhull d Qt Qbb Qc";
    double *at = malloc((points + 1) * 2 * sizeof *at);
    FILE *silent = fopen("/dev/null", "w");
    uint32_t *out = NULL;
    if (at != NULL && silent != NULL) {
        qhT qh;
        int left, blocks;
        for (size_t i = 0; i < points; ++i) {
            at[2 * i] = grid[i][0];
            at[2 * i + 1] = grid[i][1];
        }
        qh_zero(&qh, silent);
        if (qh_new_qhull(&qh, 2, (int)points, at, False, command, NULL, silent) == 0) {
            out = corners_of(&qh, triangles);
        }
        qh_freeqhull(&qh, !qh_ALL);
        qh_memfreeshort(&qh, &left, &blocks);
    }
    if (silent != NULL) {
        (void)fclose(silent);
    }
    free(at);
    return out;
}
