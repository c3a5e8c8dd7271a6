/* SPDX-License-Identifier: BSD-3-Clause */
/* checks.h -- the rules between the keys of a scene, by file. A weft__check_fn is
 * called with a mapping whose keys have been read. */
#pragma once

#include "scene/read.h"
#include "scene/sweep.h"

/* table_file.c: puts the rows of tables that are CSV files in place of their names;
 * whether there were any. What such a file has wrong is reported, and its name stays.
 */
bool weft__take_tables(weft__reader *reader);
bool weft__is_table_file(const weft__node *node);

/* material_file.c: the mapping that a JSON file has, in place of its name; the node
 * itself: it is no name, or what is wrong was reported. */
const weft__node *weft__take_material(weft__reader *reader, const weft__node *node);

/* scene_pins.c: the oscillation [m], [Hz] of a pin or a shape; whether it is finite. */
bool weft__check_motion(weft__reader *reader, const weft__match *match,
                        const double amplitude[3], double frequency);

/* contact/scene_contact.c */
weft__read_fn weft__read_shape;
weft__check_fn weft__check_shape;

/* [m] The longest edge of a grid, or of triangles at rest or where they start. */
double weft__longest_edge(const weft_cloth_def *def, bool start);

/* contact/scene_body.c: whether two scenes that differ in a parameter have as many
 * triangles of each shape. */
bool weft__same_shapes(const weft_scene *a, const weft_scene *b);

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
