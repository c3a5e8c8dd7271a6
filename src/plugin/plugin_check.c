/* SPDX-License-Identifier: BSD-3-Clause */
/* plugin_check.c -- checks a plugin. Fields are read in the order
 * in which they can be trusted: abi, struct_size, then the rest. */
#include "plugin/plugin_check.h"

#include <string.h>

weft_status weft__method_check(const weft_stepper_type *type, size_t index,
                               weft_error *err)
{
    if (type->abi != WEFT_STEPPER_ABI) {
        return weft_error_set(
            err, WEFT_BAD_PLUGIN,
            "method %zu is built for plugin interface %u, this weft has %u", index,
            (unsigned)type->abi, WEFT_STEPPER_ABI);
    }
    if (type->struct_size < WEFT_STEPPER_TYPE_LEAST) {
        return weft_error_set(
            err, WEFT_BAD_PLUGIN,
            "method %zu has a struct_size of %u bytes, abi %u needs %zu", index,
            (unsigned)type->struct_size, WEFT_STEPPER_ABI, WEFT_STEPPER_TYPE_LEAST);
    }
    if (type->name == NULL || type->name[0] == '\0') {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "method %zu has no name", index);
    }
    const char *missing = type->create == NULL          ? "create"
                          : type->step == NULL          ? "step"
                          : type->state_changed == NULL ? "state_changed"
                          : type->stats == NULL         ? "stats"
                          : type->destroy == NULL       ? "destroy"
                                                        : NULL;
    if (missing != NULL) {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "method '%s' has no %s", type->name,
                              missing);
    }
    return WEFT_OK;
}

static weft_status check_names(const weft_plugin *plugin, weft_error *err)
{
    for (size_t i = 0; plugin->types[i] != NULL; ++i) {
        const char *name = plugin->types[i]->name,
                   *full = weft_stepper_full_name(plugin->types[i]);
        for (size_t j = 0; j < i; ++j) {
            if (weft_stepper_is(plugin->types[j], name)
                || (full != NULL && weft_stepper_is(plugin->types[j], full))) {
                return weft_error_set(err, WEFT_BAD_PLUGIN,
                                      "method '%s' is there twice", name);
            }
        }
    }
    return WEFT_OK;
}

weft_status weft__plugin_check(const weft_plugin *plugin, weft_error *err)
{
    if (plugin == NULL) {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "its entry function returned NULL");
    }
    if (plugin->abi != WEFT_STEPPER_ABI) {
        return weft_error_set(err, WEFT_BAD_PLUGIN,
                              "it is built for plugin interface %u, this weft has %u",
                              (unsigned)plugin->abi, WEFT_STEPPER_ABI);
    }
    if (plugin->struct_size < sizeof *plugin) {
        return weft_error_set(
            err, WEFT_BAD_PLUGIN, "it has a struct_size of %u bytes, abi %u needs %zu",
            (unsigned)plugin->struct_size, WEFT_STEPPER_ABI, sizeof *plugin);
    }
    if (plugin->id == NULL || plugin->id[0] == '\0' || plugin->version == NULL
        || plugin->solver == NULL || plugin->types == NULL
        || plugin->types[0] == NULL) {
        return weft_error_set(err, WEFT_BAD_PLUGIN,
                              "it lacks an id, a version, a solver text or methods");
    }
    for (size_t i = 0; plugin->types[i] != NULL; ++i) {
        const weft_stepper_type *type = plugin->types[i];
        TRY(weft__method_check(type, i, err));
        if (type->reference == NULL || type->license == NULL) {
            return weft_error_set(err, WEFT_BAD_PLUGIN, "method '%s' has no %s",
                                  type->name,
                                  type->reference == NULL ? "reference" : "license");
        }
    }
    return check_names(plugin, err);
}
