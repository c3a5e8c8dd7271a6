/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/bands.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>

#include "base/try.h"
#include "cloth/model.h"

enum {
    CHUNK = 64,
    LIKE = 8
}; /* rows between two looks at what is under way; and how
      many of them are like a block of triangles */

/* ---- what is possible ------------------------------------------------------------ */

weft_status weft__bands_comm_check(const weft_comm *comm, weft_error *err)
{
    const bool whole = comm == NULL
                       || (WEFT_HAS(comm, weft_comm, stop) && comm->max && comm->begin
                           && comm->end && comm->share && comm->gather);
    const bool placed
        = comm == NULL || (whole && comm->rank >= 0 && comm->rank < comm->size);
    return placed ? WEFT_OK
                  : weft_error_set(err, WEFT_INVALID, "comm %s",
                                   whole ? "has a rank that is not in [0, size)"
                                         : "lacks a function or its struct_size");
}

static weft_status bands_check_band(const weft_sim_def *def, weft_error *err)
{
    const weft_band band = weft_cloth_band(def->cloth);
    const weft_comm *comm = def->comm;
    size_t first = 0, own = band.rows;
    if (comm != NULL && comm->size > 1
        && !weft_comm_band(band.rows, (size_t)comm->rank, (size_t)comm->size, &first,
                           &own)) {
        return weft_error_set(err, WEFT_INVALID,
                              "%zu rows are too few for %d bands: each needs %d",
                              band.rows, comm->size, WEFT_GHOST_ROWS);
    }
    if (band.first == first && band.own == own) {
        return WEFT_OK;
    }
    return comm == NULL
               ? weft_error_set(err, WEFT_INVALID,
                                "the cloth is a band, rows %zu to %zu of %zu: its "
                                "simulation needs a comm",
                                band.first, band.first + band.own - 1, band.rows)
               : weft_error_set(err, WEFT_INVALID,
                                "the cloth has rows %zu to %zu of %zu; band %d of %d "
                                "is rows %zu to %zu",
                                band.first, band.first + band.own - 1, band.rows,
                                comm->rank, comm->size, first, first + own - 1);
}

weft_status weft__bands_check(const weft_sim_def *def, weft_error *err)
{
    const weft_comm *comm = def->comm;
    if (comm != NULL
        && (def->cloth->mesh.triangles != NULL || weft__cloth_gathers(def->cloth))
        && !(WEFT_HAS(comm, weft_comm, post) && comm->post != NULL)) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "bands of triangles, or with contact of the cloth with "
                              "itself, need a comm with `post`");
    }
    TRY(bands_check_band(def, err));
    if (def->comm == NULL) {
        return WEFT_OK;
    }
    if ((def->method->flags & (uint32_t)WEFT_STEPPER_DISTRIBUTED) == 0) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "method '%.40s' cannot integrate a cloth in bands: its "
                              "steps depend on sums over the whole state",
                              def->method->name);
    }
    const char *why = def->limit.method != WEFT_LIMIT_NONE
                          ? "a strain limit goes from row to row"
                      : def->correct != NULL ? "`correct` needs the whole state"
                      : def->force != NULL   ? "`force` needs the whole state"
                                             : NULL;
    return why == NULL ? WEFT_OK
                       : weft_error_set(err, WEFT_UNSUPPORTED,
                                        "not possible for a cloth in bands: %s", why);
}

/* ---- decisions ------------------------------------------------------------------- */

bool weft__bands_first(const weft_comm *comm, bool has, void *data, size_t bytes)
{
    if (comm == NULL) {
        return has;
    }
    const double place = has ? (double)(comm->size - comm->rank) : 0.0;
    const double first = comm->max(comm->self, place);
    if (first > 0.0 && first < (double)comm->size) { /* else band 0 has it */
        const bool mine = place == first;
        comm->gather(comm->self, mine ? data : NULL, mine ? bytes : 0, data);
    }
    if (first > 0.0) {
        comm->share(comm->self, data, bytes);
    }
    return first > 0.0;
}

weft_status weft_comm_agree(const weft_comm *comm, weft_status status, weft_error *err)
{
    weft_error why = { .status = status };
    if (comm == NULL) {
        return status;
    }
    if (status != WEFT_OK && err != NULL) {
        why = *err;
    }
    if (weft__bands_first(comm, status != WEFT_OK, &why, sizeof why) && err != NULL) {
        *err = why;
    }
    return why.status;
}

double weft__bands_max(const weft_comm *comm, double mine)
{
    return comm == NULL ? mine : comm->max(comm->self, mine);
}

/* ---- blocks ---------------------------------------------------------------------- */

const void *weft__bands_blocks(const weft__forces *forces, const void *blocks,
                               size_t size)
{
    const weft_comm *comm = forces->comm;
    if (comm == NULL) {
        return blocks;
    }
    comm->gather(comm->self, blocks, weft_cloth_band(forces->cloth).own * size,
                 forces->all);
    return comm->rank == 0 ? forces->all : NULL;
}

bool weft__bands_is_first(const weft_comm *comm)
{
    return comm == NULL || comm->rank == 0;
}

void weft__bands_share(const weft_comm *comm, void *data, size_t bytes)
{
    if (comm != NULL) {
        comm->share(comm->self, data, bytes);
    }
}

/* Numbers of own blocks, from the first on. */
typedef struct number_job {
    weft__numbers_fn *of;
    const void *ctx;
    size_t above, count;
    double *own;
} number_job;

static void write_numbers(void *ctx, size_t first, size_t end)
{
    const number_job *to = ctx;
    for (size_t b = first; b < end; ++b) {
        to->of(to->ctx, b, to->own + to->count * (b - to->above));
    }
}

void weft__bands_sum(const weft__forces *forces, weft__numbers_fn *of, const void *ctx,
                     size_t count, double *sum)
{
    const weft_band band = forces->cloth->mesh.band;
    number_job all = { of, ctx, band.above, count, (double *)(void *)forces->measures };
    assert(count * sizeof *sum <= sizeof *forces->measures);
    weft__forces_spans(forces, write_numbers, &all);
    const double *rows = weft__bands_blocks(forces, all.own, count * sizeof *sum);
    memset(sum, 0, count * sizeof *sum);
    for (size_t j = 0; rows != NULL && j < count * band.rows; ++j) {
        sum[j % count] += rows[j];
    }
    weft__bands_share(forces->comm, sum, count * sizeof *sum);
}

void weft__bands_most(const weft__forces *forces, double *numbers, size_t count)
{
    const weft_comm *comm = forces->comm;
    const double *of = (const double *)(const void *)forces->all;
    assert(count * sizeof *numbers <= sizeof *forces->all); /* a row's room for each */
    comm->gather(comm->self, numbers, count * sizeof *numbers, forces->all);
    for (size_t j = 0; comm->rank == 0 && j < count * (size_t)comm->size; ++j) {
        numbers[j % count] = fmax(numbers[j % count], of[j]);
    }
    comm->share(comm->self, numbers, count * sizeof *numbers);
}

uint64_t weft__bands_cloth_hash(const weft__forces *forces)
{
    const weft_cloth *cloth = forces->cloth;
    uint64_t *own = (uint64_t *)(void *)forces->measures, hash = 0;
    if (cloth->mesh.whole_of != NULL) {
        return cloth->whole_hash;
    }
    for (size_t r = 0; r < cloth->mesh.band.own; ++r) {
        own[r] = weft__cloth_block_hash(cloth, cloth->mesh.band.above + r);
    }
    const uint64_t *rows = weft__bands_blocks(forces, own, sizeof *own);
    if (rows != NULL) {
        hash = weft__cloth_hash(cloth, rows);
    }
    weft__bands_share(forces->comm, &hash, sizeof hash);
    return hash;
}

/* ---- who needs whose particles ----------------------------------------------------
 */

static bool is_ghost(const weft__mesh *mesh, size_t i)
{
    const size_t first = mesh->band.above * mesh->block;
    return i < first || i >= first + mesh->band.own * mesh->block;
}

/* The particles of band `rank` of the whole. */
static void owned(const weft__mesh *mesh, const weft_comm *comm, size_t rank,
                  size_t *first, size_t *end)
{
    size_t count = mesh->band.rows;
    *first = 0;
    (void)weft_comm_band(count, rank, (size_t)comm->size, first, &count);
    *end = (*first + count) * mesh->block;
    *first *= mesh->block;
}

/* How many of an ascending list are in [first, end), and which is the first of them. */
static size_t bands_between(const uint32_t *list, size_t count, size_t first,
                            size_t end, size_t *at)
{
    size_t in = 0;
    *at = 0;
    for (size_t j = 0; j < count; ++j) {
        *at += list[j] < first;
        in += list[j] >= first && list[j] < end;
    }
    return in;
}

/* The ghosts here in numbers of the whole; returns how many there are. */
static size_t list_ghosts(weft__forces *forces, uint32_t *list)
{
    const weft__mesh *mesh = &forces->cloth->mesh;
    size_t count = 0;
    forces->exchange.missing = 0;
    for (size_t i = 0; mesh->whole_of != NULL && i < mesh->particles; ++i) {
        if (is_ghost(mesh, i) && count > 0 && list[count - 1] == mesh->whole_of[i]) {
            ++forces->exchange.missing;
        } else if (is_ghost(mesh, i)) {
            list[count++] = mesh->whole_of[i];
        }
    }
    return count;
}

/* Parcels of the lists of all bands, one behind the other. False: no memory. */
static bool make_exchange(weft__forces *forces, const uint32_t *lists,
                          const size_t *counts)
{
    const weft__mesh *mesh = &forces->cloth->mesh;
    const weft_comm *comm = forces->comm;
    const size_t me = (size_t)comm->rank, size = (size_t)comm->size;
    const size_t skip = (mesh->band.first - mesh->band.above) * mesh->block;
    weft__exchange *exchange = &forces->exchange;
    size_t sent = 0, room = 0, first, end, low, high, at;
    const uint32_t *mine = lists, *list = lists;
    for (size_t r = 0; r < me; ++r) {
        mine += counts[r];
    }
    owned(mesh, comm, me, &first, &end);
    exchange->parcels = weft__zeroed(&forces->memory, size, sizeof *exchange->parcels);
    exchange->edge
        = weft__zeroed(&forces->memory, mesh->band.own, sizeof *exchange->edge);
    for (size_t pass = 0; exchange->parcels != NULL && pass < 2; ++pass, list = lists) {
        double *out = exchange->room, *in = out + 3 * sent;
        exchange->count = sent = 0;
        for (size_t r = 0; r < size; list += counts[r++]) {
            owned(mesh, comm, r, &low, &high);
            const size_t ins = 3 * bands_between(mine, counts[me], low, high, &at);
            const size_t outs = 3 * bands_between(list, counts[r], first, end, &at);
            exchange->before = r == me ? exchange->count : exchange->before;
            if (r == me || outs + ins == 0) {
                continue;
            }
            exchange->parcels[exchange->count++]
                = (weft_parcel){ (int)r, outs, ins, out, in };
            for (size_t j = 0; pass == 1 && j < outs / 3; ++j) {
                exchange->sent[sent + j] = (uint32_t)(list[at + j] - skip);
                exchange->edge[(list[at + j] - first) / mesh->block] = true;
            }
            sent += outs / 3;
            room += pass == 0 ? outs + ins : 0;
            out = pass == 1 ? out + outs : out, in = pass == 1 ? in + ins : in;
        }
        if (pass == 0) {
            exchange->sent = weft__alloc(&forces->memory, sent, sizeof *exchange->sent);
            exchange->room = weft__alloc(&forces->memory, room, sizeof *exchange->room);
        }
        if (exchange->sent == NULL || exchange->room == NULL
            || exchange->edge == NULL) {
            return false;
        }
    }
    return exchange->parcels != NULL;
}

static weft_status bands_no_memory(const weft_comm *comm, bool made, weft_error *err)
{
    return weft_comm_agree(
        comm,
        made ? WEFT_OK : weft_error_set(err, WEFT_NO_MEMORY, "no memory for ghosts"),
        err);
}

/* All bands get the lists of all. */
static weft_status bands_handshake(weft__forces *forces, uint32_t *own, size_t *counts,
                                   uint32_t **lists, weft_error *err)
{
    const weft_comm *comm = forces->comm;
    size_t all = 0;
    const size_t size = (size_t)comm->size, mine = list_ghosts(forces, own);
    comm->gather(comm->self, &mine, sizeof mine, counts);
    comm->share(comm->self, counts, size * sizeof *counts);
    for (size_t r = 0; r < size; ++r) {
        all += counts[r];
    }
    *lists = weft__alloc(&forces->memory, all, sizeof **lists);
    TRY(bands_no_memory(comm, *lists != NULL, err));
    comm->gather(comm->self, own, mine * sizeof *own, *lists);
    comm->share(comm->self, *lists, all * sizeof **lists);
    return bands_no_memory(comm, make_exchange(forces, *lists, counts), err);
}

weft_status weft__bands_handshake(weft__forces *forces, weft_error *err)
{
    const weft_comm *comm = forces->comm;
    const weft_allocator *memory = &forces->memory;
    uint32_t *lists = NULL;
    if (comm == NULL || forces->cloth->mesh.triangles == NULL) {
        return WEFT_OK;
    }
    uint32_t *own = weft__alloc(memory, forces->cloth->mesh.particles, sizeof *own);
    size_t *counts = weft__alloc(memory, (size_t)comm->size, sizeof *counts);
    weft_status status = bands_no_memory(comm, own != NULL && counts != NULL, err);
    status = status == WEFT_OK ? bands_handshake(forces, own, counts, &lists, err)
                               : status;
    WEFT__FREE_ALL(memory, own, counts, lists);
    return status;
}

/* ---- right-hand side ------------------------------------------------------------- */

typedef struct band_rhs {
    const weft__forces *forces;
    const weft__state *of;
    double *dydt;
    size_t first, end; /* own rows */
    size_t low, high;  /* of them those that no other band waits for */
    size_t parts;      /* of [low, high) */
    bool edges;        /* of triangles: blocks that others wait for, or the others */
    atomic_int failed;
} band_rhs;

static void bands_evaluate(band_rhs *self, size_t first, size_t end)
{
    if (first < end
        && weft__rhs_blocks(self->forces->cloth, self->of, self->dydt, first, end)
               != 0) {
        atomic_store(&self->failed, 1);
    }
}

/* The rows that are ghosts of the band above, and those of the band below. */
static void do_edge(void *ctx, size_t i)
{
    band_rhs *self = ctx;
    bands_evaluate(self, i == 0 ? self->first : self->high,
                   i == 0 ? self->low : self->end);
}

static void do_inner(void *ctx, size_t i)
{
    band_rhs *self = ctx;
    const weft_comm *comm = self->forces->comm;
    const size_t rows = self->high - self->low;
    bands_evaluate(self, self->low + rows * i / self->parts,
                   self->low + rows * (i + 1) / self->parts);
    if (comm->poke != NULL && weft__pool_in_caller(self->forces->pool)) {
        comm->poke(comm->self);
    }
}

/* Blocks of triangles, of one kind. */
static void do_kind(void *ctx, size_t i)
{
    band_rhs *self = ctx;
    const weft_comm *comm = self->forces->comm;
    const bool *edge = self->forces->exchange.edge;
    const size_t own = self->end - self->first;
    const size_t last = own * (i + 1) / self->parts;
    for (size_t b = own * i / self->parts, end = b; b < last; b = end) {
        while (end < last && edge[end] == edge[b]) {
            ++end;
        }
        if (edge[b] == self->edges) {
            bands_evaluate(self, self->first + b, self->first + end);
        }
    }
    if (!self->edges && comm->poke != NULL
        && weft__pool_in_caller(self->forces->pool)) {
        comm->poke(comm->self);
    }
}

static size_t inner_parts(const weft__forces *forces, size_t rows)
{
    const size_t chunks = (rows + CHUNK - 1) / CHUNK;
    const size_t shares = forces->spans < rows ? forces->spans : rows;
    const size_t parts = chunks > shares ? chunks : shares;
    return parts < WEFT_PARTS ? parts : WEFT_PARTS;
}

/* v' of own particles of triangles, to those that have them as ghosts. */
static void send(const weft__forces *forces, const double *dvdt)
{
    const weft_comm *comm = forces->comm;
    const size_t n = forces->cloth->mesh.particles;
    const weft__exchange *exchange = &forces->exchange;
    const uint32_t *sent = exchange->sent;
    double *out = exchange->room;
    for (size_t p = 0; p < exchange->count; sent += exchange->parcels[p++].outs / 3) {
        for (size_t j = 0; j < exchange->parcels[p].outs; ++j) {
            *out++ = dvdt[j % 3 * n + sent[j / 3]];
        }
    }
    comm->post(comm->self, exchange->parcels, exchange->count);
}

static void receive(const weft__forces *forces, double *dvdt)
{
    const weft__mesh *mesh = &forces->cloth->mesh;
    const weft__exchange *exchange = &forces->exchange;
    const size_t n = mesh->particles;
    size_t i = exchange->missing;
    forces->comm->end(forces->comm->self);
    for (size_t p = 0; p < exchange->count; ++p) {
        const weft_parcel *from = &exchange->parcels[p];
        if (p == exchange->before) {
            i = (mesh->band.above + mesh->band.own) * mesh->block;
        }
        for (size_t j = 0; j < from->ins; ++j) {
            dvdt[j % 3 * n + i + j / 3] = from->in[j];
        }
        i += from->ins / 3;
    }
    for (size_t j = 0; j < 3 * exchange->missing; ++j) {
        dvdt[j % 3 * n + j / 3] = dvdt[j % 3 * n + exchange->missing];
    }
}

/* The blocks that no other band waits for, on the threads. With contact of the cloth
 * with itself others wait for all, and also for that. */
static void do_rest(band_rhs *all, bool now)
{
    const weft__forces *forces = all->forces;
    const weft__mesh *mesh = &forces->cloth->mesh;
    const bool gathers = forces->exchange.gather.cloth != NULL;
    all->edges = false;
    if (now == gathers) {
        weft__pool_run(forces->pool, mesh->triangles != NULL ? do_kind : do_inner, all,
                       all->parts);
    }
    if (now && gathers) {
        (void)weft__gather_end(forces, all->of->y, 0);
        if (weft__gather_add(forces, all->dydt + 3 * mesh->particles) != 0) {
            atomic_store(&all->failed, 1);
        }
    }
}

static int rhs_of_triangles(band_rhs *all)
{
    const weft__forces *forces = all->forces;
    const weft_cloth *cloth = forces->cloth;
    double *dvdt = all->dydt + 3 * cloth->mesh.particles;
    all->edges = true;
    weft__pool_run(forces->pool, do_kind, all, all->parts);
    do_rest(all, true);
    weft__ghost_blocks(cloth, all->of, all->dydt, 0, all->first);
    weft__ghost_blocks(cloth, all->of, all->dydt, all->end, weft__blocks(&cloth->mesh));
    send(forces, dvdt);
    do_rest(all, false);
    receive(forces, dvdt);
    return atomic_load(&all->failed);
}

/* The ghosts' own v' is not touched after begin: it is being received. */
int weft__bands_rhs(const weft__forces *forces, const weft__state *of, double *dydt)
{
    const weft_comm *comm = forces->comm;
    const weft_cloth *cloth = forces->cloth;
    const weft_band band = cloth->mesh.band;
    const size_t n = cloth->mesh.particles, edge = WEFT_GHOST_ROWS;
    const size_t first = band.above, end = first + band.own;
    const bool grid = cloth->mesh.triangles == NULL;
    size_t low = first + (grid && band.above > 0 ? edge : 0);
    size_t high = end - (grid && band.below > 0 ? edge : 0);
    if (low > high) { /* less than four: all are edges */
        low = high = end;
    }
    band_rhs all = { .forces = forces,
                     .of = of,
                     .dydt = dydt,
                     .first = first,
                     .end = end,
                     .low = low,
                     .high = high,
                     .parts = inner_parts(forces, (grid ? 1 : LIKE) * (high - low)) };
    const weft_rows rows = { .first = dydt + 3 * n,
                             .planes = 3,
                             .stride = n,
                             .cols = cloth->mesh.cols,
                             .above = band.above,
                             .own = band.own,
                             .below = band.below };
    weft__gather_begin(forces, of->y);
    if (!grid) {
        return rhs_of_triangles(&all);
    }
    weft__pool_run(forces->pool, do_edge, &all, 2);
    do_rest(&all, true);
    weft__ghost_blocks(cloth, of, dydt, 0, first);
    weft__ghost_blocks(cloth, of, dydt, end, cloth->mesh.rows);
    comm->begin(comm->self, &rows);
    do_rest(&all, false);
    comm->end(comm->self);
    return atomic_load(&all.failed);
}

/* ---- shapes ---------------------------------------------------------------------- */

void weft__bands_deepest(const weft_comm *comm, weft__penetration *penetration)
{
    const double far = 0x1p53;
    if (comm == NULL) {
        return;
    }
    /* the earliest of the last calls, then the deepest in it, then the first */
    const double before = far - (double)penetration->call;
    const bool last = weft__bands_max(comm, before) == before;
    const double depth = last && penetration->found ? fabs(penetration->gap) : 0.0;
    const bool deepest = weft__bands_max(comm, depth) == depth;
    penetration->found = weft__bands_first(comm, last && penetration->found && deepest,
                                           penetration, sizeof *penetration);
}
