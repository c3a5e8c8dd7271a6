/* SPDX-License-Identifier: BSD-3-Clause */
/* check.c -- weft check: validates scenes and describes them; writes no file. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program/batch/batch.h"
#include "program/check/check.h"
#include "program/record/result.h"
#include "program/reports.h"

/* Those of this verb alone. */
typedef struct check_options {
    bool all;
} check_options;

static const check_options *check_own(const arguments *given)
{
    return given->own;
}

static void print_bytes(const char *what, double bytes)
{
    static const char *const units[] = { "B", "kB", "MB", "GB", "TB" };
    size_t unit = 0;
    while (bytes >= 1000.0 && unit + 1 < sizeof units / sizeof units[0]) {
        bytes /= 1000.0;
        ++unit;
    }
    printf("%s %.3g %s", what, bytes, units[unit]);
}

static void print_range(const char *what, weft_range range)
{
    if (range.first == range.last) {
        printf(" %s %td", what, range.first);
    } else if (range.first == 0 && range.last == -1) {
        printf(" all %ss", what);
    } else {
        printf(" %ss %td to %td", what, range.first, range.last);
    }
}

static size_t matched(weft_range range, size_t count)
{
    const ptrdiff_t n = (ptrdiff_t)count;
    const ptrdiff_t first = range.first < 0 ? range.first + n : range.first;
    const ptrdiff_t last = range.last < 0 ? range.last + n : range.last;
    return (size_t)(last - first + 1);
}

/* Of the one vertex of a pin, such as the one that is nearest to a point. */
static void print_vertex(const weft_cloth_def *def, const weft_cloth *cloth,
                         size_t vertex)
{
    char name[64];
    const double *x = &def->mesh->start[3 * vertex];
    printf(" %s at (%.4g, %.4g, %.4g) m,",
           weft_particle_text(cloth, vertex, name, sizeof name), x[0], x[1], x[2]);
}

static void print_pins(const weft_cloth_def *def, const weft_cloth *cloth)
{
    const bool grid = def->mesh == NULL;
    printf("  pins       %zu %s held\n", weft_cloth_pins(cloth),
           grid ? "particles" : "vertices");
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        const bool moves = pin->frequency > 0.0 || pin->velocity[0] != 0.0
                           || pin->velocity[1] != 0.0 || pin->velocity[2] != 0.0;
        const bool one = !grid && pin->vertex_count == 1; /* its text has the cloth */
        const bool named = !grid && !one && def->mesh->part_count > 0;
        printf("             pin %zu%s%s:", i, named ? ", " : "",
               named ? cloth_of(def->mesh, pin->vertices[0]) : "");
        if (grid) {
            print_range("row", pin->rows);
            print_range("column", pin->cols);
        } else if (one) {
            print_vertex(def, cloth, pin->vertices[0]);
        }
        printf("%s %zu matched%s\n", grid ? "," : "",
               grid ? matched(pin->rows, def->rows) * matched(pin->cols, def->cols)
                    : pin->vertex_count,
               moves ? ", moved" : "");
    }
}

static void print_cloths(const weft_mesh_def *mesh, const weft_cloth *cloth)
{
    for (size_t k = 0; k < mesh->part_count; ++k) {
        const record_part_facts of = record_part_facts_of(cloth, k);
        const weft_cloth_def *grid = mesh->grids != NULL ? mesh->grids[k] : NULL;
        const char *item = k == 0 ? "cloths" : "";
        size_t triangles = 0;
        if (grid != NULL) {
            print_item(item, "%s: grid of %zu x %zu particles, %.6g kg, %zu held",
                       of.part.name, grid->rows, grid->cols, of.mass, of.pinned);
            continue;
        }
        for (size_t t = 0; t < mesh->triangles; ++t) {
            triangles += part_of(mesh, mesh->corners[3 * t]) == k;
        }
        print_item(item, "%s: %zu vertices, %zu triangles, %.6g kg, %zu held",
                   of.part.name, of.part.count, triangles, of.mass, of.pinned);
    }
}

/* sim NULL: not known. A run also keeps a state for its frames. */
static void print_memory(const weft_cloth *cloth, const weft_sim *sim)
{
    const double vector = (double)weft_cloth_dim(cloth) * sizeof(double);
    const double own = (double)weft_cloth_bytes(cloth);
    const double run = sim != NULL ? (double)weft_sim_stats(sim).bytes : 0.0;
    fputs("  memory     ", stdout);
    print_bytes("cloth", own);
    print_bytes(", each state vector", vector);
    if (run > 0.0) {
        print_bytes("\n             in a run", own + run + vector);
        printf(", %.0f bytes per particle",
               (own + run + vector) / (double)weft_cloth_particles(cloth));
    }
    putchar('\n');
}

static void print_cloth(const weft_cloth_def *def, const weft_cloth *cloth)
{
    char size[HUMAN_SIZE];
    double least = weft_cloth_particle_mass(cloth, 0), most = least;
    if (def->mesh != NULL) {
        print_item("mesh", "%s", weft_cloth_text(cloth, size, sizeof size));
        print_cloths(def->mesh, cloth);
    } else {
        printf("  particles  %zu (%zu rows x %zu columns)\n",
               weft_cloth_particles(cloth), def->rows, def->cols);
        fputs("  springs   ", stdout);
    }
    for (size_t i = 0; def->mesh == NULL && i < WEFT_FAMILIES; ++i) {
        printf(" %zu %s%s", weft_cloth_springs(cloth, (weft_family)i),
               weft_family_name((weft_family)i), i + 1 < WEFT_FAMILIES ? "," : "\n");
    }
    for (size_t i = 1; i < weft_cloth_particles(cloth); ++i) {
        least = fmin(least, weft_cloth_particle_mass(cloth, i));
        most = fmax(most, weft_cloth_particle_mass(cloth, i));
    }
    printf("  masses     %.6g kg in all, %.6g to %.6g kg a particle\n",
           weft_cloth_mass(cloth), least, most);
    print_pins(def, cloth);
}

static void print_stepper(const weft_scene *scene, size_t particles)
{
    const weft_stepper_type *type = weft_scene_method_type(scene);
    const weft_stepper_config *config = weft_scene_config(scene);
    const int order = type != NULL ? type->order : config->butcher->order;
    char number[16], matrices[160];
    sentence steps = { "" };
    (void)snprintf(number, sizeof number, order > 0 ? "%d" : "variable", order);
    if (config->fixed_step > 0.0) {
        say(&steps, "fixed step %.9g s", config->fixed_step);
        if (record_step_differs(scene)) {
            say(&steps, ", of at most %g s, so that a frame has %.0f",
                weft_scene_step(scene),
                weft_run_frame_time(weft_scene_run(scene), 1) / config->fixed_step);
        }
    } else {
        say(&steps, "rtol %g, atol %g m and %g m/s, %s norm", config->rtol,
            config->atol_position, config->atol_velocity,
            config->norm == WEFT_NORM_MAX ? "max" : "rms");
    }
    print_item("stepper", "%s %s, order %s, %s", weft_scene_plugin(scene),
               weft_scene_method(scene), number, steps.text);
    if (type != NULL
        && weft_stepper_matrices(type, particles, matrices, sizeof matrices) > 0.0) {
        print_item("matrices", "%s", matrices + strlen("matrices "));
    }
}

static void print_notes(const weft_scene *scene)
{
    const char *about, *line;
    for (size_t i = 0; (line = weft_scene_note(scene, i, &about)) != NULL; ++i) {
        print_item(about, "%s", line);
    }
}

static void notes_yaml(yaml_out *out, const weft_scene *scene)
{
    const char *about, *line;
    size_t i = 0;
    for (; (line = weft_scene_note(scene, i, &about)) != NULL; ++i) {
        yaml_out_write(out,
                       i == 0 ? "notes: [{ about: %s, line: \"%s\" }"
                              : "{ about: %s, line: \"%s\" }",
                       about, line);
    }
    if (i > 0) {
        yaml_out_write(out, "]");
    }
}

/* What is known without a simulation, whose start may relax for minutes. */
static void print_scene(const char *file, const weft_scene *scene,
                        const weft_cloth *cloth)
{
    const weft_run_def *run = weft_scene_run(scene);
    const weft_limit_def *limit = weft_scene_limit(scene);
    print_line(stdout, "%s: ok: %s", file, weft_scene_name(scene));
    print_cloth(weft_scene_cloth(scene), cloth);
    print_notes(scene);
    start_print_stretch(weft_scene_cloth(scene));
    for (size_t i = 0; i < REPORT_SECTIONS; ++i) {
        if (report_sections[i]->check != NULL) {
            report_sections[i]->check(scene, cloth);
        }
    }
    if (limit->method != WEFT_LIMIT_NONE) {
        printf("  limit      %s, strain %g, %s, %zu sweeps at most\n",
               limit->method == WEFT_LIMIT_PROVOT ? "provot" : "bridson", limit->strain,
               limit->solver == WEFT_LIMIT_FAST ? "fast" : "sweep", limit->sweeps);
    }
    print_stepper(scene, weft_cloth_particles(cloth));
    printf("  run        %g s in %zu frames,", run->duration,
           weft_run_last_frame(run) + 1);
    print_bytes(" run.vtkhdf", frames_bytes(scene, &(size_t){ 0 }));
    putchar('\n');
    (void)fflush(stdout);
}

static void print_survey(const weft_scene *scene, const weft_cloth *cloth,
                         const weft_sim *sim, const survey *found, bool all)
{
    weft_error err;
    print_memory(cloth, sim);
    stability_print(scene, found, all);
    if (scene_supported(scene, &err) != WEFT_OK) {
        print_item("note", "%s", err.message);
    }
}

static void scene_yaml(yaml_out *out, const char *file, const weft_scene *scene,
                       const weft_cloth *cloth, const survey *found)
{
    yaml_out_write(out, "{ file: \"%s\", name: \"%s\", particles: %zu, pinned: %zu",
                   file, weft_scene_name(scene), weft_cloth_particles(cloth),
                   weft_cloth_pins(cloth));
    start_yaml(out, weft_scene_cloth(scene));
    record_cloths(out, cloth);
    notes_yaml(out, scene);
    for (size_t i = 0; i < REPORT_SECTIONS; ++i) {
        if (report_sections[i]->check_yaml != NULL) {
            report_sections[i]->check_yaml(out, scene);
        }
    }
    stability_yaml(out, scene, found);
    yaml_out_write(out, "}");
}

static void warn_of_sections(const char *file, const weft_cloth_def *def)
{
    for (size_t i = 0; i < REPORT_SECTIONS; ++i) {
        if (report_sections[i]->warn != NULL) {
            report_sections[i]->warn(file, def);
        }
    }
}

/* It may be on purpose. */
static void warn_without_springs(const char *file, const weft_scene *scene,
                                 const weft_cloth *cloth)
{
    size_t springs = weft_scene_cloth(scene)->mesh != NULL;
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        springs += weft_cloth_springs(cloth, (weft_family)i);
    }
    if (springs == 0) {
        print_line(stderr,
                   "%s: warning: cloth has no springs: nothing holds it together",
                   file);
    }
}

/* The simulation of a cloth and what methods cost on it. */
typedef struct described {
    double *start;
    weft_sim *sim;
    survey found;
} described;

static weft_status measure(const weft_scene *scene, const weft_cloth *cloth,
                           const arguments *given, described *to, weft_error *err)
{
    if (weft_scene_method_type(scene) != NULL) {
        TRY(start_create(scene, cloth, true, &to->start, err));
        TRY(band_sim_create(scene, NULL, NULL, (weft_log){ NULL, NULL }, cloth,
                            to->start, &to->sim, err));
    }
    return survey_create(scene, cloth, to->sim, to->start, given, &to->found, err);
}

/* Describes a valid scene, to *out or, if that is NULL, as text. */
static int describe(const char *file, const weft_scene *scene, const arguments *given,
                    yaml_out *out)
{
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    described of = { .start = NULL };
    if (scene_accepted(scene) != EXIT_DONE) {
        return EXIT_SCENE;
    }
    weft_status status = frames_have_room(scene, &err);
    if (status == WEFT_OK) {
        status = cloth_create(scene, weft_scene_cloth(scene), &cloth, &err);
    }
    if (status == WEFT_OK && out == NULL) {
        print_scene(file, scene, cloth);
    }
    if (status == WEFT_OK) {
        warn_without_springs(file, scene, cloth);
        warn_of_sections(file, weft_scene_cloth(scene));
        status = measure(scene, cloth, given, &of, &err);
    }
    if (status != WEFT_OK) {
        (void)snprintf(err.file, sizeof err.file, "%.200s", file);
        err.line = err.column = 1;
    } else if (out != NULL) {
        scene_yaml(out, file, scene, cloth, &of.found);
    } else {
        print_survey(scene, cloth, of.sim, &of.found, check_own(given)->all);
    }
    survey_destroy(&of.found);
    weft_sim_destroy(of.sim);
    weft_cloth_destroy(cloth);
    free(of.start);
    return status == WEFT_OK ? EXIT_DONE : report_error(&err);
}

static bool is_beyond(const weft_sweep *sweep, size_t run)
{
    weft_scene *scene = NULL;
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    const bool beyond = weft_sweep_scene(sweep, run, &scene, NULL) == WEFT_OK
                        && weft_scene_config(scene)->fixed_step > 0.0
                        && simulation_create(scene, NULL, &cloth, &sim, NULL) == WEFT_OK
                        && stability_warn(scene, sim, true);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
    return beyond;
}

/* Validates all runs of a sweep, and describes the first. */
static int check_file(const char *file, const arguments *given, yaml_out *out)
{
    weft_error err = { 0 };
    weft_sweep *sweep = NULL;
    weft_scene *scene = NULL;
    int code = open_scene(file, given, NULL, &sweep);
    code = code == EXIT_DONE ? batch_check(given, file, sweep) : code;
    if (code != EXIT_DONE) {
        weft_sweep_destroy(sweep);
        return code;
    }
    const size_t keys = out == NULL ? weft_sweep_keys(sweep) : 0;
    if (keys > 0) {
        printf("%s: ok: a sweep of %zu runs; the first:\n", file,
               weft_sweep_runs(sweep));
    }
    for (size_t k = 0; k < keys; ++k) {
        printf("  %s %s=%s\n", k == 0 ? "sweep     " : "          ",
               weft_sweep_key(sweep, k), weft_sweep_value(sweep, k, 1));
    }
    code = weft_sweep_scene(sweep, 1, &scene, &err) == WEFT_OK
               ? describe(file, scene, given, out)
               : report_error(&err);
    /* of the first hundred runs at most, as each needs a simulation */
    const size_t runs = weft_sweep_runs(sweep), most = runs < 100 ? runs : 100;
    size_t beyond = 0;
    for (size_t run = 1; code == EXIT_DONE && out == NULL && runs > 1 && run <= most;
         ++run) {
        beyond += is_beyond(sweep, run);
    }
    if (beyond > 0) {
        printf("  warning    fixed_step is beyond the stable step in %zu of the %s%zu "
               "runs\n",
               beyond, most < runs ? "first " : "", most);
    }
    weft_scene_destroy(scene);
    weft_sweep_destroy(sweep);
    return code;
}

static int check_verb(const arguments *given)
{
    yaml_out out;
    int code = EXIT_DONE;
    if (given->yaml) {
        yaml_out_begin(&out, stdout);
        yaml_out_write(&out, "scenes: [");
    }
    for (int i = 0; i < given->operand_count; ++i) {
        const int one
            = check_file(given->operands[i], given, given->yaml ? &out : NULL);
        code = code == EXIT_DONE ? one : code;
    }
    if (given->yaml) {
        yaml_out_write(&out, "]");
        code = yaml_out_end(&out) || code != EXIT_DONE ? code : EXIT_FILE;
    }
    return code;
}

static const verb_option options[] = {
    OWN(check_options, all, "all", NULL, "every method of every plugin"),
    SHARED(refine, "refine", NULL,
           "sharper bounds by the power method, not guaranteed"),
    SHARED(yaml, "yaml", NULL, "as YAML: the stable steps of every method"),
    OPTION_SET,
    OPTION_PLUGIN_PATH,
};

const verb verb_check = {
    .name = "check",
    .summary = "validate scenes, print their contents; write nothing",
    .help
    = "usage: weft check SCENE.yaml... [OPTIONS]\n"
      "\n"
      "Validates scenes and prints particles, springs, masses, the matching pins, "
      "memory, integrator and frames. Reports all errors of a file at once. For "
      "contact, prints its shapes and how stiff it is at rest, after a fall of the "
      "cloth onto each shape, and between layers of the cloth. For a fabric or bending "
      "rigidity, prints the springs, the moduli that they make and Peirce's bending "
      "length. Also prints the fastest vibration of the cloth, and for the cheapest "
      "methods the largest step at which no vibration grows, with the evaluations of "
      "the forces per simulated second. A method marked * has no such step on undamped "
      "vibrations: its step is the one at which none of these more than doubles during "
      "the run. Estimates from the stiffest vibration and its damping ratio whether a "
      "stabilised or an implicit method would be faster; on triangles tries both an "
      "explicit and an implicit method up to a tenth of a second after the first "
      "touch.\n",
    OPTIONS(options),
    .own_size = sizeof(check_options),
    .more
    = "example: weft check scenes/*.yaml\n"
      "\n"
      "exit codes: 0 all scenes are valid, 1 a start crosses and contact.untangle does "
      "not free it, or there is no memory, 2 wrong command line, 3 a scene is wrong, 4 "
      "a file could not be read, 130 SIGINT, 143 SIGTERM\n",
    .operands = { 1, ANY_NUMBER, "no scene given", NULL },
    .run = check_verb,
};
