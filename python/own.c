/* SPDX-License-Identifier: BSD-3-Clause */
/* own.c -- weft-own.so: methods that are functions in another process, of Python
 * (weft/own.py).
 *
 * WEFT_OWN has the path of a local socket, and the methods' names on further lines.
 * Each instance connects to it and sends its method and dim, then for every step t, h
 * and y. The other side answers with requests: to evaluate f(t, y), or with the end of
 * the step. */
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "weft/stepper.h"

const weft_plugin *weft_plugin_own(void);

enum { METHODS = 16, TEXT = 2048 };

typedef enum request_kind { EVALUATE, DONE, UNUSABLE, RAISED } request_kind;

typedef struct request {
    int64_t kind;
    double t; /* [s] EVALUATE */
} request;

typedef struct stepper {
    weft_ode ode;
    weft_allocator memory;
    const char *name;
    int socket;
    double fixed_step; /* [s] */
    weft_stepper_stats stats;
    double *y, *f;
} stepper;

static char text[TEXT]; /* of WEFT_OWN, cut into lines */
static weft_stepper_type types[METHODS];

static bool put(const stepper *self, const void *data, size_t size)
{
    const char *at = data;
    while (size > 0) {
        const ssize_t sent = send(self->socket, at, size, MSG_NOSIGNAL);
        if (sent <= 0) {
            return false;
        }
        at += sent;
        size -= (size_t)sent;
    }
    return true;
}

static bool get(const stepper *self, void *data, size_t size)
{
    return recv(self->socket, data, size, MSG_WAITALL) == (ssize_t)size;
}

static bool join(stepper *self, size_t method)
{
    struct sockaddr_un to = { .sun_family = AF_UNIX };
    const uint64_t hello[2] = { method, self->ode.dim };
    (void)strncpy(to.sun_path, text, sizeof to.sun_path - 1);
    self->socket = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    return self->socket >= 0
           && connect(self->socket, (const struct sockaddr *)&to, sizeof to) == 0
           && put(self, hello, sizeof hello);
}

static void destroy(void *instance)
{
    stepper *self = instance;
    if (self != NULL) {
        const weft_allocator memory = self->memory;
        if (self->socket >= 0) {
            (void)close(self->socket);
        }
        (void)memory.resize(memory.ctx, self, 0);
    }
}

static weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **out,
                          weft_error *err)
{
    const char *wrong = weft_stepper_mistake(type, ode, config);
    const weft_allocator memory = weft_stepper_memory(config);
    *out = NULL;
    if (wrong != NULL) {
        return weft_error_set(err, WEFT_INVALID, "%s: %s", type->name, wrong);
    }
    stepper *self
        = memory.resize(memory.ctx, NULL, sizeof *self + 2 * ode->dim * sizeof(double));
    if (self == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    *self = (stepper){ .ode = *ode,
                       .memory = memory,
                       .name = type->name,
                       .fixed_step = config->fixed_step };
    self->stats.next_step = config->fixed_step;
    self->y = (double *)(self + 1), self->f = self->y + ode->dim;
    if (!join(self, (size_t)(type - types))) {
        destroy(self);
        return weft_error_set(err, WEFT_UNSUPPORTED, "%s: its process does not answer",
                              type->name);
    }
    *out = self;
    return WEFT_OK;
}

/* Evaluates until the step is over: what became of it, with its end in self->y. */
static weft_status converse(stepper *self, weft_error *err)
{
    const size_t bytes = self->ode.dim * sizeof(double);
    int64_t code = 0;
    request asked;
    while (get(self, &asked, sizeof asked)) {
        if (asked.kind == UNUSABLE) {
            return code < 0 ? weft_error_set(err, WEFT_STOPPED, "stopped by the model")
                            : weft_error_set(err, WEFT_NOT_FINITE, "%s: not finite",
                                             self->name);
        }
        if (asked.kind == RAISED || !get(self, self->y, bytes)) {
            break;
        }
        if (asked.kind == DONE) {
            return WEFT_OK;
        }
        code = self->ode.rhs(asked.t, self->y, self->f, self->ode.ctx);
        ++self->stats.rhs_calls;
        if (!put(self, &code, sizeof code) || !put(self, self->f, bytes)) {
            break;
        }
    }
    return weft_error_set(err, WEFT_STOPPED, "%s raised an exception", self->name);
}

static weft_status step(void *instance, double t_end, double *t, double *y,
                        weft_error *err)
{
    stepper *self = instance;
    const size_t dim = self->ode.dim;
    const double rest = t_end - *t;
    if (!(rest > 0.0)) {
        return weft_error_set(err, WEFT_INVALID, "step from %.17g to %.17g s", *t,
                              t_end);
    }
    /* A rest that is longer than the step by roundoff alone is taken whole. */
    const bool last = self->fixed_step >= rest * (1.0 - 1e-6);
    const double begin[2] = { *t, last ? rest : self->fixed_step };
    size_t bad = 0;
    const bool sent = put(self, begin, sizeof begin) && put(self, y, dim * sizeof *y);
    const weft_status status
        = sent ? converse(self, err)
               : weft_error_set(err, WEFT_STOPPED, "%s: its process ended", self->name);
    if (status != WEFT_OK) {
        return status;
    }
    for (size_t i = 0; i < dim; ++i) {
        bad += (size_t)!isfinite(self->y[i]);
    }
    if (bad > 0) {
        return weft_error_set(err, WEFT_NOT_FINITE, "not finite after a step of %g s",
                              begin[1]);
    }
    memcpy(y, self->y, dim * sizeof *y);
    *t = last ? t_end : *t + begin[1];
    ++self->stats.steps;
    self->stats.last_step = begin[1];
    return WEFT_OK;
}

/* A method is a function of its arguments: nothing is kept from step to step. */
static void state_changed(void *instance)
{
    (void)instance;
}

static void stats(const void *instance, weft_stepper_stats *out)
{
    weft_stepper_stats_copy(&((const stepper *)instance)->stats, out);
}

WEFT_API const weft_plugin *weft_plugin_own(void)
{
    static const weft_stepper_type *list[METHODS + 1];
    static const weft_plugin plugin = { .abi = WEFT_STEPPER_ABI,
                                        .struct_size = sizeof(weft_plugin),
                                        .id = "own",
                                        .version = WEFT_VERSION,
                                        .solver = "",
                                        .types = list };
    const char *given = getenv("WEFT_OWN");
    (void)strncpy(text, given == NULL ? "" : given, TEXT - 1);
    char *name = strchr(text, '\n');
    for (size_t i = 0; i < METHODS && name != NULL; ++i) {
        *name++ = '\0';
        types[i] = (weft_stepper_type){ .abi = WEFT_STEPPER_ABI,
                                        .struct_size = sizeof(weft_stepper_type),
                                        .name = name,
                                        .reference = "a function of the caller",
                                        .license = "",
                                        .flags = WEFT_STEPPER_FIXED_ONLY,
                                        .create = create,
                                        .step = step,
                                        .state_changed = state_changed,
                                        .stats = stats,
                                        .destroy = destroy };
        list[i] = &types[i];
        name = strchr(name, '\n');
    }
    return &plugin;
}
