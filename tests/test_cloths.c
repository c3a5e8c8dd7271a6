/* SPDX-License-Identifier: BSD-3-Clause */
/* test_cloths.c -- several cloths: one mesh of named parts, in C, in scenes and in what
 * the program writes. */
#include <math.h>

#include "meshes.h"
#include "scene_load.h"
#include "shell.h"

#define OUT     BUILD_DIR "/cloths"
#define PROGRAM "\"$weft\"" /* of a shell that has entered a directory */
#define IN(at)  "weft=$PWD/" WEFT " && cd " at " && "

/* ---- in C --------------------------------------------------------------------------
 */

enum { MOST_VERTICES = 700, MOST_TRIANGLES = 1400 };

/* Two sheets as one mesh. */
typedef struct pair {
    test_mesh sheet[2];
    weft_cloth_part parts[2];
    weft_fabric fabrics[2];
    double start[3 * MOST_VERTICES], rest[2 * MOST_VERTICES];
    uint32_t corners[3 * MOST_TRIANGLES], fabric_of[MOST_TRIANGLES];
    weft_mesh_def mesh;
    weft_cloth_def def;
} pair;

/* Of rows x (rows + 1) vertices, at a distance [m]. */
static void make_pair(pair *at, size_t rows, double spacing, double jitter)
{
    *at = (pair){ .mesh = weft_mesh_def_default(), .def = weft_cloth_def_default() };
    mesh_sheet(&at->sheet[0], rows, rows + 1, spacing, MESH_RIGHT, jitter, 1);
    mesh_sheet(&at->sheet[1], rows + 1, rows + 2, 0.8 * spacing, MESH_RANDOM, jitter,
               2);
    for (size_t k = 0; k < 2; ++k) {
        const weft_mesh_def *from = &at->sheet[k].def;
        const size_t v = at->mesh.vertices, t = at->mesh.triangles;
        at->parts[k] = (weft_cloth_part){
            k == 0 ? "shirt" : "skirt", v, from->vertices, { 0.0, 1.0 + (double)k, 0.0 }
        };
        memcpy(at->start + 3 * v, from->start, 3 * from->vertices * sizeof(double));
        memcpy(at->rest + 2 * v, from->rest, 2 * from->vertices * sizeof(double));
        for (size_t j = 0; j < 3 * from->triangles; ++j) {
            at->corners[3 * t + j] = from->corners[j] + (uint32_t)v;
            at->fabric_of[t + j / 3] = (uint32_t)k;
        }
        at->fabrics[k] = mesh_fabric;
        at->fabrics[k].density = k == 0 ? 0.2 : 0.6;
        at->mesh.vertices += from->vertices;
        at->mesh.triangles += from->triangles;
    }
    at->mesh.uv_count = at->mesh.vertices;
    at->mesh.start = at->start;
    at->mesh.rest = at->rest;
    at->mesh.corners = at->corners;
    at->mesh.fabrics = at->fabrics;
    at->mesh.fabric_count = 2;
    at->mesh.fabric_of = at->fabric_of;
    at->mesh.parts = at->parts;
    at->mesh.part_count = 2;
    at->def.mesh = &at->mesh;
}

static void free_pair(pair *at)
{
    mesh_free(&at->sheet[0]);
    mesh_free(&at->sheet[1]);
}

START_TEST(a_cloth_knows_its_parts_by_number_name_and_vertex)
{
    pair two;
    weft_cloth *cloth;
    char text[96];
    make_pair(&two, 3, 0.1, 0.0);
    ck_assert_int_eq(weft_cloth_create(&two.def, &cloth, NULL), WEFT_OK);
    ck_assert_uint_eq(weft_cloth_parts(cloth), 2);
    const weft_cloth_part skirt = weft_cloth_part_at(cloth, 1);
    ck_assert_str_eq(skirt.name, "skirt");
    ck_assert_uint_eq(skirt.first, 12);
    ck_assert_uint_eq(skirt.count, 20);
    ck_assert_double_eq(skirt.velocity[1], 2.0);
    ck_assert_uint_eq(weft_cloth_part_find(cloth, "skirt"), 1);
    ck_assert_uint_eq(weft_cloth_part_find(cloth, "hat"), SIZE_MAX);
    ck_assert_uint_eq(weft_cloth_part_of(cloth, 11), 0);
    ck_assert_uint_eq(weft_cloth_part_of(cloth, 12), 1);
    ck_assert_str_eq(weft_cloth_text(cloth, text, sizeof text),
                     "32 vertices, 36 triangles in 2 cloths");
    ck_assert_str_eq(weft_particle_text(cloth, 12, text, sizeof text),
                     "vertex 12 of skirt");
    const weft_primitive edge = { 2, { 0, 1 } };
    ck_assert_str_eq(weft_primitive_text(cloth, &edge, text, sizeof text),
                     "edge 0-1 of shirt");
    weft_cloth_destroy(cloth);
    free_pair(&two);
}
END_TEST

START_TEST(a_cloth_without_parts_has_none)
{
    test_mesh sheet;
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth;
    mesh_sheet(&sheet, 3, 3, 0.1, MESH_RIGHT, 0.0, 1);
    for (size_t k = 0; k < 2; ++k) {
        def.mesh = k == 0 ? NULL : &sheet.def;
        ck_assert_int_eq(weft_cloth_create(&def, &cloth, NULL), WEFT_OK);
        ck_assert_uint_eq(weft_cloth_parts(cloth), 0);
        ck_assert_uint_eq(weft_cloth_part_of(cloth, 3), 0);
        ck_assert_uint_eq(weft_cloth_part_find(cloth, ""), SIZE_MAX);
        weft_cloth_destroy(cloth);
    }
    mesh_free(&sheet);
}
END_TEST

/* What keeps a part together in a state, and its own velocity at the start. */
START_TEST(a_part_has_the_same_places_in_a_state_and_its_own_velocity_and_fabric)
{
    pair two;
    weft_cloth *cloth;
    double y[6 * 32], mass[2] = { 0.0, 0.0 };
    make_pair(&two, 3, 0.1, 0.0);
    const size_t held = 12;
    const weft_pin pin = { .vertices = &held, .vertex_count = 1 };
    two.def.pins = &pin;
    two.def.pin_count = 1;
    ck_assert_int_eq(weft_cloth_create(&two.def, &cloth, NULL), WEFT_OK);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < 32; ++i) {
        const size_t at = weft_cloth_index(cloth, i), part = i < 12 ? 0 : 1;
        ck_assert_uint_eq(at < 12 ? 0 : 1, part);
        ck_assert_double_eq(y[4 * 32 + at], i == held ? 0.0 : 1.0 + (double)part);
        mass[part] += weft_cloth_particle_mass(cloth, i);
    }
    ck_assert_double_eq_tol(mass[0], 0.2 * 0.06, 1e-15);
    ck_assert_double_eq_tol(mass[1], 0.6 * 0.0768, 1e-15);
    weft_cloth_destroy(cloth);
    free_pair(&two);
}
END_TEST

static void refused(const pair *at, const char *wanted)
{
    weft_cloth *cloth;
    weft_error err = { 0 };
    ck_assert_int_eq(weft_cloth_create(&at->def, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, wanted) != NULL, "no '%s' in %s", wanted,
                  err.message);
}

START_TEST(parts_have_all_vertices_once_names_and_triangles_of_their_own)
{
    pair two;
    make_pair(&two, 3, 0.1, 0.0);
    const pair good = two;
#define REFUSED(change, wanted)                                                        \
    change;                                                                            \
    refused(&two, wanted);                                                             \
    memcpy(two.parts, good.parts, sizeof two.parts)
    REFUSED(two.parts[1].name = "shirt", "part 1: name 'shirt' is not one of its own");
    REFUSED(two.parts[1].name = "a b", "part 1: name 'a b' is not one of its own");
    REFUSED(two.parts[1].name = NULL, "part 1: name '' is not one of its own");
    REFUSED(two.parts[1].first = 11, "part 1, skirt, has vertices 11 and 20 more");
    REFUSED(two.parts[0].count = SIZE_MAX, "part 0, shirt, has vertices 0 and");
    REFUSED(two.parts[1].count = 19, "its parts have 31 vertices, not all 32");
    REFUSED(two.parts[1].velocity[2] = NAN, "part 1, skirt: its velocity is not");
    REFUSED((two.parts[0].count = 11, two.parts[1].first = 11, two.parts[1].count = 21),
            "has corners 6, 7, 11 of different parts");
    two.mesh.part_count = 65;
    refused(&two, "65 parts, of at most 64");
    two.mesh.part_count = 1;
    two.mesh.parts = NULL;
    refused(&two, "parts is NULL");
    free_pair(&two);
}
END_TEST

/* ---- they touch --------------------------------------------------------------------
 */

/* One above the other, both wavy, which meet at 2 m/s without gravity. */
static void meet(pair *two)
{
    for (size_t i = 0; i < two->mesh.vertices; ++i) {
        double *x = &two->start[3 * i];
        const bool upper = i >= two->parts[1].first;
        x[2] = 0.004 * sin(40.0 * x[0] + 25.0 * x[1]) + (upper ? 0.02 : 0.0);
        x[0] += upper ? 0.013 : 0.0;
    }
    for (size_t k = 0; k < 2; ++k) {
        memcpy(two->parts[k].velocity, (double[]){ 0.1, 0.0, k == 0 ? 1.5 : -0.5 },
               sizeof two->parts[k].velocity);
    }
    memset(two->def.gravity, 0, sizeof two->def.gravity);
    two->def.contact.self = true;
    two->def.contact.thickness = 0.0025;
    two->def.contact.damping = two->def.contact.friction = 0.0;
}

/* Without contact they are through each other after 0.01 s. */
START_TEST(two_cloths_push_each_other_apart_and_keep_momentum_and_energy)
{
    static pair two;
    weft_error err = { 0 };
    weft_cloth *cloth;
    make_pair(&two, 15, 0.02, 0.2);
    meet(&two);
    ck_assert_msg(weft_cloth_create(&two.def, &cloth, &err) == WEFT_OK, "%s",
                  err.message);
    ck_assert_uint_gt(touching_with_momentum_and_energy_kept(cloth), 1000);
    weft_cloth_destroy(cloth);
    free_pair(&two);
}
END_TEST

/* ---- scenes ------------------------------------------------------------------------
 */

/* rows x cols vertices, level at height y, behind one that no face has; group top is
 * the first row. */
static void write_sheet(const char *name, size_t rows, size_t cols, double spacing,
                        double y)
{
    FILE *to = fopen(name, "w");
    ck_assert_ptr_nonnull(to);
    fputs("v 9 9 9\n", to);
    for (size_t i = 0; i < rows * cols; ++i) {
        const double u = spacing * (double)(i % cols), v = spacing * (double)(i / cols);
        (void)fprintf(to, "v %.17g %.17g %.17g\nvt %.17g %.17g\n", u, y, v, u, -v);
    }
    for (size_t i = 0; i + cols < rows * cols; ++i) {
        const size_t a = i + 1, b = a + cols;
        if (a % cols != 0) {
            (void)fprintf(to, "f %zu/%zu %zu/%zu %zu/%zu\nf %zu/%zu %zu/%zu %zu/%zu\n",
                          a + 1, a, b + 1, b, a + 2, a + 1, a + 2, a + 1, b + 1, b,
                          b + 2, b + 1);
        }
    }
    fputs("g top\np", to);
    for (size_t i = 0; i < cols; ++i) {
        (void)fprintf(to, " %zu", i + 2);
    }
    fputs("\n", to);
    ck_assert_int_eq(fclose(to), 0);
}

#define SHIRT                                                                          \
    "mesh: {file: a.obj}, fabric: {density: 0.2, stretch: 400, shear: 90, bend: "      \
    "1.0e-5}, pins: [{group: top, velocity: [0, 0, 0.1]}, {vertices: [9]}]"
#define SKIRT                                                                          \
    "mesh: {file: b.obj}, fabric: {preset: 11oz-black-denim}, velocity: [0, 0.5, 0], " \
    "loads: [{near: [0, 2, 0], mass: 0.01}], pins: [{near: [0.2, 2, 0]}]"
#define REST                                                                           \
    "forces: {wind: {velocity: [0, 1, 0], drag: 0.1}}\n"                               \
    "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-4}\n"         \
    "run: {duration: 0.2, fps: 20}\n"
#define BOTH                                                                           \
    "weft: 1\ncloths:\n- {name: shirt, " SHIRT "}\n- {name: skirt, " SKIRT "}\n"

static void write_scenes(void)
{
    ck_assert_int_eq(shell("rm -rf %s && mkdir -p %s", OUT, OUT), 0);
    write_sheet(OUT "/a.obj", 5, 6, 0.05, 0.5);
    write_sheet(OUT "/b.obj", 7, 5, 0.05, 2.0);
    write_file(OUT "/both.yaml", BOTH REST);
    write_file(OUT "/shirt.yaml", "weft: 1\ncloth: {" SHIRT "}\n" REST);
    write_file(OUT "/skirt.yaml", "weft: 1\ncloth: {" SKIRT "}\n" REST);
}

/* Triangles are summed in another order, so to rounding. */
START_TEST(each_of_two_cloths_moves_as_it_does_alone)
{
    write_scenes();
    expect(shell(IN(OUT) "for i in both shirt skirt; do " PROGRAM
                         " run $i.yaml --out $i --set run.duration=0.05 2>$i.log || "
                         "exit; done"),
           0);
    says("65 vertices, 88 triangles in 2 cloths");
    expect(shell(IN(
               OUT) "for i in shirt skirt; do sed -n \"s/^$i,//p\" "
                    "both/final.csv >$i.csv; sed 1d $i/final.csv | paste -d, $i.csv - "
                    "| awk -F, '{ for (k = 1; k <= 7; ++k) if (($k - $(k + 7))^2 > "
                    "1e-22) exit 1; ++n } END { print n }' || exit; done"),
           0);
    ck_assert_str_eq(output, "30\n35\n");
    expect(shell("head -1 " OUT "/both/final.csv " OUT "/shirt/final.csv"), 0);
    says("cloth,vertex,x,y,z,vx,vy,vz\n");
    says("==\nvertex,x,y,z,vx,vy,vz\n");
}
END_TEST

START_TEST(a_part_keeps_its_numbers_its_pins_and_its_fabric)
{
    write_scenes();
    weft_scene_def def = scene_of_text(BOTH REST);
    def.file = OUT "/both.yaml";
    weft_scene *scene = good_scene(&def);
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    const weft_mesh_def *mesh = cloth->mesh;
    ck_assert_uint_eq(mesh->part_count, 2);
    ck_assert_str_eq(mesh->parts[1].name, "skirt");
    ck_assert_uint_eq(mesh->parts[1].first, 30);
    ck_assert_double_eq(mesh->parts[1].velocity[1], 0.5);
    ck_assert_uint_eq(mesh->file_index[0], 1);
    ck_assert_uint_eq(mesh->file_index[30], 1);
    ck_assert_uint_eq(cloth->pin_count, 3);
    ck_assert_uint_eq(cloth->pins[1].vertices[0], 8); /* v 9, from 0 */
    ck_assert_uint_eq(cloth->pins[2].vertices[0], 34);
    ck_assert_uint_eq(cloth->loads[0].vertices[0], 30);
    ck_assert_double_eq(mesh->fabrics[mesh->fabric_of[0]].density, 0.2);
    ck_assert_str_eq(mesh->fabrics[mesh->fabric_of[40]].name, "11oz-black-denim");
    ck_assert_ptr_nonnull(strstr(weft_scene_part_file(scene, 0), "a.obj"));
    ck_assert_ptr_nonnull(strstr(weft_scene_part_file(scene, 1), "b.obj"));
    weft_scene_destroy(scene);
}
END_TEST

static const struct {
    const char *set, *wanted;
} overrides[] = {
    { "cloths.1.name=shirt", "override cloths.1.name:15: error: cloths[0] is called" },
    { "cloths[1].name=a b", "'a b' is no name of a cloth: 1 to 40 letters" },
    { "cloths[1].fabric.density=-1",
      "override cloths[1].fabric.density:26: error: density must be a number > 0" },
    { "cloths[1].seams=hinge", "seams of cloths[1] differs from that of cloths[0]" },
    { "cloths[0].membrane=arc",
      "both.yaml:4:3: error: membrane of cloths[1] differs from that of cloths[0]" },
    { "cloths[0].grid={rows: 3, cols: 5, spacing: 0.1}", "grid excludes mesh" },
    { "cloths[0].springs.stretch.stiffness=3", "'springs' needs a grid" },
    { "cloths[1].fabric=null",
      "cloths[1] lacks 'fabric', which a mesh of triangles is made of" },
    { "cloths[1].mesh=null", "cloths[1] lacks 'grid', 'mesh' or 'cut'" },
    { "cloths[1].mesh.file=c.obj", "c.obj: No such file" },
    { "cloths[2]={mesh: {file: a.obj}}", "cloths[2] lacks the required key 'name'" },
    { "cloths[0].pins[0].group=waist", "the mesh has no group 'waist'" },
    { "cloths[0].pins=[top]", "a pin of a mesh must be {vertices: ...}" },
    { "cloths=[]", "cloths must be a list of 1 to 64 mappings {name, keys as cloth}" },
    { "cloth={}", "excludes cloths" },
    { "cloth={mesh: {file: a.obj}, fabric: {density: 0.2, stretch: 50}}",
      "excludes cloths" },
    { "cloths=null", "the scene lacks 'cloth' or 'cloths': exactly one is required" },
    { "limit={method: provot, strain: 0.1}", "a strain limit needs a grid" },
};

START_TEST(a_mistake_of_a_cloth_is_reported_at_its_key)
{
    write_scenes();
    weft_scene_def def = scene_of_text(BOTH REST);
    def.file = OUT "/both.yaml";
    def.sets = &overrides[_i].set;
    def.set_count = 1;
    const char *text = bad_scene(&def);
    ck_assert_msg(strstr(text, overrides[_i].wanted) != NULL, "no '%s' in\n%s",
                  overrides[_i].wanted, text);
}
END_TEST

START_TEST(mistakes_of_two_files_are_each_at_their_line)
{
    write_scenes();
    ck_assert_int_eq(
        shell("cd %s && sed -i 's/^v 0.25 0.5 0.1$/v 0.25 0.5 x/' a.obj && "
              "sed -i '/^g top/d; $a f 2/1 3/2 7/6' b.obj",
              OUT),
        0);
    weft_scene_def def = scene_of_text(BOTH REST);
    def.file = OUT "/both.yaml";
    const char *text = bad_scene(&def);
    ck_assert_ptr_nonnull(strstr(text, OUT "/b.obj:"));
    ck_assert_ptr_nonnull(strstr(text, "edge 2-6 has 3 triangles"));
}
END_TEST

/* ---- results -----------------------------------------------------------------------
 */

START_TEST(results_have_the_names_and_meshes_of_the_cloths_and_run_again)
{
    write_scenes();
    expect(shell(IN(OUT) "" PROGRAM
                         " run both.yaml --out one 2>&1 && rm a.obj b.obj && " PROGRAM
                         " run one/scene.yaml --out two 2>&1 && " PROGRAM
                         " diff one two"),
           0);
    says("equal at 5 times that both have");
    ck_assert(exists(OUT "/two/scene-0.obj") && exists(OUT "/two/scene-1.obj")
              && !exists(OUT "/two/scene.obj"));
    ck_assert_ptr_nonnull(strstr(read_file(OUT "/one/manifest.yaml"),
                                 "cloths:\n- name: \"shirt\"\n  vertices: 30\n  "
                                 "pinned: 7\n"));
    ck_assert_ptr_nonnull(strstr(read_file(OUT "/one/result.yaml"), "  cloth: \"s"));
    expect(shell(IN(OUT) "" PROGRAM " run both.yaml --out one --force 2>&1"), 3);
    ck_assert(
        exists(OUT "/one/scene-0.obj")); /* a scene that is wrong changes nothing */
}
END_TEST

START_TEST(exports_tell_the_cloths_apart)
{
    write_scenes();
    expect(shell(IN(OUT) "" PROGRAM " run both.yaml --out one 2>&1 && for f in obj ply "
                         "pvd; do " PROGRAM
                         " export one --format $f; done && grep -c '^[gf]' "
                         "one/final.obj && grep '^g' one/final.obj"),
           0);
    says("90\ng shirt\ng skirt\n");
    expect(shell(IN(
               OUT "/one") "grep -a -c '^property int cloth\\|^comment cloth 1 "
                           "is skirt' final.ply && grep -a -c 'Int64\" Name=\"cloth\"' "
                           "frames/frame-000003.vtp && rm run.vtkhdf && " PROGRAM
                           " export . --format csv --frame 0 2>&1 && head -2 "
                           "frames/frame-000000.csv"),
           0);
    says("2\n1\n");
    says("cloth,vertex,x,y,z,vx,vy,vz\nshirt,1,0,0.5,0,");
    expect(shell(IN(OUT) "" PROGRAM
                         " export one --garment g.obj 2>/dev/null && cmp g-shirt.obj "
                         "a.obj && cmp g-skirt.obj b.obj"),
           0);
    ck_assert_str_eq(output, "g-shirt.obj\ng-skirt.obj\n");
    expect(shell(IN(OUT) "" PROGRAM " export one --garment g.obj 2>&1"), 4);
    says("g-shirt.obj: the file exists");
}
END_TEST

START_TEST(check_and_converge_name_the_cloths)
{
    write_scenes();
    expect(shell(IN(OUT) "" PROGRAM " check both.yaml"), 0);
    says("shirt: 30 vertices, 40 triangles, 0.01 kg, 7 held");
    says("skirt: 35 vertices, 48 triangles,");
    says("pin 2: vertex 5 of skirt at (0.2, 2, 0) m, 1 matched");
    says("fabric     skirt: 11oz-black-denim: C");
    expect(
        shell(IN(
            OUT) "" PROGRAM " converge both.yaml --sizes 1,2 --at skirt:35.y "
                 "--set run.duration=0.01 --set stepper.fixed_step=2.0e-5 --csv 2>&1"),
        0);
    says("skirt:35.y");
    expect(shell(IN(OUT) "" PROGRAM " converge both.yaml --sizes 1,2 --at 3.y 2>&1"),
           2);
    says("no vertex, CLOTH:NUMBER, of 65");
}
END_TEST

START_TEST(a_sweep_varies_a_cloth_and_a_resumed_run_ends_the_same)
{
    write_scenes();
    write_file(OUT "/sweep.yaml",
               BOTH REST "sweep: {'cloths[0].fabric.density': [0.1, 0.4]}\n");
    expect(shell(IN(OUT) "" PROGRAM " batch sweep.yaml --out all 2>&1 && grep -h "
                         "-A3 shirt all/*/manifest.yaml | grep mass"),
           0);
    says("mass: 0.00500000000000000");
    says("mass: 0.0200000000000000");
    expect(
        shell(IN(
            OUT) "k='--set run.checkpoint=2 --set run.keep_checkpoint=true' && " PROGRAM
                 " run both.yaml --out whole $k 2>&1 && " PROGRAM
                 " run both.yaml --out cut $k --set run.duration=0.1 2>&1 && " PROGRAM
                 " resume cut --until 0.2 2>&1 && cmp whole/final.csv "
                 "cut/final.csv && " PROGRAM " run both.yaml --out other $k 2>&1 && "
                 "sed -i 's/^v 0 2 0$/v 0 2 1/' other/scene-1.obj && ! " PROGRAM
                 " resume other --until 0.3 2>&1"),
        0);
    says("other/scene.yaml with its meshes is not the scene that");
}
END_TEST

TEST_SUITE(cloths)
{
    Suite *suite = suite_create("cloths");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 120.0);
    tcase_add_test(all, a_cloth_knows_its_parts_by_number_name_and_vertex);
    tcase_add_test(all, a_cloth_without_parts_has_none);
    tcase_add_test(
        all, a_part_has_the_same_places_in_a_state_and_its_own_velocity_and_fabric);
    tcase_add_test(all, parts_have_all_vertices_once_names_and_triangles_of_their_own);
    tcase_add_test(test_long(suite, 120.0),
                   two_cloths_push_each_other_apart_and_keep_momentum_and_energy);
    tcase_add_test(all, each_of_two_cloths_moves_as_it_does_alone);
    tcase_add_test(all, a_part_keeps_its_numbers_its_pins_and_its_fabric);
    tcase_add_loop_test(all, a_mistake_of_a_cloth_is_reported_at_its_key, 0,
                        sizeof overrides / sizeof overrides[0]);
    tcase_add_test(all, mistakes_of_two_files_are_each_at_their_line);
    tcase_add_test(all, results_have_the_names_and_meshes_of_the_cloths_and_run_again);
    tcase_add_test(all, exports_tell_the_cloths_apart);
    tcase_add_test(all, check_and_converge_name_the_cloths);
    tcase_add_test(all, a_sweep_varies_a_cloth_and_a_resumed_run_ends_the_same);
    suite_add_tcase(suite, all);
    return suite;
}
