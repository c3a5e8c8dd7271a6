/* SPDX-License-Identifier: BSD-3-Clause */
/* adjoint.c -- the gradient of an objective, backwards through the steps of a run
 * (docs/guides/gradients.md). A run forwards records its steps and leaves checkpoints;
 * from each of these, the last one first, the states of the stages up to the next are
 * computed again, kept, and gone through from their end. Both levels have as much
 * memory.
 *
 * With the derivatives G_j of the objective with respect to the states j = k + 1, ...
 * of a step (sim/stages.h), that by rate k is w_k = sum share_jk G_j, G_k = J^T w_k,
 * and what it adds with respect to a parameter w_k.df/dp. */
#include <math.h>

#include "base/memory.h"
#include "base/sized.h"
#include "forces/springs/springs_products.h"
#include "sim/simulation.h"
#include "sim/stages.h"
#include "weft/gradient.h"

typedef struct recorded_step {
    double t, h;  /* [s] where it begins, its length */
    double piece; /* [s] that of tables and keys (mesh/track.h) */
    bool restarts;
    bool keeps;   /* its first state in the segment is its start */
    size_t first; /* where its states are in the segment */
} recorded_step;

typedef struct adjoint {
    const weft_gradient_def *def;
    weft_sim *sim;
    weft_allocator memory;
    weft__stages *table;
    weft__parameter_derivative *derivatives; /* of each parameter */
    recorded_step *steps;
    size_t count, room_for; /* steps */
    size_t *frame;          /* of each frame the step after it */
    double **checkpoints;   /* the state, then v' of rate 0, of every so many steps;
                             * after those kept, spare ones */
    size_t every, kept, made;
    size_t slots;    /* states of stages that a step has in `segment` */
    double *segment; /* the states of `every` steps that are needed backwards */
    double *rates[WEFT__STAGES + 1], *by_state[WEFT__STAGES + 2];
    /* 6 N each; carried: by the next step's rate 0. Of free particles only their
     * second half is ever written. */
    double *vectors, *w, *carried;
    double *room[3];
    double *net; /* [N] 3 N, if the masses depend on a parameter, else NULL */
    double *value, *by_parameter;
} adjoint;

void weft_gradient_def_init(weft_gradient_def *def, size_t size)
{
    const weft_gradient_def start = { .struct_size = (uint32_t)size };
    weft__sized_write(def, size, &start, sizeof start);
}

/* ---- made -------------------------------------------------------------------------
 */

static weft_status adjoint_no_memory(weft_error *err)
{
    return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a gradient");
}

static weft_status adjoint_check(const weft_gradient_def *def,
                                 const double *by_parameter, weft_error *err)
{
    double before = 0.0;
    if (def->sim == NULL || def->objective == NULL
        || (def->count > 0 && (def->parameters == NULL || by_parameter == NULL))
        || (def->frames > 0 && def->times == NULL)) {
        return weft_error_set(
            err, WEFT_INVALID,
            "a gradient needs a sim, an objective, as many numbers and times as it "
            "says, and by_parameter for these numbers: one is NULL");
    }
    for (size_t i = 0; i < def->frames; ++i) {
        if (!(def->times[i] >= before) || !isfinite(def->times[i])) {
            return weft_error_set(err, WEFT_INVALID,
                                  "times[%zu] = %g s: they must ascend from 0", i,
                                  def->times[i]);
        }
        before = def->times[i];
    }
    return WEFT_OK;
}

static size_t dim_of(const adjoint *of)
{
    return weft_cloth_dim(of->sim->cloth);
}

static weft_status adjoint_make_sim(adjoint *of, weft_error *err)
{
    weft_sim_def def;
    TRY(WEFT__DEF_READ(weft_sim_def, &def, of->def->sim, WEFT__DEF_MOST, err));
    def.sensitivity = NULL;
    TRY(weft_sim_create(&def, &of->sim, err));
    const char *why = weft__sensitivity_refusal(of->sim);
    if (why != NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "no gradient with %s", why);
    }
    return weft__stages_find(of->sim->def.method, &of->sim->config, of->table, err);
}

static weft_status adjoint_make_room(adjoint *of, weft_error *err)
{
    const size_t dim = dim_of(of), end = of->table->count + 1;
    for (size_t k = 1; k < end; ++k) {
        of->slots += of->table->needed[k];
    }
    of->vectors = weft__zeroed(&of->memory, (2 * end + 7) * dim, sizeof(double));
    of->frame = weft__zeroed(&of->memory, of->def->frames, sizeof *of->frame);
    of->derivatives
        = weft__zeroed(&of->memory, of->def->count, sizeof *of->derivatives);
    if (of->vectors == NULL || of->frame == NULL || of->derivatives == NULL) {
        return adjoint_no_memory(err);
    }
    double *next = of->vectors;
    for (size_t k = 0; k < end; ++k, next += dim) {
        of->rates[k] = next;
    }
    for (size_t k = 0; k <= end; ++k, next += dim) {
        of->by_state[k] = next;
    }
    of->w = next, of->carried = next + dim;
    for (size_t k = 0; k < 3; ++k) {
        of->room[k] = next + (2 + k) * dim;
    }
    return WEFT_OK;
}

static weft_status make_derivatives(adjoint *of, weft_error *err)
{
    for (size_t j = 0; j < of->def->count; ++j) {
        const weft_parameter *parameter = &of->def->parameters[j];
        weft_error inner = { 0 };
        const weft_status status = weft__parameter_derivative_init(
            &of->derivatives[j], of->sim->cloth, parameter->less, parameter->more,
            parameter->span, 1.0, &of->memory, &inner);
        if (status != WEFT_OK) {
            return weft_error_set(
                err, status, "gradient, parameter %zu, %.60s: %.200s", j,
                parameter->name == NULL ? "unnamed" : parameter->name, inner.message);
        }
        of->by_parameter[j] = 0.0;
        if (of->derivatives[j].inverse_mass != NULL) {
            of->net = of->room[2] + dim_of(of);
        }
    }
    return WEFT_OK;
}

/* ---- forwards ---------------------------------------------------------------------
 */

/* So many checkpoints that fewer, or more, would take more memory with their segment.
 */
static size_t most_of(const adjoint *of)
{
    return of->every * of->slots * (of->table->carries ? 4 : 6) / 3;
}

/* Keeps every second checkpoint. */
static void thin(adjoint *of)
{
    for (size_t i = 0; i < of->kept; i += 2) {
        double *to = of->checkpoints[i];
        of->checkpoints[i] = of->checkpoints[i / 2];
        of->checkpoints[i / 2] = to;
    }
    of->kept = (of->kept + 1) / 2;
    of->every *= 2;
}

static weft_status leave_checkpoint(adjoint *of, weft_error *err)
{
    const size_t dim = dim_of(of), half = of->table->carries ? dim / 2 : 0;
    if (of->kept == of->made) {
        double **list = weft__resize(&of->memory, of->checkpoints, of->made + 1,
                                     sizeof *of->checkpoints);
        of->checkpoints = list != NULL ? list : of->checkpoints;
        double *to = weft__alloc(&of->memory, dim + half, sizeof *to);
        if (to == NULL || list == NULL) {
            weft__free(&of->memory, to);
            return adjoint_no_memory(err);
        }
        of->checkpoints[of->made++] = to;
    }
    double *to = of->checkpoints[of->kept++];
    memcpy(to, of->sim->y, dim * sizeof *to);
    memcpy(to + dim, of->rates[0] + dim / 2, half * sizeof *to);
    return WEFT_OK;
}

/* One step of the run, which step of->count begins. */
static weft_status record_step(adjoint *of, double t_end, weft_error *err)
{
    weft_sim *sim = of->sim;
    const uint64_t rejected = sim->guard.vetoed;
    const bool begins = of->count == 0 || sim->piece_begins;
    if (of->count == of->room_for) {
        const size_t more = 2 * of->room_for + 64;
        recorded_step *steps
            = weft__resize(&of->memory, of->steps, more, sizeof *steps);
        if (steps == NULL) {
            return adjoint_no_memory(err);
        }
        of->steps = steps, of->room_for = more;
    }
    if (of->count % of->every == 0 && of->kept == most_of(of)) {
        thin(of);
    }
    if (of->count % of->every == 0 && leave_checkpoint(of, err) != WEFT_OK) {
        return WEFT_NO_MEMORY;
    }
    sim->rates = (of->count + 1) % of->every == 0 ? of->rates[0] : NULL;
    of->steps[of->count] = (recorded_step){ .t = sim->t };
    const weft_status status = weft_sim_step(sim, t_end, err);
    of->steps[of->count].piece = sim->piece;
    of->steps[of->count].restarts = begins || sim->guard.vetoed > rejected;
    of->steps[of->count++].h = weft_sim_stats(sim).last_step;
    return status;
}

static weft_status record(adjoint *of, weft_error *err)
{
    weft_status status = WEFT_OK;
    of->every = 8;
    for (size_t i = 0; status == WEFT_OK && i < of->def->frames; ++i) {
        while (status == WEFT_OK && of->sim->t < of->def->times[i]) {
            status = record_step(of, of->def->times[i], err);
        }
        of->frame[i] = of->count;
    }
    of->sim->rates = NULL;
    return status;
}

/* ---- the states of a step ---------------------------------------------------------
 */

/* Where the part of a plane that begins at `low` ends: few enough to stay in the first
 * cache, whatever is added to them. */
static size_t part_end(size_t low, size_t end)
{
    return end - low < 1024 ? end : low + 1024;
}

/* State k of a step of h from y. */
static void find_state(const adjoint *of, size_t k, double h, const double *y,
                       double *to)
{
    const weft__mesh *mesh = &of->sim->cloth->mesh;
    const size_t n = mesh->particles, half = 3 * n;
    const double advance = h * of->table->c[k];
    for (size_t low = 0, high; low < half; low = high) {
        high = part_end(low, half);
        for (size_t i = low; i < high; ++i) {
            to[i] = y[i] + advance * y[half + i];
            to[half + i] = y[half + i];
        }
        for (size_t j = 0; j < k; ++j) {
            const weft__share *by = &of->table->share[k][j];
            const double *a = of->rates[j] + half, x = h * h * by->xa, v = h * by->va;
            for (size_t i = low; (x != 0.0 || v != 0.0) && i < high; ++i) {
                to[i] += x * a[i];
                to[half + i] += v * a[i];
            }
        }
    }
    for (size_t i = 0; i < 3 * mesh->pinned; ++i) {
        const size_t at = mesh->pins[i / 3] + i % 3 * n;
        to[at] = y[at], to[half + at] = y[half + at];
        for (size_t j = 0; j < k; ++j) {
            const weft__share *by = &of->table->share[k][j];
            const double *rate = of->rates[j];
            to[at] += h * (by->xp * rate[at] + h * by->xq * rate[half + at]);
            to[half + at] += h * by->vq * rate[half + at];
        }
    }
}

/* Where `segment` has state k of a step; 0: its start, if the step keeps that. */
static double *adjoint_place_of(const adjoint *of, size_t step, size_t k)
{
    size_t slot = of->steps[step].first;
    for (size_t j = 0; j < k; ++j) {
        slot += j == 0 ? of->steps[step].keeps : of->table->needed[j];
    }
    return of->segment + slot * dim_of(of);
}

/* The state at the start of a step that has a checkpoint or keeps it; that at the end
 * of the run. */
static const double *adjoint_start_of(const adjoint *of, size_t step)
{
    return step == of->count       ? of->sim->y
           : step % of->every == 0 ? of->checkpoints[step / of->every]
                                   : adjoint_place_of(of, step, 0);
}

/* Finds where the states of steps are, and has room for them. */
static weft_status make_segment(adjoint *of, weft_error *err)
{
    size_t most = 1, next = 0, frame = 0;
    for (size_t i = 0; i < of->count; ++i) {
        recorded_step *step = &of->steps[i];
        const bool first = i % of->every == 0;
        for (; of->frame[frame] < i; ++frame) { /* the last frame is at the end */
        }
        step->keeps
            = !first
              && (of->frame[frame] == i || (step->restarts && of->table->carries));
        step->first = first ? 0 : next;
        next = step->first + step->keeps + of->slots;
        most = next > most ? next : most;
    }
    of->segment = weft__alloc(&of->memory, most * dim_of(of), sizeof *of->segment);
    return of->segment != NULL ? WEFT_OK : adjoint_no_memory(err);
}

/* That of the step after one, or that begins where the last step ends. */
static double next_piece(const adjoint *of, size_t step)
{
    const weft_sim *sim = of->sim;
    return step + 1 < of->count ? of->steps[step + 1].piece
           : sim->piece_begins  ? sim->next_piece
                                : sim->piece;
}

/* Fills the segment of steps [first, end) from its checkpoint. */
static int adjoint_repeat(adjoint *of, size_t first, size_t end)
{
    const weft__mesh *mesh = &of->sim->cloth->mesh;
    const size_t count = of->table->count, half = 3 * mesh->particles;
    weft__forces *forces = &of->sim->forces;
    const double *y = of->checkpoints[first / of->every];
    int failed = 0;
    if (of->table->carries) {
        memcpy(of->rates[0] + half, y + 2 * half, half * sizeof *y);
        weft__move_pins(mesh, of->steps[first].t, of->steps[first].t, of->rates[0],
                        mesh->particles, 0, mesh->particles);
    }
    for (size_t i = first; i < end; ++i) {
        const double t = of->steps[i].t, h = of->steps[i].h;
        const bool last = i + 1 == end;
        forces->piece = of->steps[i].piece;
        if (of->steps[i].restarts && of->table->carries) {
            failed |= weft__forces_rhs(forces, t, y, of->rates[0]);
        }
        for (size_t k = 1; k <= count; ++k) {
            double *state = adjoint_place_of(of, i, k);
            if (of->table->needed[k]) {
                find_state(of, k, h, y, state);
            }
            if (of->table->needed[k] && !(last && k == count)) {
                failed |= weft__forces_rhs(forces, t + of->table->c[k] * h, state,
                                           of->rates[k]);
            }
        }
        if (!last) {
            double *next = of->steps[i + 1].keeps ? adjoint_place_of(of, i + 1, 0)
                                                  : of->room[i % 2];
            find_state(of, count + 1, h, y, next);
            if (of->steps[i].piece != next_piece(of, i)) {
                weft__meet_pins(mesh, of->steps[i + 1].t, next_piece(of, i),
                                next + half);
            }
            y = next;
        }
        if (of->table->carries) {
            double *rate = of->rates[count];
            of->rates[count] = of->rates[0];
            of->rates[0] = rate;
        }
    }
    return failed;
}

/* ---- backwards --------------------------------------------------------------------
 */

/* w = what the states after rate k have of it. */
static void find_by_rate(const adjoint *of, size_t k, double h, double *w)
{
    const weft__mesh *mesh = &of->sim->cloth->mesh;
    const size_t n = mesh->particles, half = 3 * n, end = of->table->count + 1;
    const double *carried
        = k == of->table->count && of->table->carries ? of->carried : NULL;
    for (size_t low = 0, high; low < half; low = high) {
        high = part_end(low, half);
        for (size_t i = half + low; i < half + high; ++i) {
            w[i] = carried != NULL ? carried[i] : 0.0;
        }
        for (size_t j = k + 1; j <= end; ++j) {
            const weft__share *by = &of->table->share[j][k];
            const double *g = of->by_state[j], x = h * h * by->xa, v = h * by->va;
            for (size_t i = low; (x != 0.0 || v != 0.0) && i < high; ++i) {
                w[half + i] += x * g[i] + v * g[half + i];
            }
        }
    }
    for (size_t i = 0; i < 3 * mesh->pinned; ++i) {
        const size_t at = mesh->pins[i / 3] + i % 3 * n;
        w[at] = carried != NULL ? carried[at] : 0.0;
        w[half + at] = carried != NULL ? carried[half + at] : 0.0;
        for (size_t j = k + 1; j <= end; ++j) {
            const weft__share *by = &of->table->share[j][k];
            const double *g = of->by_state[j];
            w[at] += h * by->xp * g[at];
            w[half + at] += h * (h * by->xq * g[at] + by->vq * g[half + at]);
        }
    }
}

/* Adds w.df/dp of each parameter in a state, and writes J^T w. */
static int go_through(adjoint *of, double t, const double *y, const double *w,
                      double *out)
{
    const weft__state at = weft__forces_state(&of->sim->forces, t, y);
    const weft_cloth *cloth = of->sim->cloth;
    void *const *spaces = of->sim->forces.spaces;
    weft__parameter_gradient by;
    int failed
        = weft__rhs_transposed(cloth, spaces, &at, w, of->room[0], out, of->net, &by);
    for (size_t j = 0; j < of->def->count; ++j) {
        failed |= weft__parameter_derivative_product(&of->derivatives[j], spaces, &at,
                                                     w, &by, of->net, of->room,
                                                     &of->by_parameter[j]);
    }
    return failed;
}

/* What the states of a step have of the state at its start. */
static void find_start(const adjoint *of, double h, double *to)
{
    const bool *needed = of->table->needed;
    const weft__mesh *mesh = &of->sim->cloth->mesh;
    const size_t half = 3 * mesh->particles, end = of->table->count + 1;
    const double *last = of->by_state[end];
    for (size_t low = 0, high; low < half; low = high) {
        high = part_end(low, half);
        for (size_t i = low; i < high; ++i) {
            to[i] = last[i];
            to[half + i] = last[half + i] + h * last[i];
        }
        for (size_t k = end - 1; k > 0; --k) {
            const double *g = of->by_state[k], advance = of->table->c[k] * h;
            for (size_t i = low; needed[k] && i < high; ++i) {
                to[i] += g[i];
                to[half + i] += g[half + i] + advance * g[i];
            }
        }
    }
    for (size_t i = 0; i < 3 * mesh->pinned; ++i) {
        const size_t at = half + mesh->pins[i / 3] + i % 3 * mesh->particles;
        to[at] = 0.0;
        for (size_t k = end; k > 0; --k) {
            to[at] += needed[k] ? of->by_state[k][at] : 0.0;
        }
    }
}

/* Adds what depends on the parameters where a piece ends after a step: the places of
 * pins are the sum of what the step leads to and a jump, their velocities are set. */
static void jump_back(adjoint *of, size_t step)
{
    const weft__mesh *mesh = &of->sim->cloth->mesh;
    const size_t n = mesh->particles;
    double *g = of->by_state[of->table->count + 1];
    const double t = step + 1 < of->count ? of->steps[step + 1].t : of->sim->t;
    const double pieces[2] = { of->steps[step].piece, next_piece(of, step) };
    for (size_t j = 0; pieces[0] != pieces[1] && j < of->def->count; ++j) {
        for (size_t i = 0; of->derivatives[j].pins && i < mesh->pinned; ++i) {
            double jump[6];
            weft__parameter_derivative_jump(&of->derivatives[j], mesh->pins[i], t,
                                            pieces, jump);
            for (size_t k = 0; k < 6; ++k) {
                of->by_parameter[j] += g[k * n + mesh->pins[i]] * jump[k];
            }
        }
    }
    for (size_t i = 0; pieces[0] != pieces[1] && i < mesh->pinned; ++i) {
        for (size_t k = 3; weft__pin_meets(mesh, mesh->pins[i]) && k < 6; ++k) {
            g[k * n + mesh->pins[i]] = 0.0;
        }
    }
}

/* The derivative by the state after a step becomes that by the state before. */
static int step_back(adjoint *of, size_t step)
{
    const size_t end = of->table->count + 1, dim = dim_of(of);
    const double t = of->steps[step].t, h = of->steps[step].h;
    double *start = of->by_state[0], *by_first = of->rates[0]; /* no longer needed */
    int failed = 0;
    jump_back(of, step);
    of->sim->forces.piece = of->steps[step].piece;
    for (size_t k = end - 1; k > 0; --k) {
        if (of->table->needed[k]) {
            find_by_rate(of, k, h, of->w);
            failed |= go_through(of, t + of->table->c[k] * h,
                                 adjoint_place_of(of, step, k), of->w, of->by_state[k]);
        }
    }
    find_start(of, h, start);
    if (of->table->carries) {
        find_by_rate(of, 0, h, of->carried);
    }
    if (of->table->carries && of->steps[step].restarts) {
        failed |= go_through(of, t, adjoint_start_of(of, step), of->carried, by_first);
        for (size_t i = 0; i < dim; ++i) {
            start[i] += by_first[i];
        }
        memset(of->carried, 0, dim * sizeof *of->carried);
    }
    of->by_state[0] = of->by_state[end], of->by_state[end] = start;
    return failed;
}

/* The frames at the state y after `count` steps; *left of them are to come. */
static weft_status add_frames(adjoint *of, size_t count, const double *y, size_t *left,
                              weft_error *err)
{
    const size_t dim = dim_of(of);
    double *gradient = of->room[0], *to = of->by_state[of->table->count + 1];
    while (*left > 0 && of->frame[*left - 1] == count) {
        const size_t frame = --*left;
        const double t = of->def->times[frame];
        memset(gradient, 0, dim * sizeof *gradient);
        if (of->def->objective(of->def->ctx, frame, t, y, of->value, gradient) != 0) {
            return weft_error_set(err, WEFT_STOPPED,
                                  "the objective stopped at frame %zu, t = %g s", frame,
                                  t);
        }
        for (size_t i = 0; i < dim; ++i) {
            to[i] += gradient[i];
        }
    }
    return WEFT_OK;
}

static weft_status go_back(adjoint *of, weft_error *err)
{
    size_t left = of->def->frames, end = of->count;
    weft_status status = WEFT_OK;
    int failed = 0;
    TRY(make_segment(of, err));
    while (end > 0 && status == WEFT_OK) {
        const size_t first = (end - 1) / of->every * of->every;
        failed |= adjoint_repeat(of, first, end);
        for (; end > first && status == WEFT_OK; --end) {
            status = add_frames(of, end, adjoint_start_of(of, end), &left, err);
            failed |= status == WEFT_OK ? step_back(of, end - 1) : 0;
        }
    }
    status = status == WEFT_OK ? add_frames(of, 0, adjoint_start_of(of, 0), &left, err)
                               : status;
    return status == WEFT_OK && failed != 0
               ? weft_error_set(err, WEFT_NOT_FINITE,
                                "the gradient is not finite: it grows beyond all "
                                "bounds, or no state has one")
               : status;
}

/* The derivative with respect to the first state, and to the parameters that it depends
 * on. */
static void finish(adjoint *of, double *by_start)
{
    const size_t dim = dim_of(of);
    const double *g = of->by_state[of->table->count + 1];
    for (size_t j = 0; j < of->def->count; ++j) {
        weft_cloth_start(of->def->parameters[j].less, of->room[0]);
        weft_cloth_start(of->def->parameters[j].more, of->room[1]);
        for (size_t i = 0; i < dim; ++i) {
            of->by_parameter[j] += g[i] * (of->room[1][i] - of->room[0][i])
                                   / of->def->parameters[j].span;
        }
    }
    if (by_start != NULL) {
        memcpy(by_start, g, dim * sizeof *g);
    }
}

static weft_status adjoint_differentiate(adjoint *of, double *by_start, weft_error *err)
{
    of->table = weft__alloc(&of->memory, 1, sizeof *of->table);
    if (of->table == NULL) {
        return adjoint_no_memory(err);
    }
    TRY(adjoint_make_sim(of, err));
    TRY(adjoint_make_room(of, err));
    TRY(make_derivatives(of, err));
    TRY(record(of, err));
    TRY(go_back(of, err));
    finish(of, by_start);
    return WEFT_OK;
}

weft_status weft_gradient(const weft_gradient_def *given, double *value,
                          double *by_parameter, double *by_start, weft_error *err)
{
    weft_gradient_def def;
    weft_status status = weft__given(given, value, "weft_gradient", err);
    if (status != WEFT_OK
        || WEFT__DEF_READ(weft_gradient_def, &def, given, WEFT__DEF_MOST, err)
               != WEFT_OK
        || adjoint_check(&def, by_parameter, err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    adjoint of = { .def = &def,
                   .memory = weft_allocator_or_malloc(def.sim->allocator),
                   .value = value,
                   .by_parameter = by_parameter };
    *value = 0.0;
    status = adjoint_differentiate(&of, by_start, err);
    for (size_t j = 0; of.derivatives != NULL && j < def.count; ++j) {
        weft__parameter_derivative_free(&of.derivatives[j], &of.memory);
    }
    for (size_t i = 0; i < of.made; ++i) {
        weft__free(&of.memory, of.checkpoints[i]);
    }
    WEFT__FREE_ALL(&of.memory, of.checkpoints, of.steps, of.frame, of.derivatives,
                   of.segment, of.vectors, of.table);
    weft_sim_destroy(of.sim);
    return status;
}
