/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_cloth_grids.c -- grids of springs among several cloths: each is the grid that it
 * is alone, and touches others by its triangles. */
#include <math.h>

#include "meshes.h"
#include "scene_load.h"
#include "shell.h"

#define OUT     BUILD_DIR "/cloth_grids"
#define PROGRAM "\"$weft\"" /* of a shell that has entered a directory */
#define IN      "weft=$PWD/" WEFT " && cd " OUT " && "

/* A grid with all that it may have, before and behind a mesh and another grid. */
enum { ROWS = 7, COLS = 9, GRID = ROWS * COLS, VEIL = 5 * 4, MESH = 30 };
enum { FIRST = VEIL + MESH, ALL = FIRST + GRID };

typedef struct outfit {
    test_mesh sheet;
    weft_cloth_def grid, veil, def;
    const weft_cloth_def *grids[3];
    weft_cloth_part parts[3];
    weft_mesh_def mesh;
    weft_pin pins[2];
    weft_load load;
    double start[3 * ALL];
    uint32_t corners[3 * 60];
    size_t held[2];
    weft_cloth *alone, *all;
} outfit;

static weft_cloth_def grid_of(size_t rows, size_t cols)
{
    weft_cloth_def out = weft_cloth_def_default();
    out.rows = rows, out.cols = cols;
    out.spacing[0] = 0.03, out.spacing[1] = 0.04;
    out.density = 0.2, out.mass = 0.0;
    out.rim_half = true;
    out.springs[WEFT_STRETCH] = (weft_spring_def){ true, 100.0, 0.1 };
    out.springs[WEFT_SHEAR] = (weft_spring_def){ true, 40.0, 0.02 };
    out.springs[WEFT_BEND] = (weft_spring_def){ false, 0.0, 0.0 };
    out.bending = (weft_bending_def){ { 2e-5, 1e-5 }, 1e-5, 1e-3 };
    out.wind_velocity[2] = 3.0;
    out.wind_drag = 0.5;
    out.damping = 1e-4;
    return out;
}

static void make_outfit(outfit *at, bool self)
{
    weft_error err = { 0 };
    *at = (outfit){ .grid = grid_of(ROWS, COLS), .veil = grid_of(5, 4) };
    at->pins[0] = (weft_pin){ .rows = { 0, 0 }, .cols = { 0, 0 } };
    at->pins[1] = (weft_pin){ .rows = { 0, 0 },
                              .cols = { -1, -1 },
                              .velocity = { 0.1, 0.2, 0.3 } };
    at->load = (weft_load){ .rows = { 3, 3 }, .cols = { 4, 4 }, .mass = 0.01 };
    at->grid.pins = at->pins, at->grid.pin_count = 2;
    at->grid.loads = &at->load, at->grid.load_count = 1;
    at->grid.contact.self = self;
    at->grid.contact.thickness = 0.012;
    ck_assert_msg(weft_cloth_create(&at->grid, &at->alone, &err) == WEFT_OK, "%s",
                  err.message);
    mesh_sheet(&at->sheet, 5, 6, 0.05, MESH_RANDOM, 0.1, 3);
    at->mesh = at->sheet.def;
    memcpy(at->start + 3 * VEIL, at->sheet.def.start, 3 * MESH * sizeof(double));
    for (size_t j = 0; j < 3 * at->mesh.triangles; ++j) {
        at->corners[j] = at->sheet.def.corners[j] + VEIL;
    }
    for (size_t i = VEIL; i < FIRST; ++i) {
        at->start[3 * i + 2] += 3.0; /* far from both */
    }
    at->veil.origin[2] = -3.0;
    at->mesh.vertices = ALL;
    at->mesh.start = at->start;
    at->mesh.corner_uv = at->sheet.def.corners;
    at->mesh.corners = at->corners;
    at->mesh.parts = at->parts, at->mesh.part_count = 3;
    at->mesh.grids = at->grids;
    at->parts[0] = (weft_cloth_part){ "veil", 0, VEIL, { 0.0 } };
    at->parts[1] = (weft_cloth_part){ "sheet", VEIL, MESH, { 0.0 } };
    at->parts[2] = (weft_cloth_part){ "flag", FIRST, GRID, { 0.0 } };
    at->grids[0] = &at->veil, at->grids[2] = &at->grid;
    at->def = at->grid; /* its air and contact */
    at->def.mesh = &at->mesh;
    at->held[0] = FIRST, at->held[1] = FIRST + COLS - 1;
    static size_t loaded = FIRST + 3 * COLS + 4;
    at->pins[0].vertices = &at->held[0], at->pins[0].vertex_count = 1;
    at->pins[1].vertices = &at->held[1], at->pins[1].vertex_count = 1;
    at->load.vertices = &loaded, at->load.vertex_count = 1;
    ck_assert_msg(weft_cloth_create(&at->def, &at->all, &err) == WEFT_OK, "%s",
                  err.message);
}

static void free_outfit(outfit *at)
{
    weft_cloth_destroy(at->alone);
    weft_cloth_destroy(at->all);
    mesh_free(&at->sheet);
}

/* The state of the grid in that of all. */
static void put(const double *grid, double *all)
{
    for (size_t k = 0; k < 6; ++k) {
        memcpy(all + k * ALL + FIRST, grid + k * GRID, GRID * sizeof *all);
    }
}

static bool same(const double *grid, const double *all, size_t planes, double within)
{
    bool is = true;
    for (size_t j = 0; j < planes * GRID; ++j) {
        const double other = all[j / GRID * ALL + FIRST + j % GRID];
        is = is && fabs(other - grid[j]) <= within;
    }
    return is;
}

/* A start that is pulled about; folded: its lower half lies on the upper one. */
static void disturb(const weft_cloth *cloth, double *y, bool folded)
{
    unsigned seed = 1;
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < 6 * GRID; ++j) {
        seed = seed * 1664525U + 1013904223U;
        y[j]
            += 0.004 * ((double)seed / 4294967296.0 - 0.5) * (j < 3 * GRID ? 1.0 : 1e2);
    }
    for (size_t i = 4 * COLS; folded && i < GRID; ++i) {
        y[GRID + i] = 2.0 * y[GRID + 3 * COLS] - y[GRID + i] + 0.005;
        y[2 * GRID + i] += 0.008;
    }
}

START_TEST(a_grid_has_the_forces_that_it_has_alone_bit_for_bit)
{
    static outfit of;
    static double y[6 * GRID], z[6 * ALL], dy[6 * GRID], dz[6 * ALL];
    static double out[6 * GRID], sum[6 * ALL];
    make_outfit(&of, false);
    disturb(of.alone, y, false);
    weft_cloth_start(of.all, z);
    put(y, z);
    ck_assert_int_eq(weft_cloth_rhs(of.alone, 0.1, y, out), 0);
    ck_assert_int_eq(weft_cloth_rhs(of.all, 0.1, z, sum), 0);
    ck_assert(same(out, sum, 6, 0.0));
    weft_cloth_force(of.alone, 0.1, y, out);
    weft_cloth_force(of.all, 0.1, z, sum);
    ck_assert(same(out, sum, 3, 0.0));
    for (size_t j = 0; j < 6 * GRID; ++j) {
        dy[j] = sin(1.0 + (double)j);
    }
    put(dy, dz);
    ck_assert_int_eq(weft_cloth_jacobian_product(of.alone, 0.1, y, dy, out), 0);
    ck_assert_int_eq(weft_cloth_jacobian_product(of.all, 0.1, z, dz, sum), 0);
    ck_assert(same(out, sum, 6, 0.0));
    ck_assert_uint_eq(weft_cloth_springs(of.all, WEFT_SHEAR),
                      2 * (ROWS - 1) * (COLS - 1) + 2 * 4 * 3);
    const weft_spring worst = weft_cloth_worst_spring(of.alone, y),
                      other = weft_cloth_worst_spring(of.all, z);
    char text[2][96];
    ck_assert_uint_eq(other.p, worst.p + FIRST);
    ck_assert_uint_eq(other.q, worst.q + FIRST);
    (void)weft_spring_text(of.alone, &worst, text[0], sizeof text[0]);
    (void)weft_spring_text(of.all, &other, text[1], sizeof text[1]);
    ck_assert_str_eq(strcat(text[0], " of flag"), text[1]);
    free_outfit(&of);
}
END_TEST

START_TEST(grids_alone_need_no_array_of_triangles)
{
    static double y[6 * GRID], z[6 * GRID];
    const weft_cloth_def grid = grid_of(ROWS, COLS), *grids[] = { &grid };
    const weft_cloth_part part = { "flag", 0, GRID, { 0.0 } };
    weft_mesh_def mesh = weft_mesh_def_default();
    weft_cloth_def def = grid;
    mesh.vertices = GRID;
    mesh.parts = &part, mesh.part_count = 1, mesh.grids = grids;
    def.mesh = &mesh;
    weft_cloth *alone = test_cloth(&grid), *among = test_cloth(&def);
    weft_cloth_start(alone, y);
    weft_cloth_start(among, z);
    ck_assert_mem_eq(y, z, sizeof y);
    weft_cloth_destroy(alone);
    weft_cloth_destroy(among);
}
END_TEST

/* Energies, powers and the bound of modes: those of others are 0 or lower. */
START_TEST(a_grid_has_the_energy_the_powers_and_the_stiffness_that_it_has_alone)
{
    static outfit of;
    static double y[6 * GRID], z[6 * ALL];
    double p[WEFT_POWERS], q[WEFT_POWERS];
    make_outfit(&of, false);
    disturb(of.alone, y, false);
    weft_cloth_start(of.all, z);
    put(y, z);
    const weft_energy one = weft_cloth_energy(of.alone, 0.1, y),
                      all = weft_cloth_energy(of.all, 0.1, z);
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        ck_assert_double_eq_tol(all.elastic[k], one.elastic[k], 1e-13 * one.elastic[0]);
    }
    ck_assert_double_eq_tol(all.kinetic, one.kinetic, 1e-14);
    weft_cloth_power(of.alone, 0.1, y, p);
    weft_cloth_power(of.all, 0.1, z, q);
    for (size_t k = 0; k < WEFT_POWERS; ++k) {
        ck_assert_double_eq_tol(q[k], p[k], 1e-12);
    }
    ck_assert_double_ne(p[WEFT_POWER_WIND], 0.0);
    ck_assert_double_ne(p[WEFT_POWER_PINS], 0.0);
    ck_assert_double_ge(weft_cloth_stiffness(of.all, 0.1, z).omega2,
                        weft_cloth_stiffness(of.alone, 0.1, y).omega2);
    free_outfit(&of);
}
END_TEST

START_TEST(a_grid_touches_itself_as_it_does_alone)
{
    static outfit of;
    static double y[6 * GRID], z[6 * ALL], out[6 * GRID], sum[6 * ALL];
    make_outfit(&of, true);
    disturb(of.alone, y, true);
    weft_cloth_start(of.all, z);
    put(y, z);
    ck_assert_uint_gt(weft_cloth_self_touching(of.alone, y), 20);
    ck_assert_uint_eq(weft_cloth_self_touching(of.all, z),
                      weft_cloth_self_touching(of.alone, y));
    weft_cloth_force(of.alone, 0.1, y, out);
    weft_cloth_force(of.all, 0.1, z, sum);
    double most = 0.0;
    for (size_t j = 0; j < 3 * GRID; ++j) {
        most = fmax(most, fabs(out[j]));
    }
    ck_assert(same(out, sum, 3, 1e-12 * most));
    ck_assert_double_eq_tol(weft_cloth_energy(of.all, 0.1, z).contact,
                            weft_cloth_energy(of.alone, 0.1, y).contact, 1e-15);
    free_outfit(&of);
}
END_TEST

START_TEST(a_grid_of_several_cloths_is_checked_as_one_alone)
{
    static outfit of;
    weft_cloth *cloth;
    weft_error err;
    make_outfit(&of, true);
#define REFUSED(change, wanted)                                                        \
    change;                                                                            \
    ck_assert_int_eq(weft_cloth_create(&of.def, &cloth, &err), WEFT_INVALID);          \
    ck_assert_msg(strstr(err.message, wanted) != NULL, "no '%s' in %s", wanted,        \
                  err.message);
    REFUSED(of.def.contact.thickness = 0.0152, "half the smaller spacing of veil");
    of.def.contact.thickness = 0.012;
    REFUSED(of.veil.spacing[1] = -1.0, "veil: spacing");
    of.veil.spacing[1] = 0.04;
    REFUSED(of.veil.springs[0].stiffness = NAN, "veil: stretch springs: stiffness");
    of.veil.springs[0].stiffness = 100.0;
    REFUSED(of.veil.rows = 4,
            "part 0, veil, has 20 vertices, but its grid 4 rows of 4");
    REFUSED((of.veil.rows = 20, of.veil.cols = 1), "a grid of 20 x 1 has no triangles");
    of.veil.rows = 5, of.veil.cols = 4;
    REFUSED(of.corners[0] = 0, "of different parts");
    of.corners[0] = VEIL;
    free_outfit(&of);
}
END_TEST

/* ---- scenes ------------------------------------------------------------------------
 */

#define FLAG                                                                           \
    "  grid: {rows: 13, cols: 17, spacing: [0.03, 0.04], origin: [0, 0.6, 0]}\n"       \
    "  density: 0.2\n  velocity: [0.1, 0, 0]\n"                                        \
    "  springs: {stretch: {stiffness: 100, damping: 0.1}, shear: {stiffness: 50},\n"   \
    "    bend: {rigidity: 1.0e-5, damping: 1.0e-3}}\n"                                 \
    "  loads: [{at: [8, 8], mass: 0.005}]\n"                                           \
    "  pins: [top-left, {at: top-right, velocity: [-0.1, 0, 0]}]\n"
#define REST                                                                           \
    "forces: {wind: {velocity: [0, 0, 3], drag: 0.5}, damping: 1.0e-4}\n"              \
    "stepper: {plugin: gsl, method: rkf45, rtol: 1.0e-6, atol: 1.0e-6}\n"              \
    "run: {duration: 0.1, fps: 30}\n"
#define DISC                                                                           \
    "- name: disc\n  cut: {outline: {disc: 0.08}, spacing: 0.03, origin: [0.2, 0.3, "  \
    "-0.1]}\n  fabric: {density: 0.2, stretch: 100, shear: 20}\n"
#define MIXED "weft: 1\ncloths:\n- name: flag\n" FLAG DISC REST

static void write_scenes(void)
{
    ck_assert_int_eq(shell("rm -rf %s && mkdir -p %s", OUT, OUT), 0);
    write_file(OUT "/alone.yaml", "weft: 1\ncloth:\n" FLAG REST);
    write_file(OUT "/one.yaml", "weft: 1\ncloths:\n- name: flag\n" FLAG REST);
    write_file(OUT "/mixed.yaml", MIXED);
}

START_TEST(one_grid_among_cloths_ends_with_the_bits_of_one_alone)
{
    write_scenes();
    expect(shell(IN "for i in alone one; do " PROGRAM
                    " run $i.yaml --out $i 2>&1 || exit; done && cut -d, -f3- "
                    "alone/final.csv >a && cut -d, -f3- one/final.csv >b && cmp a b"),
           0);
    says("221 vertices, 384 triangles in 1 cloth");
    says("of flag; ");
}
END_TEST

START_TEST(a_run_with_a_grid_and_a_mesh_resumes_exports_and_runs_again)
{
    write_scenes();
    expect(shell(IN
                 "k='--set run.checkpoint=1 --set run.keep_checkpoint=true' && " PROGRAM
                 " run mixed.yaml --out whole $k --set run.threads=2 2>&1 && " PROGRAM
                 " run mixed.yaml --out cut $k --set run.duration=0.05 2>&1 && " PROGRAM
                 " resume cut --until 0.1 2>&1 && cmp whole/final.csv "
                 "cut/final.csv && " PROGRAM " run whole/scene.yaml --out again 2>&1 "
                 "&& " PROGRAM " diff whole again && " PROGRAM
                 " export whole --format obj && " PROGRAM
                 " export whole --garment g.obj && ls whole g-*"),
           0);
    says("equal at 4 times that both have");
    says("scene-1.obj");
    ck_assert(!exists(OUT "/whole/scene-0.obj") && exists(OUT "/g-disc.obj")
              && !exists(OUT "/g-flag.obj"));
    expect(shell("grep -c '^f' " OUT "/whole/final.obj; grep '^g' " OUT
                 "/whole/final.obj"),
           0);
    says("g disc\ng flag\n");
    expect(shell(IN PROGRAM " check mixed.yaml"), 0);
    says("flag: grid of 13 x 17 particles, 0.05108 kg, 2 held");
}
END_TEST

/* Its springs are bonds and its bending ties beside the links of the mesh. */
START_TEST(an_implicit_method_reaches_the_state_of_an_explicit_one)
{
    write_scenes();
    expect(shell(IN PROGRAM " run mixed.yaml --out e --set run.duration=0.03 --set "
                            "stepper.rtol=1e-8 --set "
                            "stepper.atol=1e-8 2>&1 && " PROGRAM
                            " run mixed.yaml --out i --set run.duration=0.03 --set "
                            "stepper.method=stiff/ros2 --set "
                            "stepper.rtol=1e-7 --set stepper.atol=1e-7 2>&1 && " PROGRAM
                            " diff e i --tol 2e-6 2>&1"),
           0);
}
END_TEST

static const struct {
    const char *set, *wanted;
} overrides[] = {
    { "cloths[0].grid.rows=1",
      "rows:21: error: a grid of 1 x 17 has no triangles, by" },
    { "cloths[0].pins=[[13, 0]]", "row 13 is outside the grid: it has rows 0 to 12" },
    { "cloths[0].pins=[{vertices: [0]}]", "vertices" },
    { "cloths[0].seams=hinge", "'seams' needs a mesh of triangles" },
    { "cloths[0].mass=0.1", "excludes" },
    { "cloths[0].density=null", "lacks 'mass' [kg] or 'density'" },
    { "cloths[1].springs.stretch.stiffness=1", "'springs' needs a grid" },
    { "limit={method: provot, strain: 0.1}", "a strain limit needs a grid" },
};

START_TEST(a_mistake_of_a_grid_among_cloths_is_reported_at_its_key)
{
    weft_scene_def def = scene_of_text(MIXED);
    def.sets = &overrides[_i].set;
    def.set_count = 1;
    const char *text = bad_scene(&def);
    ck_assert_msg(strstr(text, overrides[_i].wanted) != NULL, "no '%s' in\n%s",
                  overrides[_i].wanted, text);
}
END_TEST

START_TEST(converge_and_sensitivities_refuse_a_grid_among_cloths)
{
    write_scenes();
    expect(shell(IN PROGRAM " converge mixed.yaml --sizes 1,2 2>&1"), 3);
    says("a grid among several cloths is not refined");
    expect(shell(IN PROGRAM " check mixed.yaml --set "
                            "'sensitivity={of: [forces.gravity.1]}' 2>&1"),
           3);
    says("sensitivity excludes a grid among several cloths");
}
END_TEST

/* ---- they touch --------------------------------------------------------------------
 */

#define SPRINGS                                                                        \
    "springs: {stretch: {stiffness: 100}, shear: {stiffness: 50}, bend: {stiffness: "  \
    "1}}"
#define PILE                                                                           \
    "weft: 1\ncloths:\n"                                                               \
    "- {name: low, grid: {rows: 8, cols: 9, spacing: 0.02, down: [0, 0, 1]}, "         \
    "density: 0.2, velocity: [0, 1.5, 0], " SPRINGS "}\n"                              \
    "- {name: sheet, mesh: {file: sheet.obj, at: [0.007, 0.02, 0.004]}, fabric: "      \
    "{density: 0.3, stretch: 100, shear: 30}}\n"                                       \
    "- {name: top, grid: {rows: 7, cols: 8, spacing: [0.025, 0.021], origin: [0.01, "  \
    "0.04, 0.01], down: [0, 0, 1]}, mass: 1.0e-4, velocity: [0, -1, 0.1], " SPRINGS    \
    "}\nforces: {gravity: [0, 0, 0]}\n"                                                \
    "contact: {self: true, thickness: 5.0e-3, damping: 0, friction: 0}\n"              \
    "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-4}\n"         \
    "run: {duration: 0.03}\n"

/* 6 x 6 vertices in the plane y = 0, with a wave. */
static void write_sheet(void)
{
    FILE *to = fopen(OUT "/sheet.obj", "w");
    ck_assert_ptr_nonnull(to);
    for (size_t i = 0; i < 36; ++i) {
        const double u = 0.022 * (double)(i % 6), v = 0.022 * (double)(i / 6);
        (void)fprintf(to, "v %.17g %.17g %.17g\nvt %.17g %.17g\n", u,
                      0.003 * sin(50.0 * u + 30.0 * v), v, u, -v);
    }
    for (size_t i = 1; i + 6 <= 36; ++i) {
        if (i % 6 != 0) {
            (void)fprintf(to, "f %zu/%zu %zu/%zu %zu/%zu\nf %zu/%zu %zu/%zu %zu/%zu\n",
                          i, i, i + 6, i + 6, i + 1, i + 1, i + 1, i + 1, i + 6, i + 6,
                          i + 7, i + 7);
        }
    }
    ck_assert_int_eq(fclose(to), 0);
}

START_TEST(grids_and_a_mesh_push_each_other_apart_and_keep_momentum_and_energy)
{
    write_scenes();
    write_sheet();
    weft_scene_def scene_def = scene_of_text(PILE);
    scene_def.file = OUT "/pile.yaml";
    weft_scene *scene = good_scene(&scene_def);
    weft_error err = { 0 };
    weft_cloth *cloth;
    ck_assert_msg(weft_cloth_create(weft_scene_cloth(scene), &cloth, &err) == WEFT_OK,
                  "%s", err.message);
    ck_assert_uint_gt(touching_with_momentum_and_energy_kept(cloth), 200);
    const weft_parameter number = { "number", cloth, cloth, 1.0 };
    const weft_sensitivity_def by = { 1, &number, true };
    weft_sim_def run = weft_sim_def_default();
    weft_sim *sim;
    run.cloth = cloth;
    run.method = test_method_named("arkode/dormand_prince");
    run.sensitivity = &by;
    ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(err.message, "grids among several cloths"));
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
}
END_TEST

static weft_sim *blown(const weft_cloth *cloth)
{
    static const double gust[3] = { -2.0, 1.0, 7.0 };
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    weft_sim *sim;
    def.cloth = cloth;
    def.method = test_method_named("verlet/velocity_verlet");
    def.config.fixed_step = 1e-4;
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
    ck_assert_int_eq(weft_sim_set_wind(sim, gust, 0.8, &err), WEFT_OK);
    return sim;
}

/* As one alone; and back to the definition's. */
START_TEST(a_wind_that_is_changed_or_restored_reaches_every_grid)
{
    static outfit of;
    static unsigned char saved[1 << 16];
    weft_error err = { 0 };
    make_outfit(&of, false);
    weft_sim *alone = blown(of.alone), *all = blown(of.all);
    ck_assert_uint_le(weft_sim_save_size(all), sizeof saved);
    ck_assert_int_eq(weft_sim_save(all, saved, sizeof saved, &err), WEFT_OK);
    for (size_t turn = 0; turn < 3; ++turn) {
        ck_assert_int_eq(weft_sim_advance(alone, 0.01 * (double)(turn + 1), &err),
                         WEFT_OK);
        ck_assert_int_eq(weft_sim_advance(all, 0.01 * (double)(turn + 1), &err),
                         WEFT_OK);
        ck_assert(same(weft_sim_state(alone), weft_sim_state(all), 6, 0.0));
        ck_assert_int_eq(weft_sim_set_wind(alone, NULL, 0.0, &err), WEFT_OK);
        ck_assert_int_eq(weft_sim_set_wind(all, NULL, 0.0, &err), WEFT_OK);
    }
    weft_sim *other = blown(of.alone);
    ck_assert_int_eq(weft_sim_restore(all, saved, weft_sim_save_size(all), &err),
                     WEFT_OK);
    ck_assert_int_eq(weft_sim_advance(other, 0.02, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_advance(all, 0.02, &err), WEFT_OK);
    ck_assert(same(weft_sim_state(other), weft_sim_state(all), 6, 0.0));
    weft_sim_destroy(other);
    weft_sim_destroy(alone);
    weft_sim_destroy(all);
    free_outfit(&of);
}
END_TEST

TEST_SUITE(cloth_grids)
{
    Suite *suite = suite_create("cloth_grids");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 120.0);
    tcase_add_test(all, a_grid_has_the_forces_that_it_has_alone_bit_for_bit);
    tcase_add_test(all, grids_alone_need_no_array_of_triangles);
    tcase_add_test(
        all, a_grid_has_the_energy_the_powers_and_the_stiffness_that_it_has_alone);
    tcase_add_test(all, a_grid_touches_itself_as_it_does_alone);
    tcase_add_test(all, a_grid_of_several_cloths_is_checked_as_one_alone);
    tcase_add_test(all, one_grid_among_cloths_ends_with_the_bits_of_one_alone);
    tcase_add_test(all, a_run_with_a_grid_and_a_mesh_resumes_exports_and_runs_again);
    tcase_add_test(test_long(suite, 120.0),
                   an_implicit_method_reaches_the_state_of_an_explicit_one);
    tcase_add_loop_test(all, a_mistake_of_a_grid_among_cloths_is_reported_at_its_key, 0,
                        sizeof overrides / sizeof overrides[0]);
    tcase_add_test(all, converge_and_sensitivities_refuse_a_grid_among_cloths);
    tcase_add_test(all,
                   grids_and_a_mesh_push_each_other_apart_and_keep_momentum_and_energy);
    tcase_add_test(all, a_wind_that_is_changed_or_restored_reaches_every_grid);
    suite_add_tcase(suite, all);
    return suite;
}
