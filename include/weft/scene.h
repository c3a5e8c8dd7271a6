/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/scene.h -- reads a scene file into definition structs for cloth, stepper and
 * run.
 *
 * docs/reference/scene.md lists every key. A scene that loads without errors is
 * complete: all values are present and in range. */
#ifndef WEFT_SCENE_H
#define WEFT_SCENE_H

#include "weft/sim.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct weft_scene weft_scene;

/* Data that a run may record for each particle beside its position. */
typedef enum weft_record_field {
    WEFT_RECORD_VELOCITY,
    WEFT_RECORD_STRAIN, /* largest (L - s) / s of its springs */
    WEFT_RECORD_PINNED,
    WEFT_RECORD_FIELDS /* their number */
} weft_record_field;

/* The contents of run.vtkhdf and series.csv, and whether there is a final.csv. */
typedef struct weft_record_def {
    bool doubles; /* else single precision */
    bool fields[WEFT_RECORD_FIELDS];
    size_t every; /* >= 1: every n-th frame, and always the first and the last */
    bool ledger;  /* the energy ledger: weft_sim_def.ledger */
    bool final;   /* the state at the end, as text */
} weft_record_def;

/* The numbers by which a run is differentiated: `sensitivity` of the scene. Fixed for
 * ever. */
typedef struct weft_scene_sensitivity {
    size_t count; /* 0: none */
    const char
        *keys[WEFT_SENSITIVITIES]; /* "forces.gravity.1", as overrides write it */
    const char
        *before[WEFT_SENSITIVITIES];   /* of a default, an override that must come
                                          before one of the key: "forces.gravity=[0,
                                          -9.81, 0]"; NULL: none */
    double values[WEFT_SENSITIVITIES]; /* p */
    bool relative;                     /* results are p dy/dp, else dy/dp */
    bool control;                      /* weft_sensitivity_def */
} weft_scene_sensitivity;

/* One error or one warning. Fixed for ever. */
typedef struct weft_diagnostic {
    bool warning;
    int line, column; /* from 1; 0, 0: place unknown */
    char place[256];  /* the file, or "override run.fps" */
    char message[384];
    char source[256]; /* the line of text that contains it */
    int caret;        /* column of source to point at, from 1; 0: none */
} weft_diagnostic;

#define WEFT_DIAGNOSTICS_MAX 20

/* All diagnostics, in the order of the file. Owned by the caller; its size is constant,
 * and nothing in it is allocated. Fixed for ever. */
typedef struct weft_diagnostics {
    size_t count;  /* number of items filled */
    size_t errors; /* total, also beyond WEFT_DIAGNOSTICS_MAX */
    size_t warnings;
    weft_diagnostic items[WEFT_DIAGNOSTICS_MAX];
} weft_diagnostics;

/* Writes `file:line:column: error: message`, the source line and a caret to text[size];
 * returns the length as snprintf does. */
WEFT_API int weft_diagnostic_format(const weft_diagnostic *diagnostic, char *text,
                                    size_t size);

/* A flat piece of cloth that is to be meshed, in the plane (u, v). Fixed for ever. */
typedef struct weft_cut {
    const double *points; /* [m] u v of each */
    size_t point_count;
    const uint32_t *lines; /* the two points of each line that edges must run along;
                              none crosses another */
    size_t line_count, border_count; /* the first border_count bound the piece */
    double spacing;                  /* [m] length of edge aimed at */
    uint64_t seed;                   /* of the points inside */
    const weft_allocator *memory;    /* of the arrays that are made */
} weft_cut;

/* Vertices: those on the lines, in their order, then those inside by rows. Fixed for
 * ever. */
typedef struct weft_cut_mesh {
    size_t vertices, triangles, edges;
    double *uv;         /* [m] u v of each vertex */
    uint32_t *corners;  /* 3 of each triangle, counterclockwise */
    uint32_t *edge;     /* on the lines: its two vertices and the line */
    double least_angle; /* [degrees] of all corners but those of the border itself */
    double least_at[2]; /* [m] where */
} weft_cut_mesh;

typedef struct weft_scene_def {
    uint32_t struct_size;
    const char *file; /* regular file to read, or the name of `text` in messages */
    const char *text; /* scene text in memory; NULL: read `file` */
    size_t length;    /* of text */
    const char *const *sets; /* set_count overrides "key.path=value" */
    size_t set_count;

    /* Finds the plugin named by stepper.plugin, so that the method and keys without use
     * are checked and reported at their place. NULL: not checked. */
    const weft_plugin *(*find_plugin)(void *ctx, const char *id, weft_error *err);
    void *find_ctx;

    /* NULL: malloc's. libyaml's reading and writing, and a weft_sweep itself, always
     * use malloc. */
    const weft_allocator *allocator;

    size_t bands; /* of the cloth (weft/comm.h): what does not run in so many bands is a
                     mistake. 0 or 1: the cloth is whole */

    /* Meshes cloth.cut; the same cut gives the same mesh. NULL: a scene with a cut is a
     * mistake, unless its scene.obj is beside it (weft_scene_mesh_file). */
    weft_status (*mesh_cut)(void *ctx, const weft_cut *cut, weft_cut_mesh *out,
                            weft_error *err);
    void *mesh_ctx;
    size_t
        refine; /* > 1: spacings of a cut are divided by it, and the sides of triangles
                   of a file, whose vertices keep their numbers; a power of 2 then */
    weft_log log;       /* of the scene's weft_cloth_def, with the two below */
    weft_stop_fn *stop; /* also asked where the scene's cloth is checked; NULL: none */
    void *stop_ctx;
} weft_scene_def;

WEFT_DEFAULT(weft_scene_def)

/* Reads, checks and resolves a scene. Errors: WEFT_BAD_SCENE (found->errors > 0),
 * WEFT_IO (the file could not be read), WEFT_STOPPED, WEFT_NO_MEMORY; then *out is
 * NULL. A scene that loads may have warnings. `found` must not be NULL. */
WEFT_API weft_status weft_scene_load(const weft_scene_def *def, weft_scene **out,
                                     weft_diagnostics *found, weft_error *err);
WEFT_API void weft_scene_destroy(weft_scene *scene); /* NULL is allowed */

WEFT_API const char *weft_scene_name(const weft_scene *scene);
WEFT_API const weft_cloth_def *weft_scene_cloth(const weft_scene *scene);
/* The fabric that the cloth was made of; NULL: it was defined by its springs. */
WEFT_API const weft_fabric *weft_scene_fabric(const weft_scene *scene);
WEFT_API const weft_limit_def *weft_scene_limit(const weft_scene *scene);
WEFT_API const weft_run_def *weft_scene_run(const weft_scene *scene);
WEFT_API const weft_record_def *weft_scene_record(const weft_scene *scene);
WEFT_API const weft_scene_sensitivity *
weft_scene_sensitivities(const weft_scene *scene);
WEFT_API const char *weft_scene_plugin(const weft_scene *scene);
WEFT_API const char *weft_scene_method(const weft_scene *scene);
/* NULL if the scene was loaded without find_plugin, or if it has a Butcher table whose
 * plugin was not found. */
WEFT_API const weft_stepper_type *weft_scene_method_type(const weft_scene *scene);
/* Its fixed_step is weft_run_step of the scene's own, which weft_scene_step returns
 * [s]; 0: none. */
WEFT_API const weft_stepper_config *weft_scene_config(const weft_scene *scene);
WEFT_API double weft_scene_step(const weft_scene *scene);

/* How many vertices of the OBJ file of the cloth, or of cloth k of several, belong to
 * no face, so that the cloth does not have them. Unless NULL, *numbers are theirs in
 * the file, from 0 and in rising order, and *places where they lie beside its start
 * [m], x y z of each. */
WEFT_API size_t weft_scene_loose(const weft_scene *scene, size_t k,
                                 const size_t **numbers, const double **places);

/* The OBJ file that the cloth, or the first of several, was read from; NULL: it has
 * none. A scene.yaml that has a
 * scene.obj beside it takes its mesh from there, whatever its name in the scene. */
WEFT_API const char *weft_scene_mesh_file(const weft_scene *scene);
/* The mesh of cloth.cut as the text of an OBJ file; NULL: the cloth is no cut, or was
 * read from a file. */
WEFT_API const char *weft_scene_mesh_text(const weft_scene *scene);

/* The same of cloth k of several, whose copies are scene-0.obj, scene-1.obj, ... */
WEFT_API const char *weft_scene_part_file(const weft_scene *scene, size_t k);
WEFT_API const char *weft_scene_part_text(const weft_scene *scene, size_t k);

/* File i = 0, 1, ... of all that triangles of shapes were read from, and to copy[size]
 * the name of its copy: a scene.yaml that has copies beside it reads these. NULL: there
 * are no more. */
WEFT_API const char *weft_scene_body_file(const weft_scene *scene, size_t i, char *copy,
                                          size_t size);

/* Whether weft made the triangles of shape k: it was a sphere, capsule or box. */
WEFT_API bool weft_scene_shape_made(const weft_scene *scene, size_t k);

/* What weft_sim_create said of the scene's method, at its place in the scene. */
WEFT_API void weft_scene_refusal(const weft_scene *scene, const weft_error *why,
                                 weft_diagnostic *out);

/* The scene as it runs: the text that was read, or, with overrides, the same document
 * written again with them applied. It includes the default name, if that came from the
 * file's name. */
WEFT_API const char *weft_scene_text(const weft_scene *scene);

/* The cloths with less and more of each number by which a scene is differentiated, for
 * weft_sim_def: p (1 -+ 2^-22), of a p that is 0 -+ 2^-22, in the number's unit; the
 * scene's own p where a value is out of range. u of weft_parameter is p, or 1
 * where that is 0. `def`: find_plugin, mesh_cut, refine and allocator of it are used,
 * as the scene was loaded. */
typedef struct weft_scene_perturbed weft_scene_perturbed;
WEFT_API weft_status weft_scene_perturbed_create(const weft_scene *scene,
                                                 const weft_scene_def *def,
                                                 weft_scene_perturbed **out,
                                                 weft_error *err);
WEFT_API void
weft_scene_perturbed_destroy(weft_scene_perturbed *twins); /* NULL is allowed */
/* NULL: the scene has no `sensitivity`. */
WEFT_API const weft_sensitivity_def *
weft_scene_perturbed_def(const weft_scene_perturbed *twins);

/* A scene file with `sweep`: {key.path: [value, ...], ...} describes many runs: every
 * combination of the values, the last key varying fastest, or, with zip: true, one run
 * for each position in the lists. A scene without it is a sweep of one run and no keys.
 * weft_scene_load treats a sweep as a mistake. */
typedef struct weft_sweep weft_sweep;

/* Reads and checks every run; a diagnostic says so if it concerns only some runs.
 * Errors and `found` as for weft_scene_load. def->sets, and the data that find_plugin
 * uses, must outlive the sweep. */
WEFT_API weft_status weft_sweep_load(const weft_scene_def *def, weft_sweep **out,
                                     weft_diagnostics *found, weft_error *err);
WEFT_API void weft_sweep_destroy(weft_sweep *sweep); /* NULL is allowed */

WEFT_API size_t weft_sweep_runs(const weft_sweep *sweep); /* 1 to 100000 */
WEFT_API size_t weft_sweep_keys(const weft_sweep *sweep);
/* The path of key 0, 1, ..., and its value in run 1, 2, ... on one line. */
WEFT_API const char *weft_sweep_key(const weft_sweep *sweep, size_t key);
WEFT_API const char *weft_sweep_value(const weft_sweep *sweep, size_t key, size_t run);
/* The scene of run 1, 2, ...; its text has the values of the run and no sweep. Errors:
 * WEFT_INVALID, WEFT_NO_MEMORY. */
WEFT_API weft_status weft_sweep_scene(const weft_sweep *sweep, size_t run,
                                      weft_scene **out, weft_error *err);

typedef enum weft_scene_help_format {
    WEFT_HELP_TEXT,
    WEFT_HELP_MARKDOWN
} weft_scene_help_format;

/* Passes every key with type, unit, default and meaning to `line`, one line at a time.
 */
WEFT_API void weft_scene_help(weft_scene_help_format format,
                              void (*line)(void *ctx, const char *text), void *ctx);

/* The same for one key, as text: "stepper.rtol", or "cloth.pins" with the keys below
 * it. WEFT_INVALID: there is no such key. */
WEFT_API weft_status weft_scene_help_key(const char *path,
                                         void (*line)(void *ctx, const char *text),
                                         void *ctx, weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
