/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_matrix.c -- the second derivatives of each triangle by Morley's element (L. S.
 * D. Morley, Aeronautical Quarterly 19, 1968), whose slopes come from
 * plate_edge_slope.c, and the sum of their squares. */
#include "forces/bending/plate.h"

#include "base/grow.h"

#define DEPENDENT 1e-10 /* part of a column that is orthogonal to the others */

/* What the triangles add: of each live one r, a matrix of three rows, so that its
 * energy is |r x|^2 / 2. */
typedef struct stencils {
    const weft__triangles *mesh;
    const weft_allocator *memory;
    weft__stop *stop;
    weft__edge_slopes slopes;
    bool *held;     /* triangles whose corners are all pinned */
    uint32_t *slot; /* of particles: 1 + their place in a list; 0 between two lists */
    size_t *first;  /* of each triangle, and their number: */
    uint32_t *particle;
    double (*r)[3]; /* [sqrt(N/m)] */
    size_t count, room, r_room;
    weft__rest_rows rest; /* of triangles that start with angles */
    size_t *begin;        /* of each particle, and their number: */
    size_t *item;       /* those of `particle` that are it, in the order of triangles */
    uint32_t *triangle; /* of each item */
} stencils;

/* ---- a triangle ------------------------------------------------------------------ */

/* Adds share times x of a particle to the row of the triangle. */
static void plate_matrix_add(stencils *of, size_t begin, uint32_t particle,
                             double share, const double row[3])
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
        plate_matrix_add(of, begin, of->slopes.particle[j], share * of->slopes.share[j],
                         row);
    }
}

/* The outward normal of an edge of a triangle by that of the edge's slope. */
static double plate_matrix_sign_of(const weft__triangles *mesh, uint32_t triangle,
                                   size_t e)
{
    const uint32_t *edges = mesh->edge[triangle];
    if (weft__in_space(mesh, triangle)) { /* the first one lies above */
        return mesh->edge_list[e].triangle[0] == triangle ? 1.0 : -1.0;
    }
    const size_t k = edges[0] == e ? 0 : edges[1] == e ? 1 : 2;
    return mesh->place[triangle][(k + 1) % 3] == mesh->edge_list[e].place[0] ? 1.0
                                                                             : -1.0;
}

/* Second derivatives Q11, Q22, 2 Q12 = (1/A) sum over edges, counterclockwise, of
 *     L [ g n n^T + sym(t n^T) (x_q - x_p) / L ],   n outward,
 * those of the slope g of a rim left out: its column is M. Returns how many are. */
static size_t plate_matrix_add_edge(stencils *of, size_t begin, uint32_t triangle,
                                    size_t k, double m[3])
{
    const weft__triangles *mesh = of->mesh;
    const size_t e = mesh->edge[triangle][k];
    const weft__edge *edge = &mesh->edge_list[e];
    const uint32_t p = mesh->place[triangle][(k + 1) % 3],
                   q = mesh->place[triangle][(k + 2) % 3];
    const double *from = weft__rest_at(mesh, triangle, (k + 1) % 3),
                 *to = weft__rest_at(mesh, triangle, (k + 2) % 3);
    const double d[2] = { to[0] - from[0], to[1] - from[1] };
    const double length = sqrt(d[0] * d[0] + d[1] * d[1]), area = mesh->area[triangle];
    const double t[2] = { d[0] / length, d[1] / length }, n[2] = { t[1], -t[0] };
    const double along[3] = { t[0] * n[0], t[1] * n[1], t[0] * n[1] + t[1] * n[0] };
    const double across[3] = { n[0] * n[0], n[1] * n[1], 2.0 * (n[0] * n[1]) };
    const double weight = length / area * plate_matrix_sign_of(mesh, triangle, e);
    plate_matrix_add(of, begin, mesh->particle[p], -1.0 / area, along);
    plate_matrix_add(of, begin, mesh->particle[q], 1.0 / area, along);
    if (edge->triangle[1] != WEFT__NONE) {
        add_slope(of, begin, e, weight, across);
        return 0;
    }
    if (!weft__bends(mesh, edge)) {
        memcpy(m, across, sizeof across);
        return 1;
    }
    const uint32_t beyond = mesh->edge_list[edge->sewn].triangle[0];
    const double facing
        = -length / area * plate_matrix_sign_of(mesh, beyond, edge->sewn);
    const double part = of->held[beyond] ? 0.0 : 0.5;
    add_slope(of, begin, e, part * weight, across);
    add_slope(of, begin, edge->sewn, (1.0 - part) * facing, across);
    return 0;
}

static void plate_matrix_subtract(double from[3], const double unit[3])
{
    const double share = weft__dot(from, unit);
    for (size_t m = 0; m < 3; ++m) {
        from[m] -= share * unit[m];
    }
}

/* Makes columns orthonormal and leaves out those that depend on others, by Gram and
 * Schmidt; returns how many are left. */
static size_t orthonormal(double columns[3][3], size_t count)
{
    size_t rank = 0;
    for (size_t i = 0; i < count; ++i) {
        double *unit = memmove(columns[rank], columns[i], sizeof columns[i]);
        const double before = sqrt(weft__dot(unit, unit));
        for (size_t j = 0; j < 2 * rank; ++j) { /* twice: what roundoff left */
            plate_matrix_subtract(unit, columns[j % rank]);
        }
        const double length = sqrt(weft__dot(unit, unit));
        for (size_t m = 0; m < 3; ++m) {
            unit[m] /= length;
        }
        rank += length > DEPENDENT * before;
    }
    return rank;
}

/* v becomes root v: D^(1/2) with D12, which is symmetric. */
static void multiply_root(const double root[4], double v[3])
{
    const double first = root[0] * v[0] + root[2] * v[1];
    v[1] = root[2] * v[0] + root[1] * v[1];
    v[0] = first;
    v[2] *= root[3];
}

/* As stiffen, of a fabric with D12: the root of its first two rows is that of a 2 x 2
 * matrix, (D + sqrt(det) I) / sqrt(tr + 2 sqrt(det)). */
static void stiffen_coupled(stencils *of, size_t begin, const weft_fabric *fabric,
                            double coupling, double part, double m[3][3], size_t rims)
{
    const double a = fabric->bend[1], b = fabric->bend[0];
    const double det = sqrt(fmax(0.0, a * b - coupling * coupling));
    const double scale = 1.0 / sqrt(a + b + 2.0 * det);
    const double root[4] = { (a + det) * scale, (b + det) * scale, coupling * scale,
                             sqrt(fabric->twist / 2.0) };
    for (size_t i = 0; i < rims; ++i) {
        multiply_root(root, m[i]);
    }
    const size_t rank = orthonormal(m, rims);
    for (size_t j = begin; j < of->count; ++j) {
        double *r = of->r[j];
        multiply_root(root, r);
        for (size_t i = 0; i < rank; ++i) {
            plate_matrix_subtract(r, m[i]);
        }
        for (size_t k = 0; k < 3; ++k) {
            r[k] = rank < 3 ? r[k] * part : 0.0;
        }
    }
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
    const double coupling = of->mesh->more[of->mesh->fabric[triangle]].bend_coupling;
    if (coupling != 0.0) {
        stiffen_coupled(of, begin, fabric, coupling, part, m, rims);
        return;
    }
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
            plate_matrix_subtract(r, m[i]);
        }
        for (size_t k = 0; k < 3; ++k) {
            r[k] *= part;
        }
    }
}

/* Room for what a triangle may add. */
static bool plate_matrix_reserve(stencils *of, size_t triangle)
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
    return weft__reserve(of->memory, &of->particle, &of->room, of->count + more,
                         sizeof *of->particle)
           && weft__reserve(of->memory, &of->r, &of->r_room, of->count + more,
                            sizeof *of->r);
}

static bool rest_at_start(stencils *of, size_t begin, uint32_t triangle)
{
    const uint32_t *corner = of->mesh->corner[triangle];
    const size_t at[3]
        = { of->slot[corner[0]] - 1, of->slot[corner[1]] - 1, of->slot[corner[2]] - 1 };
    const weft__rest_stencil rows
        = { triangle, of->count - begin, of->particle + begin, of->r + begin, at };
    return weft__rest_rows_take(&of->rest, of->mesh, &rows, of->memory);
}

static bool stencil(stencils *of, uint32_t triangle)
{
    const size_t begin = of->count;
    double m[3][3];
    size_t rims = 0;
    if (!plate_matrix_reserve(of, triangle)) {
        return false;
    }
    for (size_t k = 0; k < 3; ++k) {
        rims += plate_matrix_add_edge(of, begin, triangle, k, m[rims]);
    }
    stiffen(of, begin, triangle, m, rims);
    const bool made = of->mesh->angled == NULL || !of->mesh->angled[triangle]
                      || rest_at_start(of, begin, triangle);
    for (size_t j = begin; j < of->count; ++j) {
        of->slot[of->particle[j]] = 0;
    }
    return made;
}

static bool stencils_create(stencils *of, const uint32_t *pin, size_t particles)
{
    const weft__triangles *mesh = of->mesh;
    of->held = weft__held_triangles(mesh, pin, of->memory);
    of->slot = weft__zeroed(of->memory, particles, sizeof *of->slot);
    of->first = weft__zeroed(of->memory, mesh->count + 1, sizeof *of->first);
    bool made = of->held != NULL && of->slot != NULL && of->first != NULL
                && weft__edge_slopes_create(&of->slopes, mesh, of->held, false,
                                            of->stop, of->memory);
    for (uint32_t t = 0; made && t < mesh->count; ++t) {
        made = !weft__stops(of->stop) && (of->held[t] || stencil(of, t));
        of->first[t + 1] = of->count;
    }
    weft__edge_slopes_free(&of->slopes, of->memory);
    return made;
}

/* Lists the triangles of each particle. */
static bool plate_matrix_turn(stencils *of, size_t particles)
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
    WEFT__FREE_ALL(of->memory, of->held, of->slot, of->first, of->particle, of->r,
                   of->begin, of->item, of->triangle);
}

/* ---- rows ------------------------------------------------------------------------ */

/* A pair of a particle of a block with another, by the block's list; no other has both
 * ends. */
typedef struct pair {
    uint32_t row, column;
    double entry, damping;
} pair;

/* The matrix as it grows, in a block of particles [first, first + own). */
typedef struct growth {
    weft__plate_matrix *out;
    size_t entries, entry_room, halo, halo_room, first, own;
    pair *pairs; /* of the block */
    size_t count, room;
    uint32_t *seat; /* 1 + place in its row of a column of the block; 0 between two */
} growth;

static bool resize_entries(const stencils *of, growth *to, size_t room)
{
    weft__plate_matrix *out = to->out;
    const bool damped = out->tau[0] != out->tau[1];
    to->entry_room = room;
    return weft__resized(of->memory, &out->column, room, sizeof *out->column)
           && weft__resized(of->memory, &out->entry, room, sizeof *out->entry)
           && (!damped
               || weft__resized(of->memory, &out->damping, room, sizeof *out->damping));
}

/* Where a particle is in the list of the block. */
static uint32_t column_of(const stencils *of, growth *to, uint32_t particle)
{
    uint32_t *slot = &of->slot[particle];
    const size_t start = to->out->halo_first[to->first / WEFT__MESH_BLOCK];
    if (particle >= to->first && particle < to->first + to->own) {
        return (uint32_t)(particle - to->first);
    }
    if (*slot == 0) {
        to->out->halo[to->halo++] = particle;
        *slot = (uint32_t)(to->halo - start);
    }
    return (uint32_t)(to->own + *slot - 1);
}

/* Adds what one triangle has in the row of particle i, whose pairs begin at `begin`: of
 * item `at` with all that this row is to have. */
static void add_item(const stencils *of, growth *to, size_t begin, size_t i, size_t at)
{
    const uint32_t triangle = of->triangle[at];
    const double *own = of->r[of->item[at]];
    const double tau = of->mesh->fabrics[of->mesh->fabric[triangle]].damping[1];
    for (size_t j = of->first[triangle]; j < of->first[triangle + 1]; ++j) {
        const uint32_t other = of->particle[j];
        if (other >= to->first && other <= i) {
            continue; /* the other's row has it */
        }
        const uint32_t column = column_of(of, to, other);
        if (to->seat[column] == 0) {
            to->pairs[to->count++] = (pair){ (uint32_t)(i - to->first), column, 0, 0 };
            to->seat[column] = (uint32_t)(to->count - begin);
        }
        pair *sum = &to->pairs[begin + to->seat[column] - 1];
        const double share = weft__dot(own, of->r[j]);
        sum->entry += share;
        sum->damping += tau * share;
    }
}

static bool plate_matrix_add_row(const stencils *of, growth *to, size_t i)
{
    const size_t begin = to->count;
    size_t most = 0;
    for (size_t at = of->begin[i]; at < of->begin[i + 1]; ++at) {
        most += of->first[of->triangle[at] + 1] - of->first[of->triangle[at]];
    }
    if (!weft__reserve(of->memory, &to->pairs, &to->room, begin + most,
                       sizeof *to->pairs)
        || !weft__reserve(of->memory, &to->out->halo, &to->halo_room, to->halo + most,
                          sizeof *to->out->halo)) {
        return false;
    }
    for (size_t at = of->begin[i]; at < of->begin[i + 1]; ++at) {
        add_item(of, to, begin, i, at);
    }
    for (size_t j = begin; j < to->count; ++j) {
        to->seat[to->pairs[j].column] = 0;
    }
    return true;
}

/* Gives pairs of the block to the shorter row of their ends, so that few are needed to
 * fill up its groups; counts those of each row. */
static void level_rows(growth *to, size_t length[WEFT__MESH_BLOCK])
{
    enum { PASSES = 8 };
    memset(length, 0, WEFT__MESH_BLOCK * sizeof *length);
    for (size_t j = 0; j < to->count; ++j) {
        ++length[to->pairs[j].row];
    }
    for (size_t pass = 0; pass < PASSES; ++pass) {
        for (pair *at = to->pairs; at < to->pairs + to->count; ++at) {
            const uint32_t row = at->row, other = at->column;
            if (other < to->own && length[row] > length[other]) {
                --length[row], ++length[other];
                at->row = other, at->column = row;
            }
        }
    }
}

/* Where the rows of a group begin, all filled up; at: the next pair of each. */
static void fill_group(growth *to, size_t first, const size_t *length, size_t *at)
{
    weft__plate_matrix *out = to->out;
    const size_t end
        = first + WEFT__PLATE_ROWS < to->own ? first + WEFT__PLATE_ROWS : to->own;
    size_t most = 0;
    for (size_t i = first; i < end; ++i) {
        most = length[i] > most ? length[i] : most;
    }
    most += most % 2;
    for (size_t i = first; i < end; ++i, to->entries += most) {
        at[i] = to->entries;
        for (size_t j = 0; j < most; ++j) {
            out->column[to->entries + j] = WEFT__PLATE_RECORD * (uint32_t)i;
            out->entry[to->entries + j] = 0.0;
            if (out->damping != NULL) {
                out->damping[to->entries + j] = 0.0;
            }
        }
    }
    out->first[(to->first + first) / WEFT__PLATE_ROWS + 1] = to->entries;
}

/* Moves the pairs of the block to their rows. */
static bool add_block(const stencils *of, growth *to)
{
    weft__plate_matrix *out = to->out;
    size_t length[WEFT__MESH_BLOCK], at[WEFT__MESH_BLOCK], most = to->entries;
    level_rows(to, length);
    for (size_t i = 0; i < to->own; ++i) {
        most += WEFT__PLATE_ROWS * (length[i] + 1);
    }
    if (most > to->entry_room
        && !resize_entries(of, to, 2 * most + 8 * out->particles)) {
        return false;
    }
    for (size_t i = 0; i < to->own; i += WEFT__PLATE_ROWS) {
        fill_group(to, i, length, at);
    }
    for (size_t j = 0; j < to->count; ++j) {
        const pair *from = &to->pairs[j];
        const size_t place = at[from->row]++;
        out->column[place] = WEFT__PLATE_RECORD * from->column;
        out->entry[place] = from->entry;
        if (out->damping != NULL) {
            out->damping[place] = from->damping;
        }
    }
    return true;
}

/* Every row, block by block. */
static bool plate_matrix_add_rows(const stencils *of, growth *to)
{
    weft__plate_matrix *out = to->out;
    const size_t n = out->particles;
    for (size_t b = 0; b * WEFT__MESH_BLOCK < n; ++b) {
        const size_t first = to->first = b * WEFT__MESH_BLOCK;
        to->own = n - first < WEFT__MESH_BLOCK ? n - first : WEFT__MESH_BLOCK;
        to->count = 0;
        for (size_t i = first; i < first + to->own; ++i) {
            if (weft__stops(of->stop) || !plate_matrix_add_row(of, to, i)) {
                return false;
            }
        }
        if (!add_block(of, to)) {
            return false;
        }
        for (size_t j = out->halo_first[b]; j < to->halo; ++j) {
            of->slot[out->halo[j]] = 0;
        }
        out->halo_first[b + 1] = to->halo;
    }
    (void)resize_entries(of, to, to->entries); /* gives back what is not needed */
    return true;
}

/* Whether a triangle resists bending, and in what range they are damped. */
static bool resists(weft__plate_matrix *to, const weft__triangles *mesh)
{
    bool any = false;
    for (size_t t = 0; t < mesh->count; ++t) {
        const weft_fabric *of = &mesh->fabrics[mesh->fabric[t]];
        if (of->bend[0] > 0.0 || of->bend[1] > 0.0 || of->twist > 0.0) {
            to->tau[0] = any ? fmin(to->tau[0], of->damping[1]) : of->damping[1];
            to->tau[1] = any ? fmax(to->tau[1], of->damping[1]) : of->damping[1];
            any = true;
        }
    }
    return any;
}

bool weft__plate_matrix_create(weft__plate_matrix *out, const weft__triangles *of,
                               size_t particles, const uint32_t *pin, weft__stop *stop,
                               const weft_allocator *memory)
{
    stencils all
        = { .mesh = of, .memory = memory, .stop = stop, .rest.to = &out->rest };
    growth grown = { .out = out };
    const size_t groups = (particles + WEFT__PLATE_ROWS - 1) / WEFT__PLATE_ROWS;
    const size_t blocks = (particles + WEFT__MESH_BLOCK - 1) / WEFT__MESH_BLOCK;
    *out = (weft__plate_matrix){ .particles = particles };
    if (!resists(out, of)) {
        return true;
    }
    out->first = weft__zeroed(memory, groups + 1, sizeof *out->first);
    out->halo_first = weft__zeroed(memory, blocks + 1, sizeof *out->halo_first);
    grown.seat = weft__zeroed(memory, particles, sizeof *grown.seat);
    const bool made = out->first != NULL && out->halo_first != NULL
                      && grown.seat != NULL && stencils_create(&all, pin, particles)
                      && plate_matrix_turn(&all, particles)
                      && plate_matrix_add_rows(&all, &grown);
    stencils_free(&all);
    WEFT__FREE_ALL(memory, grown.seat, grown.pairs);
    if (!made) {
        weft__plate_matrix_free(out, memory);
    }
    return made;
}

void weft__plate_matrix_free(weft__plate_matrix *of, const weft_allocator *memory)
{
    WEFT__FREE_ALL(memory, of->first, of->column, of->entry, of->damping,
                   of->halo_first, of->halo, of->rest.triangle, of->rest.first,
                   of->rest.particle, of->rest.weight, of->rest.square);
    *of = (weft__plate_matrix){ .particles = 0 };
}
