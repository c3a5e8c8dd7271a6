/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* Every shipped scene runs to its end within bounds on strain and energy. */
#include "program/cut/cut.h"
#include "support.h"

#include <dirent.h>
#include <math.h>
#include <string.h>

/* What a scene must keep to. `passive`: nothing feeds energy in (no wind, no moved
 * pin), so that the total never rises above where it began. */
typedef struct bounds {
    const char *file;
    double least_strain, most_strain; /* of the largest strain in the whole run */
    double most_kinetic;              /* [J] at any frame */
    bool passive;
    double until; /* [s] no further than that; 0: to its end */
    bool gsl;     /* needs that plugin */
    bool cut;     /* needs the mesher */
    bool self;    /* contact.self, without which it would pass through itself */
} bounds;

static const bounds scenes[] = {
    { "hung-stretch.yaml", 0.2, 0.6, 1.5, true, .gsl = true },
    { "hung-shear.yaml", 0.1, 0.6, 1.5, true, .gsl = true },
    { "two-corners.yaml", 0.1, 0.6, 1.5, true, .gsl = true },
    { "curtain.yaml", 0.01, 0.5, 0.5, false, .gsl = true },
    { "flag.yaml", 0.01, 0.5, 1.0, false, .gsl = true },
    { "chain.yaml", 0.001, 0.2, 2.0, true, .gsl = true },
    { "trampoline.yaml", 0.3, 0.6, 8.0, true, .gsl = true },
    { "provot.yaml", 1.0, 2.5, 0.1, .passive = true },
    { "provot-paper.yaml", 0.1, 0.6, 0.2, .until = 2.0 }, /* lifts without a force */
    { "provot-limited.yaml", 0.1, 0.4, 0.1, .passive = true },
    { "limited-100.yaml", 0.0, 0.1011, 0.1, .passive = true, .until = 0.05 },
    { "stiffness.yaml", 0.0, 0.0, 1.0, .passive = true },
    { "hammock.yaml", 0.01, 0.5, 10.0, .passive = false },
    { "ball.yaml", 0.02, 0.15, 1.0, true, .gsl = true },
    { "table.yaml", 0.02, 0.15, 1.0, true, .gsl = true },
    { "rail.yaml", 0.01, 0.15, 1.0, false, .gsl = true },
    { "pole.yaml", 0.02, 0.2, 1.0, false, .gsl = true },
    { "whirl.yaml", 0.02, 0.15, 1.0, false, .gsl = true },
    { "tarpaulin.yaml", 0.1, 0.3, 60.0, .passive = true },
    { "cantilever.yaml", 1e-5, 0.01, 1e-3, .passive = true },
    { "denim.yaml", 0.001, 0.15, 0.01, true, .gsl = true },
    { "pennant.yaml", 0.005, 0.1, 0.01, false, .gsl = true },
    { "ribbon.yaml", 0.01, 0.1, 0.01, false, .gsl = true, .self = true },
    { "towel.yaml", 0.01, 0.1, 0.1, false, .gsl = true, .self = true },
    { "twist.yaml", 0.01, 0.15, 0.2, false, .gsl = true, .self = true },
    { "hung-towel.yaml", 0.01, 0.3, 1.0, .passive = true, .until = 0.5, .cut = true },
    { "skirt.yaml", 0.01, 0.1, 1.0, .passive = true, .until = 0.3 },
    { "tshirt.yaml", 0.01, 0.1, 1.0, .passive = true, .until = 0.3 },
    { "dressed.yaml", 0.01, 0.6, 1.0, .passive = true, .until = 0.05, .self = true },
    { "disc.yaml", 0.01, 0.05, 1.0, .passive = true, .until = 0.3, .cut = true },
    { "poncho.yaml", 0.02, 0.2, 1.0, .passive = true, .until = 0.35, .cut = true },
    { "walk.yaml", 0.02, 0.2, 1.0, .until = 0.35, .cut = true, .self = true },
    { "dropped-disc.yaml", 0.01, 0.1, 0.5, .passive = true, .until = 0.3, .cut = true,
      .self = true },
    { "pennant-cut.yaml", 0.01, 0.15, 1.0, .passive = false, .until = 0.3,
      .cut = true },
    { "hat.yaml", 1e-4, 0.05, 0.1, .passive = false, .until = 0.12 },
    { "pillow-case.yaml", 0.001, 0.1, 0.1, .passive = true, .until = 0.2,
      .self = true },
};

#define SCENES (sizeof scenes / sizeof scenes[0])

static const weft_plugin *linked(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin;
    (void)ctx;
    for (size_t i = 0; (plugin = test_plugin(i)) != NULL; ++i) {
        if (strcmp(plugin->id, id) == 0) {
            return plugin;
        }
    }
    weft_error_set(err, WEFT_BAD_PLUGIN, "plugin '%s' is not linked in", id);
    return NULL;
}

/* With one override unless set is NULL. */
static weft_scene *load(const char *file, const char *set)
{
    static weft_diagnostics found;
    char path[256], text[2048];
    (void)snprintf(path, sizeof path, "scenes/%s", file);
    weft_scene_def def = weft_scene_def_default();
    def.file = path;
    def.find_plugin = linked;
#ifdef WEFT_QHULL
    def.mesh_cut = cut_mesh;
#endif
    def.sets = &set, def.set_count = set != NULL ? 1 : 0;
    weft_scene *scene = NULL;
    weft_error err = { 0 };
    if (weft_scene_load(&def, &scene, &found, &err) != WEFT_OK) {
        text[0] = '\0';
        if (found.count > 0) {
            (void)weft_diagnostic_format(&found.items[0], text, sizeof text);
        }
        ck_abort_msg("%s%s", err.message, text);
    }
    ck_assert_msg(found.count == 0, "%s: %s", path, found.items[0].message);
    return scene;
}

static void check_frame(const bounds *bound, const weft_sim *sim, double start,
                        double *most_strain)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const double *y = weft_sim_state(sim);
    const weft_energy energy = weft_cloth_energy(cloth, weft_sim_time(sim), y);
    const double strain = weft_cloth_worst_spring(cloth, y).strain;
    *most_strain = strain > *most_strain ? strain : *most_strain;
    ck_assert_msg(strain <= bound->most_strain + 1e-12, "strain %g at t = %g", strain,
                  weft_sim_time(sim));
    ck_assert(weft_cloth_gap(cloth, weft_sim_time(sim), y, NULL, NULL) > 0.0);
    ck_assert(!bound->self || weft_cloth_crossings(cloth, y, NULL) == 0);
    ck_assert_msg(energy.kinetic <= bound->most_kinetic, "kinetic %g J at t = %g",
                  energy.kinetic, weft_sim_time(sim));
    if (bound->passive) {
        const double now = weft_energy_total(energy);
        ck_assert_msg(now <= start + 1e-3 * (fabs(start) + energy.kinetic),
                      "energy rose from %g to %g J at t = %g", start, now,
                      weft_sim_time(sim));
    }
}

static weft_sim *simulation(const weft_scene *scene, const weft_cloth *cloth)
{
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    weft_sim *sim = NULL;
    def.cloth = cloth;
    def.method = weft_scene_method_type(scene);
    def.config = *weft_scene_config(scene);
    def.limit = *weft_scene_limit(scene);
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
    return sim;
}

/* To half its time, or until it is stretched as it must be; to its end if there is
 * time. */
START_TEST(every_scene_stays_within_its_bounds)
{
    const bounds *bound = &scenes[_i];
#ifndef HAVE_GSL
    if (bound->gsl) {
        return;
    }
#endif
#ifndef WEFT_QHULL
    if (bound->cut) {
        return;
    }
#endif
    weft_scene *scene = load(bound->file, NULL);
    const weft_run_def *run = weft_scene_run(scene);
    weft_cloth *cloth = test_cloth(weft_scene_cloth(scene));
    weft_sim *sim = simulation(scene, cloth);
    const weft_energy energy
        = weft_cloth_energy(cloth, weft_sim_time(sim), weft_sim_state(sim));
    double most_strain = 0.0;
    const double end = bound->until > 0.0 ? bound->until : run->duration;
    const double enough = end * test_rounds(1, 2) / 2.0;
    for (size_t i = 1;
         (double)i / run->fps <= (most_strain >= bound->least_strain ? enough : end);
         ++i) {
        weft_error err = { 0 };
        const weft_status status = weft_sim_advance(sim, (double)i / run->fps, &err);
        ck_assert_msg(status == WEFT_OK, "%s", err.message);
        check_frame(bound, sim, weft_energy_total(energy), &most_strain);
    }
    ck_assert_msg(most_strain >= bound->least_strain, "largest strain only %g",
                  most_strain);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
}
END_TEST

/* The garment takes longer until it does than all others together. */
START_TEST(cloth_passes_through_itself_where_self_contact_is_off)
{
    const bounds *bound = &scenes[_i];
#ifndef HAVE_GSL
    if (bound->gsl) {
        return;
    }
#endif
    if (!bound->self
        || (strcmp(bound->file, "dressed.yaml") == 0 && test_rounds(1, 0))) {
        return;
    }
    weft_scene *scene = load(bound->file, "contact.self=false");
    const weft_run_def *run = weft_scene_run(scene);
    weft_cloth *cloth = test_cloth(weft_scene_cloth(scene));
    weft_sim *sim = simulation(scene, cloth);
    size_t crossing = 0;
    for (size_t i = 1; crossing < 2 && i <= weft_run_last_frame(run); ++i) {
        ck_assert_int_eq(weft_sim_advance(sim, weft_run_frame_time(run, i), NULL),
                         WEFT_OK);
        crossing += weft_cloth_crossings(cloth, weft_sim_state(sim), NULL) > 0;
    }
    ck_assert_uint_gt(crossing, 1);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(every_shipped_scene_is_in_the_list)
{
    DIR *folder = opendir("scenes");
    ck_assert_ptr_nonnull(folder);
    size_t found = 0;
    for (struct dirent *item; (item = readdir(folder)) != NULL;) {
        const char *dot = strrchr(item->d_name, '.');
        if (dot == NULL || strcmp(dot, ".yaml") != 0) {
            continue;
        }
        bool listed = false;
        for (size_t i = 0; i < SCENES; ++i) {
            listed = listed || strcmp(scenes[i].file, item->d_name) == 0;
        }
        ck_assert_msg(listed, "%s", item->d_name);
        ++found;
    }
    closedir(folder);
    ck_assert_uint_eq(found, SCENES);
}
END_TEST

TEST_SUITE(scenes)
{
    Suite *all = suite_create("scenes");
    TCase *bounds_case = tcase_create("bounds");
    tcase_set_timeout(bounds_case, 300);
    tcase_add_loop_test(bounds_case, every_scene_stays_within_its_bounds, 0, SCENES);
    tcase_add_loop_test(
        bounds_case, cloth_passes_through_itself_where_self_contact_is_off, 0, SCENES);
    tcase_add_test(bounds_case, every_shipped_scene_is_in_the_list);
    suite_add_tcase(all, bounds_case);
    return all;
}
