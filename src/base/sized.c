/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/sized.h"

bool weft__sized_read(void *to, size_t size, const void *from, size_t given)
{
    const unsigned char *bytes = from;
    memcpy(to, from, given < size ? given : size);
    while (given > size && bytes[given - 1] == 0) {
        --given;
    }
    return given <= size;
}

void weft__sized_write(void *out, size_t size, const void *from, size_t known)
{
    memset(out, 0, size);
    memcpy(out, from, known < size ? known : size);
}

weft_status weft__sized_unknown(const char *name, weft_error *err)
{
    return weft_error_set(err, WEFT_INVALID,
                          "%s has members that this libweft, version %s, does not "
                          "know: the program needs a newer one",
                          name, WEFT_VERSION);
}

weft_status weft__def_read(void *def, size_t size, const void *from, size_t most,
                           const char *name, weft_error *err)
{
    const uint32_t known = (uint32_t)size;
    uint32_t given = 0;
    memcpy(&given, from, sizeof given);
    /* of no version a part of a pointer */
    if (given < sizeof given || given > most || given % sizeof(void *) != 0) {
        return weft_error_set(err, WEFT_INVALID,
                              "%s: struct_size is %u; start from %s_default()", name,
                              (unsigned)given, name);
    }
    const bool understood = weft__sized_read(def, size, from, given);
    memcpy(def, &known, sizeof known);
    return understood ? WEFT_OK : weft__sized_unknown(name, err);
}
