/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/cloth.h -- the model: particles with springs on a grid, or with triangles of
 * fabric between them, and the forces on them.
 *
 * A weft_cloth is constant after creation: every function here that takes one is pure
 * and may be called in many threads at once. The caller owns the state
 *
 *     double y[6 N]: planes x[N] y[N] z[N] [m], then vx[N] vy[N] vz[N] [m/s]
 *
 * of N particles. Particle (r, c) of a grid of N = rows * cols has index
 * i = r * cols + c; on triangles, states have an order of their own
 * (weft_cloth_index). SI units. The formulas are in docs/theory/model.md. */
#ifndef WEFT_CLOTH_H
#define WEFT_CLOTH_H

#include "weft/base.h"
#include "weft/comm.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct weft_cloth weft_cloth;

/* Springs of (r, c): stretch to the next column and row, shear across both diagonals of
 * a cell, bend to the second next column and row. */
typedef enum weft_family {
    WEFT_STRETCH,
    WEFT_SHEAR,
    WEFT_BEND,
    WEFT_FAMILIES /* their number */
} weft_family;

/** Names a family of springs.
 * @param family any value
 * @return static text: "stretch", "shear" or "bend"; never NULL */
WEFT_API const char *weft_family_name(weft_family family);

typedef enum weft_law {
    WEFT_LAW_HOOKE, /* T = k (L - s) + c w.u,     k [N/m] */
    WEFT_LAW_STRAIN /* T = k (L / s - 1) + c w.u, k [N] */
} weft_law;

/* Fixed for ever. */
typedef struct weft_spring_def {
    bool present;
    double stiffness; /* [N/m] (hooke) or [N] (strain), >= 0 */
    double damping;   /* [kg/s], >= 0, along the spring only */
} weft_spring_def;

/* Bending rigidity of a plate, instead of bend springs; docs/theory/bending.md. None if
 * all three moduli are 0. Fixed for ever. */
typedef struct weft_bending_def {
    double rigidity[2]; /* [N m] >= 0, along a column (warp), along a row (weft) */
    double twist;       /* [N m] >= 0; negative: sqrt(rigidity[0] rigidity[1]) */
    double damping;     /* [s] >= 0: force -damping K v, K the stiffness matrix */
} weft_bending_def;

/* Inclusive; a negative index counts from the end, so {0, -1} is all. Fixed for ever.
 */
typedef struct weft_range {
    ptrdiff_t first, last;
} weft_range;

/* A point mass on each of some particles. */
typedef struct weft_load {
    weft_range rows, cols;  /* of a grid */
    double mass;            /* [kg] > 0, added to each particle of the range */
    const size_t *vertices; /* of triangles: vertex_count of them */
    size_t vertex_count;
} weft_load;

/* A vector that changes with time: `count` rows t x y z, t [s] increasing, from before
 * the start if you like. Between two rows no component leaves the range of its two
 * values, and equal rows are a rest: a cubic Hermite polynomial with the slopes of
 * Fritsch and Butland (SciPy's PchipInterpolator), 0 at the first and the last row. It
 * has one continuous derivative, is constant before the first row and after the last,
 * and no step passes the time of a row (docs/theory/model.md). Where a struct says so,
 * it is a natural cubic spline instead: with two continuous derivatives between its
 * ends, where its velocity jumps, and beyond the range of its rows. Fixed for ever. */
typedef struct weft_table {
    const double *rows; /* 4 count numbers; count 0: none */
    size_t count;
} weft_table;

/* Particles that follow x(t) = x(0) + velocity t + amplitude sin(2 pi frequency t) +
 * path(t) - path(0). */
typedef struct weft_pin {
    weft_range rows, cols;  /* of a grid */
    double velocity[3];     /* [m/s] */
    double amplitude[3];    /* [m] */
    double frequency;       /* [Hz] >= 0 */
    const size_t *vertices; /* of triangles: vertex_count of them */
    size_t vertex_count;
    weft_table path;   /* [m] */
    bool path_natural; /* it is a natural spline */
} weft_pin;

typedef enum weft_shape_kind {
    WEFT_PLANE,   /* all that is behind `at`, against `normal` */
    WEFT_SPHERE,  /* about `at` */
    WEFT_CAPSULE, /* all within `radius` of the line from `at` to `to`; its ends are
                     joined by a 4-norm */
    WEFT_BOX,     /* along the axes, about `at`; its edges are rounded by a 4-norm */
    WEFT_MESH,    /* the triangles of `body`, which have two sides each */
    WEFT_SHAPES   /* their number */
} weft_shape_kind;

/** Names a kind of collider.
 * @param kind any value
 * @return static text: "plane", "sphere", "capsule", "box" or "mesh"; never NULL */
WEFT_API const char *weft_shape_name(weft_shape_kind kind);

/* A turn by the angle rate t + amplitude sin(2 pi frequency t) [rad] about an axis.
 * Fixed for ever. */
typedef struct weft_turn {
    double axis[3];   /* create normalises it; 0 0 0: no turn */
    double about[3];  /* [m] a point of the axis at t = 0; NAN: `at` of the shape */
    double rate;      /* [rad/s] */
    double amplitude; /* [rad] */
    double frequency; /* [Hz] >= 0 */
} weft_turn;

/* Triangles of a shape, open or closed, in any orientation;
 * docs/guides/drape-on-a-body.md. With several keys its vertices move: key i has their
 * places at time i / fps, in between they follow natural cubic splines, after the last
 * they rest. Arrays are copied by weft_cloth_create. Fixed for ever. */
typedef struct weft_body {
    size_t vertices, triangles, keys; /* >= 3, >= 1, >= 1 */
    const double *positions;          /* [m] from `at`: x y z of each vertex, by keys */
    const uint32_t *corners;          /* vertices, 3 of each triangle */
    double fps;                       /* [1/s] finite, > 0 with several keys */
} weft_body;

/* A rigid shape. It turns as `turn` says, and then all of it, the axis of the turn too,
 * moves as a pin does, by velocity t + amplitude sin(2 pi frequency t). */
typedef struct weft_shape {
    weft_shape_kind kind;
    double at[3];     /* [m] a point of a plane, a centre, the first end of a capsule */
    double to[3];     /* [m] capsule: the other end */
    double normal[3]; /* plane: outwards; create normalises it */
    double radius;    /* [m] > 0, sphere, capsule */
    double half[3];   /* [m] box: half its edges, > rounding */
    double rounding;  /* [m] > 0, box */
    double velocity[3];  /* [m/s] */
    double amplitude[3]; /* [m] */
    double frequency;    /* [Hz] >= 0 */
    double
        spin[3];     /* [rad/s] of the surface about `at`: along the normal of a plane
                        and the axis of a capsule, none of a box or a mesh; turns with it */
    double friction; /* >= 0; negative: the contact's */
    weft_turn turn;
    double orientation[4]; /* box, mesh: a rotation before its turn, as x y z w of
                              a quaternion; create normalises it; 0 0 0 0: none */
    const weft_body *body; /* mesh; of weft_cloth_shape: the cloth's own copy */
} weft_shape;

/** Returns a collider of a kind, at rest, with the contact's friction: a plane y >= 0,
 * a ball of 1 m, a capsule of 1 m from 0 to 1 m along x, a cube of 2 m rounded by 1 cm,
 * a mesh without a body.
 * @param kind of the collider
 * @return the collider, whose members may be changed
 * @par Example
 * @snippet dragged_sphere.c add */
WEFT_RESULT(weft_shape, weft_shape_default, (weft_shape_kind kind), (kind))

/** @copydoc weft_shape_vertices
 * @param size [bytes] sizeof(weft_shape) of the caller, which weft_shape_vertices
 *   passes */
WEFT_API void weft_shape_vertices_sized(const weft_shape *shape, size_t size, double t,
                                        double *xyz);

/** Computes where the vertices of a mesh collider are.
 * @param shape of kind WEFT_MESH
 * @param t [s]
 * @param[out] xyz [m] x y z of each vertex: 3 shape->body->vertices doubles */
static inline void weft_shape_vertices(const weft_shape *shape, double t, double *xyz)
{
    weft_shape_vertices_sized(shape, sizeof *shape, t, xyz);
}

/** @copydoc weft_shape_triangulate
 * @param size [bytes] sizeof(weft_shape) of the caller, which weft_shape_triangulate
 *   passes; this function leaves the collider as it is */
WEFT_API weft_status weft_shape_triangulate_sized(const weft_shape *shape, size_t size,
                                                  double thickness, double edge,
                                                  const weft_allocator *allocator,
                                                  weft_body **body, weft_error *err);

/** Turns a sphere, capsule or box into a mesh of triangles, which all of the cloth
 * feels, not its particles alone. The vertices lie on its surface; with the default
 * edge the triangles lie at most a quarter of the thickness below it.
 * @param[in,out] shape becomes a mesh with *body
 * @param thickness [m] > 0 of the contact
 * @param edge [m] largest length of an edge; 0: sqrt(2 R thickness), R the radius or
 *   rounding
 * @param allocator NULL: malloc's
 * @param[out] body the triangles, for weft_body_destroy after weft_cloth_create
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (another kind, a spin, more than 200 000 triangles),
 *   WEFT_NO_MEMORY; on failure the collider is unchanged */
static inline weft_status weft_shape_triangulate(weft_shape *shape, double thickness,
                                                 double edge,
                                                 const weft_allocator *allocator,
                                                 weft_body **body, weft_error *err)
{
    const weft_status status = weft_shape_triangulate_sized(
        shape, sizeof *shape, thickness, edge, allocator, body, err);
    for (size_t k = 0; status == WEFT_OK && k < 4 && shape->kind != WEFT_BOX; ++k) {
        shape->orientation[k] = 0.0; /* which these have none of */
    }
    if (status == WEFT_OK) {
        shape->kind = WEFT_MESH;
        shape->body = *body;
    }
    return status;
}

/** Frees what weft_shape_triangulate made.
 * @param body may be NULL
 * @param allocator the same as there */
WEFT_API void weft_body_destroy(weft_body *body, const weft_allocator *allocator);

typedef enum weft_friction_law {
    WEFT_FRICTION_SMOOTH, /* analytic, no stiffer than 10 times the contact */
    WEFT_FRICTION_COULOMB /* exactly Coulomb's above `slip` */
} weft_friction_law;

/* Contact of free particles with shapes; docs/theory/contact.md. Fixed for ever. */
typedef struct weft_contact_def {
    double thickness;      /* [m] > 0: forces begin at this gap */
    double stopping_speed; /* [m/s] > 0: stops a particle where s^p / (1 - s) = 1 */
    int exponent;          /* p, 3 to 10 */
    double damping;        /* [s/m] >= 0 */
    double friction;       /* >= 0, of shapes without their own */
    weft_friction_law law;
    double slip;              /* [m/s] > 0: friction fades at slower slip */
    const weft_shape *shapes; /* shape_count of them; 0: no contact with shapes */
    size_t shape_count;
    bool self; /* contact of the cloth with itself, pinned particles included; needs
                  thickness <= half the smaller spacing, or smallest height */
} weft_contact_def;

/* A measured fabric, independent of the grid: moduli of the whole sheet, per width;
 * docs/guides/measured-fabric.md. Fixed for ever. */
typedef struct weft_fabric {
    const char *name;  /* of a preset; may be NULL */
    double density;    /* [kg/m^2] > 0 */
    double stretch[2]; /* C [N/m] > 0, along a column (warp), along a row (weft) */
    double shear;      /* G [N/m] >= 0; of a grid also C12 between warp and weft */
    double bend[2];    /* B [N m] >= 0, warp, weft */
    double twist;      /* [N m]; negative: sqrt(bend[0] bend[1]) */
    double damping[2]; /* [s] >= 0, in the plane, of bending: times the stiffness */
    double coupling;   /* C12 [N/m] of triangles, C12^2 < stretch[0] stretch[1] */
} weft_fabric;

typedef enum weft_seam {
    WEFT_SEAM_BEND, /* the cloth bends across a seam as it does elsewhere */
    WEFT_SEAM_HINGE /* it turns freely there */
} weft_seam;

/* Where triangles have their rest shape. */
typedef enum weft_rest_shape {
    WEFT_REST_PLANE, /* in the plane (u, v) */
    WEFT_REST_START  /* in space, where they start */
} weft_rest_shape;

/* In what shape the cloth is free of bending. */
typedef enum weft_rest_angle {
    WEFT_ANGLE_DEFAULT, /* flat with WEFT_REST_PLANE, start with WEFT_REST_START */
    WEFT_ANGLE_FLAT,
    WEFT_ANGLE_START
} weft_rest_angle;

/* The rest shape of the triangles of one cloth. In space they need no (u, v): each
 * vertex is one particle, there are no seams, and faces may be turned over. */
typedef struct weft_rest {
    weft_rest_shape shape;
    weft_rest_angle angle;
    double warp[3]; /* in space: the direction of the warp, projected into each
                       triangle; 0, 0, 0: the fabric is alike in all directions */
} weft_rest;

enum { WEFT_CLOTHS_MAX = 64, WEFT_CLOTH_NAME_MAX = 40 };

/* One of several cloths that a mesh has: vertices one after another, which share no
 * triangle with others. Fixed for ever. */
typedef struct weft_cloth_part {
    const char *name;    /* letters, digits, _ and -, WEFT_CLOTH_NAME_MAX at most */
    size_t first, count; /* vertices [first, first + count) */
    double velocity[3];  /* [m/s] initial, instead of that of the definition */
} weft_cloth_part;

/* Triangles of fabric instead of a grid of springs; docs/guides/cut-and-sew.md. The
 * rest shape lies in the plane (u, v), u along the weft, v along the warp. A vertex may
 * have several UV coordinates: its triangles are sewn then. A panel is a set of
 * triangles joined through edges whose two ends have the same ones on both sides;
 * another edge of two triangles is a seam. Arrays are copied by weft_cloth_create. */
typedef struct weft_mesh_def {
    uint32_t struct_size, fabric_size; /* [bytes]; of an element of `fabrics` */
    size_t vertices;                   /* N, each a corner of a triangle */
    const double *start;      /* [m] where they are at t = 0: x y z of each, 3 N */
    const size_t *file_index; /* N indices that messages have for them; NULL: 0, 1, ...
                               */
    size_t uv_count;
    const double *rest;        /* [m] u v of each of them */
    size_t triangles;          /* T */
    const uint32_t *corners;   /* vertices, 3 T: in one order all over a panel */
    const uint32_t *corner_uv; /* indices of `rest`, 3 T; NULL: as `corners` */
    const uint32_t *fabric_of; /* T indices of `fabrics`; NULL: 0 for all */
    const weft_fabric *fabrics;
    size_t fabric_count;
    weft_seam seams;
    bool arc; /* lengths of edges follow the cloth's arc: no locking on coarse meshes,
                 some 4 times the cost */
    const weft_cloth_part *parts; /* part_count cloths, which have all vertices in their
                 order; at most WEFT_CLOTHS_MAX */
    size_t part_count;            /* 0: one cloth, without a name */
    const struct weft_cloth_def *const *grids; /* part_count of them, or NULL. Part k is
                       the grid of grids[k] unless that is NULL: its particle (r, c) is
                       vertex first + r cols + c, which has no triangle, place or start
                       here. Its rows to scale, mass, density, law, springs, across,
                       rim_half and bending are used: 2 rows and 2 columns or more */
    const weft_rest *rests; /* of each part, without parts one; NULL: in the plane. Then
                               `rest` and `corner_uv` have what lies in the plane */
    const double *space;    /* [m] x y z of each vertex in the rest shape that lies in
                               space, 3 N; NULL: `start` */
    size_t rest_size;       /* [bytes] of an element of `rests` */
} weft_mesh_def;

/** Fills the defaults of weft_mesh_def_default, which calls it.
 * @param[out] def filled up to size
 * @param size [bytes] sizeof(weft_mesh_def) of the caller */
WEFT_API void weft_mesh_def_init(weft_mesh_def *def, size_t size);

/** Returns a mesh without triangles, with seams that bend; set the rest.
 * @return the defaults, with struct_size, fabric_size and rest_size set
 * @par Example
 * @snippet pillow.c mesh */
static inline weft_mesh_def weft_mesh_def_default(void)
{
    weft_mesh_def def;
    weft_mesh_def_init(&def, sizeof def);
    def.fabric_size = sizeof(weft_fabric);
    def.rest_size = sizeof(weft_rest);
    return def;
}

/* The definition of a cloth. weft_cloth_create copies the arrays. */
typedef struct weft_cloth_def {
    uint32_t struct_size;
    uint32_t load_size, pin_size, shape_size; /* [bytes] of an element of the arrays */
    size_t rows, cols; /* particles down and across, >= 1 each, rows * cols >= 2 */
    double spacing[2]; /* [m] > 0: row to row (along a column), then column to column */
    double origin[3];  /* [m] rest position of particle (0, 0) */
    double right[3];   /* direction of increasing column; create normalises it */
    double down[3];    /* direction of increasing row; perpendicular to right (1e-9) */
    double scale;      /* > 0: initial = origin + scale (rest - origin) */
    double mass;       /* [kg] > 0 of each particle: set density = 0; 0: by density */
    double density;    /* [kg/m^2] > 0, lumped by area; 0: mass is used */
    double velocity[3];     /* [m/s] initial velocity of particles without a pin */
    const weft_load *loads; /* load_count of them */
    size_t load_count;
    weft_law law;
    weft_spring_def springs[WEFT_FAMILIES];
    const weft_pin *pins; /* pin_count of them; a later one overrides an earlier one */
    size_t pin_count;
    double gravity[3];       /* [m/s^2] */
    double damping;          /* [kg/s] >= 0, viscous: F = -damping v on each particle */
    double wind_velocity[3]; /* [m/s] */
    double wind_drag;        /* [kg/(m^2 s)] >= 0; 0: no wind */
    const weft_allocator *allocator; /* NULL: malloc's */
    weft_contact_def contact;
    bool rim_half; /* stretch and bend springs along the rim carry half their values */
    weft_bending_def bending;              /* excludes bend springs */
    weft_spring_def across[WEFT_FAMILIES]; /* if present: of stretch and bend springs
                       along a row (weft); `springs` are then those along a column */
    size_t band_first, band_rows; /* a band of the cloth: its own rows [band_first,
                       band_first + band_rows), 2 or more, and up to 2 ghost rows of
                       each neighbour (weft/comm.h). The cloth created has these rows
                       alone, and its index 0 is the first of them; all else in the
                       definition is that of the whole. Of triangles blocks, 1 or more.
                       band_rows 0: the whole cloth. Functions of the cloth of a band
                       do without its contact with itself */
    const weft_mesh_def *mesh; /* triangles instead of a grid; NULL: a grid. Then rows
                       to scale, mass, density, law, springs, across, bending and
                       rim_half are not used, and pins and loads have vertices */
    weft_table wind_table;     /* [m/s] unless count is 0, instead of wind_velocity */
    double untangle; /* [s] >= 0; > 0: a start may pass through itself and shapes, and
                       weft_sim_create calls weft_cloth_untangle */
    bool wind_table_natural; /* the wind's table is a natural spline */
    bool strict;             /* cloth that passes through a collider between its
                               particles (weft_cloth_passages) is an error: at the
                               start, and at frames (weft_sim_check_frame) */
    weft_log log;       /* progress of weft_cloth_untangle, at least once a second */
    weft_stop_fn *stop; /* asked while the cloth is made, which takes a minute for a
                       million triangles, and by weft_cloth_untangle; NULL: none */
    void *stop_ctx;
} weft_cloth_def;

/** Counts the particles of the whole cloth.
 * @param def complete
 * @return N: rows * cols, or the vertices of the mesh */
static inline size_t weft_cloth_def_particles(const weft_cloth_def *def)
{
    return def->mesh != NULL ? def->mesh->vertices : def->rows * def->cols;
}

/** Counts the blocks that weft_comm_band divides among bands: the rows of a grid, or
 * blocks of WEFT_BLOCK_VERTICES vertices of a mesh.
 * @param def complete
 * @return their number */
static inline size_t weft_cloth_def_blocks(const weft_cloth_def *def)
{
    return def->mesh == NULL
               ? def->rows
               : (def->mesh->vertices + WEFT_BLOCK_VERTICES - 1) / WEFT_BLOCK_VERTICES;
}

/* How far a cloth is stretched where it starts, as a part of its rest shape: 1 is not.
 * Fixed for ever. */
typedef struct weft_stretch {
    double least, largest;             /* of all triangles, in any direction */
    double median;                     /* of sqrt(area at the start / area at rest) */
    size_t triangles;                  /* 0: a grid, of which all three are `scale` */
    size_t least_at[3], largest_at[3]; /* vertices of the triangles that have them */
} weft_stretch;

/** Computes how far a cloth is stretched where it starts.
 * @param def one of which a cloth can be made
 * @param part one of its mesh's parts; 0 without parts: all
 * @param[out] out filled
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_NO_MEMORY */
WEFT_API weft_status weft_cloth_def_stretch(const weft_cloth_def *def, size_t part,
                                            weft_stretch *out, weft_error *err);

/* What a surface is whose rest shape lies in space. Fixed for ever. */
typedef struct weft_rest_report {
    size_t triangles;                 /* 0: the rest shape lies in the plane */
    size_t pieces, closed, one_sided; /* sets of triangles that edges join; those
                                         without a boundary, and those of one side, as a
                                         Moebius band */
    size_t flipped;        /* triangles that are turned over, of the others */
    size_t woven, blended; /* triangles with the fabric along the warp, and
                              others, if there is a warp within 17 degrees of
                              their normal */
    size_t sharp;          /* edges that fold by more than 60 degrees */
    double fold;           /* [rad] of the sharpest, */
    size_t fold_at[2];     /* which joins these vertices */
    double defect; /* [rad] 2 pi less the angles about a vertex: the largest in size */
    size_t defect_at;
} weft_rest_report;

/** Surveys a surface whose rest shape lies in space.
 * @param def one of which a cloth can be made
 * @param part one of its mesh's parts; 0 without parts
 * @param[out] out filled
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_NO_MEMORY */
WEFT_API weft_status weft_cloth_def_rest(const weft_cloth_def *def, size_t part,
                                         weft_rest_report *out, weft_error *err);

/* A spring between two particles, given by family and indices. Fixed for ever. */
typedef struct weft_spring {
    weft_family family;
    size_t p, q;
    double strain; /* (L - s) / s */
} weft_spring;

/* A particle, an edge or a triangle of the cloth, for contact with itself. Edges run
 * along rows, columns and the diagonal (r, c + 1)-(r + 1, c) of each cell. Fixed for
 * ever. */
typedef struct weft_primitive {
    size_t count; /* 1, 2 or 3 particles */
    size_t particle[3];
} weft_primitive;

/* Fixed for ever: a further force adds to the member that is nearest to it. */
typedef struct weft_energy {
    double kinetic;                /* [J] of the free particles */
    double gravitational;          /* [J] -m g.x, of the free particles */
    double elastic[WEFT_FAMILIES]; /* [J] WEFT_BEND: that of bending rigidity, too */
    double contact;                /* [J] potential of shapes and self-contact */
} weft_energy;

/* The powers [W] that change the total energy. */
typedef enum weft_power {
    WEFT_POWER_SPRINGS,  /* turned into heat by damping of springs, bending, >= 0 */
    WEFT_POWER_DRAG,     /* turned into heat by viscous drag of free particles, >= 0 */
    WEFT_POWER_WIND,     /* put into free particles by the wind */
    WEFT_POWER_PINS,     /* put into springs and bending by moving pins */
    WEFT_POWER_CONTACT,  /* turned into heat by the damping of contact, >= 0 */
    WEFT_POWER_FRICTION, /* turned into heat by friction, >= 0 */
    WEFT_POWER_SHAPES,   /* put into free particles by moving shapes */
    WEFT_POWERS          /* their number */
} weft_power;

/* The measures of a state; the functions below describe each of them. */
typedef struct weft_measures {
    weft_energy energy;
    double momentum[3], angular_momentum[3]; /* [kg m/s], [kg m^2/s] */
    double power[WEFT_POWERS];               /* [W] */
    weft_spring worst;
    uint64_t hash;
    double gap;                     /* [m] of a free particle: the smallest */
    size_t gap_particle, gap_shape; /* where; 0 without shapes */
    size_t touching;                /* free particles with a gap below the thickness */
    double self_gap;                /* [m] of the cloth to itself */
    weft_primitive self_pair[2];    /* where; count 0: nowhere */
    size_t self_touching;           /* pairs of primitives nearer than the thickness */
} weft_measures;

typedef enum weft_limit_method {
    WEFT_LIMIT_NONE,
    WEFT_LIMIT_PROVOT, /* on positions, after Provot 1995 */
    WEFT_LIMIT_BRIDSON /* on velocities, after Bridson, Fedkiw, Anderson 2002 */
} weft_limit_method;

typedef enum weft_limit_solver {
    WEFT_LIMIT_FAST, /* sweeps with momentum: some n of them on an n x n grid */
    WEFT_LIMIT_SWEEP /* plain sweeps, as in the paper: some n^3 */
} weft_limit_solver;

/* The strain limit: no limited spring is longer than (1 + strain) rest lengths;
 * docs/theory/model.md. Fixed for ever. */
typedef struct weft_limit_def {
    weft_limit_method method;
    double strain;                /* >= 0 */
    bool families[WEFT_FAMILIES]; /* the limited families */
    size_t sweeps;                /* >= 1: maximum of passes per step */
    double tolerance;             /* > 0: met up to (1 + strain)(1 + tolerance) */
    bool keep_velocity;           /* provot: positions only, as in the paper */
    weft_limit_solver solver;
} weft_limit_def;

/** Makes the springs and the bending of a grid from a fabric: sets density, mass (0),
 * law, rim_half, springs and bending. With a spacing a along a column, b along a row:
 *
 *     column C[0] b / a - G a / b    row C[1] a / b - G b / a
 *     shear  G (a^2 + b^2) / (2 a b)
 *
 * This is exact for homogeneous strain on every grid of 2 x 2 and more; a chain has C x
 * 1 m / spacing and no shear.
 * @param fabric its density, moduli and damping
 * @param[in,out] def its rows, cols and spacing must be set; unchanged on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID: a value is out of range, or not sqrt(G / C[0]) <= b /
 *   a <= sqrt(C[1] / G), where springs would be negative (the message has this
 *   interval)
 * @par Example
 * @snippet frames.c fabric */
WEFT_API weft_status weft_fabric_apply(const weft_fabric *fabric, weft_cloth_def *def,
                                       weft_error *err);

/** Computes the fabric that the springs and the bending rigidity of a grid make in
 * homogeneous strain of the whole cloth: the reverse of weft_fabric_apply. Springs
 * whose rim does not carry half make a stiffer fabric on a coarser grid.
 * @param def of which a cloth can be made
 * @return the fabric; its damping is 0 and its twist >= 0
 * @par Example
 * @snippet frames.c fabric */
WEFT_API weft_fabric weft_fabric_of(const weft_cloth_def *def);

/** Computes Peirce's bending length (bend / (density gravity))^(1/3), in which the
 * weight bends a fabric. A grid shows such bends if its spacing is at most half of it.
 * @param fabric its bend and density
 * @param way 0: along the warp, 1: along the weft
 * @param gravity [m/s^2] > 0
 * @return [m]; 0 without gravity
 * @par Example
 * @snippet frames.c fabric */
WEFT_API double weft_fabric_length(const weft_fabric *fabric, size_t way,
                                   double gravity);

/** Lists the fabrics measured by Wang, O'Brien and Ramamoorthi (ACM Trans. Graph.
 * 30(4), 71, 2011). Their damping is 0.
 * @param[out] count their number
 * @return static data */
WEFT_API const weft_fabric *weft_fabric_presets(size_t *count);

/** Finds a preset by its name.
 * @param name such as "11oz-black-denim"
 * @return static data; NULL: there is none
 * @par Example
 * @snippet two_cloths.c fabric */
WEFT_API const weft_fabric *weft_fabric_find(const char *name);

/** Fills the defaults of weft_cloth_def_default, which calls it.
 * @param[out] def filled up to size
 * @param size [bytes] sizeof(weft_cloth_def) of the caller */
WEFT_API void weft_cloth_def_init(weft_cloth_def *def, size_t size);

/** Returns a cloth of 2 x 2 particles, 1 m apart, of 0.2 kg/m^2, without springs and
 * pins, with earth's gravity along -y. Its contact has thickness 5 mm, stopping speed 5
 * m/s, exponent 4, damping 1 s/m, smooth friction of 0.3 and slip 1 mm/s, but no
 * colliders. Set the members that differ.
 * @return the defaults, with struct_size and the sizes of elements set
 * @par Example
 * @snippet minimal.c define */
static inline weft_cloth_def weft_cloth_def_default(void)
{
    weft_cloth_def def;
    weft_cloth_def_init(&def, sizeof def);
    def.load_size = sizeof(weft_load);
    def.pin_size = sizeof(weft_pin);
    def.shape_size = sizeof(weft_shape);
    return def;
}

/** Creates a cloth, which is constant: many threads and simulations may share it. It
 * uses the fastest instructions of this machine, unless the environment variable
 * WEFT_ISA selects other supported ones: "plain", "x86-64-v3" (AVX2) or "x86-64-v4"
 * (AVX-512).
 * @param def copied, with its arrays
 * @param[out] out the cloth, for weft_cloth_destroy; NULL on failure
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (a value is out of range, a pin is outside of the grid,
 *   rest positions coincide, a free particle is in a collider, with contact.self the
 *   cloth intersects itself, WEFT_ISA is another name, ...: the message names the
 *   member), WEFT_STOPPED (weft_cloth_def.stop), WEFT_NO_MEMORY
 * @par Example
 * @snippet minimal.c create */
WEFT_API weft_status weft_cloth_create(const weft_cloth_def *def, weft_cloth **out,
                                       weft_error *err);

/** Destroys a cloth, after the simulations that use it.
 * @param cloth may be NULL */
WEFT_API void weft_cloth_destroy(weft_cloth *cloth);

/** Names the instructions that the cloth's forces use.
 * @param cloth the cloth
 * @return static text, such as "x86-64-v3" */
WEFT_API const char *weft_cloth_isa(const weft_cloth *cloth);

/** Counts the rows of a grid. Functions with a row, an index or the length of a state
 * include the ghost rows of a band; springs (by the row where they begin), pins, mass,
 * energies, powers, momenta, gaps and loads are those of its own rows, where also
 * forces are right. A band of triangles has its own order of particles, which is that
 * of the state, in place of vertices; its triangles, edges and UV coordinates are of no
 * use.
 * @param cloth the cloth
 * @return their number; 0 if the cloth is a mesh */
WEFT_API size_t weft_cloth_rows(const weft_cloth *cloth);

/** Counts the columns of a grid.
 * @param cloth the cloth
 * @return their number; 0 if the cloth is a mesh */
WEFT_API size_t weft_cloth_cols(const weft_cloth *cloth);

/** Counts the particles; a band counts its ghosts too.
 * @param cloth the cloth
 * @return N */
WEFT_API size_t weft_cloth_particles(const weft_cloth *cloth);

/** Counts the doubles of a state.
 * @param cloth the cloth
 * @return 6 N */
WEFT_API size_t weft_cloth_dim(const weft_cloth *cloth);

/** Returns which rows of the whole cloth this one has.
 * @param cloth a whole one: all rows, or blocks of WEFT_BLOCK_VERTICES vertices of
 *   triangles
 * @return the band */
WEFT_API weft_band weft_cloth_band(const weft_cloth *cloth);

/** Counts the springs of a family.
 * @param cloth the cloth
 * @param family of springs
 * @return their number; a band counts those of its own rows */
WEFT_API size_t weft_cloth_springs(const weft_cloth *cloth, weft_family family);

/** Counts the pinned particles.
 * @param cloth the cloth
 * @return their number; a band counts those of its own rows */
WEFT_API size_t weft_cloth_pins(const weft_cloth *cloth);

/** Returns how much memory the cloth takes.
 * @param cloth the cloth
 * @return [bytes] */
WEFT_API size_t weft_cloth_bytes(const weft_cloth *cloth);

/** Sums the masses of all particles, also of pinned ones.
 * @param cloth the cloth
 * @return [kg] */
WEFT_API double weft_cloth_mass(const weft_cloth *cloth);

/** Returns the mass of a particle.
 * @param cloth the cloth
 * @param i < N: r * cols + c on a grid, the vertex index on a mesh
 * @return [kg] */
WEFT_API double weft_cloth_particle_mass(const weft_cloth *cloth, size_t i);

/** Returns whether a particle is pinned.
 * @param cloth the cloth; weft_sim_cloth() for the present pins of a simulation
 * @param i as weft_cloth_particle_mass
 * @return whether it is
 * @par Example
 * @snippet game_loop.c pinned */
WEFT_API bool weft_cloth_pinned(const weft_cloth *cloth, size_t i);

/** Finds the place of a vertex in the planes of a state. Particle indices, and arrays
 * with one or three values for each particle, follow the definition: r * cols + c on a
 * grid, the vertex index on a mesh. States, and planes as long as those of a state,
 * have an order of their own on a mesh.
 * @param cloth the cloth
 * @param vertex < N
 * @return the place; on a grid it is the particle index
 * @par Example
 * @snippet pillow.c index */
WEFT_API size_t weft_cloth_index(const weft_cloth *cloth, size_t vertex);

/** Finds the vertex at a place of a state: the reverse of weft_cloth_index.
 * @param cloth the cloth
 * @param index < N
 * @return the vertex index */
WEFT_API size_t weft_cloth_vertex(const weft_cloth *cloth, size_t index);

/** Returns the index by which files and messages name a vertex:
 * weft_mesh_def.file_index.
 * @param cloth the cloth
 * @param vertex < N
 * @return the index */
WEFT_API size_t weft_cloth_file_index(const weft_cloth *cloth, size_t vertex);

/** Counts the cloths that a mesh joins: weft_mesh_def.parts.
 * @param cloth the cloth
 * @return their number; 0 without parts
 * @par Example
 * @snippet two_cloths.c parts */
WEFT_API size_t weft_cloth_parts(const weft_cloth *cloth);

/** Returns one of the cloths that a mesh joins. Its vertices [first, first + count)
 * also have the places [first, first + count) of a state, in another order.
 * @param cloth the cloth
 * @param k < weft_cloth_parts()
 * @return the part; its name is valid as long as the cloth
 * @par Example
 * @snippet two_cloths.c parts */
WEFT_API weft_cloth_part weft_cloth_part_at(const weft_cloth *cloth, size_t k);

/** Finds one of the cloths that a mesh joins by its name.
 * @param cloth the cloth
 * @param name of the part
 * @return its index; SIZE_MAX: there is none */
WEFT_API size_t weft_cloth_part_find(const weft_cloth *cloth, const char *name);

/** Finds the cloth that a vertex belongs to.
 * @param cloth the cloth
 * @param vertex < N
 * @return the index of the part; 0 without parts */
WEFT_API size_t weft_cloth_part_of(const weft_cloth *cloth, size_t vertex);

/** Lists the triangles as they are drawn and touched. A cell (r, c) of a grid has the
 * triangles (r, c), (r + 1, c), (r, c + 1) and (r + 1, c + 1), (r, c + 1), (r + 1, c),
 * one after the other; triangles of a mesh turn as they are defined.
 * @param cloth the cloth
 * @param[out] corners particle indices, three of each triangle: 3 T; NULL: only count
 * @return T
 * @par Example
 * @snippet window.c triangles */
WEFT_API size_t weft_cloth_triangles(const weft_cloth *cloth, uint32_t *corners);

/** Lists the edges as they are touched: on a grid those of rows, of columns and the
 * diagonals between the triangles of its cells.
 * @param cloth the cloth
 * @param[out] ends particle indices, two of each edge: 2 E; NULL: only count
 * @return E */
WEFT_API size_t weft_cloth_edges(const weft_cloth *cloth, uint32_t *ends);

/** Lists the UV coordinates of the flat rest shape. Two triangles that share an edge
 * but not its UV coordinates are sewn there. Particle (r, c) of a grid has one pair, c
 * spacing[1], -r spacing[0].
 * @param cloth the cloth
 * @param[out] corner_uv which pair each corner of the triangles has: 3 T; NULL: not
 *   wanted
 * @param[out] uv [m] u v of each pair: 2 P; NULL: not wanted
 * @return P */
WEFT_API size_t weft_cloth_uv(const weft_cloth *cloth, uint32_t *corner_uv, double *uv);

/** Counts the panels of the rest shape, and the edges along which they are sewn.
 * @param cloth the cloth
 * @param[out] sewn the number of sewn edges
 * @param[out] length [m] of these edges, in all
 * @return the number of panels; a grid has 1 */
WEFT_API size_t weft_cloth_panels(const weft_cloth *cloth, size_t *sewn,
                                  double *length);

/** Describes a cloth, as messages do: "16 x 24 particles" or "85 vertices, 140
 * triangles", "... in 2 cloths" if there are several; a band describes the whole cloth.
 * @param cloth the cloth
 * @param[out] text receives the words, as snprintf writes
 * @param size [bytes] of text
 * @return text */
WEFT_API const char *weft_cloth_text(const weft_cloth *cloth, char *text, size_t size);

/** Names a particle as messages do: "particle (3, 4)" or "vertex 17", "... of NAME" if
 * there are several cloths.
 * @param cloth the cloth
 * @param i < N
 * @param[out] text receives the words, as snprintf writes
 * @param size [bytes] of text
 * @return text
 * @par Example
 * @snippet frames.c failure */
WEFT_API const char *weft_particle_text(const weft_cloth *cloth, size_t i, char *text,
                                        size_t size);

/** Names a spring as messages do: "shear spring (3, 4)-(4, 5)" or "edge 17-4".
 * @param cloth the cloth
 * @param spring as weft_cloth_worst_spring returns it
 * @param[out] text receives the words, as snprintf writes
 * @param size [bytes] of text
 * @return text */
WEFT_API const char *weft_spring_text(const weft_cloth *cloth,
                                      const weft_spring *spring, char *text,
                                      size_t size);

/** Names a particle, an edge or a triangle as messages do: "edge (3, 4)-(3, 5)", "cell
 * (3, 4)" or "triangle 17-4-21".
 * @param cloth the cloth
 * @param primitive of the cloth
 * @param[out] text receives the words, as snprintf writes
 * @param size [bytes] of text
 * @return text */
WEFT_API const char *weft_primitive_text(const weft_cloth *cloth,
                                         const weft_primitive *primitive, char *text,
                                         size_t size);

/** Computes the state at t = 0.
 * @param cloth the cloth
 * @param[out] y a state, 6 N doubles */
WEFT_API void weft_cloth_start(const weft_cloth *cloth, double *y);

/** Computes the rest positions. The rest shape of a mesh is flat (weft_cloth_uv), so
 * for a mesh these are the positions at t = 0.
 * @param cloth the cloth
 * @param[out] xyz [m] x y z of particle 0, ...: 3 N doubles */
WEFT_API void weft_cloth_rest(const weft_cloth *cloth, double *xyz);

/** Computes dy/dt, the right-hand side. Calls nothing and allocates nothing, and has
 * the same bits on every machine, whatever its instructions.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param[out] dydt [m/s], [m/s^2]: 6 N doubles, which must not overlap y
 * @return 0; 1 if dy/dt, or a force on a pinned particle, is not finite or a free
 *   particle has no gap > 0 to a collider
 * @par Example
 * @snippet derivative.c rhs */
WEFT_API int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y,
                            double *dydt);

/** Computes J dy, the derivative of weft_cloth_rhs along dy:
 *
 *     dx' = dv,   dv' = M^-1 (dF/dx dx + dF/dv dv)
 *
 * for free particles, and 0 for pinned ones, whose motion does not depend on the state.
 * F is all forces. Exact; a spring of length 0, where F has no derivative, adds
 * nothing. The bits are the same on every machine. It costs two weft_cloth_rhs on a
 * cloth without colliders or wind.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param dy planes as a state
 * @param[out] out planes as a state, which must not overlap the others
 * @return 0; 1 as weft_cloth_rhs; -1: no memory for the points of a mesh collider, the
 *   only thing that it allocates
 * @par Example
 * @snippet derivative.c product */
WEFT_API int weft_cloth_jacobian_product(const weft_cloth *cloth, double t,
                                         const double *y, const double *dy,
                                         double *out);

/** Computes the transposed product J^T w, the derivative of w.f with respect to the
 * state: for every v, v.(J^T w) is w.(J v), but for roundoff. On the calling thread; it
 * costs some two weft_cloth_rhs.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param w planes as a state
 * @param[out] out planes as a state, which must not overlap the others
 * @return 0; 1 as weft_cloth_rhs; -1: no memory, or a grid among several cloths, whose
 *   product is not known
 * @par Example
 * @snippet derivative.c product */
WEFT_API int weft_cloth_jacobian_product_transposed(const weft_cloth *cloth, double t,
                                                    const double *y, const double *w,
                                                    double *out);

/** Computes the derivative of weft_cloth_rhs with respect to a parameter, from two
 * cloths that differ in it. For springs, weight, air and masses it is exact but for
 * roundoff, for the other forces a central difference, for pinned particles the
 * derivative of their motion. Only the other forces that differ are evaluated.
 * @param less a cloth with less of the parameter
 * @param more a cloth with more of it, and otherwise the same definition
 * @param span the difference of the parameter between the two
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param[out] out [m/s], [m/s^2] per unit of span: 6 N doubles
 * @return 0; 1 as weft_cloth_rhs; -1: the two have other particles, pins or colliders
 *   than one another, or there is no memory
 * @par Example
 * @snippet derivative.c parameter */
WEFT_API int weft_cloth_parameter_product(const weft_cloth *less,
                                          const weft_cloth *more, double span, double t,
                                          const double *y, double *out);

/** Computes w.(df/dp), the product of w with what weft_cloth_parameter_product
 * computes.
 * @param less a cloth with less of the parameter
 * @param more a cloth with more of it, and otherwise the same definition
 * @param span the difference of the parameter between the two
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param w 6 N doubles
 * @param[out] out one number, per unit of span
 * @return 0, 1 or -1, as weft_cloth_parameter_product */
WEFT_API int weft_cloth_parameter_product_transposed(const weft_cloth *less,
                                                     const weft_cloth *more,
                                                     double span, double t,
                                                     const double *y, const double *w,
                                                     double *out);

/** Computes the force on every particle, as if none were pinned; pinned particles feel
 * no contact with colliders.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param[out] f [N] planes fx fy fz: 3 N doubles */
WEFT_API void weft_cloth_force(const weft_cloth *cloth, double t, const double *y,
                               double *f);

/** Computes the energies. Energies, powers, momenta and masses are summed over each row
 * of particles, and of the springs that begin there, then over the rows in their order:
 * the same bits everywhere, also from weft_sim_measure on threads.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @return [J]
 * @par Example
 * @snippet scene.c frames */
WEFT_API weft_energy weft_cloth_energy(const weft_cloth *cloth, double t,
                                       const double *y);

/** Sums all energies.
 * @param energy of weft_cloth_energy
 * @return [J] */
WEFT_API double weft_energy_total(weft_energy energy);

/** Computes the rate at which springs, bending, air drag, contact and friction turn
 * energy into heat. The drag of pinned particles does not count, because their motion
 * is prescribed.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @return [W] >= 0 */
WEFT_API double weft_cloth_dissipation(const weft_cloth *cloth, double t,
                                       const double *y);

/** Computes all powers: d(energy)/dt = wind + pins + shapes - springs - drag - contact
 * - friction, exactly.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param[out] power [W] */
WEFT_API void weft_cloth_power(const weft_cloth *cloth, double t, const double *y,
                               double power[WEFT_POWERS]);

/* Bounds on the stiffness and damping of all modes, linearised about a state. A mode
 * x'' + c x' + w2 x = 0 has stiffness w2 [1/s^2] and damping rate c [1/s]; the pair
 * (w2, c) of every mode lies in the convex polygon of the corners. Negative w2, the
 * buckling of slack springs, is motion rather than instability of a method and is left
 * out, as is the stiffness of the wind. */
enum { WEFT_STIFFNESS_CORNERS = 40 };

/* Fixed for ever. */
typedef struct weft_stiffness {
    double omega2;  /* [1/s^2] no mode is stiffer */
    double damping; /* [1/s] no mode is damped more */
    size_t count;
    double corners[WEFT_STIFFNESS_CORNERS][2]; /* (w2, c), in order round the polygon */
} weft_stiffness;

/** Computes guaranteed bounds of all modes in a state, in one pass over the springs,
 * without allocation.
 *
 * With y NULL they hold in any state and are less sharp: on triangles while no stretch
 * is above 1.1 and no triangle has less than 0.6 of its area, as a stretched membrane
 * stiffens without end, and with `arc` while no edge turns by more than 0.25 rad; with
 * colliders, for particles that touch one at a time and arrive at no more than
 * stopping_speed (docs/theory/stability.md). Where friction makes w2 and c complex,
 * their real parts are bounded. With contact of the cloth with itself the bounds are
 * estimates: the slopes of the feature weights are left out, and with y NULL layers
 * meet at no more than stopping_speed.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles; NULL: any state
 * @return the bounds; not finite if y is not
 * @par Example
 * @snippet adaptive.c stable step */
WEFT_API weft_stiffness weft_cloth_stiffness(const weft_cloth *cloth, double t,
                                             const double *y);

/** Computes bounds in a state, sharpened by the power method from a fixed start. omega2
 * and damping become Rayleigh quotients, which never exceed the largest values, and the
 * corners are cut down to slightly above them. The result is not guaranteed; together
 * with the guaranteed bounds it encloses the true values.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param iterations steps of the power method; 0: 100
 * @param[out] out the bounds
 * @param[out] err may be NULL
 * @return WEFT_OK; WEFT_INVALID (y is NULL), WEFT_NO_MEMORY */
WEFT_API weft_status weft_cloth_stiffness_refined(const weft_cloth *cloth, double t,
                                                  const double *y, size_t iterations,
                                                  weft_stiffness *out, weft_error *err);

/** Sums m v over the free particles.
 * @param cloth the cloth
 * @param y a state, 6 N doubles
 * @param[out] p [kg m/s] */
WEFT_API void weft_cloth_momentum(const weft_cloth *cloth, const double *y,
                                  double p[3]);

/** Sums m x cross v over the free particles, about the origin of the coordinates.
 * @param cloth the cloth
 * @param y a state, 6 N doubles
 * @param[out] l [kg m^2/s] */
WEFT_API void weft_cloth_angular_momentum(const weft_cloth *cloth, const double *y,
                                          double l[3]);

/** Finds the spring with the largest strain, the first by rows among equals; NaN counts
 * as larger than every number.
 * @param cloth the cloth
 * @param y a state, 6 N doubles
 * @return the spring; strain 0 and p = q = 0 of a cloth without springs */
WEFT_API weft_spring weft_cloth_worst_spring(const weft_cloth *cloth, const double *y);

/** Computes the largest strain (L - s) / s of the springs at each particle.
 * @param cloth the cloth
 * @param y a state, 6 N doubles
 * @param[out] strain N doubles, by particle index: negative if all springs are
 *   compressed, 0 without springs */
WEFT_API void weft_cloth_strains(const weft_cloth *cloth, const double *y,
                                 double *strain);

/** Computes the smallest gap of a free particle to a collider, and where: the first by
 * particles, then colliders, among equals; NaN counts as smaller than every number.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param[out] particle its index, 0 if there is none; may be NULL
 * @param[out] shape the collider's index, 0 if there is none; may be NULL
 * @return [m]; INFINITY if there is none
 * @par Example
 * @snippet dragged_sphere.c load */
WEFT_API double weft_cloth_gap(const weft_cloth *cloth, double t, const double *y,
                               size_t *particle, size_t *shape);

/** Counts the free particles with a gap below the thickness to some collider; with mesh
 * colliders, those of edges and triangles with such a gap, too.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @return their number */
WEFT_API size_t weft_cloth_touching(const weft_cloth *cloth, double t, const double *y);

/** Computes the smallest distance of two primitives that push each other apart, and
 * which: the first in the order of the search among equals.
 * @param cloth the cloth
 * @param y a state, 6 N doubles
 * @param[out] pair the two primitives, counts of 0 if there are none; may be NULL
 * @return [m]; INFINITY if there are none */
WEFT_API double weft_cloth_self_gap(const weft_cloth *cloth, const double *y,
                                    weft_primitive pair[2]);

/* An edge or a triangle of the cloth that passes through a shape. Fixed for ever. */
typedef struct weft_passage {
    weft_primitive primitive;
    size_t shape;
} weft_passage;

/** Counts the edges of the cloth that pass through a sphere, capsule or box, and
 * triangles without such an edge: they have a point deeper inside than a quarter of the
 * thickness, or of the radius or rounding if that is less; cloth that sags between
 * particles has not. Decided exactly, by the gap of the collider along them. Primitives
 * that pins hold there, by all of their corners or by one inside the collider, do not
 * count.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N finite doubles
 * @param[out] first one of them, of count 0 if there is none; may be NULL
 * @return their number */
WEFT_API size_t weft_cloth_passages(const weft_cloth *cloth, double t, const double *y,
                                    weft_passage *first);

/** Counts the pairs of primitives that push each other apart.
 * @param cloth the cloth
 * @param y a state, 6 N doubles
 * @return their number */
WEFT_API size_t weft_cloth_self_touching(const weft_cloth *cloth, const double *y);

/** Counts self-intersections: pairs of an edge and a triangle that have a point in
 * common beside a common particle, or in a chain of two such edges, and neighbours at
 * the same place. Decided exactly, whether the cloth has self-contact or not; pairs of
 * pinned particles alone do not count, and the edges of a slit pass through each other
 * freely. Takes O(N log N) unless much of the cloth is in one place. Allocates nothing
 * on a grid, nor on triangles with self-contact.
 * @param cloth the cloth
 * @param y a state, 6 N finite doubles
 * @param[out] pair the first, by its edge: the particles of the smallest index; counts
 *   of 0 if there is none. May be NULL
 * @return their number; SIZE_MAX: no memory */
WEFT_API size_t weft_cloth_crossings(const weft_cloth *cloth, const double *y,
                                     weft_primitive pair[2]);

/** Counts the colliders.
 * @param cloth the cloth; weft_sim_cloth() for the present colliders of a simulation
 * @return their number */
WEFT_API size_t weft_cloth_shapes(const weft_cloth *cloth);

/* Two parts of a cloth, or one and a mesh collider, that cross or touch; or a free
 * particle inside another collider. Fixed for ever. */
typedef struct weft_crossing {
    char text[224];        /* "edge (3, 4)-(3, 5) passes through cell (9, 2)" */
    size_t count[2];       /* points of both: 1 to 3; 0: none */
    double place[2][3][3]; /* [m] of each */
} weft_crossing;

/* Calls `each`, unless it is NULL, for all that make a state at t = 0 an error of
 * weft_cloth_create, but cloth inside a closed body; returns their number, SIZE_MAX: no
 * memory. */
typedef void weft_crossing_fn(void *ctx, const weft_crossing *one);

/** Calls a function for each intersection that makes a state at t = 0 an error of
 * weft_cloth_create, but for cloth inside a closed body.
 * @param cloth the cloth
 * @param y a state, 6 N finite doubles
 * @param each called with each intersection; NULL: only count
 * @param ctx passed to each
 * @return their number; SIZE_MAX: no memory */
WEFT_API size_t weft_cloth_each_crossing(const weft_cloth *cloth, const double *y,
                                         weft_crossing_fn *each, void *ctx);

/** Relaxes a start of a cloth with weft_cloth_def.untangle by its elastic forces,
 * strongly damped, while what intersects is moved apart; then free particles are at
 * rest. A state without intersections stays as it is. Ends after untangle seconds, or
 * where the number of intersections does not fall any more; y is then the state with
 * the fewest, and never has more than it began with.
 * @param cloth the cloth
 * @param[in,out] y a state, 6 N doubles
 * @param[out] err may be NULL
 * @return WEFT_OK; with y finite: WEFT_SOLVER (the message says what is left),
 *   WEFT_STOPPED (`stop` of the definition), WEFT_NO_MEMORY; WEFT_INVALID (y is not
 *   finite) */
WEFT_API weft_status weft_cloth_untangle(const weft_cloth *cloth, double *y,
                                         weft_error *err);

/** Returns the contact that a cloth was defined with, without the colliders.
 * @param cloth the cloth
 * @return the contact; weft_cloth_shape has the colliders */
WEFT_API weft_contact_def weft_cloth_contact(const weft_cloth *cloth);

/** Returns a collider of the cloth.
 * @param cloth the cloth
 * @param k < weft_cloth_shapes()
 * @return the collider; the body of a mesh is the cloth's own */
WEFT_RESULT(weft_shape, weft_cloth_shape, (const weft_cloth *cloth, size_t k),
            (cloth, k))

/** Computes where a collider is.
 * @param cloth the cloth
 * @param k < weft_cloth_shapes()
 * @param t [s]
 * @param[out] at [m] the place of its `at`; may be NULL
 * @param[out] velocity [m/s] of that point; may be NULL
 * @par Example
 * @snippet dragged_sphere.c drag */
WEFT_API void weft_cloth_shape_pose(const weft_cloth *cloth, size_t k, double t,
                                    double at[3], double velocity[3]);

/** Computes how a collider stands.
 * @param cloth the cloth
 * @param k < weft_cloth_shapes()
 * @param t [s]
 * @param[out] rotation 3 x 3, by rows: of its directions as defined, of a box from x,
 *   y, z; may be NULL
 * @param[out] omega [rad/s] of its rotation; may be NULL */
WEFT_API void weft_cloth_shape_rotation(const weft_cloth *cloth, size_t k, double t,
                                        double rotation[9], double omega[3]);

/** Computes the force and the torque that the cloth exerts on a collider.
 * @param cloth the cloth
 * @param t [s]
 * @param y a state, 6 N doubles
 * @param k < weft_cloth_shapes()
 * @param[out] force [N]
 * @param[out] torque [N m] about its `at` */
WEFT_API void weft_cloth_shape_load(const weft_cloth *cloth, double t, const double *y,
                                    size_t k, double force[3], double torque[3]);

/** Computes a 64-bit hash of the bits of a state. Equal states have equal hashes on
 * every machine with IEEE 754 doubles and either byte order. Each row of a grid, or
 * block of 512 particles of triangles, is hashed, plane after plane in their order, and
 * the hashes of the rows in their order, both by
 *
 *     h = 0xcbf29ce484222325; for each word w of 64 bits:
 *         h = (h ^ w ^ (w >> 32)) * 0x100000001b3; h = h ^ (h >> 29)
 *
 * @param cloth the cloth
 * @param y a state, 6 N doubles
 * @return the hash */
WEFT_API uint64_t weft_cloth_state_hash(const weft_cloth *cloth, const double *y);

/** Computes weft_cloth_state_hash of a grid without its cloth.
 * @param y 6 rows cols doubles
 * @param rows of the grid
 * @param cols of the grid
 * @return the hash */
WEFT_API uint64_t weft_state_hash(const double *y, size_t rows, size_t cols);

#ifdef __cplusplus
}
#endif

#endif
