/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/scene.h -- reads a scene file into definition structs for cloth, integrator and
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
    bool ledger;  /* the energy balance: weft_sim_def.ledger */
    bool final;   /* the state at the end, as text */
} weft_record_def;

/* The parameters of a run's sensitivities: `sensitivity` of the scene. Fixed for ever.
 */
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

/** Writes a diagnostic as `file:line:column: error: message`, with the line of the
 * source and a caret under its column.
 * @param diagnostic one of weft_diagnostics.items
 * @param[out] text receives the lines, as snprintf writes
 * @param size [bytes] of text
 * @return the length of the whole text, as snprintf returns it
 * @par Example
 * @snippet scene.c load */
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

/* A scene to be read, and what reading it needs. */
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
                     error. 0 or 1: the cloth is whole */

    /* Meshes cloth.cut; the same cut gives the same mesh. NULL: a scene with a cut is
     * an error, unless its scene.obj is beside it (weft_scene_mesh_file). */
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

/** Returns a definition without a file: set file or text. It checks no method, as
 * find_plugin is NULL.
 * @return the defaults, with struct_size set
 * @par Example
 * @snippet scene.c load */
WEFT_DEFAULT(weft_scene_def)

/** Reads, checks and resolves a scene. A scene that loads may have warnings.
 * @param def a file or a text, overrides, and how plugins are found
 * @param[out] out the scene, for weft_scene_destroy; NULL on failure
 * @param[out] found all errors and warnings, in the order of the file; may not be NULL
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_BAD_SCENE (found->errors > 0), WEFT_IO (the file could not be
 *   read), WEFT_STOPPED, WEFT_INVALID (the definition is of a later version),
 *   WEFT_NO_MEMORY
 * @par Example
 * @snippet scene.c load */
WEFT_API weft_status weft_scene_load(const weft_scene_def *def, weft_scene **out,
                                     weft_diagnostics *found, weft_error *err);

/** Destroys a scene, and with it all that the functions below return.
 * @param scene may be NULL */
WEFT_API void weft_scene_destroy(weft_scene *scene);

/** Returns the name of the scene: its key `name`, or the name of its file.
 * @param scene the scene
 * @return text, valid as long as the scene, as is what the functions below return */
WEFT_API const char *weft_scene_name(const weft_scene *scene);

/** Returns the cloth's definition.
 * @param scene the scene
 * @return for weft_cloth_create
 * @par Example
 * @snippet scene.c play */
WEFT_API const weft_cloth_def *weft_scene_cloth(const weft_scene *scene);

/** Returns the fabric that the cloth was made of.
 * @param scene the scene
 * @return NULL: the cloth was defined by its springs */
WEFT_API const weft_fabric *weft_scene_fabric(const weft_scene *scene);

/** Returns the strain limit.
 * @param scene the scene
 * @return for weft_sim_def.limit
 * @par Example
 * @snippet scene.c play */
WEFT_API const weft_limit_def *weft_scene_limit(const weft_scene *scene);

/** Returns duration, frames, threads, checkpoints and the end of the run.
 * @param scene the scene
 * @return for weft_play.run
 * @par Example
 * @snippet scene.c frames */
WEFT_API const weft_run_def *weft_scene_run(const weft_scene *scene);

/** Returns what the run records.
 * @param scene the scene
 * @return valid as long as the scene */
WEFT_API const weft_record_def *weft_scene_record(const weft_scene *scene);

/** Returns the parameters with respect to which a run is differentiated.
 * @param scene the scene
 * @return count 0: none */
WEFT_API const weft_scene_sensitivity *
weft_scene_sensitivities(const weft_scene *scene);

/** Returns the id of the plugin, `stepper.plugin`.
 * @param scene the scene
 * @return text, such as "gsl" */
WEFT_API const char *weft_scene_plugin(const weft_scene *scene);

/** Returns the name of the method, `stepper.method`.
 * @param scene the scene
 * @return text, such as "rkf45" */
WEFT_API const char *weft_scene_method(const weft_scene *scene);

/** Returns the method.
 * @param scene the scene
 * @return for weft_sim_def.method; NULL if the scene was loaded without find_plugin, or
 *   if it has a Butcher table whose plugin was not found
 * @par Example
 * @snippet scene.c play */
WEFT_API const weft_stepper_type *weft_scene_method_type(const weft_scene *scene);

/** Returns the settings of the method. A fixed step is weft_run_step of the scene's
 * own.
 * @param scene the scene
 * @return for weft_sim_def.config
 * @par Example
 * @snippet scene.c play */
WEFT_API const weft_stepper_config *weft_scene_config(const weft_scene *scene);

/** Returns the fixed step as the scene has it.
 * @param scene the scene
 * @return [s]; 0: none */
WEFT_API double weft_scene_step(const weft_scene *scene);

/** Counts the vertices of the OBJ file of a cloth that belong to no face, so that the
 * cloth does not have them.
 * @param scene the scene
 * @param k 0, or the index of one of several cloths
 * @param[out] numbers their indices in the file, from 0 and in rising order; may be
 *   NULL
 * @param[out] places [m] where they lie beside the cloth's start: x y z of each; may be
 *   NULL
 * @return their number */
WEFT_API size_t weft_scene_loose(const weft_scene *scene, size_t k,
                                 const size_t **numbers, const double **places);

/** Returns a line about a choice that reading the scene made, which `weft check`
 * prints: how many vertices `weld` joined, which plane is the rest shape of a file
 * without vt.
 * @param scene the scene
 * @param i 0, 1, ...
 * @param[out] about the thing that the line is about, such as "weld"; NULL: no line
 * @return the line, with the name of its cloth if there are several; NULL: there are
 *   fewer lines */
WEFT_API const char *weft_scene_note(const weft_scene *scene, size_t i,
                                     const char **about);

/** Returns the OBJ file that the cloth, or the first of several, was read from. A
 * scene.yaml that has a scene.obj beside it takes its mesh from there, whatever its
 * name in the scene.
 * @param scene the scene
 * @return a path; NULL: there is none */
WEFT_API const char *weft_scene_mesh_file(const weft_scene *scene);

/** Returns the mesh of `cloth.cut` as the text of an OBJ file.
 * @param scene the scene
 * @return text; NULL: the cloth is no cut, or was read from a file */
WEFT_API const char *weft_scene_mesh_text(const weft_scene *scene);

/** Returns the OBJ file of one of several cloths, whose copies are scene-0.obj,
 * scene-1.obj, ...
 * @param scene the scene
 * @param k the index of the cloth
 * @return a path; NULL: there is none */
WEFT_API const char *weft_scene_part_file(const weft_scene *scene, size_t k);

/** Returns the mesh of a `cut` of one of several cloths as the text of an OBJ file.
 * @param scene the scene
 * @param k the index of the cloth
 * @return text; NULL: it is no cut, or was read from a file */
WEFT_API const char *weft_scene_part_text(const weft_scene *scene, size_t k);

/** Lists the files that mesh colliders were read from. A scene.yaml that has copies of
 * these names beside it reads the copies.
 * @param scene the scene
 * @param i 0, 1, ...
 * @param[out] copy the name of the file's copy
 * @param size [bytes] of copy
 * @return a path; NULL: there are no more */
WEFT_API const char *weft_scene_body_file(const weft_scene *scene, size_t i, char *copy,
                                          size_t size);

/** Returns whether weft made the triangles of a collider, which was a sphere, capsule
 * or box.
 * @param scene the scene
 * @param k the index of the collider
 * @return whether it did */
WEFT_API bool weft_scene_shape_made(const weft_scene *scene, size_t k);

/** Locates in the scene what weft_sim_create reported of its method.
 * @param scene the scene
 * @param why the error of weft_sim_create
 * @param[out] out the diagnostic, for weft_diagnostic_format */
WEFT_API void weft_scene_refusal(const weft_scene *scene, const weft_error *why,
                                 weft_diagnostic *out);

/** Returns the scene as it runs: the text that was read, or, with overrides, the same
 * document written again with them applied. It includes the default name, if that came
 * from the file's name.
 * @param scene the scene
 * @return YAML */
WEFT_API const char *weft_scene_text(const weft_scene *scene);

/* The perturbed copies of a scene's cloth: with less and more of each parameter of its
 * `sensitivity`, for weft_sim_def. */
typedef struct weft_scene_perturbed weft_scene_perturbed;

/** Creates, for each parameter of the scene's `sensitivity`, the cloths with less and
 * more of it: p (1 -+ 2^-22), for p = 0 -+ 2^-22 in the parameter's unit, the scene's
 * own p where a value is out of range. u of weft_parameter is p, or 1 where that is 0.
 * @param scene the scene
 * @param def find_plugin, mesh_cut, refine and allocator of it are used, as the scene
 *   was loaded
 * @param[out] out the cloths, for weft_scene_perturbed_destroy; NULL on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_BAD_SCENE (a perturbed value makes no cloth), WEFT_STOPPED,
 *   WEFT_NO_MEMORY, and what weft_cloth_create returns */
WEFT_API weft_status weft_scene_perturbed_create(const weft_scene *scene,
                                                 const weft_scene_def *def,
                                                 weft_scene_perturbed **out,
                                                 weft_error *err);

/** Destroys the cloths, after the simulations that use them.
 * @param perturbed may be NULL */
WEFT_API void weft_scene_perturbed_destroy(weft_scene_perturbed *perturbed);

/** Returns the definition with these cloths.
 * @param perturbed the cloths
 * @return for weft_sim_def.sensitivity; NULL: the scene has no `sensitivity` */
WEFT_API const weft_sensitivity_def *
weft_scene_perturbed_def(const weft_scene_perturbed *perturbed);

/* A scene file with `sweep`: {key.path: [value, ...], ...} describes many runs: every
 * combination of the values, the last key varying fastest, or, with zip: true, one run
 * for each position in the lists. A scene without it is a sweep of one run and no keys.
 * weft_scene_load treats a sweep as an error. */
typedef struct weft_sweep weft_sweep;

/** Reads and checks every run of a scene with `sweep`; a diagnostic reports if it
 * concerns only some runs.
 * @param def as of weft_scene_load; its sets, and the data that find_plugin uses, must
 *   outlive the sweep
 * @param[out] out the sweep, for weft_sweep_destroy; NULL on failure
 * @param[out] found as of weft_scene_load
 * @param[out] err may be NULL
 * @return as weft_scene_load: WEFT_OK; WEFT_BAD_SCENE, WEFT_IO, WEFT_STOPPED,
 *   WEFT_INVALID, WEFT_NO_MEMORY */
WEFT_API weft_status weft_sweep_load(const weft_scene_def *def, weft_sweep **out,
                                     weft_diagnostics *found, weft_error *err);

/** Destroys a sweep; scenes of its runs stay.
 * @param sweep may be NULL */
WEFT_API void weft_sweep_destroy(weft_sweep *sweep);

/** Counts the runs.
 * @param sweep the sweep
 * @return 1 to 100000 */
WEFT_API size_t weft_sweep_runs(const weft_sweep *sweep);

/** Counts the keys whose values change.
 * @param sweep the sweep
 * @return their number; 0 of a scene without `sweep` */
WEFT_API size_t weft_sweep_keys(const weft_sweep *sweep);

/** Returns a key.
 * @param sweep the sweep
 * @param key 0, 1, ...
 * @return its path, such as "cloth.density" */
WEFT_API const char *weft_sweep_key(const weft_sweep *sweep, size_t key);

/** Returns the value of a key in a run.
 * @param sweep the sweep
 * @param key 0, 1, ...
 * @param run 1, 2, ...
 * @return YAML, on one line */
WEFT_API const char *weft_sweep_value(const weft_sweep *sweep, size_t key, size_t run);

/** Makes the scene of a run; its text has the values of the run and no sweep.
 * @param sweep the sweep
 * @param run 1, 2, ...
 * @param[out] out the scene, for weft_scene_destroy; NULL on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (no such run), WEFT_NO_MEMORY */
WEFT_API weft_status weft_sweep_scene(const weft_sweep *sweep, size_t run,
                                      weft_scene **out, weft_error *err);

typedef enum weft_scene_help_format {
    WEFT_HELP_TEXT,
    WEFT_HELP_MARKDOWN
} weft_scene_help_format;

/** Describes every key of a scene, with type, unit, default and meaning.
 * @param format text or Markdown
 * @param line called with each line, in order
 * @param ctx passed to line */
WEFT_API void weft_scene_help(weft_scene_help_format format,
                              void (*line)(void *ctx, const char *text), void *ctx);

/** Describes one key of a scene, with the keys below it, as text.
 * @param path such as "stepper.rtol" or "cloth.pins"
 * @param line called with each line, in order
 * @param ctx passed to line
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID: there is no such key */
WEFT_API weft_status weft_scene_help_key(const char *path,
                                         void (*line)(void *ctx, const char *text),
                                         void *ctx, weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
