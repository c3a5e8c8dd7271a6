/* SPDX-License-Identifier: BSD-3-Clause */
/* export_frames.c -- weft export: frames of a run as files that other programs read.
 *
 * Frames come from run.vtkhdf, the final state from final.csv. If run.vtkhdf is
 * missing, frames are computed again from the run's scene.yaml, which gives the same
 * bits, and each is checked against the hash in its row of series.csv. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "program/cli.h"
#include "program/loose.h"
#include "program/record/export/export.h"
#include "program/record/frames.h"
#include "program/record/result.h"
#include "program/record/series.h"

/* Those of this verb alone. */
typedef struct export_options {
    const char *format;
    const char *frame;
    const char *garment;
} export_options;

static const export_options *export_own(const arguments *given)
{
    return given->own;
}

typedef struct export_format {
    const char *name;
    record_write_fn *write;    /* one file per frame; NULL: none */
    const char *suffix;        /* of these files */
    const record_movie *movie; /* one file over all frames; NULL: none */
    bool rest;                 /* needs rest.obj beside it */
    bool whole;                /* points are counted: with vertices that no face has */
} export_format;

static const export_format formats[] = {
    { "obj", .write = record_obj, .suffix = "obj", .whole = true },
    { "ply", .write = record_ply, .suffix = "ply", .whole = true },
    { "csv", .write = record_csv, .suffix = "csv" },
    { "mdd", .movie = &record_mdd, .rest = true, .whole = true },
    { "pc2", .movie = &record_pc2, .rest = true, .whole = true },
    { "pvd", .write = record_vtp, .suffix = "vtp", .movie = &record_pvd },
};

enum { FORMATS = sizeof formats / sizeof formats[0] };

typedef struct export_job {
    const char *directory;
    const export_format *format;
    size_t n, count;           /* particles; frames there are */
    weft_scene *scene;         /* NULL: not known, nor are shapes */
    size_t shapes;             /* that are written beside the cloth */
    double *shape_position;    /* of one of them */
    record_frames *frames;     /* NULL: computed again, with the members below */
    record_series_row *series; /* [count] as the run recorded it */
    weft_cloth *cloth;         /* of triangles also for final.csv */
    weft_sim *sim;
    record_faces faces;
    size_t first, last;     /* wanted, as indices below count */
    double *values;         /* 7 N: positions, velocities, strains */
    record_surface surface; /* of values: of one frame */
    loose_surface loose;    /* what the format adds to it */
    record_file movie;
} export_job;

/* ---- one frame, wherever it comes from -------------------------------------- */

enum { NAME = 64 };

static size_t number_of(const export_job *job, size_t i)
{
    return job->frames == NULL ? i : (size_t)job->frames->numbers[i];
}

/* Part 0 is the cloth, part k + 1 shape k: its files have -shape-k behind the stem. */
static void name_part(char name[NAME], const char *stem, size_t part,
                      const char *suffix)
{
    char shape[32] = "";
    if (part > 0) {
        (void)snprintf(shape, sizeof shape, "-shape-%zu", part - 1);
    }
    (void)snprintf(name, NAME, "%s%s.%s", stem, shape, suffix);
}

static record_surface part_at(export_job *job, size_t part, double time)
{
    return part == 0 && job->loose.count > 0 ? loose_add(&job->loose, &job->surface)
           : part == 0                       ? job->surface
                       : record_shape_surface(weft_scene_cloth(job->scene), part - 1,
                                              time, job->shape_position);
}

/* One line for any number of frames of a part. */
static void print_files(const export_job *job, size_t part)
{
    char stem[NAME / 2], name[NAME];
    (void)snprintf(stem, sizeof stem, "frame-%06zu", number_of(job, job->first));
    name_part(name, stem, part, job->format->suffix);
    print_plainly(stdout, "%s/frames/%s", job->directory, name);
    if (job->last > job->first) {
        (void)snprintf(stem, sizeof stem, "frame-%06zu", number_of(job, job->last));
        name_part(name, stem, part, job->format->suffix);
        printf(" to %s, %zu files", name, job->last - job->first + 1);
    }
    putchar('\n');
}

static weft_status write_parts(export_job *job, const char *stem, double time,
                               weft_error *err)
{
    const record_movie *movie = job->format->movie;
    for (size_t part = 0; part <= job->shapes; ++part) {
        char name[NAME];
        const record_surface surface = part_at(job, part, time);
        name_part(name, stem, part, job->format->suffix);
        TRY(record_surface_write(job->directory, name, job->format->write, &surface,
                                 err));
        if (movie != NULL) {
            movie->list(job->movie.stream, time, part, name);
        }
    }
    return WEFT_OK;
}

static weft_status write_frame(export_job *job, size_t number, double time,
                               weft_error *err)
{
    char stem[NAME / 2];
    if (job->format->write == NULL) {
        const record_surface surface = part_at(job, 0, time);
        job->format->movie->points(job->movie.stream, &surface);
        return WEFT_OK;
    }
    (void)snprintf(stem, sizeof stem, "frames/frame-%06zu", number);
    return write_parts(job, stem, time, err);
}

/* ---- frames of run.vtkhdf --------------------------------------------------- */

static weft_status read_frames(export_job *job, weft_error *err)
{
    double *velocity = job->values + 3 * job->n, *strain = job->values + 6 * job->n;
    record_frames *frames = job->frames;
    for (size_t i = job->first; i <= job->last; ++i) {
        TRY(record_frames_positions(frames, i, job->values, err));
        if (job->surface.velocity != NULL) {
            TRY(record_frames_field(frames, WEFT_RECORD_VELOCITY, i, velocity, err));
        }
        if (job->surface.strain != NULL) {
            TRY(record_frames_field(frames, WEFT_RECORD_STRAIN, i, strain, err));
        }
        TRY(write_frame(job, (size_t)frames->numbers[i], frames->times[i], err));
    }
    return WEFT_OK;
}

/* ---- frames computed again -------------------------------------------------- */

static weft_status on_frame(void *ctx, size_t index, weft_error *err)
{
    export_job *job = ctx;
    const double *y = weft_sim_state(job->sim);
    if (index < job->first) {
        return WEFT_OK;
    }
    const uint64_t recorded = job->series[index].hash;
    const uint64_t hash = weft_cloth_state_hash(job->cloth, y);
    if (hash != recorded) {
        return weft_error_set(err, WEFT_SOLVER,
                              "frame %zu computed again has hash %016" PRIx64
                              ", the run had %016" PRIx64
                              ": other versions? see manifest.yaml",
                              index, hash, recorded);
    }
    weft_sim_positions(job->sim, job->values);
    weft_sim_velocities(job->sim, job->values + 3 * job->n);
    weft_cloth_strains(job->cloth, y, job->values + 6 * job->n);
    return write_frame(job, index, weft_sim_time(job->sim), err);
}

/* ---- files -------------------------------------------------------------------- */

static weft_status export_frames(export_job *job, weft_error *err)
{
    if (job->format->write != NULL) {
        char path[RECORD_PATH];
        TRY(record_path(job->directory, "frames", path, err));
        TRY(record_directory(path, err));
    }
    if (job->frames == NULL) {
        const weft_play frames = { .run = weft_scene_run(job->scene),
                                   .last = job->last,
                                   .frame = on_frame,
                                   .ctx = job };
        TRY(weft_sim_play(job->sim, &frames, err));
    } else {
        TRY(read_frames(job, err));
    }
    for (size_t part = 0; job->format->write != NULL && part <= job->shapes; ++part) {
        print_files(job, part);
    }
    return WEFT_OK;
}

static double time_of(const export_job *job, size_t i)
{
    return job->frames == NULL ? weft_run_frame_time(weft_scene_run(job->scene), i)
                               : job->frames->times[i];
}

static weft_status begin_movie(export_job *job, const char *name, size_t points,
                               weft_error *err)
{
    double *times = malloc(job->count * sizeof *times);
    if (times == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the times");
    }
    for (size_t i = 0; i < job->count; ++i) {
        times[i] = time_of(job, i);
    }
    const weft_status status = record_file_open(&job->movie, job->directory, name, err);
    if (status == WEFT_OK) {
        job->format->movie->begin(job->movie.stream, times, job->count, points);
    }
    free(times);
    return status;
}

/* The pose that a cache moves: the particles at rest, a shape at t = 0. */
static weft_status write_rest(export_job *job, size_t part, weft_error *err)
{
    char name[NAME];
    if (job->frames == NULL) {
        weft_cloth_rest(job->cloth, job->values);
    } else {
        memcpy(job->values, job->frames->rest, 3 * job->n * sizeof *job->values);
    }
    const record_surface surface = part_at(job, part, 0.0);
    name_part(name, "rest", part, "obj");
    TRY(record_surface_write(job->directory, name, record_obj, &surface, err));
    print_plainly(stdout, "%s/%s\n", job->directory, name);
    return WEFT_OK;
}

static weft_status export_part(export_job *job, size_t part, weft_error *err)
{
    char name[NAME];
    if (job->format->rest) {
        TRY(write_rest(job, part, err));
    }
    const record_surface surface = part_at(job, part, 0.0);
    name_part(name, "run", part, job->format->name);
    TRY(begin_movie(job, name, surface.faces.particles, err));
    const weft_status status = part == 0 ? export_frames(job, err) : WEFT_OK;
    for (size_t i = 0; part > 0 && i < job->count; ++i) {
        const record_surface at = part_at(job, part, time_of(job, i));
        job->format->movie->points(job->movie.stream, &at);
    }
    if (status != WEFT_OK) {
        record_file_discard(&job->movie);
        return status;
    }
    if (job->format->movie->end != NULL) {
        job->format->movie->end(job->movie.stream);
    }
    TRY(record_file_commit(&job->movie, err));
    print_plainly(stdout, "%s\n", job->movie.path);
    return WEFT_OK;
}

static weft_status export_final(export_job *job, weft_error *err)
{
    char name[NAME], time[RECORD_RESULT_TEXT];
    double *velocity = job->values + 3 * job->n;
    job->surface.velocity = velocity;
    job->surface.strain = NULL;
    job->surface.doubles = true;
    /* the hash of triangles is that of an order which is not recorded */
    if (job->surface.faces.cols == 0 && job->cloth == NULL) {
        if (job->scene == NULL) {
            return weft_error_set(err, WEFT_IO,
                                  "%s/scene.yaml cannot be read: it is needed to check "
                                  "final.csv",
                                  job->directory);
        }
        TRY(weft_cloth_create(weft_scene_cloth(job->scene), &job->cloth, err));
    }
    TRY(record_final_read(job->directory, &job->surface.faces, job->cloth, job->values,
                          velocity, err));
    if (job->format->write != record_csv) { /* final.csv is there already */
        (void)record_result_get(job->directory, "time", time);
        TRY(write_parts(job, "final", strtod(time, NULL), err));
    }
    for (size_t part = 0; part <= job->shapes; ++part) {
        name_part(name, "final", part, job->format->suffix);
        print_plainly(stdout, "%s/%s\n", job->directory, name);
    }
    return WEFT_OK;
}

/* ---- which frames ----------------------------------------------------------- */

static int export_wanted(const arguments *given, export_job *job)
{
    weft_error err = { 0 };
    weft_status status = WEFT_OK;
    uint64_t hash;
    const bool all = export_own(given)->frame == NULL
                         ? job->format->movie != NULL
                         : strcmp(export_own(given)->frame, "all") == 0;
    const bool final = !all
                       && (export_own(given)->frame == NULL
                           || strcmp(export_own(given)->frame, "last") == 0);
    size_t number = 0;
    const bool named
        = all || final || option_count(export_own(given)->frame, '\0', &number);
    job->first = all ? 0 : job->count - 1;
    job->last = job->count - 1;
    if (!all && !final) {
        for (job->first = 0;
             job->first < job->count && number_of(job, job->first) != number;) {
            ++job->first;
        }
        job->last = job->first;
    }
    if (!named || job->first == job->count) {
        return usage_error(given, "--frame %s: last, all or one recorded of 0 to %zu",
                           export_own(given)->frame, number_of(job, job->count - 1));
    }
    if (job->format->movie != NULL) {
        /* a point cache holds one part, and all frames of it; a list the files of all
         */
        const size_t last = job->format->rest ? job->shapes : 0;
        for (size_t part = 0; status == WEFT_OK && part <= last; ++part) {
            status = export_part(job, part, &err);
        }
    } else if (final && record_exists(job->directory, "final.csv")
               && record_result_hash(job->directory, &hash)) {
        status = export_final(job, &err);
    } else {
        status = export_frames(job, &err);
    }
    return status == WEFT_OK ? EXIT_DONE : report_error(&err);
}

/* ---- sources of frames ------------------------------------------------------- */

static int open_recorded(export_job *job)
{
    weft_error err = { 0 };
    if (record_frames_open(job->directory, &job->frames, &err) != WEFT_OK) {
        return report_error(&err);
    }
    job->scene = record_scene(job->directory);
    if (job->scene == NULL) {
        print_plainly(
            stderr,
            "weft: warning: %s/scene.yaml cannot be read: shapes, if there are "
            "any, are left out\n",
            job->directory);
    }
    job->surface.faces = job->frames->faces;
    job->count = job->frames->count;
    return EXIT_DONE;
}

static int open_anew(const arguments *given, export_job *job)
{
    weft_error err = { 0 };
    const int code = open_run(job->directory, given, &job->scene);
    if (code != EXIT_DONE) {
        return code;
    }
    if (record_series_rows(job->directory, &job->series, &job->count, &err) != WEFT_OK
        || simulation_create(job->scene, NULL, &job->cloth, &job->sim, &err)
               != WEFT_OK) {
        return report_error(&err);
    }
    fprintf(stderr, "%s/run.vtkhdf is missing: frames are computed again\n",
            job->directory);
    const weft_status status = record_faces_of(job->cloth, &job->faces, &err);
    job->surface.faces = job->faces;
    return status == WEFT_OK ? EXIT_DONE : report_error(&err);
}

/* Room for one frame. */
static int make_surface(export_job *job)
{
    const record_frames *frames = job->frames;
    job->n = job->surface.faces.particles;
    job->values = malloc(7 * job->n * sizeof *job->values);
    const size_t points
        = job->scene == NULL ? 0 : record_shape_points(weft_scene_cloth(job->scene));
    job->shape_position = malloc((points + 1) * sizeof(double[3]));
    if (job->values == NULL || job->shape_position == NULL) {
        return report_status(WEFT_NO_MEMORY, "no memory for a frame");
    }
    job->surface.position = job->values;
    if (frames == NULL || frames->fields[WEFT_RECORD_VELOCITY]) {
        job->surface.velocity = job->values + 3 * job->n;
    }
    if (frames == NULL || frames->fields[WEFT_RECORD_STRAIN]) {
        job->surface.strain = job->values + 6 * job->n;
    }
    job->surface.doubles = frames == NULL || frames->doubles;
    if (job->scene != NULL && job->format->write != record_csv) {
        job->shapes = record_shape_count(weft_scene_cloth(job->scene));
    }
    weft_error err = { 0 };
    return !job->format->whole
                   || loose_create(job->scene, &job->surface.faces, &job->loose, &err)
                          == WEFT_OK
               ? EXIT_DONE
               : report_error(&err);
}

static int export_run(const arguments *given, export_job *job)
{
    int code = record_exists(job->directory, "run.vtkhdf") ? open_recorded(job)
                                                           : open_anew(given, job);
    code = code == EXIT_DONE ? make_surface(job) : code;
    code = code == EXIT_DONE ? export_wanted(given, job) : code;
    free(job->values);
    free(job->shape_position);
    free(job->series);
    loose_free(&job->loose);
    record_faces_free(&job->faces);
    record_frames_close(job->frames);
    weft_sim_destroy(job->sim);
    weft_cloth_destroy(job->cloth);
    weft_scene_destroy(job->scene);
    return code;
}

/* ---- the rest shape ---------------------------------------------------------- */

/* dress.obj, or dress-shirt.obj of one of several cloths. */
static void name_garment(char name[RECORD_PATH], const char *to, const char *cloth)
{
    const size_t length = strlen(to);
    const size_t stem
        = length > 4 && strcmp(to + length - 4, ".obj") == 0 ? length - 4 : length;
    if (cloth == NULL) {
        (void)snprintf(name, RECORD_PATH, "%s", to);
    } else {
        (void)snprintf(name, RECORD_PATH, "%.*s-%s%s", (int)stem, to, cloth, to + stem);
    }
}

/* The mesh of a scene, or of the scene of a run, as a new file. */
static int export_garment(const arguments *given)
{
    const char *operand = given->operands[0], *to = export_own(given)->garment;
    weft_scene *scene = NULL;
    weft_error err = { 0 };
    const int code = record_exists(operand, "scene.yaml")
                         ? open_run(operand, given, &scene)
                         : open_scene(operand, given, &scene, NULL);
    if (code != EXIT_DONE) {
        return code;
    }
    const weft_mesh_def *mesh = weft_scene_cloth(scene)->mesh;
    const size_t parts = mesh != NULL ? mesh->part_count : 0;
    weft_status status
        = mesh != NULL
              ? WEFT_OK
              : weft_error_set(&err, WEFT_BAD_SCENE,
                               "%.200s: a garment needs cloth.cut or cloth.mesh, not a "
                               "grid",
                               operand);
    for (size_t k = 0; status == WEFT_OK && k < (parts > 0 ? parts : 1); ++k) {
        char name[RECORD_PATH];
        if (mesh->grids != NULL && mesh->grids[k] != NULL) {
            continue; /* it has no pieces */
        }
        name_garment(name, to, parts > 0 ? mesh->parts[k].name : NULL);
        status = record_exists(NULL, name)
                     ? weft_error_set(&err, WEFT_IO, "%.200s: the file exists", name)
                     : record_mesh(NULL, name, scene, k, &err);
        if (status == WEFT_OK) {
            print_plainly(stdout, "%s\n", name);
        }
    }
    weft_scene_destroy(scene);
    return status == WEFT_OK ? EXIT_DONE : report_error(&err);
}

static int export_verb(const arguments *given)
{
    export_job job = { .directory = given->operands[0] };
    const char *names[FORMATS + 1] = { NULL };
    size_t format;
    if (export_own(given)->garment != NULL
        && (export_own(given)->format != NULL || export_own(given)->frame != NULL)) {
        return usage_error(given, "--garment excludes --format and --frame");
    }
    if (export_own(given)->garment != NULL) {
        return export_garment(given);
    }
    if (export_own(given)->format == NULL) {
        return usage_error(given,
                           "--format obj, ply, csv, mdd, pc2 or pvd is needed, or "
                           "--garment FILE.obj");
    }
    for (size_t i = 0; i < FORMATS; ++i) {
        names[i] = formats[i].name;
    }
    if (choose(given, "format", export_own(given)->format, names, &format)
        != EXIT_DONE) {
        return EXIT_USAGE;
    }
    job.format = &formats[format];
    if (job.format->movie != NULL && export_own(given)->frame != NULL
        && strcmp(export_own(given)->frame, "all") != 0) {
        return usage_error(given, "--frame %s: %s holds all frames",
                           export_own(given)->frame, job.format->name);
    }
    report_unfinished(job.directory);
    return export_run(given, &job);
}

static const verb_option options[] = {
    OWN(export_options, format, "format", "obj",
        "Wavefront OBJ: faces, texture coordinates\n"
        "           ply         the same, binary\n"
        "           csv         row,col,x,y,z,vx,vy,vz (of a mesh: vertex,x,...)\n"
        "           mdd, pc2    all frames in run.mdd or run.pc2, with rest.obj: for "
        "Blender's Mesh Cache, with all axes as Blender has them (y points up here)\n"
        "           pvd         all frames as VTP files and run.pvd, for ParaView "
        "before 5.12; later versions open run.vtkhdf"),
    OWN(export_options, frame, "frame", "last|all|N",
        "for obj, ply and csv; default: last, to DIR/final.obj; others to "
        "DIR/frames/frame-000012.obj"),
    OWN(export_options, garment, "garment", "FILE.obj",
        "the mesh instead of frames: where vertices start (v), the rest shape (vt), "
        "faces and groups, for Blender and for cloth.mesh; that of cloth.cut, or a "
        "copy of the file of cloth.mesh; of several cloths a file for each, "
        "FILE-NAME.obj"),
    SHARED(sets, "set", "KEY=VALUE", "of the scene of --garment"),
    OPTION_PLUGIN_PATH,
};

const verb verb_export = {
    .name = "export",
    .summary = "write frames of a run for other programs",
    .help = "usage: weft export DIR --format FORMAT [OPTIONS]\n"
            "       weft export DIR|SCENE --garment FILE.obj [OPTIONS]\n"
            "\n"
            "Writes frames of a run into its directory and prints the names of the "
            "files. Shapes of contact go to files of their own (final-shape-0.obj, "
            "...), but not as csv.\n",
    OPTIONS(options),
    .own_size = sizeof(export_options),
    .more = "Frames come from DIR/run.vtkhdf, the last state from DIR/final.csv. If "
            "run.vtkhdf is missing, the frames are computed again from DIR/scene.yaml "
            "and must match the hash in series.csv.\n"
            "\n"
            "example: weft export flag --format obj --frame all\n",
    .operands
    = { 1, 1, "needs the directory of one run, or a scene for --garment", NULL },
    .run = export_verb,
};
