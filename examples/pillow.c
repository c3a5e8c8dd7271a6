/* SPDX-License-Identifier: BSD-3-Clause */
/* pillow.c -- two squares that are sewn along their rim, and the air in between: a
 * pressure as an own force on a mesh, by the numbers of the vertices. */
#include <stdio.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum {
    SIDE = 11,
    CELLS = (SIDE - 1) * (SIDE - 1),
    TOP = SIDE * SIDE,                   /* vertices of the upper square */
    ALL = TOP + (SIDE - 2) * (SIDE - 2), /* the lower one shares its rim */
    TRIANGLES = 2 * 2 * CELLS
};

/* u v of each place in the rest shape, x y z of each vertex at the start [m] */
static double rest[2 * TOP][2], start[ALL][3];
static uint32_t corners[TRIANGLES][3], places[TRIANGLES][3];

static int on_rim(int row, int col)
{
    return row == 0 || col == 0 || row == SIDE - 1 || col == SIDE - 1;
}

/* Square k: 0 above, 1 below, seen from outside. */
static void add_square(int k, uint32_t vertex_of[TOP], uint32_t *next)
{
    const double spacing = 0.03; /* [m] */
    for (int i = 0; i < TOP; ++i) {
        const int row = i / SIDE, col = i % SIDE, rim = on_rim(row, col);
        double *uv = rest[k * TOP + i];
        if (k == 0 || !rim) {
            double *x = start[vertex_of[i] = (*next)++];
            x[0] = spacing * col;
            x[1] = rim ? 0.0 : k == 0 ? 1e-3 : -1e-3;
            x[2] = spacing * row;
        }
        uv[0] = k == 0 ? spacing * col : -spacing * col;
        uv[1] = -spacing * row;
    }
    for (int c = 0; c < CELLS; ++c) {
        const uint32_t a = (uint32_t)(c / (SIDE - 1) * SIDE + c % (SIDE - 1));
        const uint32_t above[6] = { a, a + SIDE, a + 1, a + 1, a + SIDE, a + SIDE + 1 };
        const uint32_t below[6] = { a, a + 1, a + SIDE + 1, a, a + SIDE + 1, a + SIDE };
        for (int j = 0; j < 6; ++j) {
            const uint32_t at = k == 0 ? above[j] : below[j];
            const int t = 2 * (k * CELLS + c) + j / 3;
            corners[t][j % 3] = vertex_of[at];
            places[t][j % 3] = (uint32_t)(k * TOP) + at;
        }
    }
}

typedef struct air {
    double pressure;   /* [Pa] above that outside */
    size_t place[ALL]; /* of each vertex in the planes of a state and of a force */
} air;

/* (b - a) x (c - a) of a triangle: twice its area, outwards. */
static void normal(const air *of, const double *y, const uint32_t corner[3],
                   double out[3])
{
    double e[2][3];
    for (int k = 0; k < 3; ++k) {
        const double *plane = y + k * ALL, a = plane[of->place[corner[0]]];
        e[0][k] = plane[of->place[corner[1]]] - a;
        e[1][k] = plane[of->place[corner[2]]] - a;
    }
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        out[k] = e[0][l] * e[1][m] - e[0][m] * e[1][l];
    }
}

/* Each corner of a triangle gets a third of pressure times area. */
static int inflate(void *ctx, double t, const double *y, double *f)
{
    const air *of = (const air *)ctx;
    double n[3];
    (void)t;
    for (int i = 0; i < TRIANGLES; ++i) {
        normal(of, y, corners[i], n);
        for (int j = 0; j < 9; ++j) {
            f[j / 3 * ALL + (int)of->place[corners[i][j % 3]]]
                += of->pressure / 6.0 * n[j / 3];
        }
    }
    return 0;
}

/* [m^3] enclosed by the triangles. */
static double volume(const air *of, const double *y)
{
    double sum = 0.0, n[3];
    for (int i = 0; i < TRIANGLES; ++i) {
        normal(of, y, corners[i], n);
        for (int k = 0; k < 3; ++k) {
            sum += y[k * ALL + (int)of->place[corners[i][0]]] * n[k] / 6.0;
        }
    }
    return sum;
}

static void print(const weft_sim *sim, const air *of)
{
    static double f[3 * ALL];
    double sum[3] = { 0.0, 0.0, 0.0 }, largest = 0.0;
    for (int j = 0; j < 3 * ALL; ++j) {
        f[j] = 0.0;
    }
    (void)inflate((void *)of, 0.0, weft_sim_state(sim), f);
    for (int j = 0; j < 3 * ALL; ++j) {
        sum[j / ALL] += f[j];
        largest = f[j] > largest ? f[j] : largest;
    }
    printf("%.2f s: %.3f l, at most %.4f N on a vertex, in all %+.0e %+.0e %+.0e N\n",
           weft_sim_time(sim), 1e3 * volume(of, weft_sim_state(sim)), largest, sum[0],
           sum[1], sum[2]);
}

int main(void)
{
    const weft_fabric fabric = *weft_fabric_find("royal-target");
    weft_mesh_def mesh = weft_mesh_def_default();
    weft_cloth_def def = weft_cloth_def_default();
    weft_sim_def run = weft_sim_def_default();
    static air inside;
    uint32_t vertex_of[TOP], next = 0;
    inside.pressure = 20.0;
    add_square(0, vertex_of, &next);
    add_square(1, vertex_of, &next);
    //! [mesh]
    mesh.vertices = ALL;
    mesh.start = start[0];
    mesh.uv_count = 2 * TOP;
    mesh.rest = rest[0];
    mesh.triangles = TRIANGLES;
    mesh.corners = corners[0];
    mesh.corner_uv = places[0];
    mesh.fabrics = &fabric;
    mesh.fabric_count = 1;
    //! [mesh]
    def.mesh = &mesh;
    def.gravity[1] = 0.0;
    def.damping = 1e-4; /* [kg/s] */
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = 1e-4; /* [s] */
    run.force = inflate;
    run.force_ctx = &inside;

    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err;
    bool ok = weft_cloth_create(&def, &cloth, &err) == WEFT_OK;
    //! [index]
    for (size_t v = 0; ok && v < ALL; ++v) {
        inside.place[v] = weft_cloth_index(cloth, v);
    }
    //! [index]
    run.cloth = cloth;
    ok = ok && weft_sim_create(&run, &sim, &err) == WEFT_OK;
    for (int frame = 0; ok && frame <= 10; ++frame) {
        ok = weft_sim_advance(sim, frame / 50.0, &err) == WEFT_OK;
        print(sim, &inside);
    }
    if (!ok) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return ok ? 0 : 1;
}
