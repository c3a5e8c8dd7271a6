/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_matrix.c -- the second derivatives of each triangle by Morley's element (L. S.
 * D. Morley, Aeronautical Quarterly 19, 1968), whose slopes come from plate_slope.h,
 * and the sum of their squares. */
#include "forces/bending/plate_matrix.h"

#include "base/memory.h"
#include "forces/bending/bending.h"
#include "forces/bending/plate_slope.h"

#define DEPENDENT 1e-10 /* length of a column orthogonal to others, by the longest */

/* What the triangles add: of each live one r, a matrix of three rows, so that its
 * energy is |r x|^2 / 2. */
typedef struct stencils {
    const weft__triangles *mesh;
    const weft_allocator *memory;
    weft__slopes slopes;
    bool *held;     /* triangles whose corners are all pinned */
    uint32_t *slot; /* of particles: 1 + their place in a list; 0 between two lists */
    size_t *first;  /* of each triangle, and their number: */
    uint32_t *particle;
    double (*r)[3]; /* [sqrt(N/m)] */
    size_t count, room;
    size_t *begin;      /* of each particle, and their number: */
    size_t *item;       /* those of `particle` that are it, in the order of triangles */
    uint32_t *triangle; /* of each item */
} stencils;

/* ---- a triangle ------------------------------------------------------------------ */

/* Edge k of a triangle, counterclockwise, n outward. */
typedef struct side {
    const weft__edge *edge;
    uint32_t ends[2];          /* particles */
    double t[2], n[2], length; /* [m] */
    double sign;               /* of n by that of the edge's slope */
} side;

static side side_of(const weft__triangles *mesh, size_t triangle, size_t k)
{
    const uint32_t *place = mesh->place[triangle];
    const uint32_t p = place[(k + 1) % 3], q = place[(k + 2) % 3];
    const double *a = mesh->rest[p], *b = mesh->rest[q];
    const double d[2] = { b[0] - a[0], b[1] - a[1] };
    const double length = sqrt(d[0] * d[0] + d[1] * d[1]);
    const weft__edge *edge = &mesh->edge_list[mesh->edge[triangle][k]];
    return (side){ .edge = edge,
                   .ends = { mesh->particle[p], mesh->particle[q] },
                   .t = { d[0] / length, d[1] / length },
                   .n = { d[1] / length, -d[0] / length },
                   .length = length,
                   .sign = p == edge->place[0] ? 1.0 : -1.0 };
}

/* Adds share times x of a particle to the row of the triangle. */
static void add(stencils *of, size_t begin, uint32_t particle, double share,
                const double row[3])
{
    size_t at = of->slot[particle];
    if (at == 0) {
        of->particle[of->count] = particle;
        memset(of->r[of->count], 0, sizeof of->r[0]);
        of->slot[particle] = (uint32_t)(++of->count - begin);
        at = of->count - begin;
    }
    double *to = of->r[begin + at - 1];
    for (size_t m = 0; m < 3; ++m) {
        to[m] += share * row[m];
    }
}

static void add_slope(stencils *of, size_t begin, size_t e, double share,
                      const double row[3])
{
    for (size_t j = of->slopes.first[e]; j < of->slopes.first[e + 1]; ++j) {
        add(of, begin, of->slopes.particle[j], share * of->slopes.share[j], row);
    }
}

/* The sign of the outward normal of an edge of one triangle. */
static double outward(const weft__triangles *mesh, size_t e)
{
    const uint32_t triangle = mesh->edge_list[e].triangle[0];
    const size_t k = mesh->edge[triangle][0] == e   ? 0
                     : mesh->edge[triangle][1] == e ? 1
                                                    : 2;
    return side_of(mesh, triangle, k).sign;
}

/* Second derivatives Q11, Q22, 2 Q12 = (1/A) sum over sides
 *     L [ g n n^T + sym(t n^T) (x_q - x_p) / L ],
 * those of the slope g of a rim left out: its column is M. */
static size_t add_side(stencils *of, size_t begin, size_t triangle, size_t k,
                       double m[3])
{
    const weft__triangles *mesh = of->mesh;
    const side s = side_of(mesh, triangle, k);
    const size_t e = mesh->edge[triangle][k];
    const double area = mesh->area[triangle];
    const double *t = s.t, *n = s.n;
    const double along[3] = { t[0] * n[0], t[1] * n[1], t[0] * n[1] + t[1] * n[0] };
    const double across[3] = { n[0] * n[0], n[1] * n[1], 2.0 * (n[0] * n[1]) };
    const double weight = s.length / area;
    add(of, begin, s.ends[0], -1.0 / area, along);
    add(of, begin, s.ends[1], 1.0 / area, along);
    if (s.edge->triangle[1] != WEFT__NONE) {
        add_slope(of, begin, e, s.sign * weight, across);
        return 0;
    }
    if (!weft__bends(mesh, s.edge)) {
        memcpy(m, across, sizeof across);
        return 1;
    }
    const uint32_t other = s.edge->sewn;
    const double facing = -outward(mesh, other);
    if (of->held[mesh->edge_list[other].triangle[0]]) {
        add_slope(of, begin, other, facing * weight, across);
    } else {
        add_slope(of, begin, e, 0.5 * s.sign * weight, across);
        add_slope(of, begin, other, 0.5 * facing * weight, across);
    }
    return 0;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(double from[3], const double unit[3])
{
    const double share = dot(from, unit);
    for (size_t m = 0; m < 3; ++m) {
        from[m] -= share * unit[m];
    }
}

/* Makes the columns orthonormal, the longest first; returns how many are left. */
static size_t orthonormal(double columns[3][3], size_t count)
{
    double top = 0.0;
    for (size_t i = 0; i < count; ++i) {
        size_t at = i;
        for (size_t j = i + 1; j < count; ++j) {
            at = dot(columns[j], columns[j]) > dot(columns[at], columns[at]) ? j : at;
        }
        double unit[3];
        memcpy(unit, columns[at], sizeof unit);
        memcpy(columns[at], columns[i], sizeof unit);
        const double length = sqrt(dot(unit, unit));
        top = i == 0 ? length : top;
        if (!(length > DEPENDENT * top)) {
            return i;
        }
        for (size_t twice = 0; twice < 2; ++twice) { /* of what roundoff left */
            const double left = sqrt(dot(unit, unit));
            for (size_t m = 0; m < 3; ++m) {
                unit[m] /= left;
            }
            for (size_t j = 0; j < i && twice == 0; ++j) {
                subtract(unit, columns[j]);
            }
        }
        memcpy(columns[i], unit, sizeof unit);
        for (size_t j = i + 1; j < count; ++j) {
            subtract(columns[j], unit);
        }
    }
    return count;
}

/* The energy's minimum over the free slopes of rims: r = sqrt(A) (I - Q Q^T) D^(1/2) H,
 * Q an orthonormal basis of the columns of D^(1/2) M. */
static void stiffen(stencils *of, size_t begin, size_t triangle, double m[3][3],
                    size_t rims)
{
    const weft_fabric *fabric = &of->mesh->fabrics[of->mesh->fabric[triangle]];
    const double d[3]
        = { sqrt(fabric->bend[1]), sqrt(fabric->bend[0]), sqrt(fabric->twist / 2.0) };
    const double part = sqrt(of->mesh->area[triangle]);
    for (size_t i = 0; i < rims; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            m[i][k] *= d[k];
        }
    }
    const size_t rank = orthonormal(m, rims);
    for (size_t j = begin; j < of->count; ++j) {
        double *r = of->r[j];
        for (size_t k = 0; k < 3; ++k) {
            r[k] = rank < 3 ? r[k] * d[k] : 0.0;
        }
        for (size_t i = 0; i < rank; ++i) {
            subtract(r, m[i]);
        }
        for (size_t k = 0; k < 3; ++k) {
            r[k] *= part;
        }
    }
}

/* Room for what a triangle may add. */
static bool reserve(stencils *of, size_t triangle)
{
    size_t more = 3;
    for (size_t k = 0; k < 3; ++k) {
        const size_t e = of->mesh->edge[triangle][k];
        const uint32_t other = of->mesh->edge_list[e].sewn;
        more += of->slopes.first[e + 1] - of->slopes.first[e];
        more += other == WEFT__NONE
                    ? 0
                    : of->slopes.first[other + 1] - of->slopes.first[other];
    }
    if (of->count + more <= of->room) {
        return true;
    }
    const size_t room = 2 * (of->count + more) + 16 * of->mesh->count;
    uint32_t *particle = weft__resize(of->memory, of->particle, room, sizeof *particle);
    of->particle = particle != NULL ? particle : of->particle;
    double(*r)[3] = weft__resize(of->memory, of->r, room, sizeof *r);
    of->r = r != NULL ? r : of->r;
    of->room = particle != NULL && r != NULL ? room : of->room;
    return particle != NULL && r != NULL;
}

static bool stencil(stencils *of, size_t triangle)
{
    const size_t begin = of->count;
    double m[3][3];
    size_t rims = 0;
    if (!reserve(of, triangle)) {
        return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        rims += add_side(of, begin, triangle, k, m[rims]);
    }
    stiffen(of, begin, triangle, m, rims);
    for (size_t j = begin; j < of->count; ++j) {
        of->slot[of->particle[j]] = 0;
    }
    return true;
}

static bool stencils_create(stencils *of, const uint32_t *pin, size_t particles)
{
    const weft__triangles *mesh = of->mesh;
    of->held = weft__alloc(of->memory, mesh->count, sizeof *of->held);
    of->slot = weft__zeroed(of->memory, particles, sizeof *of->slot);
    of->first = weft__zeroed(of->memory, mesh->count + 1, sizeof *of->first);
    bool made = of->held != NULL && of->slot != NULL && of->first != NULL;
    for (size_t t = 0; made && t < mesh->count; ++t) {
        const uint32_t *corner = mesh->corner[t];
        of->held[t] = pin[corner[0]] != 0 && pin[corner[1]] != 0 && pin[corner[2]] != 0;
    }
    made = made && weft__slopes_create(&of->slopes, mesh, of->held, of->memory);
    for (size_t t = 0; made && t < mesh->count; ++t) {
        made = of->held[t] || stencil(of, t);
        of->first[t + 1] = of->count;
    }
    weft__slopes_free(&of->slopes, of->memory);
    return made;
}

/* Lists the triangles of each particle. */
static bool turn(stencils *of, size_t particles)
{
    of->begin = weft__zeroed(of->memory, particles + 2, sizeof *of->begin);
    of->item = weft__alloc(of->memory, of->count, sizeof *of->item);
    of->triangle = weft__alloc(of->memory, of->count, sizeof *of->triangle);
    if (of->begin == NULL || of->item == NULL || of->triangle == NULL) {
        return false;
    }
    for (size_t j = 0; j < of->count; ++j) {
        ++of->begin[of->particle[j] + 2];
    }
    for (size_t i = 2; i < particles + 2; ++i) {
        of->begin[i] += of->begin[i - 1];
    }
    for (size_t t = 0; t < of->mesh->count; ++t) {
        for (size_t j = of->first[t]; j < of->first[t + 1]; ++j) {
            const size_t at = of->begin[of->particle[j] + 1]++;
            of->item[at] = j;
            of->triangle[at] = (uint32_t)t;
        }
    }
    return true;
}

static void stencils_free(stencils *of)
{
    void *const blocks[] = { of->held, of->slot,  of->first, of->particle,
                             of->r,    of->begin, of->item,  of->triangle };
    for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; ++i) {
        weft__free(of->memory, blocks[i]);
    }
}

/* ---- rows ------------------------------------------------------------------------ */

/* The matrix as it grows: columns are particles first. */
typedef struct growth {
    weft__plate_matrix *out;
    size_t columns, column_room, halo, halo_room;
} growth;

/* Of what has `fabric`: [s]. */
static double damping_of(const stencils *of, uint32_t triangle)
{
    return of->mesh->fabrics[of->mesh->fabric[triangle]].damping[1];
}

static bool reserve_columns(const stencils *of, growth *to, size_t more, bool damped)
{
    weft__plate_matrix *out = to->out;
    if (to->columns + more <= to->column_room) {
        return true;
    }
    const size_t room = 2 * (to->columns + more) + 16 * out->particles;
    const size_t group = WEFT__PLATE_ROWS * sizeof *out->entry;
    uint32_t *column = weft__resize(of->memory, out->column, room, sizeof *column);
    out->column = column != NULL ? column : out->column;
    double *entry = weft__resize(of->memory, out->entry, room, group);
    out->entry = entry != NULL ? entry : out->entry;
    double *damping
        = damped ? weft__resize(of->memory, out->damping, room, group) : NULL;
    out->damping = damping != NULL ? damping : out->damping;
    to->column_room = room;
    return column != NULL && entry != NULL && (!damped || damping != NULL);
}

/* Adds what one triangle has in row `row` of the group whose columns begin at `begin`:
 * of item `at` with all of them. */
static void add_item(const stencils *of, growth *to, size_t begin, size_t row,
                     size_t at)
{
    weft__plate_matrix *out = to->out;
    const uint32_t triangle = of->triangle[at];
    const double *own = of->r[of->item[at]];
    for (size_t j = of->first[triangle]; j < of->first[triangle + 1]; ++j) {
        uint32_t *slot = &of->slot[of->particle[j]];
        if (*slot == 0) {
            out->column[to->columns] = of->particle[j];
            for (size_t r = 0; r < WEFT__PLATE_ROWS; ++r) {
                out->entry[WEFT__PLATE_ROWS * to->columns + r] = 0.0;
                if (out->damping != NULL) {
                    out->damping[WEFT__PLATE_ROWS * to->columns + r] = 0.0;
                }
            }
            *slot = (uint32_t)(++to->columns - begin);
        }
        const size_t k = WEFT__PLATE_ROWS * (begin + *slot - 1) + row;
        const double share = dot(own, of->r[j]);
        out->entry[k] += share;
        if (out->damping != NULL) {
            out->damping[k] += damping_of(of, triangle) * share;
        }
    }
}

/* Makes the sum of a row 0 by its entry of the diagonal. */
static void balance(const growth *to, double *entry, size_t begin, size_t i)
{
    const size_t row = i % WEFT__PLATE_ROWS;
    double sum = 0.0, *diagonal = NULL;
    for (size_t j = begin; j < to->columns; ++j) {
        double *at = &entry[WEFT__PLATE_ROWS * j + row];
        diagonal = to->out->column[j] == i ? at : diagonal;
        sum += to->out->column[j] == i ? 0.0 : *at;
    }
    if (diagonal != NULL) {
        *diagonal = -sum;
    }
}

/* The rows [first, end) of a group. */
static bool add_group(const stencils *of, growth *to, size_t first, size_t end,
                      bool damped)
{
    const size_t begin = to->columns;
    size_t most = 0;
    for (size_t at = of->begin[first]; at < of->begin[end]; ++at) {
        most += of->first[of->triangle[at] + 1] - of->first[of->triangle[at]];
    }
    if (!reserve_columns(of, to, most, damped)) {
        return false;
    }
    for (size_t i = first; i < end; ++i) {
        for (size_t at = of->begin[i]; at < of->begin[i + 1]; ++at) {
            add_item(of, to, begin, i - first, at);
        }
    }
    for (size_t i = first; i < end; ++i) {
        balance(to, to->out->entry, begin, i);
        if (damped) {
            balance(to, to->out->damping, begin, i);
        }
    }
    for (size_t j = begin; j < to->columns; ++j) {
        of->slot[to->out->column[j]] = 0;
    }
    return true;
}

static bool reserve_halo(const stencils *of, growth *to)
{
    weft__plate_matrix *out = to->out;
    if (to->halo < to->halo_room) {
        return true;
    }
    const size_t room = 2 * to->halo + out->particles + 64;
    uint32_t *halo = weft__resize(of->memory, out->halo, room, sizeof *halo);
    out->halo = halo != NULL ? halo : out->halo;
    to->halo_room = room;
    return halo != NULL;
}

/* Renames the columns [begin, end) of the block of rows [first, first + own). */
static bool rename_columns(const stencils *of, growth *to, size_t begin, size_t end,
                           size_t first, size_t own)
{
    weft__plate_matrix *out = to->out;
    const size_t start = to->halo;
    for (size_t j = begin; j < end; ++j) {
        const uint32_t particle = out->column[j];
        uint32_t *slot = &of->slot[particle];
        if (particle >= first && particle < first + own) {
            out->column[j] = (uint32_t)(particle - first);
            continue;
        }
        if (*slot == 0) {
            if (!reserve_halo(of, to)) {
                return false;
            }
            out->halo[to->halo++] = particle;
            *slot = (uint32_t)(to->halo - start);
        }
        out->column[j] = (uint32_t)(own + *slot - 1);
    }
    for (size_t j = start; j < to->halo; ++j) {
        of->slot[out->halo[j]] = 0;
    }
    return true;
}

/* Every row, block by block. */
static bool add_rows(const stencils *of, growth *to, bool damped)
{
    weft__plate_matrix *out = to->out;
    const size_t n = out->particles;
    for (size_t first = 0, b = 0; first < n; first += WEFT__MESH_BLOCK, ++b) {
        const size_t end = n - first < WEFT__MESH_BLOCK ? n : first + WEFT__MESH_BLOCK;
        const size_t begin = to->columns;
        for (size_t i = first; i < end; i += WEFT__PLATE_ROWS) {
            const size_t last = end - i < WEFT__PLATE_ROWS ? end : i + WEFT__PLATE_ROWS;
            if (!add_group(of, to, i, last, damped)) {
                return false;
            }
            out->first[i / WEFT__PLATE_ROWS + 1] = to->columns;
        }
        if (!rename_columns(of, to, begin, to->columns, first, end - first)) {
            return false;
        }
        out->reach[b + 1] = to->halo;
    }
    return true;
}

/* Gives back what growth took in advance. */
static void shrink(weft__plate_matrix *of, const growth *to,
                   const weft_allocator *memory)
{
    const size_t group = WEFT__PLATE_ROWS * sizeof *of->entry;
    void *less = weft__resize(memory, of->column, to->columns, sizeof *of->column);
    of->column = less != NULL ? less : of->column;
    less = weft__resize(memory, of->entry, to->columns, group);
    of->entry = less != NULL ? less : of->entry;
    if (of->damping != NULL) {
        less = weft__resize(memory, of->damping, to->columns, group);
        of->damping = less != NULL ? less : of->damping;
    }
}

/* Whether a live triangle resists bending, and what damping they have. */
typedef struct kinds {
    bool present, several;
    double tau; /* [s] */
} kinds;

static kinds kinds_of(const stencils *of)
{
    kinds found = { .present = false };
    for (uint32_t t = 0; t < of->mesh->count; ++t) {
        const weft_fabric *fabric = &of->mesh->fabrics[of->mesh->fabric[t]];
        const bool stiff
            = fabric->bend[0] > 0.0 || fabric->bend[1] > 0.0 || fabric->twist > 0.0;
        if (stiff) {
            const double tau = damping_of(of, t);
            found.several = found.several || (found.present && tau != found.tau);
            found.tau = tau;
            found.present = true;
        }
    }
    return found;
}

bool weft__plate_matrix_create(weft__plate_matrix *out, const weft__triangles *of,
                               size_t particles, const uint32_t *pin,
                               const weft_allocator *memory)
{
    stencils all = { .mesh = of, .memory = memory };
    growth grown = { .out = out };
    const kinds found = kinds_of(&all);
    const size_t groups = (particles + WEFT__PLATE_ROWS - 1) / WEFT__PLATE_ROWS;
    const size_t blocks = (particles + WEFT__MESH_BLOCK - 1) / WEFT__MESH_BLOCK;
    *out = (weft__plate_matrix){ .particles = particles };
    if (!found.present) {
        return true;
    }
    out->tau = found.several ? 0.0 : found.tau;
    out->first = weft__zeroed(memory, groups + 1, sizeof *out->first);
    out->reach = weft__zeroed(memory, blocks + 1, sizeof *out->reach);
    const bool made = out->first != NULL && out->reach != NULL
                      && stencils_create(&all, pin, particles) && turn(&all, particles)
                      && add_rows(&all, &grown, found.several);
    stencils_free(&all);
    if (made) {
        shrink(out, &grown, memory);
    } else {
        weft__plate_matrix_free(out, memory);
    }
    return made;
}

void weft__plate_matrix_free(weft__plate_matrix *of, const weft_allocator *memory)
{
    void *const blocks[]
        = { of->first, of->column, of->entry, of->damping, of->reach, of->halo };
    for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; ++i) {
        weft__free(memory, blocks[i]);
    }
    *of = (weft__plate_matrix){ .particles = 0 };
}
