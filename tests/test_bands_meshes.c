/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* test_bands_meshes.c -- a cloth of triangles in bands of blocks has the bits of the
 * whole cloth on any number of bands, as test_bands.c has them of grids. */
#include "bands_run.h"
#include "bodies.h"
#include "meshes.h"

/* A sheet of two fabrics, sewn along a line, with pins at rest and moving, loads, and
 * wind; its vertices have no order. */
static scenario sewn(test_mesh *sheet, size_t rows, const char *method)
{
    static const size_t some[] = { 0, 1, 2, 300, 700, 1100 };
    static const weft_pin held[] = { { .vertices = some, .vertex_count = 3 },
                                     { .vertices = some + 3,
                                       .vertex_count = 3,
                                       .velocity = { 0.2, 0.0, 0.3 },
                                       .amplitude = { 0.0, 0.01, 0.0 },
                                       .frequency = 5.0 } };
    static const weft_load load
        = { .vertices = some + 4, .vertex_count = 2, .mass = 1e-3 };
    static uint32_t fabrics[20000];
    const size_t cols = 90;
    scenario of = in_wind(11, 6, method);
    const weft_cloth_def grid = of.cloth;
    mesh_sheet(sheet, rows, cols, 0.02, MESH_RANDOM, 0.2, rows);
    mesh_sew(sheet, cols / 2, 0.3, 0.8, 0.6);
    mesh_shuffle(sheet, 7, NULL);
    sheet->fabrics[0].damping[0] = sheet->fabrics[0].damping[1]
        = test_needs_damping(of.sim.method) ? 2e-3 : 2e-5;
    sheet->fabrics[1] = sheet->fabrics[0];
    sheet->fabrics[1].damping[1] *= 0.5;
    ck_assert_uint_le(sheet->def.triangles, sizeof fabrics / sizeof fabrics[0]);
    for (size_t t = 0; t < sheet->def.triangles; ++t) {
        fabrics[t] = t % 7 == 0;
    }
    sheet->def.fabric_count = 2;
    sheet->def.fabric_of = fabrics;
    of.cloth = mesh_cloth(sheet);
    of.cloth.gravity[1] = -9.81;
    of.cloth.pins = held, of.cloth.pin_count = 2;
    of.cloth.loads = &load, of.cloth.load_count = 1;
    of.cloth.damping = 1e-4;
    of.cloth.wind_table = grid.wind_table, of.cloth.wind_drag = grid.wind_drag;
    of.duration = 0.002;
    if (of.sim.config.fixed_step > 0.0) {
        of.sim.config.fixed_step = 4e-5;
    }
    return of;
}

/* The same, about to fall on a ball. */
static scenario falling(test_mesh *sheet)
{
    scenario of = sewn(sheet, 54, "arkode/dormand_prince");
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.1;
    shapes[0].at[0] = 0.9, shapes[0].at[1] = 0.6, shapes[0].at[2] = -0.106;
    shapes[0].velocity[2] = 2.0;
    of.cloth.contact.shapes = shapes;
    of.cloth.contact.shape_count = 1;
    of.sim.ledger = true;
    return of;
}

START_TEST(methods_have_the_same_bits)
{
    static const struct {
        const char *method;
        size_t rows;
    } of[] = { { "arkode/dormand_prince", 52 },
               { "verlet/velocity_verlet", 57 },
               { "stiff/rkc2", 52 } };
    for (size_t i = 0; i < sizeof of / sizeof of[0]; ++i) {
        test_mesh sheet;
        outcome whole;
        const scenario on = sewn(&sheet, of[i].rows, of[i].method);
        run_whole(&on, &whole);
        ck_assert_msg(whole.status == WEFT_OK, "%s", whole.err.message);
        drop(&whole);
        check_bands(&on);
        mesh_free(&sheet);
    }
}
END_TEST

/* And end a step where the lowest particle of all falls below a height. */
START_TEST(the_rms_norm_and_events_have_the_same_bits)
{
    static const char *const methods[] = { "arkode/bogacki_shampine", "stiff/rkc2" };
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; ++i) {
        test_mesh sheet;
        outcome whole, parts;
        double z = -1e-5;
        scenario of = sewn(&sheet, 52, methods[i]);
        of.sim.config.norm = WEFT_NORM_RMS;
        of.sim.event = lowest;
        of.sim.event_ctx = &z;
        run_whole(&of, &whole);
        ck_assert_int_eq(whole.status, WEFT_OK);
        bool found = false;
        for (size_t f = 0; f < whole.frames; ++f) {
            found = found || strstr(whole.series[f], "event 0x1") != NULL;
        }
        ck_assert(found);
        for (size_t c = 0; c < (size_t)test_rounds(1, COUNTS); ++c) {
            run_bands(&of, counts[(2 + i + c) % COUNTS], &parts);
            check_bits(&of, &whole, &parts);
            drop(&parts);
        }
        drop(&whole);
        mesh_free(&sheet);
    }
}
END_TEST

START_TEST(threads_of_bands_have_the_same_bits)
{
    test_mesh sheet;
    outcome whole, parts;
    scenario of = sewn(&sheet, 54, "arkode/bogacki_shampine");
    run_whole(&of, &whole);
    of.sim.config.threads = 2;
    run_bands(&of, 2, &parts);
    check_bits(&of, &whole, &parts);
    drop(&parts), drop(&whole);
    mesh_free(&sheet);
}
END_TEST

START_TEST(contact_and_ledger_have_the_same_bits_and_steps_are_taken_back_together)
{
    test_mesh sheet;
    outcome whole;
    scenario of = falling(&sheet);
    run_whole(&of, &whole);
    ck_assert_msg(whole.status == WEFT_OK, "%s", whole.err.message);
    ck_assert_ptr_nonnull(strstr(whole.series[FRAMES], "touching 0x1."));
    drop(&whole);
    check_bands(&of);
    of.sim.method = test_method_named("verlet/velocity_verlet");
    of.sim.config.fixed_step = 4e-5;
    of.duration = 4e-4;
    shapes[0].velocity[2] = 150.0;
    run_whole(&of, &whole);
    ck_assert_msg(strstr(whole.series[whole.frames - 1], "vetoed 0x0") == NULL, "%s",
                  whole.series[whole.frames - 1]);
    drop(&whole);
    check_bands(&of);
    mesh_free(&sheet);
}
END_TEST

/* Into the middle of a triangle, which is larger than the ball. */
START_TEST(passages_have_the_message_of_the_whole)
{
    test_mesh sheet;
    outcome whole;
    scenario of = falling(&sheet);
    const uint32_t *corner = sheet.def.corners + 3 * (sheet.def.triangles / 2);
    shapes[0].radius = 2e-3;
    for (size_t k = 0; k < 3; ++k) {
        shapes[0].at[k] = 0.0;
        for (size_t c = 0; c < 3; ++c) {
            shapes[0].at[k] += sheet.def.start[3 * corner[c] + k] / 3.0;
        }
    }
    shapes[0].at[2] -= 5e-3;
    shapes[0].velocity[2] = 5e-3 / of.duration;
    of.cloth.contact.thickness = 5e-4;
    of.cloth.strict = true;
    run_whole(&of, &whole);
    ck_assert_msg(strstr(whole.err.message, "passes through") != NULL, "%s",
                  whole.err.message);
    drop(&whole);
    check_bands(&of);
    mesh_free(&sheet);
}
END_TEST

START_TEST(failures_have_the_message_of_the_whole)
{
    test_mesh sheet;
    outcome whole;
    scenario of = sewn(&sheet, 54, "verlet/velocity_verlet");
    of.sim.config.fixed_step = 4e-4;
    of.duration = 1.0;
    run_whole(&of, &whole);
    ck_assert_int_eq(whole.status, WEFT_NOT_FINITE);
    drop(&whole);
    check_bands(&of);
    mesh_free(&sheet);
}
END_TEST

START_TEST(saved_bands_restore_on_any_number)
{
    test_mesh sheet;
    scenario of = falling(&sheet);
    outcome saved;
    run_bands(&of, 3, &saved);
    ck_assert_int_eq(saved.status, WEFT_OK);
    of.restore = saved.saved, of.restore_size = saved.saved_size;
    check_bands(&of);
    drop(&saved);
    mesh_free(&sheet);
}
END_TEST

START_TEST(a_band_without_memory_fails_all)
{
    test_mesh sheet;
    scenario of = sewn(&sheet, 54, "arkode/dormand_prince");
    outcome parts;
    of.odd = NO_MEMORY;
    of.odd_band = 1;
    run_bands(&of, 3, &parts);
    ck_assert_int_eq(parts.status, WEFT_NO_MEMORY);
    drop(&parts);
    mesh_free(&sheet);
}
END_TEST

START_TEST(a_band_lies_inside_and_has_straight_edges)
{
    test_mesh sheet;
    weft_cloth *cloth = NULL;
    weft_error err;
    const scenario of = sewn(&sheet, 54, "arkode/dormand_prince");
    weft_cloth_def def = of.cloth;
    def.band_first = 9, def.band_rows = 3;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "3 blocks from block 9 of 10"));
    def.band_first = 7, def.untangle = 1.0;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_UNSUPPORTED);
    def.untangle = 0.0, sheet.def.arc = true;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_UNSUPPORTED);
    mesh_free(&sheet);
}
END_TEST

START_TEST(a_mesh_collider_is_refused_in_bands)
{
    test_mesh sheet;
    weft_cloth *cloth = NULL;
    weft_error err;
    const scenario of = sewn(&sheet, 54, "arkode/dormand_prince");
    weft_cloth_def def = of.cloth;
    body_mesh *ground = plate(1, 1.0, 1.0);
    weft_shape shape = body_shape(ground);
    def.contact.shapes = &shape, def.contact.shape_count = 1;
    def.band_first = 7, def.band_rows = 3;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_UNSUPPORTED);
    ck_assert_ptr_nonnull(
        strstr(err.message, "with a shape of kind mesh has no bands"));
    free(ground);
    mesh_free(&sheet);
}
END_TEST

/* Own particles, and of the others those that forces on them depend on: on a sheet
 * about three rings. */
START_TEST(a_band_has_its_own_particles_and_few_ghosts)
{
    test_mesh sheet;
    mesh_sheet(&sheet, 150, 150, 0.01, MESH_ALTERNATING, 0.0, 1);
    weft_cloth_def def = mesh_cloth(&sheet);
    weft_cloth *whole = test_cloth(&def);
    double mass = 0.0;
    for (size_t rank = 0; rank < 4; ++rank) {
        ck_assert(weft_comm_band(weft_cloth_def_blocks(&def), rank, 4, &def.band_first,
                                 &def.band_rows));
        weft_cloth *cloth = test_cloth(&def);
        const size_t own = weft_cloth_band(cloth).own * WEFT_BLOCK_VERTICES;
        ck_assert_uint_le(weft_cloth_particles(cloth), own + own / 4);
        ck_assert_uint_lt(weft_cloth_bytes(cloth), weft_cloth_bytes(whole) / 2);
        mass += weft_cloth_mass(cloth);
        weft_cloth_destroy(cloth);
    }
    ck_assert_double_eq_tol(mass, weft_cloth_mass(whole), 1e-12 * mass);
    weft_cloth_destroy(whole);
    mesh_free(&sheet);
}
END_TEST

TEST_SUITE(bands_meshes)
{
    Suite *suite = suite_create("bands of meshes");
    TCase *same = tcase_create("same bits");
    tcase_set_timeout(same, 240);
    tcase_add_test(same, methods_have_the_same_bits);
    tcase_add_test(same, the_rms_norm_and_events_have_the_same_bits);
    tcase_add_test(same, threads_of_bands_have_the_same_bits);
    tcase_add_test(
        same, contact_and_ledger_have_the_same_bits_and_steps_are_taken_back_together);
    tcase_add_test(same, passages_have_the_message_of_the_whole);
    tcase_add_test(same, failures_have_the_message_of_the_whole);
    tcase_add_test(same, saved_bands_restore_on_any_number);
    tcase_add_test(same, a_band_without_memory_fails_all);
    tcase_add_test(same, a_band_lies_inside_and_has_straight_edges);
    tcase_add_test(same, a_mesh_collider_is_refused_in_bands);
    tcase_add_test(same, a_band_has_its_own_particles_and_few_ghosts);
    suite_add_tcase(suite, same);
    return suite;
}
