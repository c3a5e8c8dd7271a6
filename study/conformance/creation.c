/* SPDX-License-Identifier: BSD-3-Clause */
/* creation.c -- a method's table, and the configs that create accepts and refuses. */
#include "study/conformance/trial.h"

void weft__table_is_sane(trial *self)
{
    const weft_stepper_type *type = self->type;
    EXPECT(type->order >= 0 && type->stages >= 0, "order %d with %d stages",
           type->order, type->stages);
    EXPECT(type->error_order >= 0, "error_order %d", type->error_order);
    EXPECT(weft__adapts(type) || type->error_order == 0,
           "an error_order without error control");
    EXPECT(type->reference[0] != '\0' && type->license[0] != '\0',
           "an empty reference or license");
    type->destroy(NULL);
}

void weft__create_calls_no_rhs(trial *self)
{
    const trial_run *r = weft__begin_usual(self, 0);
    EXPECT(r->model.calls == 0, "create called the rhs");
    const weft_stepper_stats stats = weft__stats(r);
    EXPECT(stats.steps == 0 && stats.rejected == 0 && stats.rhs_calls == 0
               && !(stats.last_step > 0.0),
           "statistics are not 0 before the first step");
}

#define FIELD(field) #field, offsetof(weft_stepper_config, field)

/* Bad numbers; all but the first matter with error control only. */
static const struct {
    const char *name;
    size_t offset; /* in the config */
    double values[4];
} odd_numbers[] = {
    { FIELD(fixed_step), { -1e-3, -1.0, (double)NAN, (double)INFINITY } },
    { FIELD(rtol), { -1e-9, -1.0, (double)NAN, (double)INFINITY } },
    { FIELD(atol_position), { 0.0, -1e-6, (double)NAN, (double)INFINITY } },
    { FIELD(atol_velocity), { 0.0, -1e-6, (double)NAN, (double)INFINITY } },
    { FIELD(first_step), { 0.0, -1e-3, (double)NAN, (double)INFINITY } },
    { FIELD(min_step), { 0.0, -1e-9, (double)NAN, (double)INFINITY } },
    { FIELD(max_step), { 0.0, -1.0, 0.9e-10, (double)NAN } },
};

static void refuses(trial *self, size_t dim, const weft_stepper_config *config,
                    bool with_structure, const char *what)
{
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = dim, .rhs = weft__model_rhs, .ctx = &m };
    const weft_structure structure = weft__model_structure(&m);
    weft_stepper_config whole = *config;
    void *instance = &m;
    weft_error err = { 0 };
    whole.structure
        = with_structure && weft__needs_structure(self->type) ? &structure : NULL;
    config = &whole;
    weft_status status = self->type->create(self->type, &ode, config, &instance, &err);
    if (status == WEFT_OK) {
        self->type->destroy(instance);
    }
    EXPECT(status == WEFT_INVALID || status == WEFT_UNSUPPORTED,
           "%s: create returned '%s', not that it is invalid or unsupported", what,
           weft_status_text(status));
    EXPECT(instance == NULL, "%s: *self is not NULL after a refusal", what);
    EXPECT(err.status == status && err.message[0] != '\0',
           "%s: refused without a reason in *err", what);
    status = self->type->create(self->type, &ode, config, &instance, NULL);
    EXPECT(status == err.status, "%s: another status without a weft_error", what);
    EXPECT(m.calls == 0, "%s: create called the rhs", what);
}

static void numbers_are_refused(trial *self, const weft_stepper_config *good)
{
    const size_t count = sizeof odd_numbers / sizeof odd_numbers[0];
    for (size_t i = 0; i < (weft__adapts(self->type) ? 4 * count : 4); ++i) {
        const double odd = odd_numbers[i / 4].values[i % 4];
        char what[64];
        weft_stepper_config bad = *good;
        memcpy((char *)&bad + odd_numbers[i / 4].offset, &odd, sizeof odd);
        (void)snprintf(what, sizeof what, "%s %g", odd_numbers[i / 4].name, odd);
        refuses(self, DIM, &bad, true, what);
    }
}

void weft__mistakes_are_refused(trial *self)
{
    const weft_butcher table = { .stages = 1 };
    weft_stepper_config good = weft__with_table(self->type, weft__usual(self->type, 0)),
                        bad = good;
    numbers_are_refused(self, &good);
    if (weft__adapts(self->type)) {
        bad.norm = (weft_norm)7;
        refuses(self, DIM, &bad, true, "norm 7");
    } else {
        bad = weft__adaptive(1e-6);
        refuses(self, DIM, &bad, true,
                "fixed_step 0 of a method without error control");
    }
    if (!weft__takes_fixed(self->type)) {
        bad = weft__fixed(1e-3);
        refuses(self, DIM, &bad, true, "fixed_step of a method that takes none");
    }
    bad = good;
    bad.struct_size = 8;
    refuses(self, DIM, &bad, true, "a config of 8 bytes");
    refuses(self, 0, &good, true, "dim 0");
    refuses(self, 5, &good, true, "dim 5");
    if (weft__needs_structure(self->type)) {
        refuses(self, DIM, &good, false, "no structure");
    }
    if ((self->type->flags & WEFT_STEPPER_BUTCHER) == 0) {
        good.butcher = &table;
        refuses(self, DIM, &good, true, "a Butcher table");
    }
    if ((self->type->flags & WEFT_STEPPER_QUADRATURES) == 0) {
        bad = good;
        bad.butcher = NULL;
        bad.quadratures = 2;
        refuses(self, DIM + 2, &bad, true, "quadratures");
    }
}

/* The config of an older program is shorter, that of a newer one longer. */
void weft__other_versions_are_served(trial *self)
{
    struct {
        weft_stepper_config config;
        unsigned char more[64];
    } newer = { .config = weft__with_table(self->type, weft__usual(self->type, 0)) };
    memset(newer.more, 0xA7, sizeof newer.more);
    const bool needs = weft__needs_structure(self->type);
    const uint32_t sizes[]
        = { sizeof newer, sizeof newer.config,
            needs ? offsetof(weft_stepper_config, linear) : WEFT_STEPPER_CONFIG_LEAST };
    for (int i = 0; i < 3; ++i) {
        trial_run *r = weft__begin(self, i, newer.config);
        self->type->destroy(r->self);
        newer.config.struct_size = sizes[i];
        newer.config.structure = needs ? &r->structure : NULL;
        r->self = NULL;
        const weft_status status
            = self->type->create(self->type, &r->ode, &newer.config, &r->self, &r->err);
        EXPECT(status == WEFT_OK,
               "a config with a struct_size of %u bytes is refused: %s",
               (unsigned)sizes[i], r->err.message);
        weft__go(self, r, 0.125);
        EXPECT(weft__same(self, r, &self->runs[0]),
               "results differ with a struct_size of %u bytes", (unsigned)sizes[i]);
    }
}

void weft__fixed_steps_ignore_tolerances(trial *self)
{
    weft_stepper_config config = weft__fixed(0x1p-9);
    trial_run *plain = weft__begin(self, 0, config);
    config.norm = WEFT_NORM_RMS;
    config.rtol = config.atol_position = config.atol_velocity = (double)NAN;
    config.first_step = config.min_step = config.max_step = -1.0;
    trial_run *odd = weft__begin(self, 1, config);
    weft__go(self, plain, 0.5);
    weft__go(self, odd, 0.5);
    EXPECT(weft__same(self, plain, odd), "the result depends on tolerances");
    const uint64_t steps = weft__stats(odd).steps;
    EXPECT(steps == 256, "%" PRIu64 " steps of 1/512 s up to 0.5 s, not 256", steps);
}
