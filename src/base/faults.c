/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/faults.h"

#include <math.h>
#include <stdarg.h>

void weft__fault(const weft__faults *to, size_t field, size_t other, const char *format,
                 ...)
{
    char message[256];
    va_list args;
    va_start(args, format);
    (void)weft_text_format_list(message, sizeof message, format, args);
    va_end(args);
    to->found(to->ctx, field, other, message);
}

void weft__keep_first(void *ctx, size_t field, size_t other, const char *message)
{
    weft__refusal *first = ctx;
    (void)field, (void)other;
    if (first->status == WEFT_OK) {
        first->status = weft_error_set(first->err, WEFT_INVALID, "%s", message);
    }
}

bool weft__in_range(const weft__number *number, double value)
{
    return (number->strict ? value > number->least : value >= number->least)
           && (number->most == 0.0
               || (number->below ? value < number->most : value <= number->most))
           && (isfinite(value) || (number->infinite && value > 0.0));
}

const char *weft__range_text(const weft__number *number, bool bare, char *out,
                             size_t size)
{
    char above[40] = "";
    if (number->most > 0.0 && !(bare && number->most > WEFT__MANY)) {
        (void)weft_text_format(above, sizeof above, " and %s %.10g",
                               number->below ? "<" : "<=", number->most);
    }
    (void)weft_text_format(out, size, "%s %g%s%s",
                           number->strict ? ">" : ">=", number->least, above,
                           number->infinite ? " or .inf" : "");
    return isinf(number->least) ? "" : out;
}

static double value_of(const weft__number *number, const void *def, size_t i)
{
    const void *at = (const char *)def + number->at;
    return number->type == WEFT__DOUBLE ? ((const double *)at)[i]
           : number->type == WEFT__SIZE ? (double)*(const size_t *)at
                                        : *(const int *)at;
}

static bool check_number(const weft__number *number, const void *def,
                         const char *prefix, const weft__faults *to)
{
    const char *unit = number->unit == NULL ? "" : number->unit;
    char values[100] = "", text[80];
    bool good = true;
    weft__number range = *number;
    range.strict = number->strict && !number->optional;
    for (size_t i = 0, used = 0; i == 0 || i < number->count; ++i) {
        const double value = value_of(number, def, i);
        good = good && weft__in_range(&range, value);
        used += (size_t)weft_text_format(values + used, sizeof values - used, "%s%.10g",
                                         i == 0 ? "" : ", ", value);
    }
    if (!good) {
        const bool choice = number->type == WEFT__ENUM;
        range.infinite = false; /* its spelling is that of a scene */
        const char *bounds = weft__range_text(&range, false, text, sizeof text);
        weft__fault(to, number->at, number->at, "%s%s %s%s%s%s%s%s", prefix,
                    number->name, values, unit[0] == '\0' ? "" : " ", unit,
                    choice ? " is unknown" : ": must be ",
                    choice              ? ""
                    : bounds[0] == '\0' ? "finite"
                                        : bounds,
                    number->infinite ? " or infinite" : "");
    }
    return good;
}

bool weft__numbers_check(const weft__number *numbers, size_t count, const void *def,
                         const weft__faults *to, const char *prefix, ...)
{
    char text[64];
    bool good = true;
    va_list args;
    va_start(args, prefix);
    (void)weft_text_format_list(text, sizeof text, prefix, args);
    va_end(args);
    for (size_t i = 0; i < count; ++i) {
        good = check_number(&numbers[i], def, text, to) && good;
    }
    return good;
}
