/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* Bending of triangles: the matrix of a plate on meshes of any shape, what clamps, rims
 * and seams do, and its bounds. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloth/model.h"
#include "meshes.h"
#include "random.h"

/* Isotropic: B = 1 N m, without transverse contraction. */
static const weft_fabric isotropic
    = { .density = 1.0, .stretch = { 1.0, 1.0 }, .bend = { 1.0, 1.0 }, .twist = 1.0 };

/* ---- matrices -------------------------------------------------------------------- */

/* A symmetric matrix, row by row. */
typedef struct matrix {
    size_t n;
    double *at;
} matrix;

/* K of a cloth by the numbers of vertices. */
static matrix matrix_of(const weft_cloth *cloth)
{
    const weft__plate_matrix *of = &cloth->plate.matrix;
    const size_t n = cloth->mesh.particles;
    matrix to = { n, calloc(n * n, sizeof *to.at) };
    for (size_t i = 0; of->first != NULL && i < n; ++i) {
        const weft__plate_row row = weft__plate_row_of(of, i);
        const size_t a = weft__vertex_of(&cloth->mesh, i);
        for (size_t j = row.first; j < row.end; ++j) {
            const weft__plate_pair pair = weft__plate_pair_of(of, i, j);
            const size_t b = weft__vertex_of(&cloth->mesh, pair.particle);
            to.at[a * n + b] += of->entry[j];
            to.at[a * n + a] -= of->entry[j];
            to.at[b * n + a] += pair.own ? of->entry[j] : 0.0;
            to.at[b * n + b] -= pair.own ? of->entry[j] : 0.0;
        }
    }
    return to;
}

static double mass_of(const weft_cloth *cloth, size_t vertex)
{
    return cloth->mesh.mass[weft__particle_of(&cloth->mesh, vertex)];
}

static matrix plate_of(const test_mesh *mesh)
{
    const weft_cloth_def def = mesh_cloth(mesh);
    weft_cloth *cloth = test_cloth(&def);
    const matrix to = matrix_of(cloth);
    weft_cloth_destroy(cloth);
    return to;
}

/* x.K x */
static double square(const matrix *of, const double *x)
{
    double sum = 0.0;
    for (size_t i = 0; i < of->n * of->n; ++i) {
        sum += x[i / of->n] * of->at[i] * x[i % of->n];
    }
    return sum;
}

static void rotate(double *a, double *b, double c, double s)
{
    const double x = *a, y = *b;
    *a = c * x - s * y;
    *b = s * x + c * y;
}

/* Leaves the eigenvalues on the diagonal (C. G. J. Jacobi, Crelle's Journal 30, 1846).
 */
static void diagonalise(matrix *of)
{
    const size_t n = of->n;
    double left = 1.0, all = 1.0;
    for (size_t sweep = 0; sweep < 30 && left > 1e-30 * all; ++sweep) {
        left = all = 0.0;
        for (size_t p = 0; p < n; ++p) {
            for (size_t q = p + 1; q < n; ++q) {
                const double a = of->at[p * n + q];
                left += a * a;
                all += of->at[p * n + p] * of->at[p * n + p];
                if (a == 0.0) {
                    continue;
                }
                const double half = (of->at[q * n + q] - of->at[p * n + p]) / (2.0 * a);
                const double t = (half < 0.0 ? -1.0 : 1.0)
                                 / (fabs(half) + sqrt(half * half + 1.0));
                const double c = 1.0 / sqrt(t * t + 1.0);
                for (size_t k = 0; k < n; ++k) {
                    rotate(&of->at[k * n + p], &of->at[k * n + q], c, t * c);
                }
                for (size_t k = 0; k < n; ++k) {
                    rotate(&of->at[p * n + k], &of->at[q * n + k], c, t * c);
                }
            }
        }
    }
}

static double largest(const matrix *of)
{
    double top = 0.0;
    for (size_t i = 0; i < of->n; ++i) {
        top = fmax(top, of->at[i * (of->n + 1)]);
    }
    return top;
}

/* M^(-1/2) K M^(-1/2) */
static void divide_by_masses(matrix *of, const weft_cloth *cloth)
{
    for (size_t i = 0; i < of->n * of->n; ++i) {
        of->at[i] /= sqrt(mass_of(cloth, i / of->n) * mass_of(cloth, i % of->n));
    }
}

/* How many eigenvalues of M^-1 K are 0 but for roundoff; none is below. */
static size_t zero_modes(const test_mesh *mesh)
{
    const weft_cloth_def def = mesh_cloth(mesh);
    weft_cloth *cloth = test_cloth(&def);
    matrix k = matrix_of(cloth);
    size_t count = 0;
    divide_by_masses(&k, cloth);
    diagonalise(&k);
    for (size_t i = 0; i < k.n; ++i) {
        const double part = k.at[i * (k.n + 1)] / largest(&k);
        ck_assert_msg(part > -1e-12, "an eigenvalue of %g of the largest", part);
        count += part < 1e-12;
    }
    free(k.at);
    weft_cloth_destroy(cloth);
    return count;
}

/* Solves K x = f for the free vertices by Cholesky's method, within the envelope of
 * their rows; x is 0 of the others. Overwrites K. */
static void solve(matrix *of, const bool *fixed, const double *f, double *x)
{
    const size_t n = of->n;
    size_t *list = malloc(n * sizeof *list), *begin = malloc(n * sizeof *begin);
    size_t count = 0;
    for (size_t i = 0; i < n; ++i) {
        x[i] = 0.0;
        if (!fixed[i]) {
            list[count++] = i;
        }
    }
    for (size_t i = 0; i < count; ++i) {
        double *row = &of->at[list[i] * n];
        for (begin[i] = 0; row[list[begin[i]]] == 0.0; ++begin[i]) {
        }
        double sum = f[list[i]];
        for (size_t j = begin[i]; j <= i; ++j) {
            const double *other = &of->at[list[j] * n];
            double entry = row[list[j]];
            for (size_t k = begin[i] > begin[j] ? begin[i] : begin[j]; k < j; ++k) {
                entry -= row[list[k]] * other[list[k]];
            }
            ck_assert(j < i || entry > 0.0);
            row[list[j]] = j < i ? entry / other[list[j]] : sqrt(entry);
            sum -= j < i ? row[list[j]] * x[list[j]] : 0.0;
        }
        x[list[i]] = sum / row[list[i]];
    }
    for (size_t i = count; i-- > 0;) {
        const double *row = &of->at[list[i] * n];
        x[list[i]] /= row[list[i]];
        for (size_t j = begin[i]; j < i; ++j) {
            x[list[j]] -= row[list[j]] * x[list[i]];
        }
    }
    free(list);
    free(begin);
}

/* ---- zero modes ------------------------------------------------------------------ */

/* Keeps the triangles that are joined through edges to the first one kept, of those
 * that chance leaves; drops vertices without a triangle. */
static bool nibble(test_mesh *of, uint64_t *seed)
{
    size_t count = 0, before = 0;
    bool kept[64] = { false };
    uint32_t number[64];
    const size_t t = of->def.triangles;
    kept[(size_t)(random_uniform(seed) * (double)t)] = true;
    const double share = 0.3 + 0.6 * random_uniform(seed);
    for (count = 1; count > before;) {
        before = count;
        for (size_t i = 0; i < t * t; ++i) {
            size_t common = 0;
            for (size_t k = 0; k < 9; ++k) {
                common += of->corners[3 * (i / t) + k / 3]
                          == of->corners[3 * (i % t) + k % 3];
            }
            if (kept[i / t] && !kept[i % t] && common == 2
                && random_uniform(seed) < share) {
                kept[i % t] = true;
                ++count;
            }
        }
    }
    memset(number, 0xff, sizeof number);
    size_t vertices = 0, triangles = 0;
    for (size_t i = 0; i < of->def.vertices; ++i) {
        for (size_t k = 0; k < 3 * t; ++k) {
            if (kept[k / 3] && of->corners[k] == i && number[i] == UINT32_MAX) {
                memmove(&of->rest[2 * vertices], &of->rest[2 * i],
                        2 * sizeof *of->rest);
                memmove(&of->start[3 * vertices], &of->start[3 * i],
                        3 * sizeof *of->start);
                number[i] = (uint32_t)vertices++;
            }
        }
    }
    for (size_t k = 0; k < 3 * t; ++k) {
        if (kept[k / 3]) {
            of->corners[triangles] = of->places[triangles] = number[of->corners[k]];
            ++triangles;
        }
    }
    mesh_point(of, vertices, vertices, triangles / 3);
    return triangles >= 6;
}

START_TEST(panels_of_any_shape_have_three_zero_modes)
{
    uint64_t seed = (uint64_t)_i + 1;
    for (size_t i = 0; i < 20; ++i) {
        test_mesh mesh;
        mesh_sheet(&mesh, (size_t)random_whole(&seed, 2, 5),
                   (size_t)random_whole(&seed, 2, 5), 0.01, MESH_RANDOM, 0.25, seed);
        const double aspect = exp(4.0 * random_uniform(&seed));
        for (size_t k = 0; k < mesh.def.uv_count; ++k) {
            mesh.rest[2 * k] *= aspect;
        }
        mesh.fabrics[0] = isotropic;
        if (nibble(&mesh, &seed)) {
            ck_assert_uint_eq(zero_modes(&mesh), 3);
        }
        mesh_free(&mesh);
    }
}
END_TEST

/* Families of meshes, each a sheet of rows x cols that is changed. */
typedef enum family_change {
    AS_IT_IS,
    SHEARED, /* by 79 degrees */
    LONG,    /* aspect 10 */
    GRADED,  /* cells of 1 to 10 */
    RING,    /* the last column is the first */
    SLIT     /* from the rim to the middle */
} family_change;

typedef struct family {
    const char *name;
    size_t rows, cols;
    test_diagonals way;
    double jitter;
    family_change change;
} family;

static void change_place(const family *of, size_t i, double x[2])
{
    const double u = x[0] / 0.01, v = x[1] / 0.01, across = (double)(of->cols - 1);
    if (of->change == SHEARED) {
        x[0] += tan(79.0 * acos(-1.0) / 180.0) * x[1];
    } else if (of->change == LONG) {
        x[0] *= 10.0;
    } else if (of->change == GRADED) {
        x[0] = 0.01 * (pow(10.0, u / across) - 1.0);
    } else if (of->change == RING) {
        const double angle = 2.0 * acos(-1.0) * (double)(i % of->cols) / across;
        x[0] = 0.01 * (2.0 + v) * cos(angle), x[1] = 0.01 * (2.0 + v) * sin(angle);
    }
}

/* Joins the last column to the first; or gives the triangles right of the middle, above
 * it, vertices of their own on the line between. */
static uint32_t change_corner(const family *of, uint32_t corner, bool right)
{
    const uint32_t cols = (uint32_t)of->cols, r = corner / cols, c = corner % cols;
    const uint32_t all = (uint32_t)(of->rows * of->cols);
    if (of->change == RING) {
        return r * (cols - 1) + c % (cols - 1);
    }
    return of->change == SLIT && right && c == cols / 2 && r > of->rows / 2 ? all + r
                                                                            : corner;
}

static void make_family(const family *of, test_mesh *mesh)
{
    const size_t all = of->rows * of->cols;
    mesh_sheet(mesh, of->rows, of->cols, 0.01, of->way, of->jitter, 3);
    const size_t triangles = mesh->def.triangles;
    mesh->rest = realloc(mesh->rest, 2 * (all + of->rows) * sizeof *mesh->rest);
    mesh->start = realloc(mesh->start, 3 * (all + of->rows) * sizeof *mesh->start);
    for (size_t i = 0; i < all; ++i) {
        change_place(of, i, &mesh->rest[2 * i]);
    }
    size_t count = 0, number[200];
    double *rest = malloc(2 * (all + of->rows) * sizeof *rest);
    memcpy(rest, mesh->rest, 2 * all * sizeof *rest);
    for (size_t r = 0; r < of->rows; ++r) { /* the other side of a slit */
        memcpy(&rest[2 * (all + r)], &rest[2 * (r * of->cols + of->cols / 2)],
               2 * sizeof *rest);
    }
    for (size_t i = 0; i < all + of->rows; ++i) {
        number[i] = SIZE_MAX;
    }
    for (size_t k = 0; k < triangles; ++k) {
        uint32_t *corner = &mesh->corners[3 * k];
        bool right = false;
        for (size_t j = 0; j < 3; ++j) {
            right = right || corner[j] % of->cols > of->cols / 2;
        }
        for (size_t j = 0; j < 3; ++j) {
            const size_t from = of->change == RING ? corner[j] : SIZE_MAX;
            const uint32_t to = change_corner(of, corner[j], right);
            if (number[to] == SIZE_MAX) {
                number[to] = count++;
                memcpy(&mesh->rest[2 * number[to]],
                       &rest[2 * (from != SIZE_MAX ? from : to)], 2 * sizeof *rest);
            }
            corner[j] = mesh->places[3 * k + j] = (uint32_t)number[to];
        }
    }
    for (size_t i = 0; i < count; ++i) {
        memcpy(&mesh->start[3 * i], &mesh->rest[2 * i], 2 * sizeof *rest);
        mesh->start[3 * i + 2] = 0.0;
    }
    free(rest);
    mesh_point(mesh, count, count, triangles);
}

/* `valence` triangles around a vertex; `split`: each of them in three at its centre. */
static void make_fan(test_mesh *mesh, size_t valence, bool split)
{
    const size_t n = valence + 1 + (split ? valence : 0);
    size_t count = 0;
    mesh_sheet(mesh, 8, 8, 1.0, MESH_RIGHT, 0.0, 1); /* room */
    for (size_t k = 0; k < valence; ++k) {
        const double angle = 2.0 * acos(-1.0) * (double)k / (double)valence;
        mesh->rest[2 * (k + 1)] = cos(angle), mesh->rest[2 * (k + 1) + 1] = sin(angle);
    }
    mesh->rest[0] = mesh->rest[1] = 0.0;
    for (size_t k = 0; k < valence; ++k) {
        const uint32_t a = (uint32_t)(1 + k), b = (uint32_t)(1 + (k + 1) % valence);
        const uint32_t middle = (uint32_t)(1 + valence + k);
        const uint32_t whole[3] = { 0, a, b };
        for (size_t j = 0; j < (split ? 3 : 1); ++j) {
            const uint32_t part[3] = { whole[j], whole[(j + 1) % 3], middle };
            memcpy(&mesh->corners[3 * count++], split ? part : whole, sizeof part);
        }
        for (size_t d = 0; split && d < 2; ++d) {
            mesh->rest[2 * (size_t)middle + d]
                = (mesh->rest[2 * (size_t)a + d] + mesh->rest[2 * (size_t)b + d]) / 3.0;
        }
    }
    memcpy(mesh->places, mesh->corners, 3 * count * sizeof *mesh->places);
    for (size_t i = 0; i < n; ++i) {
        memcpy(&mesh->start[3 * i], &mesh->rest[2 * i], 2 * sizeof *mesh->rest);
        mesh->start[3 * i + 2] = 0.0;
    }
    mesh_point(mesh, n, n, count);
}

static const family families[] = {
    { "one diagonal", 6, 8, MESH_RIGHT, 0.0, AS_IT_IS },
    { "union jack", 6, 8, MESH_ALTERNATING, 0.0, AS_IT_IS },
    { "random", 6, 8, MESH_RANDOM, 0.25, AS_IT_IS },
    { "jitter of 45 %", 8, 8, MESH_RANDOM, 0.45, AS_IT_IS },
    { "strip of one triangle", 2, 21, MESH_ALTERNATING, 0.0, AS_IT_IS },
    { "strip of two", 3, 21, MESH_RIGHT, 0.0, AS_IT_IS },
    { "strip of three", 4, 21, MESH_RANDOM, 0.25, AS_IT_IS },
    { "aspect 10", 6, 8, MESH_RANDOM, 0.25, LONG },
    { "sheared by 79 degrees", 6, 8, MESH_RANDOM, 0.25, SHEARED },
    { "graded", 6, 10, MESH_RANDOM, 0.25, GRADED },
    { "annulus", 4, 13, MESH_RIGHT, 0.0, RING },
    { "annulus of one triangle", 2, 13, MESH_ALTERNATING, 0.0, RING },
    { "slit square", 7, 9, MESH_RANDOM, 0.25, SLIT },
    { "two triangles", 2, 2, MESH_RIGHT, 0.0, AS_IT_IS },
    { "four triangles", 2, 3, MESH_RIGHT, 0.0, AS_IT_IS },
    { "eight triangles", 3, 3, MESH_ALTERNATING, 0.0, AS_IT_IS },
};
enum { FAMILIES = sizeof families / sizeof *families };

START_TEST(families_of_meshes_have_three_zero_modes)
{
    test_mesh mesh;
    make_family(&families[_i], &mesh);
    const size_t count = zero_modes(&mesh);
    ck_assert_msg(count == 3, "%s: %d", families[_i].name, (int)count);
    mesh_free(&mesh);
}
END_TEST

START_TEST(fans_have_three_zero_modes)
{
    for (size_t valence = 3; valence <= 12; ++valence) {
        for (int split = 0; split < 2; ++split) {
            test_mesh mesh;
            make_fan(&mesh, valence, split);
            ck_assert_uint_eq(zero_modes(&mesh), 3);
            mesh_free(&mesh);
        }
    }
}
END_TEST

START_TEST(one_triangle_has_no_bending)
{
    double rest[] = { 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 }, start[9] = { 0.0, 0.0, 0.0, 1.0 };
    uint32_t corners[] = { 0, 1, 2 };
    test_mesh mesh = { .start = start, .rest = rest, .corners = corners };
    start[7] = 1.0;
    mesh.fabrics[0] = isotropic;
    mesh_point(&mesh, 3, 3, 1);
    const matrix k = plate_of(&mesh);
    for (size_t i = 0; i < 9; ++i) {
        ck_assert_double_eq(k.at[i], 0.0);
    }
    free(k.at);
}
END_TEST

/* ---- exact energies -------------------------------------------------------------- */

/* Twice the energy of one triangle with second derivatives q, less what the slopes of
 * its rims take. */
static double relaxed(const test_mesh *mesh, size_t triangle, const double q[3])
{
    const weft_fabric *fabric = &mesh->fabrics[0];
    double d[3][3] = { { fabric->bend[1] },
                       { 0.0, fabric->bend[0] },
                       { 0.0, 0.0, fabric->twist / 2.0 } };
    const uint32_t *p = &mesh->places[3 * triangle];
    const double *x[3];
    for (size_t k = 0; k < 3; ++k) {
        x[k] = &mesh->rest[2 * (size_t)p[k]];
    }
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = p[k], b = p[(k + 1) % 3];
        size_t beside = 0;
        for (size_t j = 0; j < 3 * mesh->def.triangles; ++j) {
            const uint32_t *other = &mesh->places[j / 3 * 3];
            beside += other[j % 3] == b && other[(j + 1) % 3] == a;
        }
        const double du = x[(k + 1) % 3][0] - x[k][0], dv = x[(k + 1) % 3][1] - x[k][1];
        const double m[3] = { dv * dv, du * du, -2.0 * du * dv };
        double moment[3], size = 0.0;
        for (size_t i = 0; i < 3; ++i) {
            moment[i] = d[i][0] * m[0] + d[i][1] * m[1] + d[i][2] * m[2];
            size += m[i] * moment[i];
        }
        for (size_t i = 0; i < 9 && beside == 0; ++i) {
            d[i / 3][i % 3] -= moment[i / 3] * moment[i % 3] / size;
        }
    }
    double sum = 0.0;
    for (size_t i = 0; i < 9; ++i) {
        sum += q[i / 3] * d[i / 3][i % 3] * q[i % 3];
    }
    const double area = 0.5
                        * ((x[1][0] - x[0][0]) * (x[2][1] - x[0][1])
                           - (x[2][0] - x[0][0]) * (x[1][1] - x[0][1]));
    return area * sum;
}

START_TEST(cylinders_of_any_direction_have_their_energy)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 8, 8, 0.2, MESH_RANDOM, 0.25, 5);
    mesh.fabrics[0] = isotropic;
    mesh.fabrics[0].bend[0] = 0.7, mesh.fabrics[0].bend[1] = 0.2;
    mesh.fabrics[0].twist = 0.45;
    const matrix k = plate_of(&mesh);
    for (double angle = 0.0; angle < 3.1; angle += 0.4) {
        const double c = cos(angle), s = sin(angle);
        const double q[3] = { c * c, s * s, 2.0 * c * s };
        double x[64], wanted = 0.0;
        for (size_t i = 0; i < 64; ++i) {
            const double along = c * mesh.rest[2 * i] + s * mesh.rest[2 * i + 1];
            x[i] = along * along / 2.0;
        }
        for (size_t t = 0; t < mesh.def.triangles; ++t) {
            wanted += relaxed(&mesh, t, q);
        }
        ck_assert_double_eq_tol(square(&k, x) / wanted, 1.0, 1e-12);
    }
    free(k.at);
    mesh_free(&mesh);
}
END_TEST

START_TEST(inner_particles_feel_no_force_on_quadratics)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 13, 13, 0.1, MESH_RANDOM, 0.25, 7);
    mesh.fabrics[0] = isotropic;
    const matrix k = plate_of(&mesh);
    const size_t n = k.n, middle = 6 * 13 + 6;
    for (size_t power = 0; power < 3; ++power) {
        double sum = 0.0, size = 0.0;
        for (size_t i = 0; i < n; ++i) {
            const double u = mesh.rest[2 * i], v = mesh.rest[2 * i + 1];
            const double x = power == 0 ? u * u : power == 1 ? v * v : u * v;
            sum += k.at[middle * n + i] * x;
            size += fabs(k.at[middle * n + i] * x);
        }
        ck_assert(fabs(sum) < 1e-12 * size);
    }
    free(k.at);
    mesh_free(&mesh);
}
END_TEST

/* ---- convergence ----------------------------------------------------------------- */

static const double pi = 3.14159265358979323846;

/* The amplitude of a simply supported square of side 1 under the load of its first
 * mode, by the exact one, on n x n cells. */
static double supported(test_mesh *mesh)
{
    matrix k = plate_of(mesh);
    const size_t n = k.n;
    bool *fixed = calloc(n, sizeof *fixed);
    double *f = calloc(n, sizeof *f), *x = malloc(n * sizeof *x);
    double *mode = malloc(n * sizeof *mode);
    for (size_t i = 0; i < n; ++i) {
        const double u = mesh->start[3 * i], v = mesh->start[3 * i + 1];
        fixed[i] = u < 1e-9 || u > 1.0 - 1e-9 || v < 1e-9 || v > 1.0 - 1e-9;
        mode[i] = sin(pi * u) * sin(pi * v);
    }
    for (size_t t = 0; t < 3 * mesh->def.triangles; ++t) {
        const double *y[3];
        for (size_t j = 0; j < 3; ++j) {
            y[j] = &mesh->start[3 * (size_t)mesh->corners[t / 3 * 3 + j]];
        }
        const double area = 0.5
                            * ((y[1][0] - y[0][0]) * (y[2][1] - y[0][1])
                               - (y[2][0] - y[0][0]) * (y[1][1] - y[0][1]));
        f[mesh->corners[t]]
            += area / 3.0 * 4.0 * pi * pi * pi * pi * mode[mesh->corners[t]];
    }
    solve(&k, fixed, f, x);
    double both = 0.0, one = 0.0;
    for (size_t i = 0; i < n; ++i) {
        both += mode[i] * x[i];
        one += mode[i] * mode[i];
    }
    free(k.at), free(fixed), free(f), free(x), free(mode);
    return both / one;
}

/* Puts the vertices of a column of a square of side 1 on a line. */
static void straighten(test_mesh *mesh, size_t column)
{
    for (size_t i = column; i < mesh->def.vertices; i += mesh->cols) {
        mesh->rest[2 * i] = mesh->start[3 * i]
            = (double)column / (double)(mesh->rows - 1);
    }
}

static double supported_sheet(size_t cells, test_diagonals way)
{
    test_mesh mesh;
    mesh_sheet(&mesh, cells + 1, cells + 1, 1.0 / (double)cells, way,
               way == MESH_RANDOM ? 0.25 : 0.0, 1);
    mesh.fabrics[0] = isotropic;
    const double found = supported(&mesh);
    mesh_free(&mesh);
    return found;
}

START_TEST(supported_plate_converges_with_order_2)
{
    /* of an independent program */
    static const double known[3][3]
        = { { 0.0276, 0.0062, 0.0015 }, { 0.0495, 0.0120, 0.0029 } };
    const test_diagonals way = (test_diagonals)_i;
    double error[3];
    for (size_t k = 0; k < 3; ++k) {
        error[k] = supported_sheet((size_t)8 << k, way) - 1.0;
        ck_assert(known[way][k] == 0.0 || fabs(error[k] - known[way][k]) < 6e-5);
    }
    ck_assert(error[0] < 0.06 && error[0] > 3.2 * error[1]
              && error[1] > 3.2 * error[2]);
    ck_assert(error[2] > 0.0);
}
END_TEST

/* The error of the tip of a cantilever of side 1 under a uniform load, clamped by a
 * pinned strip one cell wide. */
static double cantilever(size_t cells, test_diagonals way)
{
    test_mesh mesh;
    const size_t cols = cells + 2, rows = cells + 1;
    const double h = 1.0 / (double)cells;
    mesh_sheet(&mesh, rows, cols, h, way, way == MESH_RANDOM ? 0.25 : 0.0, 2);
    mesh.fabrics[0] = isotropic;
    size_t *pinned = malloc(2 * rows * sizeof *pinned);
    for (size_t r = 0; r < rows; ++r) {
        pinned[2 * r] = r * cols, pinned[2 * r + 1] = r * cols + 1;
    }
    straighten(&mesh, 1);
    weft_cloth_def def = mesh_cloth(&mesh);
    const weft_pin pin = { .vertices = pinned, .vertex_count = 2 * rows };
    def.pins = &pin, def.pin_count = 1, def.pin_size = sizeof pin;
    weft_cloth *cloth = test_cloth(&def);
    matrix k = matrix_of(cloth);
    bool *fixed = calloc(k.n, sizeof *fixed);
    double *f = calloc(k.n, sizeof *f), *x = malloc(k.n * sizeof *x), tip = 0.0;
    for (size_t i = 0; i < k.n; ++i) {
        fixed[i] = i % cols < 2;
        f[i] = mass_of(cloth, i);
    }
    solve(&k, fixed, f, x);
    for (size_t r = 0; r < rows; ++r) {
        tip += x[r * cols + cols - 1] / (double)rows;
    }
    weft_cloth_destroy(cloth);
    free(k.at), free(fixed), free(f), free(x), free(pinned);
    mesh_free(&mesh);
    return 8.0 * tip - 1.0;
}

START_TEST(strip_of_pinned_triangles_clamps_along_its_inner_rim)
{
    const double coarse = cantilever(8, MESH_RIGHT), fine = cantilever(16, MESH_RIGHT);
    ck_assert(fabs(coarse - 0.0130) < 6e-5 && fabs(fine - 0.0031) < 6e-5);
    const double rough = cantilever(8, MESH_RANDOM);
    ck_assert(rough < 0.03 && rough > 3.0 * cantilever(16, MESH_RANDOM));
}
END_TEST

/* How far the tip of a strip of length 1 hangs below its clamp under weight of 8 B /
 * L^3, on so many cells, after it has come to rest. */
static double sag(size_t cells, bool arc)
{
    test_mesh mesh;
    const size_t rows = cells / 4 + 1, cols = cells + 2;
    size_t held[2 * 9];
    mesh_sheet(&mesh, rows, cols, 1.0 / (double)cells, MESH_RIGHT, 0.0, 1);
    mesh.fabrics[0] = isotropic;
    mesh.fabrics[0].stretch[0] = mesh.fabrics[0].stretch[1] = 1e4;
    mesh.fabrics[0].shear = 5e3, mesh.fabrics[0].coupling = 0.0;
    mesh.def.arc = arc;
    for (size_t r = 0; r < rows; ++r) {
        held[2 * r] = r * cols, held[2 * r + 1] = r * cols + 1;
    }
    weft_cloth_def def = mesh_cloth(&mesh);
    const weft_pin pin = { .vertices = held, .vertex_count = 2 * rows };
    def.pins = &pin, def.pin_count = 1, def.pin_size = sizeof pin;
    def.gravity[2] = -8.0;
    def.damping = 8.0 / (double)(cells * cells);
    weft_cloth *cloth = test_cloth(&def);
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = 3.2e-3 / (double)cells;
    weft_sim *sim
        = test_sim(cloth, test_method_named("verlet/velocity_verlet"), &config);
    ck_assert_int_eq(weft_sim_advance(sim, 5.0, NULL), WEFT_OK);
    const double *z = weft_sim_state(sim) + 2 * weft_cloth_particles(cloth);
    double tip = 0.0;
    for (size_t r = 0; r < rows; ++r) {
        const size_t i = weft__particle_of(&cloth->mesh, r * cols + cols - 1);
        tip += z[i] * (r == 0 || r + 1 == rows ? 0.5 : 1.0) / (double)(rows - 1);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
    return -tip;
}

START_TEST(strip_hangs_as_the_heavy_elastica)
{
    const double exact = 0.6406307; /* of the rod's equation, by shooting */
    const double coarse = sag(8, false) - exact, fine = sag(16, false) - exact;
    ck_assert(fabs(coarse - 0.0071) < 2e-4 && coarse > 3.0 * fabs(fine));
    const double arc = sag(8, true) - exact;
    ck_assert(fabs(arc - 0.0078) < 2e-4);
}
END_TEST

/* ---- seams ----------------------------------------------------------------------- */

/* A sheet in halves that are sewn along a straight line, one of them turned. */
static void cut(test_mesh *mesh, size_t cells, weft_seam seams)
{
    mesh_sheet(mesh, cells + 1, cells + 1, 1.0 / (double)cells, MESH_RANDOM, 0.25, 1);
    mesh->fabrics[0] = isotropic;
    straighten(mesh, cells / 2);
    mesh_sew(mesh, cells / 2, 3.0, 0.8, 0.6);
    mesh->def.seams = seams;
}

/* A sheet cut along a curve, or from its rim to its middle, and sewn; or whole. */
typedef enum seam_line { WHOLE, CURVED, DART } seam_line;

static double sewn_along(seam_line line, size_t cells)
{
    test_mesh mesh;
    const size_t side = cells + 1, n = side * side, at = cells / 2;
    mesh_sheet(&mesh, side, side, 1.0 / (double)cells, MESH_RANDOM, 0.25, 1);
    mesh.fabrics[0] = isotropic;
    straighten(&mesh, at);
    for (size_t i = 0; i < n; ++i) { /* what is straight becomes a curve */
        const double u = mesh.rest[2 * i], v = mesh.rest[2 * i + 1];
        mesh.rest[2 * i] += 0.1 * sin(pi * u) * sin(pi * v);
        mesh.start[3 * i] = mesh.rest[2 * i];
    }
    if (line == CURVED) {
        mesh_sew(&mesh, at, 3.0, 0.8, 0.6);
    }
    for (size_t k = 0; line == DART && k < 3 * mesh.def.triangles; ++k) {
        const uint32_t *corner = &mesh.corners[k / 3 * 3];
        const bool right
            = corner[0] % side > at || corner[1] % side > at || corner[2] % side > at;
        if (right && mesh.corners[k] % side == at && mesh.corners[k] / side > at) {
            mesh.places[k] += (uint32_t)n;
        }
    }
    if (line == DART) {
        mesh.rest = realloc(mesh.rest, 4 * n * sizeof *mesh.rest);
        memcpy(&mesh.rest[2 * n], mesh.rest, 2 * n * sizeof *mesh.rest);
        mesh_point(&mesh, n, 2 * n, mesh.def.triangles);
    }
    const double amplitude = supported(&mesh);
    mesh_free(&mesh);
    return amplitude;
}

START_TEST(sewn_pieces_converge_with_order_2)
{
    const seam_line line = (seam_line)_i;
    double error[2];
    for (size_t k = 0; k < 2; ++k) {
        const size_t cells = (size_t)16 << k;
        const double whole = sewn_along(WHOLE, cells) - 1.0;
        error[k] = sewn_along(line, cells) - 1.0;
        ck_assert_msg(fabs(error[k] - whole) < 0.1 * fabs(whole), "%g, whole %g",
                      error[k], whole);
    }
    ck_assert_msg(error[0] > 3.5 * error[1], "%g %g", error[0], error[1]);
}
END_TEST

START_TEST(sewn_pieces_bend_as_a_whole)
{
    test_mesh mesh;
    cut(&mesh, 16, WEFT_SEAM_BEND);
    const double sewn = supported(&mesh), whole = supported_sheet(16, MESH_RANDOM);
    mesh_free(&mesh);
    cut(&mesh, 16, WEFT_SEAM_HINGE);
    const double hinged = supported(&mesh);
    mesh_free(&mesh);
    ck_assert(fabs(sewn - whole) < 1e-3);
    ck_assert(hinged > 1.15);
}
END_TEST

START_TEST(hinge_has_one_zero_mode_more)
{
    for (weft_seam seams = WEFT_SEAM_BEND; seams <= WEFT_SEAM_HINGE; ++seams) {
        test_mesh mesh;
        cut(&mesh, 6, seams);
        ck_assert_uint_eq(zero_modes(&mesh), seams == WEFT_SEAM_BEND ? 3 : 4);
        mesh_free(&mesh);
    }
}
END_TEST

START_TEST(matrix_does_not_depend_on_numbers)
{
    test_mesh mesh, other;
    uint32_t to[7 * 7];
    cut(&mesh, 6, WEFT_SEAM_BEND);
    cut(&other, 6, WEFT_SEAM_BEND);
    mesh_shuffle(&other, 9, to);
    const matrix k = plate_of(&mesh), shuffled = plate_of(&other);
    for (size_t i = 0; i < k.n * k.n; ++i) {
        const size_t j = to[i / k.n] * k.n + to[i % k.n];
        ck_assert(memcmp(&k.at[i], &shuffled.at[j], sizeof *k.at) == 0);
        ck_assert(memcmp(&k.at[i], &k.at[i % k.n * k.n + i / k.n], sizeof *k.at) == 0);
    }
    free(k.at), free(shuffled.at);
    mesh_free(&mesh), mesh_free(&other);
}
END_TEST

/* ---- bounds ---------------------------------------------------------------------- */

START_TEST(bound_holds_and_is_sharp)
{
    for (test_diagonals way = MESH_RIGHT; way <= MESH_RANDOM; ++way) {
        test_mesh mesh;
        mesh_sheet(&mesh, 8, 8, 0.1, way, way == MESH_RANDOM ? 0.25 : 0.0, 3);
        mesh.fabrics[0] = isotropic;
        const weft_cloth_def def = mesh_cloth(&mesh);
        weft_cloth *cloth = test_cloth(&def);
        matrix k = matrix_of(cloth);
        double bound = 0.0, rows = 0.0;
        for (size_t i = 0; i < k.n; ++i) {
            double sum = 0.0;
            for (size_t j = 0; j < k.n; ++j) {
                sum += fabs(k.at[i * k.n + j]);
            }
            rows = fmax(rows, sum / mass_of(cloth, i));
            bound = fmax(bound, cloth->plate.most[i] / cloth->mesh.mass[i]);
        }
        divide_by_masses(&k, cloth);
        diagonalise(&k);
        const double top = largest(&k);
        ck_assert(rows <= 2.1 * top && bound >= top && bound <= 1.3 * top);
        weft_cloth_destroy(cloth);
        free(k.at);
        mesh_free(&mesh);
    }
}
END_TEST

/* ---- the force ------------------------------------------------------------------- */

/* A cloth of some 1600 particles, 0: undamped, 1: damped, 2: of two fabrics that are
 * damped differently, and a state of it. */
typedef struct sample {
    test_mesh mesh;
    uint32_t *fabric_of;
    weft_cloth *cloth;
    size_t n;
    double *y, *along, *force;
    weft__state at;
} sample;

static void sample_init(sample *of, int kind)
{
    uint64_t seed = 11;
    mesh_sheet(&of->mesh, 40, 40, 0.01, MESH_RANDOM, 0.25, 5);
    of->mesh.fabrics[0].damping[1] = kind == 0 ? 0.0 : 1e-3;
    of->mesh.fabrics[1] = isotropic;
    of->mesh.fabrics[1].damping[1] = 5e-3;
    of->fabric_of = calloc(of->mesh.def.triangles, sizeof *of->fabric_of);
    for (size_t t = 0; kind == 2 && t < of->mesh.def.triangles; ++t) {
        of->fabric_of[t] = random_uniform(&seed) < 0.5;
    }
    of->mesh.def.fabric_of = of->fabric_of;
    of->mesh.def.fabric_count = 2;
    const weft_cloth_def def = mesh_cloth(&of->mesh);
    of->cloth = test_cloth(&def);
    of->n = weft_cloth_particles(of->cloth);
    of->y = malloc(6 * of->n * sizeof *of->y);
    of->along = malloc(6 * of->n * sizeof *of->along);
    of->force = calloc(3 * of->n, sizeof *of->force);
    weft_cloth_start(of->cloth, of->y);
    for (size_t i = 0; i < 6 * of->n; ++i) {
        of->y[i] += 1e-3 * random_uniform(&seed);
        of->along[i] = random_uniform(&seed) - 0.5;
    }
    of->at = (weft__state){ .y = of->y };
}

static void sample_free(sample *of)
{
    weft_cloth_destroy(of->cloth);
    mesh_free(&of->mesh);
    free(of->fabric_of), free(of->y), free(of->along), free(of->force);
}

/* The force [N] in a state. */
static void push(const sample *of, const double *y, double *to)
{
    const weft__state at = { .y = y };
    memset(to, 0, 3 * of->n * sizeof *to);
    ck_assert_int_eq(weft__plate_force.law.add(&of->cloth->plate, &at, WEFT__FORCE, to,
                                               0, weft__blocks(&of->cloth->mesh)),
                     0);
}

static weft_measures measured(const sample *of, const double *y)
{
    const weft__state at = { .y = y };
    weft_measures sum = { .touching = 0 };
    for (size_t b = 0; b < weft__blocks(&of->cloth->mesh); ++b) {
        weft__plate_force.measures.energy(&of->cloth->plate, &at, b, &sum);
        weft__plate_force.measures.power(&of->cloth->plate, &at, b, &sum);
    }
    return sum;
}

static double product(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

START_TEST(momentum_is_kept_and_heat_is_what_damping_takes)
{
    sample of;
    sample_init(&of, _i);
    double *still = calloc(6 * of.n, sizeof *still), size = 0.0;
    double *moving = calloc(3 * of.n, sizeof *moving);
    memcpy(still, of.y, 3 * of.n * sizeof *still);
    push(&of, still, of.force);
    push(&of, of.y, moving);
    for (size_t k = 0; k < 3; ++k) {
        double sum = 0.0;
        for (size_t i = 0; i < of.n; ++i) {
            sum += moving[k * of.n + i];
            size += fabs(moving[k * of.n + i]);
        }
        ck_assert(fabs(sum) < 1e-13 * size);
    }
    const double *v = of.y + 3 * of.n;
    const double taken = product(of.force, v, 3 * of.n) - product(moving, v, 3 * of.n);
    const double heat = measured(&of, of.y).power[WEFT_POWER_SPRINGS];
    ck_assert(fabs(taken - heat) <= 1e-9 * heat);
    ck_assert(_i == 0 ? heat == 0.0 : heat > 0.0);
    free(still), free(moving);
    sample_free(&of);
}
END_TEST

START_TEST(moving_pins_put_in_what_the_cloth_takes)
{
    test_mesh mesh;
    uint64_t seed = 3;
    enum { ROWS = 6, N = ROWS * ROWS };
    size_t held[2 * ROWS];
    mesh_sheet(&mesh, ROWS, ROWS, 0.01, MESH_RANDOM, 0.25, 5);
    for (size_t i = 0; i < 2 * ROWS; ++i) {
        held[i] = i;
    }
    const weft_pin pin = { .vertices = held,
                           .vertex_count = 2 * ROWS,
                           .velocity = { 0.1, -0.2, 0.3 } };
    weft_cloth_def def = mesh_cloth(&mesh);
    def.pins = &pin, def.pin_count = 1, def.pin_size = sizeof pin;
    weft_cloth *cloth = test_cloth(&def);
    double y[6 * N], f[3 * N], put_in = 0.0;
    const sample of = { .cloth = cloth, .n = N };
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < 3 * N; ++i) {
        y[i] += 1e-3 * random_uniform(&seed);
    }
    push(&of, y, f);
    for (size_t i = 0; i < 3 * N; ++i) {
        put_in -= cloth->mesh.pin[i % N] != 0 ? f[i] * pin.velocity[i / N] : 0.0;
    }
    ck_assert_double_eq_tol(measured(&of, y).power[WEFT_POWER_PINS] / put_in, 1.0,
                            1e-12);
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

START_TEST(fast_forms_have_the_bits_of_the_loops)
{
    sample of;
    sample_init(&of, _i);
    double *loops = calloc(3 * of.n, sizeof *loops);
    for (weft__isa isa = WEFT__LOOPS; isa <= weft__isa_last(); ++isa) {
        weft__cloth_choose(of.cloth, isa);
        push(&of, of.y, isa == WEFT__LOOPS ? loops : of.force);
        ck_assert(isa == WEFT__LOOPS
                  || memcmp(loops, of.force, 3 * of.n * sizeof *loops) == 0);
    }
    free(loops);
    sample_free(&of);
}
END_TEST

START_TEST(ties_are_the_matrix)
{
    sample of;
    sample_init(&of, _i);
    const weft__plate *plate = &of.cloth->plate;
    const size_t count = weft__plate_force.couplings.scalar_couplings(plate, NULL);
    weft_scalar_coupling *ties = malloc(count * sizeof *ties);
    ck_assert_uint_eq(weft__plate_force.couplings.scalar_couplings(plate, ties), count);
    push(&of, of.y, of.force);
    double apart = 0.0, size = 0.0;
    for (size_t j = 0; j < count; ++j) {
        const size_t p = ties[j].p, q = ties[j].q;
        ck_assert(p < q);
        for (size_t k = 0; k < 3; ++k) {
            const double *x = of.y + k * of.n, *v = x + 3 * of.n;
            const double pull = ties[j].k * (x[p] - x[q]) + ties[j].c * (v[p] - v[q]);
            size = fmax(size, fabs(pull));
            of.force[k * of.n + p] += pull;
            of.force[k * of.n + q] -= pull;
        }
    }
    for (size_t i = 0; i < 3 * of.n; ++i) {
        apart = fmax(apart, fabs(of.force[i]));
    }
    ck_assert(apart < 1e-13 * size);
    free(ties);
    sample_free(&of);
}
END_TEST

/* ---- what may fail --------------------------------------------------------------- */

typedef struct pool {
    size_t calls, fail_at, live;
} pool;

static void *pool_resize(void *ctx, void *block, size_t size)
{
    pool *from = ctx;
    if (size == 0) {
        --from->live;
        free(block);
        return NULL;
    }
    if (++from->calls >= from->fail_at) {
        return NULL;
    }
    from->live += block == NULL;
    return realloc(block, size);
}

START_TEST(memory_that_is_missing_is_reported_and_goes_back)
{
    test_mesh mesh;
    size_t failures = 0;
    cut(&mesh, 4, WEFT_SEAM_BEND);
    mesh.def.arc = true;
    mesh.fabrics[1] = isotropic;
    mesh.fabrics[1].damping[1] = 1.0;
    uint32_t fabric_of[32] = { 1 };
    mesh.def.fabric_of = fabric_of, mesh.def.fabric_count = 2;
    for (weft_status status = WEFT_NO_MEMORY; status != WEFT_OK; ++failures) {
        pool from = { .fail_at = failures + 1 };
        const weft_allocator memory = { .resize = pool_resize, .ctx = &from };
        weft_cloth_def def = mesh_cloth(&mesh);
        def.allocator = &memory;
        weft_cloth *cloth;
        status = weft_cloth_create(&def, &cloth, NULL);
        ck_assert(status == WEFT_OK || status == WEFT_NO_MEMORY);
        weft_cloth_destroy(cloth);
        ck_assert_uint_eq(from.live, 0);
    }
    ck_assert_uint_gt(failures, 60);
    mesh_free(&mesh);
}
END_TEST

START_TEST(bending_beyond_a_double_is_refused)
{
    test_mesh mesh;
    weft_cloth *cloth;
    weft_error err;
    mesh_sheet(&mesh, 4, 4, 1e-3, MESH_RIGHT, 0.0, 1);
    mesh.fabrics[0].bend[0] = 1e300;
    const weft_cloth_def def = mesh_cloth(&mesh);
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message,
                     "the bending of the fabric of triangle 0 is too large "
                     "for a double at its height of 0.000707 m");
    mesh_free(&mesh);
}
END_TEST

TEST_SUITE(plate)
{
    Suite *suite = suite_create("plate");
    TCase *tcase = tcase_create("plate");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, panels_of_any_shape_have_three_zero_modes, 0, 40);
    tcase_add_loop_test(tcase, families_of_meshes_have_three_zero_modes, 0, FAMILIES);
    tcase_add_test(tcase, fans_have_three_zero_modes);
    tcase_add_test(tcase, one_triangle_has_no_bending);
    tcase_add_test(tcase, cylinders_of_any_direction_have_their_energy);
    tcase_add_test(tcase, inner_particles_feel_no_force_on_quadratics);
    tcase_add_loop_test(tcase, supported_plate_converges_with_order_2, 0, 3);
    tcase_add_test(tcase, strip_of_pinned_triangles_clamps_along_its_inner_rim);
    tcase_add_test(tcase, strip_hangs_as_the_heavy_elastica);
    tcase_add_test(tcase, sewn_pieces_bend_as_a_whole);
    tcase_add_loop_test(tcase, sewn_pieces_converge_with_order_2, WHOLE, DART + 1);
    tcase_add_test(tcase, hinge_has_one_zero_mode_more);
    tcase_add_test(tcase, matrix_does_not_depend_on_numbers);
    tcase_add_test(tcase, bound_holds_and_is_sharp);
    tcase_add_loop_test(tcase, momentum_is_kept_and_heat_is_what_damping_takes, 0, 3);
    tcase_add_test(tcase, moving_pins_put_in_what_the_cloth_takes);
    tcase_add_loop_test(tcase, fast_forms_have_the_bits_of_the_loops, 0, 3);
    tcase_add_loop_test(tcase, ties_are_the_matrix, 0, 3);
    tcase_add_test(tcase, memory_that_is_missing_is_reported_and_goes_back);
    tcase_add_test(tcase, bending_beyond_a_double_is_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
