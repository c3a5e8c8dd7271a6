/* SPDX-License-Identifier: BSD-3-Clause */
/* plugin.c -- a plugin's tables of any content: refused, or fit for use. Each table is
 * as long as its struct_size says and no longer. */
#include "fuzz/fuzz.h"

typedef struct bytes {
    const uint8_t *at, *end;
} bytes;

static unsigned next(bytes *from)
{
    return from->at < from->end ? *from->at++ : 0;
}

static const char *text(bytes *from)
{
    static const char *const texts[] = { NULL, "", "a", "b", "ab", "long-name" };
    return texts[next(from) % (sizeof texts / sizeof texts[0])];
}

static weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **self,
                          weft_error *err)
{
    (void)ode, (void)config, *self = NULL;
    return weft_error_set(err, WEFT_UNSUPPORTED, "%s", type->name);
}

static weft_status step(void *self, double t_end, double *t, double *y, weft_error *err)
{
    (void)self, (void)t_end, (void)t, (void)y;
    return weft_error_set(err, WEFT_UNSUPPORTED, "no step");
}

static void state_changed(void *self)
{
    (void)self;
}

static void stats(const void *self, weft_stepper_stats *out)
{
    (void)self, (void)out;
}

/* Mostly right, so that what comes after is looked at too. */
static uint32_t near(bytes *from, size_t right)
{
    const unsigned byte = next(from);
    return byte < 200 ? (uint32_t)right : (uint32_t)(byte - 200) * 4;
}

/* The first `size` bytes of a whole struct; at least abi and struct_size. */
static void *cut(const void *whole, size_t length, uint32_t size)
{
    const size_t kept = size < 8 ? 8 : size;
    char *copy = calloc(1, kept);
    HOLDS(copy != NULL);
    memcpy(copy, whole, kept < length ? kept : length);
    return copy;
}

static const weft_stepper_type *make_type(bytes *from)
{
    weft_stepper_type type = { .abi = near(from, WEFT_STEPPER_ABI),
                               .struct_size = near(from, sizeof type) };
    const unsigned there = next(from);
    type.name = text(from);
    type.reference = (there & 1) == 0 ? "r" : NULL;
    type.license = (there & 2) == 0 ? "l" : NULL;
    type.create = (there & 4) == 0 ? create : NULL;
    type.step = (there & 8) == 0 ? step : NULL;
    type.state_changed = (there & 16) == 0 ? state_changed : NULL;
    type.stats = (there & 32) == 0 ? stats : NULL;
    type.destroy = (there & 64) == 0 ? state_changed : NULL;
    type.flags = next(from);
    type.full_name = text(from);
    return cut(&type, sizeof type, type.struct_size);
}

enum { TYPES = 8 };

static void use(const weft_plugin *plugin)
{
    const weft_registry_def def = { .struct_size = sizeof def };
    weft_registry *registry = NULL;
    const weft_plugin *again = NULL;
    weft_error err = { 0 };
    HOLDS(weft_registry_create(&def, &registry, NULL) == WEFT_OK);
    if (weft_registry_add(registry, plugin, &err) == WEFT_OK) {
        HOLDS(weft_registry_find(registry, plugin->id, &again, &err) == WEFT_OK);
        HOLDS(again == plugin && plugin->types[0] != NULL);
        for (size_t i = 0; plugin->types[i] != NULL; ++i) {
            HOLDS(weft_plugin_method(plugin, plugin->types[i]->name)
                  == plugin->types[i]);
        }
        HOLDS(weft_registry_add(registry, plugin, NULL) == WEFT_BAD_PLUGIN);
    } else {
        HOLDS(err.status == WEFT_BAD_PLUGIN && err.message[0] != '\0');
        HOLDS(weft_registry_count(registry) == 0);
    }
    weft_registry_destroy(registry);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes from = { data, data + size };
    const weft_stepper_type *types[TYPES + 1] = { 0 };
    weft_plugin plugin = { .abi = near(&from, WEFT_STEPPER_ABI),
                           .struct_size = near(&from, sizeof plugin),
                           .id = text(&from),
                           .version = text(&from),
                           .solver = text(&from),
                           .types = next(&from) < 250 ? types : NULL };
    const size_t count = next(&from) % (TYPES + 1);
    for (size_t i = 0; i < count; ++i) {
        types[i] = make_type(&from);
    }
    weft_plugin *copy = cut(&plugin, sizeof plugin, plugin.struct_size);
    use(copy);
    free(copy);
    for (size_t i = 0; i < count; ++i) {
        free((void *)types[i]);
    }
    return 0;
}
