/* SPDX-License-Identifier: BSD-3-Clause */
/* self.c -- the forces of self-contact, by the law of contact.h for the mass M, e W, of
 * a grid e W / 4, for e and v = sum b_i v_i (docs/theory/contact.md, "Pairs"). The
 * feet satisfy e_k.r = 0 for the edges e_k; hence along dx, with delta = sum b_i dx_i,
 * the weight changes by dW = lean.delta + turn_1.de_1 + turn_2.de_2. */
#include "forces/contact/self/self_list.h"

#include <stdio.h>
#include <string.h>

#include "forces/contact/self/self_law.h"
#include "mesh/grid_def.h"
#include "mesh/surface.h"
#include "mesh/triangles_work.h"

/* Of what two layers have by reduced areas, edges share this; facts of
 * docs/theory/contact.md
 */
#define EDGES_SHARE 0.125

static double grid_window(const weft__self *own, const weft__mesh *grid)
{
    return 1.0 / fmin(own->law.thickness / weft__shortest_edge(grid), 0.3);
}

weft__self_law weft__self_law_of(const weft__self *own)
{
    if (own->surface != NULL) {
        return (weft__self_law){ .own = own, .share = 1.0 };
    }
    const double a2 = own->mesh->spacing[0] * own->mesh->spacing[0];
    const double b2 = own->mesh->spacing[1] * own->mesh->spacing[1];
    return (weft__self_law){ .own = own,
                             .share = WEFT__GRID_SHARE,
                             .window = grid_window(own, own->mesh),
                             .square = { a2, b2, a2 + b2 } };
}

/* ---- forces ---------------------------------------------------------------------- */

/* [m^2] of an edge of a grid at rest */
static double self_rest_square(const weft__self_law *law, uint32_t a, uint32_t b)
{
    const uint32_t by = a < b ? b - a : a - b;
    return by == 1 && law->own->mesh->cols > 1 ? law->square[1]
           : by == law->own->mesh->cols        ? law->square[0]
                                               : law->square[2];
}

double weft__pair_rest(const weft__self_law *law, const weft__pair *pair)
{
    const weft__contact_surface *surface = law->own->surface;
    const uint32_t *i = pair->particle;
    if (pair->kind != WEFT__EDGES) {
        return 0.0;
    }
    return surface != NULL
               ? 1.0 / (surface->square[pair->item[0]] * surface->square[pair->item[1]])
               : 1.0
                     / (self_rest_square(law, i[0], i[1])
                        * self_rest_square(law, i[2], i[3]));
}

/* By reduced areas, and the smallest density of the free points. */
static double surface_mass(const weft__self *own, const weft__pair *pair)
{
    const weft__contact_surface *surface = own->surface;
    const bool edges = pair->kind == WEFT__EDGES;
    const double *areas = edges || pair->kind == WEFT__VERTEX_EDGE ? surface->edge_area
                          : pair->kind == WEFT__VERTICES           ? surface->area
                                                         : surface->triangle_area;
    const double a = (edges ? surface->edge_area : surface->area)[pair->item[0]];
    const double b = areas[pair->item[1]];
    double density = INFINITY;
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        const size_t i = pair->particle[k];
        density
            = weft__self_held(own, i) ? density : fmin(density, surface->density[i]);
    }
    return density < (double)INFINITY
               ? (edges ? EDGES_SHARE : 1.0) * density * (a * b / (a + b))
               : 0.0;
}

double weft__pair_mass(const weft__self *own, const weft__pair *pair)
{
    const weft__part *grid = weft__pair_grid(own, pair);
    double least = 0.0;
    if (own->surface != NULL && grid == NULL) {
        return surface_mass(own, pair);
    }
    for (size_t k = 0; k < weft__pair_particles(pair); ++k) {
        const size_t i = pair->particle[k];
        const double mass = own->mesh->pin[i] == 0 ? own->mesh->mass[i] : 0.0;
        least = mass > 0.0 && (least == 0.0 || mass < least) ? mass : least;
    }
    return grid != NULL ? -least : least;
}

void weft__pair_windows(const weft__self_law *law, const weft__pair *pair,
                        double window[3])
{
    const weft__contact_surface *surface = law->own->surface;
    const bool triangle = pair->kind == WEFT__VERTEX_TRIANGLE;
    for (size_t k = 0; k < 3; ++k) {
        window[k]
            = surface == NULL ? law->window
              : triangle
                  ? surface->triangle_window[k * surface->triangles + pair->item[1]]
              : pair->kind == WEFT__EDGES && k < 2 ? surface->edge_window[pair->item[k]]
              : pair->kind == WEFT__VERTEX_EDGE    ? surface->edge_window[pair->item[1]]
                                                   : 1.0;
    }
}

static inline void self_place(const double *planes, size_t n, const weft__pair *pair,
                              double x[4][3])
{
    for (size_t i = 0; i < weft__pair_particles(pair); ++i) {
        for (size_t k = 0; k < 3; ++k) {
            x[i][k] = planes[k * n + pair->particle[i]];
        }
    }
}

/* Whether a pair pushes unless its mass is 0. */
static bool is_pushing(const weft__self *own, const weft__pair *pair, const double *y)
{
    const weft__pair_kind kind = (weft__pair_kind)pair->kind;
    double x[4][3] = { { 0.0 } };
    self_place(y, own->points, pair, x);
    const law_gram of = law_gram_of(kind, x);
    return law_pushes(kind, &of, own->law.thickness);
}

double weft__pair_pushes(const weft__self *own, const weft__pair *pair, const double *y)
{
    return is_pushing(own, pair, y) ? weft__pair_mass(own, pair) : 0.0;
}

/* The mass of a pair that pushes, its feet, weighed, and the velocities of its
 * particles; 0: it does not push. */
static inline double self_meet(const weft__self_law *law, weft__pair_kind kind,
                               const weft__pair *pair, const double *y, law_feet *at,
                               double v[4][3])
{
    const size_t n = law->own->points;
    const double mass = weft__pair_mass(law->own, pair);
    double x[4][3], window[3];
    self_place(y, n, pair, x);
    const law_gram of = law_gram_of(kind, x);
    if (mass == 0.0 || !law_pushes(kind, &of, law->own->law.thickness)) {
        return 0.0;
    }
    self_place(y + 3 * n, n, pair, v);
    *at = law_feet_of(kind, &of);
    weft__pair_windows(law, pair, window);
    law_weigh(kind, law, weft__pair_rest(law, pair), window, at);
    return mass;
}

/* One function for each kind, as it is a constant. */
static inline bool self_push_kind(weft__pair_kind kind, const weft__self_law *law,
                                  const weft__pair *pair, const double *y,
                                  weft__pushes *out, size_t lane, double *bad)
{
    double v[4][3];
    law_feet at;
    law_push push;
    const double mass = self_meet(law, kind, pair, y, &at, v);
    if (mass == 0.0) {
        return false;
    }
    law_push_of(kind, &law->own->law, weft__pair_share(law, mass),
                weft__pair_friction(law->own, pair), law->own->max_friction, &at,
                fabs(mass), v, &push);
    for (size_t i = 0; i < weft__kind_particles(kind); ++i) {
        out->particle[i][lane] = (int32_t)pair->particle[i];
        for (size_t k = 0; k < 3; ++k) {
            out->force[i][k][lane] = push.force[i][k];
            *bad += push.force[i][k] * 0.0;
        }
    }
    out->gap[lane] = at.d, out->energy[lane] = push.energy;
    out->heat[lane] = push.heat, out->friction[lane] = push.friction;
    return true;
}

bool weft__pair_push(const weft__self_law *law, const weft__pair *pair, const double *y,
                     weft__pushes *out, size_t lane, double *bad)
{
    return BY_KIND(pair->kind, self_push_kind, law, pair, y, out, lane, bad);
}

bool weft__pair_meets(const weft__self_law *law, const weft__pair *pair,
                      const double *y, double arm[4], weft__touch *touch)
{
    const weft_contact_def *contact = &law->own->law;
    const weft__pair_kind kind = (weft__pair_kind)pair->kind;
    double v[4][3];
    law_feet at;
    const double mass = self_meet(law, kind, pair, y, &at, v);
    if (mass == 0.0) {
        return false;
    }
    *touch = (weft__touch){ .gap = at.d,
                            .steepness = 1.0,
                            .share = weft__pair_share(law, mass) * at.weight };
    touch->speed = law_slip(kind, &at, v, touch->normal, touch->slip);
    weft__touch_forces(contact, weft__pair_friction(law->own, pair), touch);
    touch->push *= fabs(mass), touch->stiffness *= fabs(mass);
    touch->friction_rate *= fabs(mass);
    memcpy(arm, at.arm, sizeof at.arm);
    return true;
}

static bool push_perturbed(const weft__self_law *law, const weft__pair *pair,
                           const double *y, weft__pushes *out, size_t lane, double *bad)
{
    return weft__pair_pushes(law->base, pair, law->base_y) != 0.0
           && weft__pair_push(law, pair, y, out, lane, bad);
}

#define EACH_NEAR(form, push)                                                          \
    size_t form(const weft__self_law *law, weft__pair_kind kind,                       \
                const weft__near *near, const weft__pair_subset *subsets,              \
                size_t subset_count, const double *y, weft__pushes *out, double *bad)  \
    {                                                                                  \
        size_t count = 0, i = 0;                                                       \
        for (size_t at = 0; at < subset_count; ++at) {                                 \
            for (; i < subsets[at].end[kind]; ++i) {                                   \
                const weft__pair pair = weft__near_pair(kind, near, i);                \
                count += !(near->slack[i] > subsets[at].moved)                         \
                         && push(law, &pair, y, &out[count / WEFT__BLOCK],             \
                                 count % WEFT__BLOCK, bad);                            \
            }                                                                          \
        }                                                                              \
        return count;                                                                  \
    }
EACH_NEAR(weft__pushes_loops, weft__pair_push)
EACH_NEAR(weft__pushes_derivatives, weft__pair_derivative)
EACH_NEAR(weft__pushes_perturbed, push_perturbed)

void weft__slack_loops(const weft__self *own, weft__pair_kind kind,
                       const weft__near *near, size_t first, size_t end,
                       const double *y, double most, double *distances)
{
    for (size_t i = first; i < end; ++i) {
        const weft__pair pair = weft__near_pair(kind, near, i);
        double x[4][3] = { { 0.0 } };
        self_place(y, own->points, &pair, x);
        distances[i] = law_distance(kind, x);
        near->slack[i] = law_slack(kind, x, distances[i], own->law.thickness, most);
    }
}

void weft__gaps_loops(const weft__self *own, weft__pair_kind kind,
                      const weft__near *near, const uint32_t *which, size_t count,
                      const double *y, double *gaps)
{
    for (size_t i = 0; i < count; ++i) {
        const weft__pair pair = weft__near_pair(kind, near, which[i]);
        gaps[i] = weft__pair_distance(&pair, y, own->points);
    }
}

size_t weft__within_loops(const double *numbers, size_t first, size_t end, double most,
                          uint32_t *which)
{
    size_t count = 0;
    for (; first < end; ++first) {
        which[count] = (uint32_t)first;
        count += !(numbers[first] > most);
    }
    return count;
}

size_t weft__meets_loops(const weft__self *own, weft__pair_kind kind,
                         const weft__near *near, const uint32_t *which, size_t count,
                         const double *y, uint32_t *out)
{
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) {
        const weft__pair pair = weft__near_pair(kind, near, which[i]);
        out[found] = which[i];
        found += is_pushing(own, &pair, y);
    }
    return found;
}

typedef struct measuring {
    const weft__self *own;
    const double *y;
    weft_measures *sum;
} measuring;

static void self_measure_pushes(void *ctx, weft__pair_kind kind,
                                const weft__pushes *pushes, size_t count)
{
    const measuring *of = ctx;
    const size_t n = of->own->points;
    const double *y = of->y;
    weft_measures *sum = of->sum;
    for (size_t i = 0; i < count; ++i) {
        const weft__pushes *from = &pushes[i / WEFT__BLOCK];
        const size_t lane = i % WEFT__BLOCK;
        weft__pair pair = { .kind = kind };
        sum->energy.contact += from->energy[lane];
        sum->power[WEFT_POWER_CONTACT] += from->heat[lane];
        sum->power[WEFT_POWER_FRICTION] += from->friction[lane];
        for (size_t k = 0; k < weft__kind_particles(kind); ++k) {
            const size_t at = pair.particle[k] = (uint32_t)from->particle[k][lane];
            const double v[3] = { y[3 * n + at], y[4 * n + at], y[5 * n + at] };
            const double f[3] = { from->force[k][0][lane], from->force[k][1][lane],
                                  from->force[k][2][lane] };
            if (of->own->mesh->pin[at] != 0) {
                sum->power[WEFT_POWER_PINS] -= weft__dot(f, v);
            }
        }
        if (from->gap[lane] < sum->self_gap) {
            weft__pair_primitives(&pair, sum->self_pair);
            sum->self_gap = from->gap[lane];
        }
        ++sum->self_touching;
    }
}

/* ---- without a list -------------------------------------------------------------- */

static bool take_pair(void *ctx, const weft__pair *pair)
{
    weft__self_pass *all = ctx;
    weft__push_fn *push = all->law.along != NULL  ? weft__pair_derivative
                          : all->law.base != NULL ? push_perturbed
                                                  : weft__pair_push;
    weft__pushes one;
    if (push(&all->law, pair, all->y, &one, 0, &all->bad)) {
        all->each(all->ctx, (weft__pair_kind)pair->kind, &one, 1);
    }
    return true;
}

bool weft__self_seek(const weft__self *own, weft__knot *knots, const double *y,
                     weft__pair_fn *visit, void *ctx)
{
    weft__quadtree tree = weft__tree_of(own, y);
    if (knots != NULL) {
        weft__tree_fill(&tree, knots);
    }
    return isfinite(weft__extent(own, NULL, y))
           && weft__each_pair(&tree, own->law.thickness, visit, ctx);
}

int weft__self_each(weft__self_pass *pass, weft__knot *knots)
{
    const weft__self_law *law = &pass->law;
    const weft__self *own = law->base != NULL ? law->base : law->own;
    const double *y = law->base != NULL ? law->base_y : pass->y;
    return !own->law.self
                   || (weft__self_seek(own, knots, y, take_pair, pass)
                       && pass->bad == 0.0)
               ? 0
               : 1;
}

static int each_pushed(const weft__self *own, weft__self_list *list,
                       const weft__state *at, weft__pushed_fn *each, void *ctx)
{
    weft__self_pass all
        = { .law = weft__self_law_of(own), .y = at->y, .each = each, .ctx = ctx };
    all.law.along = at->along;
    return list != NULL ? weft__self_list_each(list, at->y, &all)
                        : weft__self_each(&all, NULL);
}

void weft__self_measure(const void *own, void *list, const weft__state *at,
                        weft_measures *sum)
{
    measuring of = { own, at->y, sum };
    (void)each_pushed(own, list, at, self_measure_pushes, &of);
}

/* ---- its part of a cloth --------------------------------------------------------- */

/* Of a mesh: at most half its smallest height. */
static void check_heights(const weft_cloth_def *def, const weft__faults *to)
{
    const weft_mesh_def *mesh = def->mesh;
    double least = INFINITY;
    size_t lowest = 0;
    for (size_t t = 0; t < mesh->triangles; ++t) {
        double longest;
        const double area = fabs(weft__twice_area(mesh, t, &longest));
        lowest = area / longest < least ? t : lowest;
        least = fmin(least, area / longest);
    }
    if (def->contact.thickness > 0.5 * least * (1.0 + 1e-9)) { /* roundoff */
        size_t names[3];
        for (size_t k = 0; k < 3; ++k) {
            const size_t vertex = weft__vertex_at(mesh, lowest, k);
            names[k] = mesh->file_index != NULL ? mesh->file_index[vertex] : vertex;
        }
        weft__fault(to, offsetof(weft_contact_def, thickness),
                    offsetof(weft_contact_def, self),
                    "contact: thickness %g m is too large for self-contact: at most "
                    "%.6g m, half the smallest height at rest, of triangle %zu-%zu-%zu",
                    def->contact.thickness, 0.5 * least, names[0], names[1], names[2]);
    }
}

static void self_check_spacing(const weft_cloth_def *grid, const weft_contact_def *law,
                               const char *name, const weft__faults *to)
{
    weft__mesh mesh = { .rows = 0 };
    weft__grid_init(&mesh, grid);
    const double most = 0.5 * weft__shortest_edge(&mesh);
    if (law->self && law->thickness > most) {
        weft__fault(
            to, offsetof(weft_contact_def, thickness), offsetof(weft_contact_def, self),
            "contact: thickness %g m is too large for self-contact: at most %g m, half "
            "the smaller spacing%s%s",
            law->thickness, most, name != NULL ? " of " : "", name != NULL ? name : "");
    }
}

void weft__self_check(const weft_cloth_def *def, const weft__faults *to)
{
    const weft_contact_def *law = &def->contact;
    if (def->mesh != NULL) {
        if (law->self) {
            check_heights(def, to);
        }
        for (size_t k = 0; def->mesh->grids != NULL && k < def->mesh->part_count; ++k) {
            if (def->mesh->grids[k] != NULL) {
                self_check_spacing(def->mesh->grids[k], law, def->mesh->parts[k].name,
                                   to);
            }
        }
        return;
    }
    self_check_spacing(def, law, NULL, to);
}

weft_status weft__notch_error(const weft__self *own, weft_error *err)
{
    char names[2][96];
    if (own->surface == NULL
        || !(own->surface->notch_width < 2.0 * own->law.thickness)) {
        return WEFT_OK;
    }
    for (size_t k = 0; k < 2; ++k) {
        const weft_primitive of = weft__primitive_of(own->mesh, own->surface->notch[k]);
        (void)weft__primitive_text(own->mesh, &of, names[k], sizeof names[k]);
    }
    return weft_error_set(err, WEFT_INVALID,
                          "contact: thickness %g m is more than half the distance of "
                          "%s and %s at rest: contact of the cloth with itself needs "
                          "at most %.6g m",
                          own->law.thickness, names[0], names[1],
                          0.5 * own->surface->notch_width);
}

/* The windows of pairs of a grid among several cloths with itself. */
static void set_grid_windows(const weft__self *of)
{
    weft__contact_surface *surface = of->surface;
    const weft__triangles *mesh = of->mesh->triangles;
    for (size_t k = 0; k < mesh->part_count; ++k) {
        const weft__part *part = &mesh->parts[k];
        if (part->grid.rows == 0) {
            continue;
        }
        const double window = grid_window(of, &part->grid);
        for (size_t j = 3; j < 6; ++j) {
            surface->triangle_window[j * surface->triangles + k] = window;
        }
        for (size_t e = surface->edge_first[part->first];
             e < surface->edge_first[part->first + part->count]; ++e) {
            surface->square[surface->edges + e] = surface->square[e];
            surface->edge_window[surface->edges + e] = window;
        }
    }
}

bool weft__self_cover(weft__self *of, const weft_allocator *memory)
{
    const weft__mesh *mesh = of->mesh;
    const size_t count = weft__surface_triangles(mesh, NULL);
    weft__surface_draft draft;
    if (weft__surface_draft_create(&draft, mesh->particles, count, memory)) {
        weft__surface_draft_parts(&draft, mesh->triangles);
        draft.thickness = of->law.thickness;
        draft.grids = count > mesh->triangles->count;
        of->surface = weft__contact_surface_create(&draft, memory);
    }
    weft__surface_draft_destroy(&draft, memory);
    if (of->surface != NULL && of->surface->grids) {
        set_grid_windows(of);
    }
    return of->surface != NULL
           && weft__find_slit_edges(of->surface, of->mesh, of->law.thickness, memory);
}

int weft__self_add(const void *own, void *space, const weft__state *at, weft__unit unit,
                   double *to)
{
    const size_t n = ((const weft__self *)own)->mesh->particles;
    weft__self_sums sums = { own, unit, to, 0, n, n };
    return each_pushed(own, space, at, weft__self_sum, &sums);
}
