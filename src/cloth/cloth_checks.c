/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth_checks.c -- what the forces check of a cloth: its start, its steps and its
 * frames (forces/force_checks.h). */
#include "cloth/model.h"
#include "mesh/surface.h"

/* ---- which checks a cloth has ---------------------------------------------------- */

#define ASK(name, question)                                                            \
    bool name(const weft_cloth *cloth)                                                 \
    {                                                                                  \
        bool yes = false;                                                              \
        for (size_t k = 0; k < WEFT__FORCES && !yes; ++k) {                            \
            const weft__force_checks *of = &weft__table[k].force->checks;              \
            yes = of->question != NULL && of->question(weft__own(cloth, k));           \
        }                                                                              \
        return yes;                                                                    \
    }
ASK(weft__cloth_gathers, gathers)
ASK(weft__cloth_pairs, pairs)

bool weft__cloth_passages(const weft_cloth *cloth)
{
    bool passages = false;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        passages = passages || (force != NULL && force->checks.passages != NULL);
    }
    return passages;
}

double weft__cloth_reach(const weft_cloth *cloth)
{
    double reach = 0.0;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_checks *of = &weft__table[k].force->checks;
        reach = of->reach != NULL ? fmax(reach, of->reach(weft__own(cloth, k))) : reach;
    }
    return reach;
}

const char *weft__cloth_no_bands(const weft_cloth *cloth)
{
    const char *name = NULL;
    for (size_t k = 0; k < WEFT__FORCES && name == NULL; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        name = force != NULL ? force->checks.no_bands : NULL;
    }
    return name;
}

const char *weft__def_no_bands(const weft_cloth_def *def)
{
    const char *name = NULL;
    for (size_t k = 0; k < WEFT__FORCES && name == NULL; ++k) {
        const weft__force_checks *of = &weft__table[k].force->checks;
        name = of->asked != NULL && of->asked(def) ? of->no_bands : NULL;
    }
    return name;
}

bool weft__def_has_gaps(const weft_cloth_def *def)
{
    bool has = false;
    for (size_t k = 0; k < WEFT__FORCES && !has; ++k) {
        const weft__force *force = weft__table[k].force;
        has = force->measures.gaps != NULL && force->checks.asked != NULL
              && force->checks.asked(def);
    }
    return has;
}

/* ---- crossings ------------------------------------------------------------------- */

weft_status weft__crossings_error(const weft_cloth *cloth, double t, const double *y,
                                  const weft__search *of, weft_error *err)
{
    weft_status status = WEFT_OK;
    for (size_t k = 0; k < WEFT__FORCES && status == WEFT_OK; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        status = force != NULL && force->checks.crossing != NULL
                     ? force->checks.crossing(weft__own(cloth, k), t, y, of, err)
                     : WEFT_OK;
    }
    return status;
}

/* ---- passages -------------------------------------------------------------------- */

weft__passages weft__block_passages(const weft_cloth *cloth, const weft__state *at,
                                    size_t b, double rise)
{
    weft__passages all = { .count = 0, .wait = (double)INFINITY };
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        if (force != NULL && force->checks.passages != NULL) {
            weft__passages one
                = force->checks.passages(weft__own(cloth, k), at, b, rise);
            one.wait = fmin(one.wait, all.wait);
            if (all.count > 0) {
                one.first = all.first, one.shape = all.shape, one.count += all.count;
            }
            all = one;
        }
    }
    return all;
}

size_t weft_cloth_passages(const weft_cloth *cloth, double t, const double *y,
                           weft_passage *first)
{
    const weft__mesh *mesh = &cloth->mesh;
    const weft__state at = { .t = t, .y = y };
    weft__passages all = { .count = 0 };
    for (size_t b = mesh->band.above; b < mesh->band.above + mesh->band.own; ++b) {
        weft__passages block = weft__block_passages(cloth, &at, b, 0.0);
        block.count += all.count;
        if (all.count == 0) {
            all = block;
        }
        all.count = block.count;
    }
    for (size_t k = 0; k < all.first.count; ++k) {
        all.first.particle[k] = weft__shown(mesh, all.first.particle[k]);
    }
    if (first != NULL) {
        *first = (weft_passage){ all.first, all.shape };
    }
    return all.count;
}

const char *weft__passage_text(const weft_cloth *cloth, double t,
                               const weft_passage *at, double count,
                               char text[WEFT__PASSAGE_TEXT])
{
    char name[WEFT__PASSAGE_TEXT / 2], others[64] = "";
    if (count > 1.0) {
        (void)snprintf(others, sizeof others, ", one of %.0f edges and triangles",
                       count);
    }
    (void)snprintf(
        text, WEFT__PASSAGE_TEXT,
        "%s passes through shapes[%zu] at t = %.9g s%s: only particles touch a %s; "
        "give "
        "it triangles: true, or the cloth a finer mesh",
        weft__primitive_text(&cloth->mesh, &at->primitive, name, sizeof name),
        at->shape, t, others, weft_shape_name(weft_cloth_shape(cloth, at->shape).kind));
    return text;
}
