/* SPDX-License-Identifier: BSD-3-Clause */
/* two_cloths.c -- two square cloths in one mesh: one hangs from two corners, the other
 * flies past it. */
#include <stdio.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { SIDE = 6, ONE = SIDE * SIDE, ALL = 2 * ONE, CELLS = (SIDE - 1) * (SIDE - 1) };

/* u v of each place in the rest shape, x y z of each vertex at the start [m] */
static double rest[ALL][2], start[ALL][3];
static uint32_t corners[2 * 2 * CELLS][3], fabric_of[2 * 2 * CELLS];

/* Square k, 5 cm from vertex to vertex, in the plane z. */
static void add_square(size_t k, double z)
{
    for (size_t i = 0; i < ONE; ++i) {
        double *uv = rest[k * ONE + i], *x = start[k * ONE + i];
        uv[0] = x[0] = 0.05 * (double)(i % SIDE);
        uv[1] = x[1] = -0.05 * (double)(i / SIDE);
        x[2] = z;
    }
    for (size_t c = 0; c < CELLS; ++c) {
        const uint32_t a = (uint32_t)(k * ONE + c / (SIDE - 1) * SIDE + c % (SIDE - 1));
        const uint32_t two[6] = { a, a + SIDE, a + 1, a + 1, a + SIDE, a + SIDE + 1 };
        for (size_t j = 0; j < 6; ++j) {
            corners[2 * (k * CELLS + c) + j / 3][j % 3] = two[j];
        }
        fabric_of[2 * (k * CELLS + c)] = fabric_of[2 * (k * CELLS + c) + 1]
            = (uint32_t)k;
    }
}

int main(void)
{
    //! [fabric]
    const weft_fabric fabrics[2]
        = { *weft_fabric_find("royal-target"), *weft_fabric_find("11oz-black-denim") };
    //! [fabric]
    const weft_cloth_part parts[2]
        = { { "flag", 0, ONE, { 0.0, 0.0, 0.0 } }, /* [m/s] */
            { "leaf", ONE, ONE, { 1.0, 2.0, 0.0 } } };
    const size_t held[2] = { 0, SIDE - 1 };
    const weft_pin pin = { .vertices = held, .vertex_count = 2 };
    weft_mesh_def mesh = weft_mesh_def_default();
    weft_cloth_def def = weft_cloth_def_default();
    add_square(0, 0.0);
    add_square(1, 0.2);
    mesh.vertices = mesh.uv_count = ALL;
    mesh.start = start[0];
    mesh.rest = rest[0];
    mesh.triangles = 2 * 2 * CELLS;
    mesh.corners = corners[0];
    mesh.fabrics = fabrics;
    mesh.fabric_count = 2;
    mesh.fabric_of = fabric_of;
    mesh.parts = parts;
    mesh.part_count = 2;
    def.mesh = &mesh;
    def.pins = &pin;
    def.pin_count = 1;

    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_error err;
    weft_sim_def run = weft_sim_def_default();
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = 2e-4; /* [s] */
    bool ok = weft_cloth_create(&def, &cloth, &err) == WEFT_OK;
    run.cloth = cloth;
    ok = ok && weft_sim_create(&run, &sim, &err) == WEFT_OK
         && weft_sim_advance(sim, 0.4, &err) == WEFT_OK;
    //! [parts]
    for (size_t k = 0; ok && k < weft_cloth_parts(cloth); ++k) {
        const weft_cloth_part part = weft_cloth_part_at(cloth, k);
        double xyz[ALL][3], height = 0.0; /* [m] */
        weft_sim_positions(sim, xyz[0]);
        for (size_t i = part.first; i < part.first + part.count; ++i) {
            height += xyz[i][1] / (double)part.count;
        }
        printf("%s: %zu vertices, at a height of %+.4f m\n", part.name, part.count,
               height);
    }
    //! [parts]
    if (!ok) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return ok ? 0 : 1;
}
