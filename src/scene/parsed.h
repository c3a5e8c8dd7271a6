/* SPDX-License-Identifier: BSD-3-Clause */
/* parsed.h -- what a scene is read into. */
#pragma once

#include "scene/keys.h"
#include "scene/obj.h"
#include "scene/tree.h"

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
    double weld;  /* [m], if the key is there */
    double at[3]; /* [m] */
    weft__turn turn;
    weft_rest rest;
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

/* What reading decided, for `check`: a line about a thing. */
typedef struct weft__note {
    const char *about;
    char *text;
    struct weft__note *next;
} weft__note;

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
    weft__note *notes;
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

/* A table of times with its spline. */
typedef struct weft__splined {
    weft_table track;
    bool natural;
} weft__splined;
