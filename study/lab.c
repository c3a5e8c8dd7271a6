/* SPDX-License-Identifier: BSD-3-Clause */
/* lab.c -- weft lab: tests of the textile laboratory on a fabric. Each is a scene,
 * which is written, and a number that is measured when the cloth has come to rest. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program/cli.h"
#include "program/record/yaml_out.h"
#include "study/shadow.h"
#include "weft/elementary.h"

#define GRAVITY 9.81  /* [m/s^2] */
#define INNER   0.09  /* [m] radius of the support of the drape test */
#define OUTER   0.15  /* and of the disc */
#define STRIP   0.2   /* [m] length of the strip that is pulled */
#define PULL    490.0 /* [N/m] */

static const double pi = 3.14159265358979323846;

/* x y z of all particles at rest. */
typedef struct specimen {
    const weft_fabric *fabric;
    const weft_cloth *cloth;
    const double *start, *x;
    size_t count;
    const char *picture; /* file of the drape's */
    yaml_out *out;       /* NULL: the result is printed as text */
} specimen;

/* ---- drape ---- */

enum { DIRECTIONS = 2880 };

/* Maxima of the radius along the rim, the first `count` vertices, each of which stands
 * out by a twentieth of the radius' range. */
static size_t count_nodes(const specimen *self, size_t count)
{
    double least = INFINITY, most = 0.0;
    size_t lowest = 0, nodes = 0;
    for (size_t i = 0; i < count; ++i) {
        const double r = hypot(self->x[3 * i], self->x[3 * i + 2]);
        lowest = r < least ? i : lowest;
        least = fmin(least, r);
        most = fmax(most, r);
    }
    const double step = 0.05 * (most - least);
    bool rises = false;
    double turn = least;
    for (size_t i = 0; i <= count; ++i) {
        const size_t at = (lowest + i) % count;
        const double r = hypot(self->x[3 * at], self->x[3 * at + 2]);
        turn = rises ? fmax(turn, r) : fmin(turn, r);
        if (fabs(r - turn) > step) {
            nodes += rises;
            rises = !rises;
            turn = r;
        }
    }
    return nodes;
}

/* The outline of the shadow, and the rims of the disc and the support [mm]. */
static weft_status draw(const specimen *self, const double (*outline)[2],
                        const char *title, weft_error *err)
{
    record_file file;
    TRY(record_file_open(&file, NULL, self->picture, err));
    fprintf(file.stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-152 -152 304 304\">\n"
            "<title>%s</title>\n<rect x=\"-152\" y=\"-152\" width=\"304\" "
            "height=\"304\" fill=\"white\"/>\n<path fill=\"#9db8d9\" d=\"",
            title);
    for (size_t i = 0; i < DIRECTIONS; ++i) {
        fprintf(file.stream, "%c%.2f %.2f", i == 0 ? 'M' : 'L', 1e3 * outline[i][0],
                -1e3 * outline[i][1]);
    }
    fprintf(file.stream,
            "Z\"/>\n<g fill=\"none\" stroke=\"#333\"><circle r=\"%g\"/>"
            "<circle r=\"%g\" stroke-dasharray=\"3\"/></g>\n</svg>\n",
            1e3 * INNER, 1e3 * OUTER);
    return record_file_commit(&file, err);
}

static weft_status report_drape(const specimen *self, weft_error *err)
{
    static const double down[3] = { 0.0, -GRAVITY, 0.0 };
    double outline[DIRECTIONS][2], squares = 0.0;
    size_t rim = 0;
    shadow of;
    TRY(shadow_init(&of, self->cloth, down, err));
    for (size_t i = 0; i < DIRECTIONS; ++i) {
        shadow_point at = { .radius = 0.0 };
        double *to = outline[i];
        weft_sincos_turns(1.0 / DIRECTIONS, (double)i, &to[1], &to[0]);
        (void)shadow_at(&of, self->x, to, &at);
        to[0] *= at.radius, to[1] *= at.radius;
        squares += at.radius * at.radius;
    }
    free(of.ends);
    while (rim < self->count
           && hypot(self->start[3 * rim], self->start[3 * rim + 2]) > 0.999 * OUTER) {
        ++rim;
    }
    char title[64];
    const size_t nodes = count_nodes(self, rim);
    const double coefficient = 100.0 * (squares / DIRECTIONS - INNER * INNER)
                               / (OUTER * OUTER - INNER * INNER);
    (void)snprintf(title, sizeof title, "coefficient %.1f %%, %zu nodes", coefficient,
                   nodes);
    const weft_status status = draw(self, (const double(*)[2])outline, title, err);
    if (self->out != NULL) {
        yaml_out_write(self->out, "coefficient: %g, nodes: %zu, picture: \"%s\"",
                       coefficient, nodes, self->picture);
        return status;
    }
    print_item("drape", "%s", title);
    if (status == WEFT_OK) {
        print_item("picture", "%s: the shadow, the support and the disc before",
                   self->picture);
    }
    return status;
}

/* ---- cantilever and strip ---- */

/* Of a strip clamped at x = 0 whose last particle is its tip, as long as at the start.
 */
static weft_status report_cantilever(const specimen *self, weft_error *err)
{
    const double *tip = &self->x[3 * (self->count - 1)];
    const double length = self->start[3 * (self->count - 1)];
    const double chord = atan2(-tip[1], tip[0]);
    const double c = length * cbrt(cos(0.5 * chord) / (8.0 * tan(chord)));
    const double rigidity = self->fabric->density * GRAVITY * c * c * c;
    (void)err;
    if (self->out != NULL) {
        yaml_out_write(self->out,
                       "length: %g, angle: %g, bending_length: %g, rigidity: %g",
                       length, chord * 180.0 / pi, c, rigidity);
    } else {
        print_item("cantilever",
                   "the chord of %.1f mm falls by %.2f degrees; by Peirce's formula "
                   "the bending length is %.2f mm, the rigidity %.3g N m",
                   1e3 * length, chord * 180.0 / pi, 1e3 * c, rigidity);
    }
    return WEFT_OK;
}

static weft_status report_strip(const specimen *self, weft_error *err)
{
    const size_t last = self->count - 1;
    const double more = self->start[3 * last + 1] - self->x[3 * last + 1];
    (void)err;
    if (self->out != NULL) {
        yaml_out_write(self->out, "extension: %g, modulus: %g", 100.0 * more / STRIP,
                       PULL * STRIP / more);
    } else {
        print_item("strip",
                   "EMT %.3g %% at %.0f N/m, along the warp: a secant modulus of %.4g "
                   "N/m",
                   100.0 * more / STRIP, PULL, PULL * STRIP / more);
    }
    return WEFT_OK;
}

/* ---- the scenes ---- */

/* A preset by its name; another fabric by its numbers, of a mesh with its coupling. */
static void write_fabric(FILE *to, const weft_fabric *fabric, bool mesh)
{
    if (weft_fabric_find(fabric->name) == fabric) {
        fprintf(to, "  fabric: {preset: %s}\n", fabric->name);
        return;
    }
    fprintf(to,
            "  fabric: {density: %.*g, stretch: [%.*g, %.*g], shear: %.*g, bend: "
            "[%.*g, %.*g]",
            weft_text_digits(fabric->density), fabric->density,
            weft_text_digits(fabric->stretch[0]), fabric->stretch[0],
            weft_text_digits(fabric->stretch[1]), fabric->stretch[1],
            weft_text_digits(fabric->shear), fabric->shear,
            weft_text_digits(fabric->bend[0]), fabric->bend[0],
            weft_text_digits(fabric->bend[1]), fabric->bend[1]);
    if (fabric->twist >= 0.0) {
        fprintf(to, ", twist: %.*g", weft_text_digits(fabric->twist), fabric->twist);
    }
    if (mesh) {
        fprintf(to, ", coupling: %.*g", weft_text_digits(fabric->coupling),
                fabric->coupling);
    }
    fputs("}\n", to);
}

static void write_drape(FILE *to, const weft_fabric *fabric)
{
    fprintf(
        to,
        "# Cusick's drape test: a disc of 30 cm over a support of 18 cm, which clamps "
        "it.\nweft: 1\nname: drape of %s\n\ncloth:\n"
        "  cut: {outline: {disc: 0.15}, lines: [{disc: 0.09}], spacing: 7.5e-3, "
        "down: [0, 0, 1]}\n"
        "  pins: [{inside: {shape: sphere, at: [0, 0, 0], radius: 0.09}}]\n",
        fabric->name);
    write_fabric(to, fabric, true);
    fputs("\nforces: {wind: {velocity: [0, 0, 0], drag: 1}}\n", to);
}

static void write_cantilever(FILE *to, const weft_fabric *fabric)
{
    enum { ROWS = 33 };
    const double spacing = 2.0 * weft_fabric_length(fabric, 0, GRAVITY) / (ROWS - 1.5);
    fprintf(
        to,
        "# Peirce's cantilever (ASTM D1388): a strip along the warp, twice as long as "
        "its bending length.\n# Two pinned rows clamp it at x = 0.\n"
        "weft: 1\nname: cantilever of %s\n\ncloth:\n"
        "  grid: {rows: %d, cols: 1, spacing: %.9g, origin: [%.9g, 0, 0], right: [0, "
        "0, 1], down: [1, 0, 0]}\n"
        "  pins: [{rows: [0, 1], cols: all}]\n",
        fabric->name, ROWS, spacing, -0.5 * spacing);
    write_fabric(to, fabric, false);
    fprintf(to, "\nforces: {damping: %.9g}\n", 50.0 * fabric->density * spacing);
}

/* A chain is 1 m wide. In the mean of its length, weight included, it carries PULL. */
static void write_strip(FILE *to, const weft_fabric *fabric)
{
    const double mass = PULL / GRAVITY - 0.5 * fabric->density * STRIP;
    fprintf(to,
            "# The KES strip: 0.2 m along the warp, pulled with 490 N/m by a weight.\n"
            "weft: 1\nname: strip of %s\n\ncloth:\n"
            "  grid: {rows: 11, cols: 1, spacing: 0.02}\n"
            "  pins: [top]\n"
            "  loads: [{at: bottom, mass: %.*g}]\n",
            fabric->name, weft_text_digits(mass), mass);
    write_fabric(to, fabric, false);
    fprintf(to, "\nforces: {damping: %.9g}\n", PULL);
}

static const struct {
    void (*write)(FILE *to, const weft_fabric *fabric);
    weft_status (*report)(const specimen *self, weft_error *err);
} tests[] = { { write_drape, report_drape },
              { write_cantilever, report_cantilever },
              { write_strip, report_strip } };
static const char *const test_names[] = { "drape", "cantilever", "strip", NULL };

/* A file with another text is the user's, unless --force is given. */
static weft_status write_scene(const char *path, size_t test, const weft_fabric *fabric,
                               bool force, weft_error *err)
{
    enum { ROOM = 2048 };
    char text[ROOM] = "", there[ROOM] = "";
    FILE *to = fmemopen(text, sizeof text - 1, "w");
    if (to == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the scene");
    }
    tests[test].write(to, fabric);
    fputs("stepper: {plugin: stiff, method: backward_euler, fixed_step: 0.03}\n"
          "run: {duration: 6, fps: 10}\n",
          to);
    (void)fclose(to);
    FILE *old = force ? NULL : fopen(path, "r");
    if (old != NULL) {
        (void)!fread(there, 1, sizeof there - 1, old);
        (void)fclose(old);
        return strcmp(there, text) == 0
                   ? WEFT_OK
                   : weft_error_set(err, WEFT_IO,
                                    "%s: File exists with another text; --force "
                                    "replaces it",
                                    path);
    }
    record_file file;
    TRY(record_file_open(&file, NULL, path, err));
    (void)fputs(text, file.stream);
    return record_file_commit(&file, err);
}

/* ---- the run ---- */

static weft_status measure(const weft_scene *scene, size_t test, const char *picture,
                           yaml_out *out, weft_error *err)
{
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    double *places = NULL;
    weft_status status = simulation_create(scene, NULL, &cloth, &sim, err);
    const size_t n = status == WEFT_OK ? weft_cloth_particles(cloth) : 0;
    if (status == WEFT_OK && (places = malloc(6 * n * sizeof *places)) == NULL) {
        status = weft_error_set(err, WEFT_NO_MEMORY, "no memory for the cloth");
    }
    if (status == WEFT_OK) {
        weft_sim_positions(sim, places);
        status = weft_sim_advance(sim, weft_scene_run(scene)->duration, err);
    }
    if (status == WEFT_OK) {
        weft_sim_positions(sim, places + 3 * n);
        const specimen self = { .fabric = weft_scene_fabric(scene),
                                .cloth = cloth,
                                .start = places,
                                .x = places + 3 * n,
                                .count = n,
                                .picture = picture,
                                .out = out };
        status = tests[test].report(&self, err);
    }
    free(places);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status;
}

/* That of a scene, as it is without the overrides, with the name of the file. */
static int read_fabric(const arguments *given, weft_fabric *out, char *name)
{
    arguments plain = *given;
    weft_error err;
    weft_scene *scene = NULL;
    plain.sets.count = 0;
    plain.out = NULL; /* the name is that of the file */
    plain.operands = &given->operands[1];
    int code = open_scene(plain.operands[0], &plain, &scene, NULL);
    const weft_fabric *fabric = code == EXIT_DONE ? weft_scene_fabric(scene) : NULL;
    if (code == EXIT_DONE && fabric == NULL) {
        (void)weft_error_set(&err, WEFT_BAD_SCENE, "%s: its cloth has no fabric",
                             plain.operands[0]);
        code = report_error(&err);
    }
    if (fabric != NULL) {
        *out = *fabric;
        out->name = out_directory(&plain, "", name);
    }
    weft_scene_destroy(scene);
    return code;
}

/* A preset, or what is read of a scene. */
static int choose_fabric(const arguments *given, weft_fabric *read, char *name,
                         const weft_fabric **fabric)
{
    enum { MOST = 64 };
    const char *names[MOST + 1] = { NULL };
    size_t count, chosen = 0;
    const weft_fabric *presets = weft_fabric_presets(&count);
    *fabric = read;
    if (strstr(given->operands[1], ".yaml") != NULL) {
        return read_fabric(given, read, name);
    }
    for (size_t i = 0; i < count && i < MOST; ++i) {
        names[i] = presets[i].name;
    }
    const int code = choose(given, "FABRIC", given->operands[1], names, &chosen);
    *fabric = &presets[chosen];
    return code;
}

/* The files TEST-FABRIC.yaml and .svg in the directory of the test, which is made. */
static weft_status place_files(const arguments *given, const char *test,
                               const char *fabric, char path[RECORD_PATH],
                               char picture[RECORD_PATH], weft_error *err)
{
    char directory[2 * RECORD_PATH], file[2 * RECORD_PATH];
    (void)snprintf(directory, sizeof directory, "%s-%s.lab", test, fabric);
    const char *into = given->out != NULL ? given->out : directory;
    (void)snprintf(file, sizeof file, "%s-%s.yaml", test, fabric);
    TRY(record_path(into, file, path, err));
    (void)snprintf(file, sizeof file, "%s-%s.svg", test, fabric);
    TRY(record_path(into, file, picture, err));
    return record_directory(into, err);
}

/* Runs the test's scene at `path`, and reports the result. */
static int run_test(const arguments *given, size_t test, const weft_fabric *fabric,
                    const char *path, const char *picture)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    yaml_out out;
    int code = open_scene(path, given, &scene, NULL);
    if (code == EXIT_DONE && given->yaml) {
        yaml_out_begin(&out, stdout);
        yaml_out_write(&out, "test: %s, fabric: \"%s\", scene: \"%s\"",
                       test_names[test], fabric->name, path);
    }
    if (code == EXIT_DONE
        && measure(scene, test, picture, given->yaml ? &out : NULL, &err) != WEFT_OK) {
        code = report_error(&err);
    }
    if (scene != NULL && given->yaml) {
        code = yaml_out_end(&out) || code != EXIT_DONE ? code : EXIT_FILE;
    } else if (code == EXIT_DONE) {
        print_item("scene", "%s; 'weft run %s --view' draws it", path, path);
    }
    weft_scene_destroy(scene);
    return code;
}

static int lab_verb(const arguments *given)
{
    size_t test = 0;
    char path[RECORD_PATH], picture[RECORD_PATH], name[RECORD_PATH];
    weft_error err = { 0 };
    weft_fabric read = { .name = NULL };
    const weft_fabric *fabric = NULL;
    int code = choose(given, "TEST", given->operands[0], test_names, &test);
    code = code == EXIT_DONE ? choose_fabric(given, &read, name, &fabric) : code;
    if (code != EXIT_DONE) {
        return code;
    }
    if (place_files(given, test_names[test], fabric->name, path, picture, &err)
            != WEFT_OK
        || write_scene(path, test, fabric, given->force, &err) != WEFT_OK) {
        return report_error(&err);
    }
    return run_test(given, test, fabric, path, picture);
}

static const verb_option options[] = {
    SHARED(out, "out", "DIR", "the directory; default: ./TEST-FABRIC.lab"),
    SHARED(force, "force", NULL, "replace a scene of that name with another text"),
    SHARED(yaml, "yaml", NULL, "the result as YAML, with all digits"),
    OPTION_SET,
    OPTION_PLUGIN_PATH,
};

const verb verb_lab = {
    .name = "lab",
    .summary = "test a measured fabric as a textile laboratory does",
    .help = "usage: weft lab TEST FABRIC [OPTIONS]\n"
            "\n"
            "Writes the scene of a test of a fabric to TEST-FABRIC.yaml in a "
            "directory, runs it to rest and prints the result. FABRIC is a preset "
            "(weft fabrics) or a scene, FILE.yaml, whose cloth.fabric is tested:\n"
            "\n"
            "  drape                Cusick: drape coefficient [%], nodes and shadow "
            "(drape-FABRIC.svg, beside the scene) of a disc of 30 cm on a support of "
            "18 cm, which clamps it\n"
            "  cantilever           Peirce, ASTM D1388: the angle of a strip twice as "
            "long as its bending length, and the bending length by Peirce's formula\n"
            "  strip                KES: the extension [%] of a strip at 490 N/m\n",
    OPTIONS(options),
    .more = "examples:\n"
            "  weft lab drape 11oz-black-denim\n"
            "  weft lab drape royal-target --set cloth.cut.spacing=5e-3\n"
            "  weft lab cantilever my.yaml\n"
            "\n"
            "exit codes: 0 done, 1 the run failed, 2 wrong command line, 3 wrong "
            "scene, 4 the scene could not be written\n",
    .operands
    = { 2, 2, "a test and a fabric are needed", "more than a test and a fabric" },
    .run = lab_verb,
};
