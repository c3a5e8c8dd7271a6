/* SPDX-License-Identifier: BSD-3-Clause */
/* suggest.c -- the nearest name to a mistyped one.
 *
 * Distance: Damerau-Levenshtein in its restricted form (optimal string alignment), the
 * number of characters inserted, left out, replaced or swapped with a neighbour. */
#include "base/suggest.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define MAX_LENGTH 48 /* no key is longer */

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Case is ignored: 'Rows' matches 'rows'. */
static int suggest_same(char a, char b)
{
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

/* rows[0] is the row to fill, for the first i + 1 characters of a; rows[1] and rows[2]
 * are the two before it. */
static void suggest_fill_row(const char *a, size_t i, const char *b,
                             size_t *const rows[3])
{
    rows[0][0] = i + 1;
    for (size_t j = 0; b[j] != '\0'; ++j) {
        const size_t replaced = rows[1][j] + !suggest_same(a[i], b[j]);
        rows[0][j + 1] = smaller(replaced, 1 + smaller(rows[0][j], rows[1][j + 1]));
        if (i > 0 && j > 0 && suggest_same(a[i], b[j - 1])
            && suggest_same(a[i - 1], b[j])) {
            rows[0][j + 1] = smaller(rows[0][j + 1], rows[2][j - 1] + 1);
        }
    }
}

static size_t suggest_distance(const char *a, const char *b)
{
    size_t rows[3][MAX_LENGTH + 1];
    for (size_t j = 0; j <= MAX_LENGTH; ++j) {
        rows[2][j] = j; /* before the first character of a */
    }
    for (size_t i = 0; a[i] != '\0'; ++i) {
        size_t *const turn[3] = { rows[i % 3], rows[(i + 2) % 3], rows[(i + 1) % 3] };
        suggest_fill_row(a, i, b, turn);
    }
    return rows[(strlen(a) + 2) % 3][strlen(b)];
}

/* 'denim' of '11oz-black-denim' */
static int is_word_of(const char *typed, size_t length, const char *name)
{
    for (const char *at = strstr(name, typed); at != NULL; at = strstr(at + 1, typed)) {
        if ((at == name || at[-1] == '-')
            && (at[length] == '\0' || at[length] == '-')) {
            return 1;
        }
    }
    return 0;
}

void weft__guess_try(weft__guess *guess, const char *typed, const char *name)
{
    const size_t typed_length = strlen(typed), length = strlen(name);
    if (typed_length > MAX_LENGTH || length > MAX_LENGTH || typed_length == 0) {
        return;
    }
    if (guess->name == NULL && typed_length > 2
        && is_word_of(typed, typed_length, name)) {
        guess->name = name;
        guess->distance = MAX_LENGTH;
    }
    const size_t longer = typed_length > length ? typed_length : length;
    const size_t limit = longer < 6 ? 1 : longer / 3;
    if (longer - smaller(typed_length, length) > limit) {
        return; /* the distance is no less */
    }
    const size_t found = suggest_distance(typed, name);
    if (found <= limit && found < length
        && (guess->name == NULL || found < guess->distance
            || (found == guess->distance && length > strlen(guess->name)))) {
        guess->name = name;
        guess->distance = found;
    }
}

const char *weft__guess_text(const weft__guess *guess, char *out, size_t size)
{
    out[0] = '\0';
    if (guess->name != NULL) {
        (void)snprintf(out, size, " (did you mean '%s'?)", guess->name);
    }
    return out;
}
