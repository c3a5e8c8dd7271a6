/* SPDX-License-Identifier: BSD-3-Clause */
/* read.h -- a tree read by the table of keys into a scene. */
#pragma once

#include "scene/keys.h"
#include "scene/obj.h"
#include "scene/tree.h"

/* ---- sweep.c: `sweep`, one scene file that stands for many runs ---- */

#define WEFT__SWEEP_KEYS 16

/* A key that is varied, and the list of its values. */
typedef struct weft__axis {
    const weft__node *key, *list;
    bool log; /* a sample has them in ratios */
} weft__axis;

typedef struct weft__sweep {
    bool present, zip;
    weft__mark at;         /* of its key */
    size_t keys, runs;     /* runs 1 without a sweep, 0 if something is wrong with it */
    size_t sample, seed;   /* how many values are drawn of each list; 0: its own */
    const weft__node *log; /* names of keys; NULL: none */
    weft__axis axis[WEFT__SWEEP_KEYS];
} weft__sweep;

/* Finds and checks the sweep of a tree whose root is a mapping, and takes it out of
 * there. Keys that one of set_count overrides sets as well are mistakes, and so are so
 * many runs that reading them all would take more than half a minute. */
void weft__sweep_take(weft__tree *tree, size_t set_count, weft__sweep *out);

/* sample.c: reports mistakes of `sample` and `log`; draws the values if they are asked
 * for, so that the sweep is one of zipped lists. */
void weft__sweep_sample(weft__tree *tree, weft__sweep *sweep);

/* Whether it varies the key at a path, or a part of its value. */
bool weft__sweep_varies(const weft__sweep *sweep, const char *path);

/* Which value of a list a run takes; the last key varies fastest. */
size_t weft__sweep_choice(const weft__sweep *sweep, size_t axis, size_t run);

/* Puts the values of one run, from 1, into its tree. */
void weft__sweep_apply(weft__tree *to, const weft__sweep *sweep, size_t run);

/* ---- what a scene is read into ---- */

typedef struct weft__place {
    weft_range rows, cols;
} weft__place;

/* A list of numbers; a matrix has side rows of side. */
typedef struct weft__list {
    double *values;
    size_t count; /* 0: absent or wrong */
    size_t side;
} weft__list;

typedef struct weft__tableau {
    weft__list a, b, c, b_embedded;
    weft_butcher set;
} weft__tableau;

/* A controller and the list its gains are read into. */
typedef struct weft__control {
    weft_controller set;
    weft__list gains;
} weft__control;

/* A rotation about an axis, which comes first, as in weft_turn. */
typedef struct weft__turn {
    double axis[3];
    double angle; /* [degrees] */
} weft__turn;

/* cloth.mesh */
typedef struct weft__mesh_file {
    char *file;
    double unit;  /* [m] */
    double at[3]; /* [m] */
    weft__turn turn;
} weft__mesh_file;

/* An item of contact.shapes; a mesh has a file. */
typedef struct weft__shape_item {
    weft_shape shape;
    char *file;
    double unit, fps; /* [m], [1/s] */
    double facets;    /* [m] the longest edge of triangles; 0: none, -1: by default */
} weft__shape_item;

/* The files of a body, for copies. */
#define WEFT__BODY_COPY "scene-shape%zu"
typedef struct weft__body_files {
    size_t shape, count;
    bool keyed;
    char **paths;
    struct weft__body_files *next;
} weft__body_files;

/* cloth.fabrics: list[0] is `fabric`, the others as the node has them. */
typedef struct weft__fabrics {
    weft_fabric *list;
    const weft__node *node; /* NULL: none */
} weft__fabrics;

/* A sheet of a laboratory in its own units, warp and weft. */
enum { WEFT__KES, WEFT__FAST };
typedef struct weft__sheet {
    double weight, extension[2], shear[2], bend[2], unused[2];
} weft__sheet;

/* A line of cloth.cut, through points or around a disc. */
typedef struct weft__cut_path {
    double radius, centre[2]; /* [m] of a disc; radius 0: none */
    const weft__node *node;
    double (*points)[2]; /* [m] in order, of a closed one counterclockwise */
    size_t count;
    bool closed, reversed; /* the points of the node come from its end but the first */
} weft__cut_path;

typedef struct weft__cut_paths {
    weft__cut_path *list;
    size_t count;
} weft__cut_paths;

/* cloth.cut */
typedef struct weft__cut {
    weft_cloth_def grid; /* spacing and where it lies, as of a grid */
    weft__cut_paths outline, holes, lines;
    size_t seed;
} weft__cut;

/* What the mesher gets of them, and the path of each line: the outline, holes, lines.
 */
typedef struct weft__cut_lines {
    double *points;
    uint32_t *lines, *path;
    size_t point_count, line_count, border_count;
} weft__cut_lines;

/* Vertices of a mesh, as a pin and a load have them. */
typedef struct weft__vertices {
    const size_t *list;
    size_t count;
} weft__vertices;

/* Its tree owns the arrays and texts that the definition structs point to. Fields whose
 * key is absent or wrong stay 0. */
struct weft_scene {
    weft_allocator memory;
    weft__tree tree;
    char *name, *text, *file, *plugin, *method;
    size_t version;
    weft_cloth_def cloth;
    weft_fabric fabric; /* density 0: none */
    weft__mesh_file mesh_file;
    weft__cut cut;
    const char *mesh_path; /* of the file that was read; NULL: none */
    weft__body_files *body_files;
    weft__fabrics fabrics;
    weft__obj obj;   /* what cloth.mesh points to */
    bool renumbered; /* vertices have other numbers than in the scene as it is */
    bool meshed;     /* the cloth is no grid, whether its mesh could be read or not */
    struct weft_scene *parts; /* several cloths, each read as if it were the only one */
    size_t part_count;
    size_t part; /* of such a one: its number, from 1 */
    char *part_name;
    size_t mistakes; /* reported before it was read */
    weft_limit_def limit;
    weft_run_def run;
    weft_record_def record;
    weft_scene_sensitivity sensitivity;
    weft_stepper_config config;
    double step; /* [s] fixed_step as given */
    const weft_stepper_type *type;
    weft__tableau tableau;
    weft__control control;
    weft_linear solver;
    bool large_matrices;     /* are allowed */
    weft_diagnostic refusal; /* at stepper.method, without a message */
};

/* 0: the grid or the mesh is wrong. */
static inline size_t weft__particles_in(const weft_scene *scene)
{
    const weft_cloth_def *cloth = &scene->cloth;
    return cloth->mesh != NULL ? cloth->mesh->vertices : cloth->rows * cloth->cols;
}

typedef struct weft__reader {
    weft_scene *scene;
    weft__tree *tree;
    weft__report *report; /* of the tree */
    const weft_scene_def *def;
    const weft__section *root;
    weft__read_fn *const *readers; /* by kind */
    size_t shape;                  /* number of the one that is read */
} weft__reader;

/* The source of scenes: a text, and its tree with the overrides applied. */
typedef struct weft__base {
    weft_scene_def def;
    weft_allocator memory;
    char *text;
    size_t length;
    weft__source *sources; /* the file, then the overrides */
    weft__tree tree;
    weft__sweep sweep;
    bool readable; /* the tree may be read as a scene */
    bool changed;  /* it is not what the text says */
} weft__base;

/* Mistakes are added to the report, which shares the base's allocator; the caller must
 * end it before closing the base. The base must be closed also after an error.
 * Errors: WEFT_INVALID, WEFT_IO, WEFT_NO_MEMORY. */
weft_status weft__base_open(const weft_scene_def *given, weft__base *out,
                            weft__report *report, weft_error *err);
void weft__base_close(weft__base *base);

/* Reads the scene of a run, from 1. WEFT_BAD_SCENE, also if the report had mistakes
 * before. */
weft_status weft__base_read(const weft__base *base, size_t run, weft__report *report,
                            weft_scene **out, weft_error *err);

/* A key of a section in a mapping. */
typedef struct weft__found {
    const weft__node *key, *value; /* NULL: absent */
    bool wrong;                    /* the value was refused, or a part of it */
    bool explained; /* absent, and a mistake that was reported may be the reason */
} weft__found;

/* A mapping and which of its section's keys it has. `faults` reports one of a field at
 * its key's value, or, if that is a default, at the value of the other one, unless a
 * value was refused before. */
typedef struct weft__match {
    weft__reader *reader;
    weft__faults faults;
    const weft__section *section;
    const char *title;
    const weft__node *map;
    weft__found found[WEFT__MAX_KEYS]; /* in the order of the section's keys */
    bool wrong;                        /* one of them is */
} weft__match;

/* Read a mapping by its section into base; NULL: the section is absent, and only its
 * defaults are put in place. */
void weft__read_section(weft__reader *reader, const weft__section *section,
                        const char *title, const weft__node *node, void *base);

/* Read the value of a key into base. */
void weft__read_value(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *base);

/* The text of a default as a value, in *plain or of the tree; NULL: no memory. */
const weft__node *weft__fallback_node(weft__tree *tree, const char *text,
                                      weft__node *plain);

/* A key by its name, which must be one of the section's. */
const weft__found *weft__found_in(const weft__match *match, const char *name);

/* Its node, and its value; NULL: it is absent. */
const weft__node *weft__key_in(const weft__match *match, const char *name);
const weft__node *weft__value_in(const weft__match *match, const char *name);

/* Whether a key is absent and no mistake explains it. */
bool weft__lacks(const weft__match *match, const char *name);

/* Reports "KEY must be TYPE, not VALUE (hint)". */
void weft__refuse_value(weft__reader *reader, const weft__key *key,
                        const weft__node *node);

/* The same with another name and type. */
void weft__refuse(weft__reader *reader, const weft__node *node, const char *name,
                  const char *wanted, bool number, const char *unit);

/* The index in key->names of the name that is the value; false: it is none of them,
 * which is reported. */
bool weft__find_name(weft__reader *reader, const weft__key *key, const weft__node *node,
                     size_t *index);

/* A number within the bounds of a key, or of a Butcher table; `name` in messages. */
bool weft__read_number(weft__reader *reader, const weft__key *key, const char *name,
                       const weft__node *node, double *out);

/* The numbers of a list, name[0], name[1], ...; false if one is wrong. */
bool weft__read_numbers(weft__reader *reader, const weft__key *key, const char *name,
                        const weft__node *list, double *out);

/* A list of lists of `width` numbers, which are called `row` ("a point [u, v] [m]"):
 * all numbers, of the tree, with room for one row more. NULL: one is wrong, or no
 * memory. */
double *weft__read_table(weft__reader *reader, const weft__key *key,
                         const weft__node *node, size_t width, const char *row);

/* table_file.c: puts the rows of tables that are CSV files in place of their names;
 * whether there were any. What such a file has wrong is reported, and its name stays.
 */
bool weft__take_tables(weft__reader *reader);
bool weft__is_table_file(const weft__node *node);

/* A table of times with its spline. */
typedef struct weft__splined {
    weft_table track;
    bool natural;
} weft__splined;

/* Reports keys, NULL at their end, by a rule: "'mass' needs a grid". Whether there were
 * some. */
bool weft__report_excluded(weft__reader *reader, const weft__match *match,
                           const char *const *names, const char *rule);

/* Reports keys that exclude each other: names, NULL at their end. false: none of them
 * is there. Then the lack of all as well. */
bool weft__check_exclusive(weft__reader *reader, const weft__match *match,
                           const char *const *names);
void weft__check_one(weft__reader *reader, const weft__match *match,
                     const char *const *names);

/* scene_pins.c: the oscillation [m], [Hz] of a pin or a shape; whether it is finite. */
bool weft__check_motion(weft__reader *reader, const weft__match *match,
                        const double amplitude[3], double frequency);

/* The one of two nodes that stands behind the other; NULL stands before any. */
const weft__node *weft__later(const weft__node *a, const weft__node *b);

/* Two keys of one mapping that may not stand together: reported at the later one. */
void weft__report_exclusive(weft__report *report, const weft__node *a,
                            const weft__node *b);

/* Of each kind: in read.c, scene_*.c and butcher.c. */
#define WEFT__READER(kind, reader, text) extern weft__read_fn weft__read_##reader;
WEFT__KIND_LIST(WEFT__READER)
#undef WEFT__READER

/* scene_contact.c */
weft__read_fn weft__read_shape;
weft__check_fn weft__check_shape, weft__check_contact;

/* Warnings of contact, when all sections were read without errors. */
void weft__warn_of_contact(weft__reader *reader, const weft__match *root);

/* scene_stop.c: `stop` and run.frames against `limit`, which excludes both. */
void weft__check_stop(weft__reader *reader, const weft__match *match);

/* scene_fabric.c */
weft__check_fn weft__check_bend, weft__check_fabric;

/* Makes the cloth of its fabric, if that is there; reports keys that it excludes. */
void weft__make_fabric(weft__reader *reader, const weft__match *cloth);

/* scene_pins.c */
weft__read_fn weft__read_pin;
weft__check_fn weft__check_place, weft__check_pin;

/* scene_cut.c */
weft__check_fn weft__check_cut;

/* cut_lines.c: the paths of a cut as lines that do not cross, of the tree. false: what
 * the paths are was reported, or no memory. */
bool weft__cut_lines_of(weft__reader *reader, const weft__cut *cut,
                        weft__cut_lines *out);

/* scene_mesh.c */
weft__check_fn weft__check_mesh, weft__check_turn;

/* A file beside the scene; in the results of a run its copy there, by default that of a
 * cloth. NULL: no memory, or
 * there is no copy and no name. */
char *weft__mesh_path(weft__reader *reader, const char *name, const char *copy);

/* scene_body.c: the body of a shape that is a mesh, whose other keys have no mistake.
 */
void weft__read_body(weft__reader *reader, const struct weft__match *match,
                     weft__shape_item *item);

/* The triangles of a sphere, capsule or box without faults, which becomes a mesh. */
void weft__make_facets(weft__reader *reader, const struct weft__match *match,
                       weft__shape_item *item);

/* What of a cloth does not go with its grid, or its mesh; the rules of a mesh. */
void weft__check_grid_cloth(weft__reader *reader, const weft__match *cloth);
void weft__check_mesh_cloth(weft__reader *reader, const weft__match *cloth);

/* scene_start.c: warnings about where a cloth without mistakes starts, which is a mesh
 * or cut, or a grid; about a thing of a file in another unit, and about a body. */
void weft__warn_of_mesh(weft__reader *reader, const weft__match *cloth);
void weft__warn_of_grid(weft__reader *reader, const weft__match *cloth);
void weft__warn_of_size(weft__reader *reader, weft__mark at, const char *what,
                        double size, double unit);
void weft__warn_of_body_size(weft__reader *reader, weft__mark at, const weft_body *body,
                             double unit);

/* scene_cloths.c */
weft__check_fn weft__check_part;

/* Sets the sizes of its structs. */
void weft__scene_begin(weft_scene *scene);

/* checks.c: warns if pins hold every particle. */
void weft__warn_of_held(weft__reader *reader, const weft__node *at);

/* scene_vertices.c */
/* Whether a pin or a load says on what it is, in the way of its cloth. */
weft__check_fn weft__check_vertices;

/* The same: of a scene without mistakes. */
void weft__check_bands(weft__reader *reader, const weft__match *root);

/* The value of section.key, or what of the section is there; key NULL: its name. */
weft__mark weft__place_in(const weft__match *root, const char *section,
                          const char *key);

/* scene_sensitivity.c; the second: what of a scene without mistakes has no derivative.
 */
weft__check_fn weft__check_sensitivity;
void weft__check_smooth(weft__reader *reader, const weft__match *root);

/* butcher.c */
weft__check_fn weft__check_butcher;

/* checks.c */
weft__check_fn weft__check_root, weft__check_grid, weft__check_springs,
    weft__check_cloth, weft__check_limit, weft__check_run;

/* scene_method.c: takes stepper.method apart where it is plugin/method, finds the
 * scene's type, removes keys of stepper that a choice of the command line or the sweep
 * leaves without use, with a warning, and reports others without use. Called before
 * the tree is read. */
void weft__resolve_method(weft__reader *reader, const weft__sweep *sweep);

/* What a method without a flag lacks, in words: "cannot keep the energy balance", what
 * others "can" and another one "can", and "set record.ledger to false". */
typedef struct weft__lack {
    const char *lacks, *can, *does, *instead;
} weft__lack;

/* scene_stepper.c: reports at a place that the method of the scene lacks a flag, with
 * the methods of its plugin that have it, else one of another plugin, and what to
 * change instead. */
void weft__require_flag(weft__reader *reader, uint32_t flag, weft__mark at,
                        const weft__lack *lack);
weft__check_fn weft__check_controller, weft__check_solver, weft__check_stepper,
    weft__check_record;
