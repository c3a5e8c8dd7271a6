/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_changes.c -- the shapes as they are saved: their number, a hash of the law
 * that they obey, and of each its kind, the numbers of weft_shape from `at` on and
 * since when it moves so. Meshes stay those of the definition. */
#include <math.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "forces/contact/contact.h"

enum {
    AT_REALS = offsetof(weft_shape, at),
    SHAPE_REALS = (offsetof(weft_shape, body) - AT_REALS) / sizeof(double),
    SHAPE_WORDS = 1 + SHAPE_REALS + 1
};

size_t weft__contact_words(const void *own)
{
    return 2 + SHAPE_WORDS * ((const weft__contact *)own)->shape_count;
}

void weft__contact_put(const void *own, unsigned char *to)
{
    const weft__contact *of = own;
    weft__word_put(to, of->shape_count);
    weft__word_put(to + WEFT__WORD, weft__contact_hash(of));
    to += 2 * WEFT__WORD;
    for (size_t k = 0; k < of->shape_count; ++k, to += SHAPE_WORDS * WEFT__WORD) {
        const weft__shape *shape = &of->shapes[k];
        weft__word_put(to, (uint64_t)shape->def.kind);
        weft__words_put(to + WEFT__WORD, (const char *)&shape->def + AT_REALS,
                        SHAPE_REALS);
        weft__real_put(to + (1 + SHAPE_REALS) * WEFT__WORD, shape->motion.motion.since);
    }
}

/* The body of the next mesh among the shapes: meshes are never added or removed. */
static const weft_body *next_body(const weft__contact *of, size_t *shape)
{
    const weft_body *body = NULL;
    while (body == NULL && *shape < of->shape_count) {
        body = of->shapes[(*shape)++].def.body;
    }
    return body;
}

static bool take_shapes(const weft__contact *of, const unsigned char *from,
                        weft__shape *shapes, size_t count)
{
    size_t body = 0;
    bool good = true;
    for (size_t k = 0; k < count; ++k, from += SHAPE_WORDS * WEFT__WORD) {
        const double since = weft__real_at(from + (1 + SHAPE_REALS) * WEFT__WORD);
        const uint64_t kind = weft__word_at(from);
        weft_shape def
            = { .kind = kind < WEFT_SHAPES ? (weft_shape_kind)kind : WEFT_SHAPES };
        weft__words_get((char *)&def + AT_REALS, from + WEFT__WORD, SHAPE_REALS);
        def.body = def.kind == WEFT_MESH ? next_body(of, &body) : NULL;
        good = good && isfinite(since)
               && weft__shape_make(of, &def, since, k, &shapes[k], NULL) == WEFT_OK;
    }
    return good;
}

weft_status weft__contact_take(void *own, const unsigned char *from, size_t words,
                               const weft_allocator *memory, weft_error *err)
{
    weft__contact *of = own;
    const size_t count = words < 2 ? SIZE_MAX : (words - 2) / SHAPE_WORDS;
    const bool whole = words >= 2 && words == 2 + SHAPE_WORDS * count
                       && weft__word_at(from) == count;
    const weft__contact present = *of;
    of->shapes = whole ? weft__alloc(memory, count, sizeof *of->shapes) : NULL;
    of->shape_count = 0;
    if (whole && of->shapes == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory to restore shapes");
    }
    if (whole && count > 0
        && weft__word_at(from + WEFT__WORD) != weft__contact_hash(of)) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved of another cloth (its law of contact differs)");
    }
    if (!whole || !take_shapes(&present, from + 2 * WEFT__WORD, of->shapes, count)) {
        return weft_error_set(err, WEFT_INVALID, "a saved shape makes no sense");
    }
    of->shape_count = count;
    return WEFT_OK;
}

void weft__contact_exchange(void *own, void *taken)
{
    weft__contact *of = own, *with = taken;
    const weft__contact before = *of;
    of->shapes = with->shapes, of->shape_count = with->shape_count;
    ++of->changes;
    with->shapes = before.shapes, with->shape_count = before.shape_count;
}

void weft__contact_drop(void *taken, const weft_allocator *memory)
{
    weft__free(memory, ((weft__contact *)taken)->shapes);
}
