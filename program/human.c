/* SPDX-License-Identifier: BSD-3-Clause */
/* human.c -- numbers, foreign text and errors as people read them. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/suggest.h"
#include "program/cli.h"

enum { TEXT = 8192 };

human human_time(double seconds)
{
    static const struct {
        double unit;
        const char *name;
    } all[] = { { 86400.0, "d" }, { 3600.0, "h" }, { 60.0, "min" }, { 1.0, "s" },
                { 1e-3, "ms" },   { 1e-6, "us" },  { 1e-9, "ns" } };
    enum { SECONDS = 3, LAST = 6 };
    human out = { "" };
    size_t i = SECONDS;
    if (seconds >= 59.95) {
        seconds = fmax(seconds, 60.0);
        for (i = 0; seconds < all[i].unit;) {
            ++i;
        }
        const double whole = floor(seconds / all[i].unit);
        const double rest = floor((seconds - whole * all[i].unit) / all[i + 1].unit);
        (void)snprintf(out.text, sizeof out.text, "%.0f %s %02.0f %s", whole,
                       all[i].name, rest, all[i + 1].name);
        return out;
    }
    while (i < LAST && seconds > 0.0 && seconds < 0.9995 * all[i].unit) {
        ++i;
    }
    (void)snprintf(out.text, sizeof out.text, "%.3g %s", seconds / all[i].unit,
                   all[i].name);
    return out;
}

human human_count(uint64_t count)
{
    char digits[24];
    human out = { "" };
    const int length = snprintf(digits, sizeof digits, "%" PRIu64, count);
    char *to = out.text;
    for (int i = 0; i < length; ++i) {
        if (i > 0 && (length - i) % 3 == 0) {
            *to++ = ',';
        }
        *to++ = digits[i];
    }
    *to = '\0';
    return out;
}

double option_real(const char *text)
{
    char *end;
    const double value = strtod(text, &end);
    return end != text && *end == '\0' ? value : (double)NAN;
}

bool option_count(const char *text, char end, size_t *count)
{
    char *stop;
    errno = 0;
    const unsigned long long value = strtoull(text, &stop, 10);
    *count = (size_t)value;
    return text[0] >= '0' && text[0] <= '9' && *stop == end && errno == 0
           && value <= SIZE_MAX;
}

void say(sentence *out, const char *format, ...)
{
    const size_t used = strlen(out->text);
    va_list args;
    va_start(args, format);
    (void)vsnprintf(out->text + used, sizeof out->text - used, format, args);
    va_end(args);
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

static void print_text(FILE *stream, const char *keep, const char *format, va_list args)
{
    char text[TEXT];
    (void)vsnprintf(text, sizeof text, format, args);
    print_plain(stream, text, keep);
}

void print_line(FILE *stream, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print_text(stream, "", format, args);
    va_end(args);
    putc('\n', stream);
}

void print_plainly(FILE *stream, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print_text(stream, "\n", format, args);
    va_end(args);
}

/* ---- lines -------------------------------------------------------------------- */

enum { LABEL = 13, HELP_WIDTH = 75 };

static size_t count_chars(const char *text, size_t length)
{
    size_t count = 0;
    for (size_t i = 0; i < length; ++i) {
        count += ((unsigned char)text[i] & 0xC0) != 0x80; /* UTF-8 */
    }
    return count;
}

/* The bytes up to the next blank where a line may end: not between number and unit. */
static size_t unbroken(const char *text)
{
    size_t length = strcspn(text, " ");
    while (text[length] == ' ' && length > 0
           && strchr("0123456789", text[length - 1]) != NULL) {
        length += 1 + strcspn(text + length + 1, " ");
    }
    return length;
}

void print_wrapped(size_t used, size_t indent, size_t width, const char *text)
{
    char word[TEXT];
    for (bool first = true;; first = false) {
        const size_t length = unbroken(text);
        const size_t chars = count_chars(text, length);
        if (!first && used > indent && used + 1 + chars > width) {
            printf("\n%*s", (int)indent, "");
            used = indent;
        } else if (!first) {
            putchar(' ');
            ++used;
        }
        (void)snprintf(word, sizeof word, "%.*s", (int)length, text);
        print_plain(stdout, word, "");
        used += chars;
        text += length;
        if (*text == '\0') {
            break;
        }
        ++text;
    }
    putchar('\n');
}

void print_item(const char *label, const char *format, ...)
{
    char text[TEXT];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    printf("  %-*s", LABEL - 2, label);
    print_wrapped(LABEL, LABEL, PAGE_WIDTH, text);
}

/* The column of the text that follows a name and two blanks. 0: a line of a paragraph;
 * the whole length: a line that is not filled. */
static size_t text_column(const char *line, size_t length)
{
    size_t column = strspn(line, " ");
    if (column == 0) {
        return 0;
    }
    while (column < length && strncmp(line + column, "  ", 2) != 0) {
        ++column;
    }
    return column < length ? column + strspn(line + column, " ") : length;
}

/* Whether a line continues a text that begins at a column. */
static bool continues(const char *line, size_t column)
{
    return *line != '\0' && *line != '\n' && strspn(line, " ") == column;
}

static void print_filled(const char *text)
{
    while (*text != '\0') {
        const size_t column = text_column(text, strcspn(text, "\n"));
        char filled[TEXT] = "";
        size_t used = 0;
        printf("%.*s", (int)column, text);
        do {
            text += column;
            const size_t length = strcspn(text, "\n");
            used += (size_t)snprintf(filled + used, sizeof filled - used, "%s%.*s",
                                     used == 0 ? "" : " ", (int)length, text);
            text += length + (text[length] == '\n');
        } while (used > 0 && used < sizeof filled && continues(text, column));
        print_wrapped(column, column, HELP_WIDTH, filled);
    }
}

void print_help(const verb *of)
{
    print_filled(of->help);
    printf("%s", of->option_count > 0 ? "\n" : "");
    for (size_t i = 0; i < of->option_count; ++i) {
        const verb_option *option = &of->options[i];
        const bool jobs = strcmp(option->name, "jobs") == 0, value = option->value;
        char name[48], line[TEXT];
        (void)snprintf(name, sizeof name, "%s--%s%s%s", jobs ? "-j, " : "",
                       option->name, value ? " " : "", value ? option->value : "");
        (void)snprintf(line, sizeof line, "  %-20s %s\n", name, option->help);
        print_filled(line);
    }
    if (of->more != NULL) {
        putchar('\n');
        print_filled(of->more);
    }
}

/* ---- errors ------------------------------------------------------------------- */

int report_error(const weft_error *err)
{
    char place[sizeof err->file + 32] = "";
    if (err->file[0] != '\0') {
        (void)snprintf(place, sizeof place, "%s:%d:%d: ", err->file, err->line,
                       err->column);
    }
    print_line(stderr, "weft: error: %s%s", place, err->message);
    return err->status == WEFT_IO          ? EXIT_FILE
           : err->status == WEFT_BAD_SCENE ? EXIT_SCENE
                                           : EXIT_SIMULATION;
}

int report_status(weft_status status, const char *format, ...)
{
    weft_error err = { .status = status };
    va_list args;
    va_start(args, format);
    (void)vsnprintf(err.message, sizeof err.message, format, args);
    va_end(args);
    return report_error(&err);
}

int usage_error(const arguments *given, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fprintf(stderr, "weft %s: ", given->verb->name);
    print_text(stderr, "", format, args);
    va_end(args);
    fprintf(stderr, "\n'weft %s --help' shows how it is used\n", given->verb->name);
    return EXIT_USAGE;
}

int choose(const arguments *given, const char *option, const char *typed,
           const char *const *names, size_t *chosen)
{
    weft__guess guess = { 0 };
    sentence list = { "" };
    char near[80];
    for (size_t i = 0; names[i] != NULL; ++i) {
        if (strcmp(typed, names[i]) == 0) {
            *chosen = i;
            return EXIT_DONE;
        }
        weft__guess_try(&guess, typed, names[i]);
        const char *separator = i == 0 ? "" : names[i + 1] == NULL ? " or " : ", ";
        say(&list, "%s%s", separator, names[i]);
    }
    return usage_error(given, "%s%s '%s'%s is not %s",
                       option[0] >= 'A' && option[0] <= 'Z' ? "" : "--", option, typed,
                       weft__guess_text(&guess, near, sizeof near), list.text);
}
