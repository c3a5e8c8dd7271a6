/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_contact.c -- contact in a scene: rules between its keys, and warnings. */
#include <string.h>

#include "base/memory.h"
#include "cloth/model.h"
#include "forces/contact/closing.h"
#include "forces/contact/passage.h"
#include "mesh/grid_def.h"
#include "mesh/triangles_work.h"
#include "scene/contact/contact_checks.h"

void weft__read_shape(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    const weft_shape *shapes = reader->scene->cloth.contact.shapes;
    weft__shape_item item = { .file = NULL };
    item.shape = weft_shape_default(WEFT_SHAPES); /* of no kind yet */
    reader->shape = shapes == NULL ? 0 : (size_t)((weft_shape *)to - shapes);
    weft__read_mapping(reader, key, node, &item);
    *(weft_shape *)to = item.shape;
}

/* ---- errors ------------------------------------------------------------------ */

void weft__check_shape(weft__reader *reader, const weft__match *match, void *base)
{
    weft__shape_item *item = base;
    const weft_shape *shape = &item->shape;
    const size_t before = reader->report->mistakes;
    bool wrong = !weft__check_motion(reader, match, shape->amplitude, shape->frequency)
                 || shape->kind == WEFT_SHAPES || match->wrong;
    if (!wrong && shape->kind == WEFT_MESH && item->file != NULL) {
        weft__read_body(reader, match, item);
        wrong = reader->report->mistakes > before || item->shape.body == NULL;
    }
    if (!wrong && weft__shape_check(shape, reader->shape, &match->faults)
        && item->facets != 0.0) {
        weft__make_facets(reader, match, item);
    }
}

static bool has_friction(const weft_contact_def *contact)
{
    bool has = (contact->self || contact->shape_count == 0) && contact->friction > 0.0;
    for (size_t k = 0; k < contact->shape_count; ++k) {
        has = has || weft__friction_of(&contact->shapes[k], contact->friction) > 0.0;
    }
    return has;
}

/* Comparisons; what takes more is left to weft_cloth_create. */
#define MAX_COMPARED ((double)(1 << 26))

/* The grid and its pins have been read before. */
static void check_start(weft__reader *reader, const weft__node *shapes)
{
    const weft_cloth_def *def = &reader->scene->cloth;
    const double particles = (double)weft__particles_in(reader->scene);
    const double each
        = (double)def->contact.shape_count * (1.0 + (double)def->pin_count);
    for (size_t k = 0; k < def->contact.shape_count && particles * each < MAX_COMPARED;
         ++k) {
        char inside[120];
        if (!weft__start_check(def, k, inside, sizeof inside)) {
            ERROR_AT(reader, weft__item(shapes, k), "%s", inside);
        }
    }
}

/* What weft_cloth_create finds: a grid starts flat, so that only rounding can bring it
 * into itself; of a mesh also notches. */
static void check_crossings(weft__reader *reader, const weft__node *at, bool bodies)
{
    weft_cloth_def def = reader->scene->cloth;
    weft_cloth *cloth = NULL;
    weft_error err = { 0 };
    if ((double)weft__particles_in(reader->scene) >= MAX_COMPARED) {
        return;
    }
    def.contact.shape_count = bodies ? def.contact.shape_count : 0;
    def.contact.self = !bodies;
    def.allocator = reader->report->memory;
    const weft_status status = weft_cloth_create(&def, &cloth, &err);
    if (status == WEFT_INVALID) {
        ERROR_AT(reader, at, "%s", err.message);
    }
    if (status == WEFT_NO_MEMORY) {
        reader->report->no_memory = true;
    }
    reader->report->stopped = reader->report->stopped || status == WEFT_STOPPED;
    weft_cloth_destroy(cloth);
}

static bool has_bodies(const weft_contact_def *contact)
{
    bool has = false;
    for (size_t k = 0; k < contact->shape_count; ++k) {
        has = has || contact->shapes[k].kind == WEFT_MESH;
    }
    return has;
}

void weft__check_contact(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_contact_def *contact = base;
    const weft__node *slip = weft__key_in(match, "slip");
    if (slip != NULL && !has_friction(contact)) {
        ERROR_AT(reader, slip,
                 "slip has no effect without friction: it is 0 everywhere");
    }
    weft__contact_check(contact, &match->faults);
    const bool cloth = weft__particles_in(reader->scene) > 0;
    if (cloth
        && (reader->scene->cloth.mesh == NULL || reader->report->found->errors == 0)) {
        weft__self_check(&reader->scene->cloth, &match->faults);
    }
    if (!cloth || reader->report->found->errors > 0 || reader->report->no_memory) {
        return;
    }
    if (contact->shape_count > 0 && reader->scene->cloth.untangle == 0.0) {
        check_start(reader, weft__value_in(match, "shapes"));
    }
    if ((has_bodies(contact) || reader->scene->cloth.strict)
        && reader->report->found->errors == 0) {
        check_crossings(reader, weft__value_in(match, "shapes"), true);
    }
    const weft__node *self = weft__value_in(match, "self");
    if (contact->self) {
        check_crossings(reader, self, false);
    } else if (contact->shape_count == 0 && self == NULL) {
        WARNING_AT(reader, match->map,
                   "contact has no effect: it has no shapes, and self is "
                   "not true");
    }
}

/* ---- warnings ---------------------------------------------------------------- */

double weft__longest_edge(const weft_cloth_def *def, bool start)
{
    const weft_mesh_def *mesh = def->mesh;
    if (mesh == NULL) {
        return fmax(def->rows > 1 ? def->spacing[0] : 0.0,
                    def->cols > 1 ? def->spacing[1] : 0.0);
    }
    double most = 0.0, longest = 0.0, square = 0.0;
    for (size_t k = 0; mesh->grids != NULL && k < mesh->part_count; ++k) {
        most = fmax(most, mesh->grids[k] != NULL
                              ? weft__longest_edge(mesh->grids[k], start)
                              : 0.0);
    }
    for (size_t t = 0; !start && t < mesh->triangles; ++t) {
        (void)weft__twice_area(mesh, t, &longest);
        most = fmax(most, longest);
    }
    for (size_t j = 0; start && j < 3 * mesh->triangles; ++j) {
        const double *a = mesh->start + 3 * (size_t)mesh->corners[j];
        const double *b
            = mesh->start + 3 * (size_t)mesh->corners[j % 3 == 2 ? j - 2 : j + 1];
        double length = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            length += (b[k] - a[k]) * (b[k] - a[k]);
        }
        square = fmax(square, length);
    }
    return fmax(most, sqrt(square));
}

/* Between particles the cloth is flat. */
static void warn_of_chord(weft__report *report, const weft_cloth_def *def, size_t k,
                          double longest, weft__mark at)
{
    const weft_shape *shape = &def->contact.shapes[k];
    const double dip = weft__shape_dip(shape, longest);
    const double thick = 2.0 * weft__shape_half(shape);
    if (dip > def->contact.thickness && thick < longest) {
        weft__report_warning(report, at,
                             "shapes[%zu] is %.3g mm thick and can pass between "
                             "particles %.3g m apart, unless it has triangles: true, "
                             "or the cloth a finer mesh",
                             k, 1e3 * thick, longest);
    } else if (dip > def->contact.thickness) {
        weft__report_warning(
            report, at,
            "between particles %.3g m apart the cloth dips %.3g mm into %sshapes[%zu], "
            "more than the thickness of %.3g mm: the shape shows through, unless it "
            "has triangles: true, or the cloth a finer mesh",
            longest, 1e3 * dip, shape->kind == WEFT_BOX ? "the edges of " : "", k,
            1e3 * def->contact.thickness);
    }
}

/* The stiffness of coulomb is 2 friction N / (m slip): at rest N / m is gravity's. */
static void warn_of_friction(weft__report *report, const weft_contact_def *contact,
                             double friction, const char *of, weft__mark at)
{
    const double most = 1e4; /* [s/m] */
    if (contact->law == WEFT_FRICTION_COULOMB && friction > most * contact->slip) {
        weft__report_warning(
            report, at,
            "friction %g of %s with law coulomb and slip %g m/s needs steps of some "
            "%.1g s: raise slip, or use law smooth",
            friction, of, contact->slip, contact->slip / (friction * 9.81));
    }
}

/* Times at which a moving pin is compared with a shape, and comparisons in all. */
enum { TIMES = 997, MOST_TIMES = 1 << 20 };

/* [s] The first time at which a pinned particle is inside a shape; < 0: never. */
static double time_inside(const weft_shape *def, const weft__motion *motion,
                          const double start[3], double duration, size_t *compared)
{
    const weft__shape shape = weft__shape_of(def, 0.0);
    const size_t last
        = shape.motion.motion.moves || shape.motion.turns || motion->moves ? TIMES : 0;
    double found = -1.0;
    for (size_t i = 0; i <= last && found < 0.0; ++i) {
        const double t = duration * ((double)i / TIMES);
        const weft__pose pose = weft__pose_of(&shape, t);
        double x[3];
        weft__motion_offset(motion, t, x);
        for (size_t k = 0; k < 3; ++k) {
            x[k] += start[k];
        }
        ++*compared;
        found = weft__gap_at(&pose, x) <= 0.0 ? t : -1.0;
    }
    return found;
}

/* A pin's first particle that enters a shape. */
static void warn_of_pin(weft__reader *reader, const weft__mesh *grid, size_t pin,
                        weft__mark at, size_t *compared)
{
    const weft_cloth_def *def = &reader->scene->cloth;
    size_t top, bottom, left, right;
    (void)weft__range_resolve(def->pins[pin].rows, def->rows, &top, &bottom);
    (void)weft__range_resolve(def->pins[pin].cols, def->cols, &left, &right);
    const size_t wide = right - left + 1, count = wide * (bottom - top + 1);
    double *rows = weft__tree_take(reader->tree, def->pins[pin].path.count + 1,
                                   WEFT__CURVE_WIDTH * sizeof *rows);
    if (rows == NULL) {
        return;
    }
    const weft__motion motion = weft__pin_motion(&def->pins[pin], rows);
    for (size_t i = 0; i < count * def->contact.shape_count; ++i) {
        const size_t k = i / count, r = top + i % count / wide, c = left + i % wide;
        double x[3];
        weft__grid_start(grid, r * grid->cols + c, x);
        *compared += def->pin_count;
        if (*compared > MOST_TIMES) {
            return;
        }
        const double t = weft__grid_pin_of(def, r, c) != pin + 1
                             ? -1.0
                             : time_inside(&def->contact.shapes[k], &motion, x,
                                           reader->scene->run.duration, compared);
        if (t >= 0.0) {
            weft__report_warning(reader->report, at,
                                 "pinned particle (%zu, %zu) is inside shapes[%zu] at "
                                 "t = %.4g s: contact does not stop it",
                                 r, c, k, t);
            return;
        }
    }
}

/* In a step of the limit a particle at the stopping speed passes half the thickness. */
static void warn_of_stepper(weft__reader *reader, const weft__node *method,
                            const weft__node *fixed_step)
{
    const weft_scene *scene = reader->scene;
    const weft_contact_def *contact = &scene->cloth.contact;
    const double h = scene->config.fixed_step;
    const double most = contact->thickness / (2.0 * contact->stopping_speed);
    if (strcmp(scene->method, "velocity_verlet") == 0 && has_friction(contact)) {
        WARNING_AT(
            reader, method,
            "velocity_verlet takes friction explicitly, which makes large errors of "
            "the energy: use a Runge-Kutta method");
    }
    if (h > most) {
        WARNING_AT(
            reader, fixed_step,
            "fixed_step %g s is longer than contact.thickness / (2 stopping_speed) = "
            "%.3g s: steps that may pass through a surface are rejected and halved",
            h, most);
    }
}

/* Nearly parallel edges push each other apart weakly (docs/guides/self-contact.md,
 * Limits). */
static void warn_of_cells(weft__reader *reader, weft__mark at)
{
    const weft_cloth_def *def = &reader->scene->cloth;
    const double down = def->spacing[0], right = def->spacing[1];
    if (def->rows > 1 && def->cols > 1
        && fmax(down, right) > 10.0 * fmin(down, right)) {
        weft__report_warning(reader->report, at,
                             "the cells of %g m x %g m are more than 10 times as long "
                             "as wide: contact of the cloth with itself may need very "
                             "short steps",
                             down, right);
    }
}

/* Where a cloth starts. */
typedef struct start {
    const weft_cloth_def *def;
    weft__mesh grid;
} start;

static void start_of(const void *ctx, size_t i, double x[3])
{
    const start *of = ctx;
    if (of->def->mesh != NULL) {
        weft__def_start(of->def->mesh, i, x);
    } else {
        weft__grid_start(&of->grid, i, x);
    }
}

/* Of shapes that will meet with the cloth between them, where it starts. */
static void warn_of_closing(weft__reader *reader, const weft__node *nodes)
{
    const weft_cloth_def *def = &reader->scene->cloth;
    const weft_contact_def *law = &def->contact;
    const size_t count = law->shape_count;
    const double compared = (double)weft__particles_in(reader->scene) * (double)count;
    start of = { .def = def };
    char name[96];
    if (count < 2 || compared * (double)count >= MAX_COMPARED) {
        return;
    }
    weft__shape *shapes = weft__alloc(reader->report->memory, count, sizeof *shapes);
    if (shapes == NULL) {
        reader->report->no_memory = true;
        return;
    }
    for (size_t k = 0; k < count; ++k) {
        shapes[k] = weft__shape_of(&law->shapes[k], law->friction);
    }
    if (def->mesh == NULL) {
        weft__grid_init(&of.grid, def);
    }
    const weft__closing_search search
        = { .shapes = shapes,
            .shape_count = count,
            .end = def->mesh != NULL ? def->mesh->vertices : of.grid.particles,
            .place = start_of,
            .ctx = &of,
            .thickness = law->thickness,
            .within = INFINITY,
            .t_last = reader->scene->run.duration };
    const weft__closing found = weft__shapes_closing(&search);
    weft__free(reader->report->memory, shapes);
    if (found.found) {
        weft__report_warning(
            reader->report, weft__item(nodes, found.shape[1])->at,
            "shapes[%zu] and shapes[%zu] are two thicknesses (%.3g mm) apart at t = "
            "%.3g s and meet at t = %.3g s, with %s between them at the start: contact "
            "cannot keep cloth out of both, so steps shrink until the run ends",
            found.shape[0], found.shape[1], 2e3 * law->thickness, found.near_time,
            found.meet_time,
            weft__particle_text(def, found.particle, name, sizeof name));
    }
}

/* A pair of contact takes the smaller density of its two parts: where both are the
 * same, the derivative by one of them has a kink. */
static void warn_of_equal_densities(weft__reader *reader, const weft__match *root)
{
    static const char ending[] = ".density";
    const weft_scene *scene = reader->scene;
    const weft_scene_sensitivity *of = &scene->sensitivity;
    const weft_mesh_def *mesh = scene->cloth.mesh;
    const weft__node *section = weft__value_in(root, "sensitivity");
    const weft__node *list = section != NULL ? weft__value_of(section, "of") : NULL;
    for (size_t i = 0; mesh != NULL && scene->cloth.contact.self && i < of->count;
         ++i) {
        const size_t length = strlen(of->keys[i]), tail = sizeof ending - 1;
        size_t same = 0;
        for (size_t k = 0; k < mesh->fabric_count; ++k) {
            same += mesh->fabrics[k].density == of->values[i];
        }
        if (length > tail && strcmp(of->keys[i] + length - tail, ending) == 0
            && same > 1) {
            WARNING_AT(
                reader, weft__item(list, i),
                "%s is also the density of another fabric: contact takes the "
                "smaller of two densities, so the derivative with respect to one of "
                "two equal ones has a kink",
                of->keys[i]);
        }
    }
}

void weft__check_late_contact(weft__reader *reader, const weft__match *root, void *base)
{
    const weft_scene *scene = base;
    const weft_cloth_def *def = &scene->cloth;
    const weft__node *stepper = weft__value_in(root, "stepper");
    const weft_contact_def *law = &def->contact;
    if (law->shape_count == 0 && !law->self) {
        return;
    }
    const weft__node *contact = weft__value_in(root, "contact");
    const weft__node *shapes = weft__value_of(contact, "shapes");
    if (reader->report->mistakes == 0) {
        warn_of_equal_densities(reader, root);
    }
    if (law->self) {
        warn_of_friction(reader->report, law, law->friction, "the cloth on itself",
                         weft__value_of(contact, "self")->at);
        warn_of_cells(reader, weft__value_of(contact, "self")->at);
    }
    const double longest = weft__longest_edge(def, false);
    for (size_t k = 0; k < law->shape_count; ++k) {
        const weft__mark at = weft__item(shapes, k)->at;
        char name[32];
        (void)snprintf(name, sizeof name, "shapes[%zu]", k);
        warn_of_chord(reader->report, def, k, longest, at);
        warn_of_friction(reader->report, law,
                         weft__friction_of(&law->shapes[k], law->friction), name, at);
    }
    const weft__node *pins = def->mesh == NULL
                                 ? weft__value_of(weft__value_in(root, "cloth"), "pins")
                                 : NULL;
    weft__mesh grid = { .rows = 0 };
    size_t compared = 0;
    for (size_t i = 0; pins != NULL && i < def->pin_count; ++i) {
        weft__grid_init(&grid, def);
        warn_of_pin(reader, &grid, i, weft__item(pins, i)->at, &compared);
    }
    warn_of_closing(reader, shapes);
    warn_of_stepper(reader, weft__value_of(stepper, "method"),
                    weft__value_of(stepper, "fixed_step"));
}
