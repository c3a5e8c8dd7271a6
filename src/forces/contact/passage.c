/* SPDX-License-Identifier: BSD-3-Clause */
/* passage.c -- where the cloth enters a shape between its particles, which alone touch
 * it. The gap of shapes.h is convex, so that along an edge it lies above its tangents
 * at two points and below its values: cuts by tangents decide an edge. A triangle whose
 * edges stay outside enters with its inside alone, where its plane cuts the shape. All
 * shapes but a plane are symmetric about a centre c: their support p in the direction n
 * of the normal, and the plane at n.(x - c) = delta, which meets the shape if |delta| <
 * n.p, then have the point c + p delta / n.p of the shape in common, which lies in the
 * triangle or, as all of the cut does, beside it. */
#include "forces/contact/passage.h"

#include "forces/contact/contact_law.h"
#include "weft/elementary.h"

/* Every second cut halves what is left. */
enum { CUTS = 128 };

/* ---- an edge --------------------------------------------------------------------- */

typedef struct passing_spot {
    double s, gap, slope; /* gap [m] at a + s displacement, and its derivative by s */
} passing_spot;

static passing_spot place_on(const weft__pose *pose, const double a[3],
                             const double displacement[3], double s)
{
    double r[3];
    law_spot at = { .gap = 0.0 };
    for (size_t k = 0; k < 3; ++k) {
        r[k] = (a[k] + s * displacement[k]) - pose->at[k];
    }
    law_spot_of(pose, pose->kind, r, &at);
    return (passing_spot){ s, at.gap, weft__dot(at.gradient, displacement) };
}

bool weft__edge_enters(const weft__pose *pose, const double a[3], const double b[3])
{
    const double displacement[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    passing_spot low = place_on(pose, a, displacement, 0.0),
                 high = place_on(pose, a, displacement, 1.0);
    bool enters = low.gap < 0.0 || high.gap < 0.0;
    for (int i = 0; i < CUTS && !enters && low.slope < 0.0 && high.slope > 0.0; ++i) {
        const double wide = high.s - low.s;
        const double meet = (low.gap - high.gap + wide * high.slope)
                            / (high.slope - low.slope); /* both tangents */
        if (!(low.gap + low.slope * meet < 0.0)) {
            return false;
        }
        const double s = low.s + (i % 2 == 0 ? meet : 0.5 * wide);
        const passing_spot at = place_on(pose, a, displacement, s);
        enters = at.gap < 0.0;
        *(at.slope < 0.0 ? &low : &high) = at;
    }
    return enters;
}

/* ---- a triangle ------------------------------------------------------------------ */

/* To p[k] > 0: of the ball of radius 1 of a 4-norm, what reaches furthest along n. */
static void round_support(const double *n, size_t count, double *p)
{
    double norm = 0.0;
    for (size_t k = 0; k < count; ++k) {
        const double length = fabs(n[k]);
        p[k] = length > 0.0 ? weft_pow(length, 1.0 / 3.0) : 0.0;
        norm += p[k] * length; /* n^(4/3) */
    }
    for (size_t k = 0; k < count; ++k) {
        p[k] /= sqrt(sqrt(norm));
    }
}

static double passage_sign_of(double x)
{
    return (double)(x > 0.0) - (double)(x < 0.0);
}

/* [m] from its centre, to the point furthest along the unit vector n. */
static void support_of(const weft__pose *pose, const double n[3], double p[3])
{
    if (pose->kind == WEFT_CAPSULE) {
        const double along = weft__dot(n, pose->axis);
        double side[3], q[2];
        for (size_t k = 0; k < 3; ++k) {
            side[k] = n[k] - along * pose->axis[k];
        }
        const double across = weft__length(side);
        round_support((const double[2]){ across, along }, 2, q);
        const double reach
            = passage_sign_of(along) * (0.5 * pose->length + pose->radius * q[1]);
        const double out = across > 0.0 ? pose->radius * q[0] / across : 0.0;
        for (size_t k = 0; k < 3; ++k) {
            p[k] = out * side[k] + reach * pose->axis[k];
        }
    } else if (pose->kind == WEFT_BOX) {
        double local[3], q[3];
        weft__rotate_back(&pose->frame, n, local);
        round_support(local, 3, q);
        for (size_t k = 0; k < 3; ++k) {
            local[k]
                = passage_sign_of(local[k]) * (pose->inner[k] + pose->radius * q[k]);
        }
        weft__rotate(&pose->frame, local, p);
    } else {
        for (size_t k = 0; k < 3; ++k) {
            p[k] = pose->radius * n[k];
        }
    }
}

/* [m] n.p is not above it: the ball of a 4-norm reaches 3^(1/4) radii. */
static double support_bound(const weft__pose *pose, const double n[3])
{
    double local[3], core = 0.0;
    if (pose->kind == WEFT_CAPSULE) {
        core = 0.5 * pose->length * fabs(weft__dot(n, pose->axis));
    } else if (pose->kind == WEFT_BOX) {
        weft__rotate_back(&pose->frame, n, local);
        core = fabs(local[0]) * pose->inner[0] + fabs(local[1]) * pose->inner[1]
               + fabs(local[2]) * pose->inner[2];
    }
    return core + 1.3161 * pose->radius;
}

bool weft__face_enters(const weft__pose *pose, double x[3][3])
{
    double side[3][3], n[3], p[3], r[3][3];
    for (size_t k = 0; k < 9; ++k) {
        const size_t i = k / 3, j = k % 3;
        const double half = pose->kind == WEFT_CAPSULE ? 0.5 * pose->length : 0.0;
        side[i][j] = x[(i + 1) % 3][j] - x[i][j];
        r[i][j] = x[i][j] - (pose->at[j] + half * pose->axis[j]);
    }
    weft__cross(side[0], side[1], n);
    const double area = weft__length(n);
    if (!(area > 0.0)) {
        return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        n[k] /= area;
    }
    const double delta = weft__dot(n, r[0]);
    if (!(fabs(delta) < support_bound(pose, n))) {
        return false;
    }
    support_of(pose, n, p);
    const double most = weft__dot(n, p);
    bool enters = fabs(delta) < most;
    for (size_t i = 0; enters && i < 3; ++i) {
        double to[3], across[3];
        for (size_t k = 0; k < 3; ++k) {
            to[k] = p[k] * (delta / most) - r[i][k];
        }
        weft__cross(side[i], to, across);
        enters = weft__dot(across, n) > 0.0;
    }
    return enters;
}

/* ---- of a cloth ------------------------------------------------------------------ */

/* Of one shape, in a state. */
typedef struct passing {
    const weft__mesh *mesh;
    const weft__pose *pose;
    const double *y;
    size_t shape;
    double half; /* [m] of the shape where it is thinnest */
    double displacement,
        rate2; /* [m] the shortest; [1/s^2] the largest (speed / displacement)^2 */
    weft__passages *found;
} passing;

static void passage_place(const passing *of, size_t i, double x[3])
{
    for (size_t k = 0; k < 3; ++k) {
        x[k] = of->y[k * of->mesh->particles + i];
    }
}

static bool edge_enters(const passing *of, size_t p, size_t q)
{
    double a[3], b[3];
    passage_place(of, p, a);
    passage_place(of, q, b);
    return weft__edge_enters(of->pose, a, b);
}

/* Whether a primitive enters, of a triangle only if no edge does. */
static bool enters(const passing *of, const weft_primitive *at)
{
    double x[3][3];
    const size_t *p = at->particle;
    if (at->count == 2) {
        return edge_enters(of, p[0], p[1]);
    }
    for (size_t k = 0; k < 3; ++k) {
        passage_place(of, p[k], x[k]);
    }
    return weft__face_enters(of->pose, x) && !edge_enters(of, p[0], p[1])
           && !edge_enters(of, p[1], p[2]) && !edge_enters(of, p[2], p[0]);
}

/* Whether pins hold a primitive where it is: all of its corners, or one in the shape.
 */
static bool is_held(const passing *of, const weft_primitive *at)
{
    size_t pinned = 0;
    bool inside = false;
    for (size_t k = 0; k < at->count; ++k) {
        if (of->mesh->pin[at->particle[k]] != 0) {
            double x[3];
            passage_place(of, at->particle[k], x);
            inside = inside || weft__gap_at(of->pose, x) <= 0.0;
            ++pinned;
        }
    }
    return inside || pinned == at->count;
}

static void try_primitive(const passing *of, size_t first, const uint32_t *corners,
                          size_t count)
{
    weft_primitive at = { .count = count };
    for (size_t k = 0; k < count; ++k) {
        at.particle[k] = first + corners[k];
    }
    if (enters(of, &at) && !is_held(of, &at)) {
        if (of->found->count == 0) {
            of->found->first = at;
            of->found->shape = of->shape;
        }
        ++of->found->count;
    }
}

/* ---- what each particle owns ----------------------------------------------------- */

/* A particle, and how the gap falls from there. */
typedef struct vantage {
    double x[3], reach2; /* [m^2] to the furthest of its neighbours */
    law_spot spot;
    double least; /* [m] of the tangent at the neighbours: no point between is nearer */
} vantage;

static vantage vantage_of(const passing *of, size_t i)
{
    vantage out = { .reach2 = 0.0 };
    double r[3];
    passage_place(of, i, out.x);
    for (size_t k = 0; k < 3; ++k) {
        r[k] = out.x[k] - of->pose->at[k];
    }
    law_spot_of(of->pose, of->pose->kind, r, &out.spot);
    out.least = out.spot.gap;
    return out;
}

static void add_neighbour(const passing *of, vantage *to, size_t i)
{
    double x[3];
    passage_place(of, i, x);
    const double displacement[3]
        = { x[0] - to->x[0], x[1] - to->x[1], x[2] - to->x[2] };
    to->reach2 = fmax(to->reach2, weft__dot(displacement, displacement));
    to->least
        = fmin(to->least, to->spot.gap + weft__dot(to->spot.gradient, displacement));
}

/* Whether something between a particle and its neighbours may enter. */
static bool passage_is_near(passing *of, const vantage *at, size_t i)
{
    const double gap = at->spot.gap;
    const weft__pose *pose = of->pose;
    const bool far = gap > 0.0 && gap * gap > at->reach2;
    const double displacement = fmax(of->half, far ? gap - sqrt(at->reach2) : 0.0);
    const double arm[3]
        = { at->x[0] - pose->at[0], at->x[1] - pose->at[1], at->x[2] - pose->at[2] };
    double turned[3], v[3];
    weft__cross(pose->rigid.omega, arm, turned);
    for (size_t k = 0; k < 3; ++k) {
        v[k] = of->y[(3 + k) * of->mesh->particles + i]
               - (pose->velocity[k] + turned[k]);
    }
    of->displacement = fmin(of->displacement, displacement);
    of->rate2 = fmax(of->rate2, weft__dot(v, v) / (displacement * displacement));
    return !far && !(at->least >= 0.0);
}

/* Of a grid whose particles begin with `first`. */
static void search_grid(passing *of, const weft__mesh *grid, size_t first, size_t i)
{
    uint32_t ends[3][2], corners[2][3];
    const size_t here = i - first, below = here + grid->cols;
    const bool right = here % grid->cols + 1 < grid->cols;
    const bool down = below < grid->particles;
    const size_t beside[3] = { i + 1, first + below, first + below + 1 };
    const bool there[3] = { right, down, right && down };
    vantage at = vantage_of(of, i);
    for (size_t k = 0; k < 3; ++k) {
        if (there[k]) {
            add_neighbour(of, &at, beside[k]);
        }
    }
    if (!passage_is_near(of, &at, i)) {
        return;
    }
    const size_t edges = weft__edges_of(grid, here, ends);
    const size_t triangles = weft__triangles_of(grid, here, corners);
    for (size_t k = 0; k < edges; ++k) {
        try_primitive(of, first, ends[k], 2);
    }
    for (size_t k = 0; k < triangles; ++k) {
        try_primitive(of, first, corners[k], 3);
    }
}

/* Whether no triangle around particle i before the j-th has corner c as well. */
static bool is_first_with(const weft__triangles *all, size_t i, size_t j, uint32_t c)
{
    bool first = true;
    for (size_t m = all->around_first[i]; m < j && first; ++m) {
        const uint32_t *corner = all->corner[all->around[m]];
        first = corner[0] != c && corner[1] != c && corner[2] != c;
    }
    return first;
}

/* The j-th triangle around a particle, if that is its lowest corner, and its edges from
 * there to higher corners: a band has all triangles around its own particles, but no
 * list of edges. */
static void try_triangle(const passing *of, size_t i, size_t j)
{
    const weft__triangles *all = of->mesh->triangles;
    const uint32_t *corner = all->corner[all->around[j]];
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t ends[2] = { (uint32_t)i, corner[k] };
        if (corner[k] > i && is_first_with(all, i, j, corner[k])) {
            try_primitive(of, 0, ends, 2);
        }
    }
    if (corner[0] == i) {
        try_primitive(of, 0, corner, 3);
    }
}

/* The edges and triangles of which particle i is the lowest corner. */
static void search_triangles(passing *of, size_t i)
{
    const weft__triangles *all = of->mesh->triangles;
    const size_t first = all->around_first[i], end = all->around_first[i + 1];
    vantage at = vantage_of(of, i);
    for (size_t j = first; j < end; ++j) {
        const uint32_t *corner = all->corner[all->around[j]];
        for (size_t k = 0; k < 3; ++k) {
            if (corner[k] > i) {
                add_neighbour(of, &at, corner[k]);
            }
        }
    }
    const bool near = passage_is_near(of, &at, i);
    for (size_t j = first; j < end && near; ++j) {
        try_triangle(of, i, j);
    }
}

static void search_block(passing *of, size_t b)
{
    const weft__mesh *mesh = of->mesh;
    for (size_t i = weft__block(mesh, b); i < weft__block(mesh, b + 1); ++i) {
        const weft__part *part = weft__grid_at(mesh, i);
        if (mesh->triangles != NULL && part == NULL) {
            search_triangles(of, i);
        } else {
            search_grid(of, part != NULL ? &part->grid : mesh,
                        part != NULL ? part->first : 0, i);
        }
    }
}

double weft__shape_half(const weft_shape *shape)
{
    const double *h = shape->half;
    return shape->kind == WEFT_BOX ? fmin(h[0], fmin(h[1], h[2])) : shape->radius;
}

weft__passages weft__contact_passages(const void *own, const weft__state *at, size_t b,
                                      double rise)
{
    const weft__contact *all = own;
    weft__passages found = { .count = 0, .wait = (double)INFINITY };
    for (size_t k = 0; k < all->shape_count; ++k) {
        const weft_shape *shape = &all->shapes[k].def;
        if (shape->kind == WEFT_MESH || shape->kind == WEFT_PLANE) {
            continue; /* a plane is entered at a particle first */
        }
        weft__pose pose = weft__pose_of(&all->shapes[k], at->t);
        pose.radius -= weft__shape_allows(&all->law, &all->shapes[k]);
        passing of = { .mesh = all->mesh,
                       .pose = &pose,
                       .y = at->y,
                       .shape = k,
                       .half = weft__shape_half(shape),
                       .displacement = (double)INFINITY,
                       .found = &found };
        search_block(&of, b);
        found.wait
            = fmin(found.wait, 1.0 / (sqrt(of.rate2) + sqrt(rise / of.displacement)));
    }
    return found;
}

double weft__shape_allows(const weft_contact_def *law, const weft__shape *shape)
{
    return 0.25 * fmin(law->thickness, shape->radius);
}

/* ---- how far a chord dips -------------------------------------------------------- */

/* Across an edge that is rounded by the 4-norm with r: x^4 + y^4 = r^4 at x, y = (s +-
 * a / 2) / sqrt(2), s from the centre along the diagonal, and the flat sides x, y = r
 * beyond. */
static double edge_dip(double a, double r)
{
    const double u = 0.5 * a, u2 = u * u;
    const double s = u < sqrt(0.5) * r
                         ? sqrt(sqrt(8.0 * u2 * u2 + 2.0 * r * r * r * r) - 3.0 * u2)
                         : sqrt(2.0) * r - u;
    return sqrt(sqrt(2.0)) * r - s;
}

double weft__shape_dip(const weft_shape *shape, double a)
{
    return shape->kind == WEFT_SPHERE || shape->kind == WEFT_CAPSULE
               ? a * a / (8.0 * shape->radius)
           : shape->kind == WEFT_BOX ? edge_dip(a, shape->rounding)
                                     : 0.0;
}
