/* SPDX-License-Identifier: BSD-3-Clause */
/* settings.c -- a hash of the settings on which results depend, to compare a restored
 * simulation with the saved one. Threads, allocators and the log change no result. */
#include "base/hash.h"
#include "sim/simulation.h"

static uint64_t hash_controller(uint64_t hash, const weft_controller *law)
{
    hash = weft__hash_word(hash, law->type);
    hash = weft__hash_word(hash, (uint64_t)law->gain_count);
    hash = weft__hash_reals(hash, law->gains, (size_t)law->gain_count);
    return WEFT__HASH_NUMBERS(hash, law->safety, law->bias, law->max_growth,
                              law->first_growth, law->min_reduction,
                              law->failed_growth);
}

/* The settings of error control. */
static uint64_t hash_adaptive(uint64_t hash, const weft_stepper_config *config)
{
    return WEFT__HASH_NUMBERS(weft__hash_word(hash, config->norm), config->rtol,
                              config->atol_position, config->atol_velocity,
                              config->first_step, config->min_step, config->max_step);
}

static uint64_t hash_linear(uint64_t hash, const weft_linear *linear)
{
    hash = weft__hash_real(hash, linear->krylov);
    hash = weft__hash_word(hash, linear->preconditioner);
    hash = weft__hash_word(hash, linear->jacobian);
    return weft__hash_word(hash, (uint64_t)linear->max_order);
}

static uint64_t hash_table(uint64_t hash, const weft_butcher *table)
{
    const size_t stages = (size_t)table->stages;
    hash = weft__hash_word(hash, stages);
    hash = weft__hash_word(hash, (uint64_t)table->order);
    hash = weft__hash_word(hash, (uint64_t)table->embedded_order);
    hash = weft__hash_reals(hash, table->a, stages * stages);
    hash = weft__hash_reals(hash, table->b, stages);
    hash = weft__hash_reals(hash, table->c, stages);
    return weft__hash_reals(hash, table->b_embedded, stages);
}

static uint64_t hash_limit(uint64_t hash, const weft_limit_def *limit)
{
    hash = weft__hash_word(hash, limit->solver);
    hash = weft__hash_word(hash, limit->sweeps);
    hash = weft__hash_word(hash, limit->keep_velocity);
    for (size_t family = 0; family < WEFT_FAMILIES; ++family) {
        hash = weft__hash_word(hash, limit->families[family]);
    }
    return WEFT__HASH_NUMBERS(hash, limit->strain, limit->tolerance);
}

uint64_t weft__settings_hash(const weft_sim_def *def, const weft_stepper_config *config)
{
    const uint32_t flags = def->method->flags;
    uint64_t hash = weft__hash_real(WEFT__HASH_START, config->fixed_step);
    if (config->fixed_step == 0.0) {
        hash = hash_adaptive(hash, config);
        if ((flags & WEFT_STEPPER_CONTROLLER) != 0 && config->controller != NULL) {
            hash = hash_controller(hash, config->controller);
        }
    }
    if ((flags & WEFT_STEPPER_LINEAR) != 0 && config->linear != NULL) {
        hash = hash_linear(hash, config->linear);
    }
    if ((flags & WEFT_STEPPER_BUTCHER) != 0) {
        hash = hash_table(hash, config->butcher);
    }
    hash = weft__hash_word(hash, def->limit.method);
    hash = def->limit.method != WEFT_LIMIT_NONE ? hash_limit(hash, &def->limit) : hash;
    hash = weft__hash_word(hash, def->ledger);
    hash = weft__hash_word(hash, def->force != NULL);
    return weft__hash_word(hash, def->correct != NULL);
}
