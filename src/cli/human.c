/* SPDX-License-Identifier: BSD-3-Clause */
/* human.c -- numbers and foreign text as people read them. */
#include <math.h>
#include <string.h>

#include "cli/human.h"

static const char *in_units(double seconds, double unit, const char *big,
                            const char *small, char out[HUMAN])
{
    const double whole = floor(seconds / unit);
    (void)snprintf(out, HUMAN, "%.0f %s %02.0f %s", whole, big,
                   floor((seconds - whole * unit)
                         / (unit == 86400.0  ? 3600.0
                            : unit == 3600.0 ? 60.0
                                             : 1.0)),
                   small);
    return out;
}

const char *human_time(double seconds, char out[HUMAN])
{
    static const struct {
        double unit;
        const char *name;
    } small[] = { { 1.0, "s" }, { 1e-3, "ms" }, { 1e-6, "us" }, { 1e-9, "ns" } };
    size_t i = 0;
    if (seconds >= 59.95) {
        return seconds >= 86400.0 ? in_units(seconds, 86400.0, "d", "h", out)
               : seconds >= 3600.0
                   ? in_units(seconds, 3600.0, "h", "min", out)
                   : in_units(fmax(seconds, 60.0), 60.0, "min", "s", out);
    }
    while (i < 3 && seconds > 0.0 && seconds < 0.9995 * small[i].unit) {
        ++i;
    }
    (void)snprintf(out, HUMAN, "%.3g %s", seconds / small[i].unit, small[i].name);
    return out;
}

const char *human_count(uint64_t count, char out[HUMAN])
{
    char digits[24];
    const int length = snprintf(digits, sizeof digits, "%" PRIu64, count);
    char *to = out;
    for (int i = 0; i < length; ++i) {
        if (i > 0 && (length - i) % 3 == 0) {
            *to++ = ',';
        }
        *to++ = digits[i];
    }
    *to = '\0';
    return out;
}

/* U+0080 to U+009F are controls too, C2 80 to C2 9F. */
void print_plain(FILE *stream, const char *text, const char *keep)
{
    for (const unsigned char *c = (const unsigned char *)text; *c != '\0'; ++c) {
        if (c[0] == 0xC2 && c[1] >= 0x80 && c[1] <= 0x9F) {
            fprintf(stream, "\\x%02x", (unsigned)*++c);
        } else if ((*c < 0x20 && strchr(keep, *c) == NULL) || *c == 0x7F) {
            fprintf(stream, "\\x%02x", (unsigned)*c);
        } else {
            putc(*c, stream);
        }
    }
}
