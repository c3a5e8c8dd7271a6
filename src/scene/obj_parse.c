/* SPDX-License-Identifier: BSD-3-Clause */
/* obj_parse.c -- the statements of an OBJ file.
 *
 * One on a line, which ends with LF; CR counts as a blank, and so does a backslash at
 * the end of a line, which continues it. '#' begins a comment. Other statements than
 * those of `statements` have no effect on cloth. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/obj.h"

typedef struct cursor {
    weft__obj *obj;
    const char *at, *end;
    size_t vertices, places, faces; /* read so far */
    const char *word;               /* of the statement */
    const char *unknown;            /* the first that is none; NULL: none */
    size_t unknowns;
} cursor;

static uint32_t byte_of(const cursor *self, const char *text)
{
    return (uint32_t)(text - self->obj->file.text);
}

#define MISTAKE(self, where, ...)                                                      \
    weft__report_error((self)->obj->report,                                            \
                       weft__obj_mark((self)->obj, byte_of(self, where)), __VA_ARGS__)

/* ---- words -------------------------------------------------------------------- */

/* Bytes of a line break behind a backslash at text; 0: there is none. */
static size_t continuation(const char *text)
{
    return text[0] != '\\'                      ? 0
           : text[1] == '\n'                    ? 2
           : text[1] == '\r' && text[2] == '\n' ? 3
                                                : 0;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Moves to the next word of the statement; returns its bytes, 0 at the end. The text
 * ends with NUL. */
static size_t next_word(cursor *self)
{
    const char *p = self->at;
    for (size_t more = 0; is_blank(*p) || (more = continuation(p)) > 0;
         p += is_blank(*p) ? 1 : more) {
    }
    self->at = p;
    if (*p == '#') {
        return 0;
    }
    while ((*p > ' ' && *p != '\\')
           || (*p != '\0' && *p != '\n' && !is_blank(*p) && continuation(p) == 0)) {
        ++p;
    }
    return (size_t)(p - self->at);
}

/* Moves behind the end of the statement, from between its words. A line break ends it
 * but behind a backslash that is not in a comment. */
static void skip_line(cursor *self)
{
    const char *end = memchr(self->at, '\n', (size_t)(self->end - self->at));
    const char *last
        = end == NULL ? self->at : end - (end > self->at && end[-1] == '\r');
    if (last > self->at && last[-1] == '\\') {
        for (size_t length; (length = next_word(self)) > 0;) {
            self->at += length;
        }
        end = memchr(self->at, '\n', (size_t)(self->end - self->at));
    }
    self->at = end == NULL ? self->end : end + 1;
}

/* A decimal number that is all of a word. Up to 15 digits and the power of ten that
 * divides them are exact, so that the quotient is rounded as strtod would. */
static bool real_of(const char *word, size_t length, double *out)
{
    static const double ten[] = { 1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                  1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15 };
    const char *p = word + (*word == '-'), *point = NULL;
    const size_t digits = length - (*word == '-');
    int64_t number = 0;
    for (; p < word + length && digits < sizeof ten / sizeof *ten; ++p) {
        if (*p >= '0' && *p <= '9') {
            number = 10 * number + (*p - '0');
        } else if (*p == '.' && point == NULL && digits > 1) {
            point = p;
        } else {
            break;
        }
    }
    if (p == word + length) {
        const double whole = (double)number;
        *out = (*word == '-' ? -whole : whole) / ten[point != NULL ? p - point - 1 : 0];
        return digits > 0;
    }
    char *end = NULL;
    *out = strspn(word, "+-.0123456789eE") >= length ? strtod(word, &end) : (double)NAN;
    return end == word + length && isfinite(*out);
}

/* The numbers that a statement needs, as "x y z"; what follows them is not used. */
static bool read_reals(cursor *self, const char *needed, size_t count, double *out)
{
    for (size_t i = 0; i < count; ++i) {
        const size_t length = next_word(self);
        if (length == 0) {
            MISTAKE(self, self->word, "this line needs %s, but has %zu %s", needed, i,
                    i == 1 ? "number" : "numbers");
            return false;
        }
        if (!real_of(self->at, length, &out[i])) {
            MISTAKE(self, self->at, "'%.*s' is not a finite decimal number",
                    (int)(length < 40 ? length : 40), self->at);
            return false;
        }
        self->at += length;
    }
    return true;
}

/* ---- corners ------------------------------------------------------------------ */

/* An index, from 1, or from the end if negative, as a number from 0. */
static bool read_index(cursor *self, const char *what, const char **p, const char *end,
                       size_t before, size_t all, uint32_t *out)
{
    const bool back = *p < end && **p == '-';
    const char *digits = *p + back, *stop = digits;
    uint64_t number = 0;
    for (; stop < end && *stop >= '0' && *stop <= '9'; ++stop) {
        number = number > UINT32_MAX ? number : 10 * number + (uint64_t)(*stop - '0');
    }
    if (stop == digits || (stop < end && *stop != '/')) {
        MISTAKE(self, *p, "'%.*s' is no number of a %s",
                (int)(end - *p < 40 ? end - *p : 40), *p, what);
        return false;
    }
    if (number == 0 || number > (back ? before : all)) {
        const int length = (int)(stop - *p < 40 ? stop - *p : 40);
        if (all == 0) {
            MISTAKE(self, *p, "%s %.*s is not there: the file has no %s", what, length,
                    *p, what);
        } else {
            MISTAKE(self, *p, "%s %.*s is not there: the file has 1 to %zu%s", what,
                    length, *p, all,
                    back ? ", and negative ones count back from this line" : "");
        }
        return false;
    }
    *out = (uint32_t)(back ? before - number : number - 1);
    *p = stop;
    return true;
}

/* v, v/vt, v//vn or v/vt/vn */
static bool read_corner(cursor *self, size_t length, uint32_t *vertex, uint32_t *place)
{
    const weft__obj *obj = self->obj;
    const char *p = self->at, *end = p + length;
    *place = WEFT__NONE;
    if (!read_index(self, "v", &p, end, self->vertices, obj->vertices, vertex)) {
        return false;
    }
    if (obj->body || obj->in_space) {
        return true;
    }
    p += p < end;
    if (p < end && *p != '/') {
        return read_index(self, "vt", &p, end, self->places, obj->places, place);
    }
    if (obj->places > 0) {
        MISTAKE(self, self->at,
                "corner %.*s has no vt, its place in the rest shape: write v/vt",
                (int)(length < 40 ? length : 40), self->at);
    }
    return obj->places == 0;
}

static bool repeats(const weft__obj_face *face, size_t k)
{
    bool repeated = false;
    for (size_t i = 0; i < k; ++i) {
        repeated = repeated || face->vertex[i] == face->vertex[k];
    }
    return repeated;
}

/* The next face, as it begins; NULL: no memory. */
static weft__obj_face *new_face(cursor *self)
{
    weft__obj *obj = self->obj;
    if (!weft__report_reserve(obj->report, &obj->face, &obj->face_room, self->faces + 1,
                              sizeof *obj->face)) {
        return NULL;
    }
    weft__obj_face *face = &obj->face[self->faces];
    *face = (weft__obj_face){ .byte = byte_of(self, self->word),
                              .fabric = obj->fabrics.statements,
                              .groups = obj->groups.statements };
    face->vertex[3] = WEFT__NONE;
    return face;
}

/* One corner more than a quadrilateral, which becomes two triangles, or than a triangle
 * of a fan around corner 0: another triangle, which is returned; NULL: no memory. */
static weft__obj_face *widen_fan(cursor *self, weft__obj_face *face, uint32_t vertex)
{
    const weft__obj_face before = *face;
    const uint32_t *v = before.vertex;
    const bool quad = v[3] != WEFT__NONE;
    face->vertex[3] = WEFT__NONE;
    ++self->faces;
    face = new_face(self);
    if (face != NULL && quad) {
        memcpy(face->vertex, (uint32_t[]){ v[0], v[2], v[3] }, 3 * sizeof vertex);
        ++self->faces;
        face = new_face(self);
    }
    if (face != NULL) {
        memcpy(face->vertex, (uint32_t[]){ v[0], v[quad ? 3 : 2], vertex },
               3 * sizeof vertex);
    }
    return face;
}

/* A face of a body has any number of corners. One that is there already adds no area; a
 * face of which fewer than three are left is dropped. */
static void read_body_face(cursor *self)
{
    weft__obj *obj = self->obj;
    size_t corners = 0, written = 0, length;
    uint32_t vertex, none, last = WEFT__NONE;
    weft__obj_face *face = new_face(self);
    for (; face != NULL && (length = next_word(self)) > 0; self->at += length) {
        ++written;
        if (!read_corner(self, length, &vertex, &none)) {
            return;
        }
        if (corners > 0 && (vertex == last || vertex == face->vertex[0])) {
            continue;
        }
        if (corners < 4) {
            face->vertex[corners] = vertex;
        } else {
            face = widen_fan(self, face, vertex);
        }
        last = vertex;
        ++corners;
    }
    if (written < 3) {
        MISTAKE(self, self->word, "a face of %zu %s: it has 3 or more", written,
                written == 1 ? "corner" : "corners");
    } else if (corners < 3) {
        obj->flat_byte = obj->flat++ == 0 ? byte_of(self, self->word) : obj->flat_byte;
    } else {
        ++self->faces;
    }
}

static void read_face(cursor *self)
{
    weft__obj_face *face = new_face(self);
    size_t corners = 0, length;
    bool good = true;
    if (face == NULL) {
        return;
    }
    for (; (length = next_word(self)) > 0; self->at += length, ++corners) {
        if (corners >= 4 || !good) {
            continue;
        }
        good = read_corner(self, length, &face->vertex[corners], &face->place[corners]);
        if (good && repeats(face, corners)) {
            MISTAKE(self, self->at, "corner %.*s repeats a vertex of the face",
                    (int)(length < 40 ? length : 40), self->at);
            good = false;
        }
    }
    if (corners < 3 || corners > 4) {
        MISTAKE(self, self->word,
                "a face of %zu %s: cloth is made of triangles and quadrilaterals%s",
                corners, corners == 1 ? "corner" : "corners",
                corners > 4 ? "; triangulate the mesh on export" : "");
        good = false;
    }
    self->faces += good;
}

/* ---- the other statements ----------------------------------------------------- */

static void obj_parse_read_vertex(cursor *self)
{
    weft__obj *obj = self->obj;
    obj->vertex_byte[self->vertices] = byte_of(self, self->word);
    double *x = obj->vertex[self->vertices++];
    x[0] = read_reals(self, "x y z", 3, x) ? x[0] : (double)NAN;
}

static void read_texture(cursor *self)
{
    weft__obj *obj = self->obj;
    if (obj->in_space) {
        return;
    }
    obj->place_byte[self->places] = byte_of(self, self->word);
    double *u = obj->place[self->places++];
    u[0] = read_reals(self, "u v", 2, u) ? u[0] : (double)NAN;
}

static void add_name(cursor *self, weft__obj_names *to, size_t length)
{
    if (weft__report_reserve(self->obj->report, &to->list, &to->room, to->count + 1,
                             sizeof *to->list)) {
        to->list[to->count++]
            = (weft__obj_name){ self->at, (uint32_t)length, to->statements };
    }
}

/* The name is one word, or all words of the line as some programs write it. */
static void read_fabric(cursor *self)
{
    const size_t length = next_word(self);
    const char *first = self->at, *end = first + length;
    ++self->obj->fabrics.statements;
    add_name(self, &self->obj->fabrics, length);
    for (size_t more; (more = next_word(self)) > 0; self->at += more) {
        end = self->at + more;
    }
    if (end > first + length) {
        self->at = first;
        add_name(self, &self->obj->fabrics, (size_t)(end - first));
        self->at = end;
    }
}

static void read_groups(cursor *self)
{
    ++self->obj->groups.statements;
    for (size_t length; (length = next_word(self)) > 0; self->at += length) {
        add_name(self, &self->obj->groups, length);
    }
}

static void read_points(cursor *self)
{
    weft__obj *obj = self->obj;
    for (size_t length; (length = next_word(self)) > 0; self->at += length) {
        const char *p = self->at;
        uint32_t vertex;
        if (weft__report_reserve(obj->report, &obj->point, &obj->point_room,
                                 obj->points + 1, sizeof *obj->point)
            && read_index(self, "v", &p, p + length, self->vertices, obj->vertices,
                          &vertex)) {
            obj->point[obj->points++]
                = (weft__obj_point){ vertex, obj->groups.statements };
        }
    }
}

static const struct {
    const char *word;
    void (*read)(cursor *self), (*read_of_body)(cursor *self); /* NULL: no effect */
} statements[] = {
    { "v", obj_parse_read_vertex, obj_parse_read_vertex },
    { "vt", read_texture, NULL },
    { "f", read_face, read_body_face },
    { "p", read_points, NULL },
    { "g", read_groups, NULL },
    { "usemtl", read_fabric, NULL },
    /* of pictures and names */
    { "vn", NULL, NULL },
    { "vp", NULL, NULL },
    { "o", NULL, NULL },
    { "s", NULL, NULL },
    { "l", NULL, NULL },
    { "mg", NULL, NULL },
    { "mtllib", NULL, NULL },
    { "usemap", NULL, NULL },
    { "maplib", NULL, NULL },
    { "lod", NULL, NULL },
    { "bevel", NULL, NULL },
    { "c_interp", NULL, NULL },
    { "d_interp", NULL, NULL },
    { "shadow_obj", NULL, NULL },
    { "trace_obj", NULL, NULL },
};

/* NONE: an empty line. */
enum { KINDS = sizeof statements / sizeof statements[0], NONE, V = 0, VT = 1, F = 2 };

/* ---- the text ----------------------------------------------------------------- */

/* The statement at the cursor, which moves behind its word; KINDS: another. */
static size_t next_statement(cursor *self)
{
    const size_t length = next_word(self);
    size_t kind = length == 0 ? NONE : 0;
    self->word = self->at;
    while (kind < KINDS
           && (strncmp(statements[kind].word, self->word, length) != 0
               || statements[kind].word[length] != '\0')) {
        ++kind;
    }
    self->at += length;
    return kind;
}

/* At the beginning of the text, behind its byte order mark. */
static cursor obj_parse_begin(weft__obj *obj)
{
    const char *text = obj->file.text;
    return (cursor){ .obj = obj,
                     .at = text + weft__mark_length(text),
                     .end = text + obj->file.length };
}

static bool obj_parse_make_room(weft__obj *obj)
{
    size_t count[NONE + 1] = { 0 };
    for (cursor self = obj_parse_begin(obj); self.at < self.end; skip_line(&self)) {
        ++count[next_statement(&self)];
    }
    obj->vertices = count[V];
    obj->places = obj->body || obj->in_space ? 0 : count[VT];
    obj->face_room = count[F] + 1;
    obj->vertex = weft__report_take(obj->report, count[V], sizeof *obj->vertex);
    obj->vertex_byte
        = weft__report_take(obj->report, count[V], sizeof *obj->vertex_byte);
    obj->place = weft__report_take(obj->report, count[VT], sizeof *obj->place);
    obj->place_byte
        = weft__report_take(obj->report, count[VT], sizeof *obj->place_byte);
    obj->face = weft__report_take(obj->report, obj->face_room, sizeof *obj->face);
    return !obj->report->no_memory;
}

/* Leaves out what programs put behind the end of a text, and takes line ends of CR
 * alone. false: it is none, which is reported. */
static bool is_text(weft__obj *obj)
{
    weft__named_file *file = &obj->file;
    cursor self = { .obj = obj };
    const bool wide = file->length > 1
                      && (memcmp(file->text, "\xFF\xFE", 2) == 0
                          || memcmp(file->text, "\xFE\xFF", 2) == 0);
    while (file->length > 0 && file->text[file->length - 1] == '\0') {
        --file->length;
    }
    const char *nul = memchr(file->text, '\0', file->length);
    if (nul != NULL) {
        MISTAKE(&self, nul, "a NUL byte: this is not the text of an OBJ file%s",
                wide ? "; it looks like UTF-16, and OBJ files are UTF-8" : "");
    }
    const size_t inner = file->length - (file->length > 0); /* an LF may end them all */
    const bool bare = nul == NULL && memchr(file->text, '\n', inner) == NULL;
    for (char *at = file->text; bare && (at = strchr(at, '\r')) != NULL; ++at) {
        *at = '\n';
    }
    return nul == NULL;
}

static void read_statements(cursor *self)
{
    const weft__obj *obj = self->obj;
    for (; self->at < self->end && !obj->report->no_memory; skip_line(self)) {
        const size_t kind = next_statement(self);
        if (kind == KINDS) {
            self->unknown = self->unknowns++ == 0 ? self->word : self->unknown;
        } else if (kind != NONE) {
            void (*read)(cursor *)
                = obj->body ? statements[kind].read_of_body : statements[kind].read;
            if (read != NULL) {
                read(self);
            }
        }
    }
}

static void warn_of_unknown(cursor *self)
{
    char more[48] = "";
    self->at = self->unknown;
    const size_t length = next_word(self);
    if (self->unknowns > 1) {
        (void)snprintf(more, sizeof more, ", the first of %zu lines", self->unknowns);
    }
    weft__report_warning(self->obj->report,
                         weft__obj_mark(self->obj, byte_of(self, self->unknown)),
                         "'%.*s' is no statement that weft reads, and is left out%s",
                         (int)(length < 40 ? length : 40), self->unknown, more);
}

bool weft__obj_parse(weft__obj *obj)
{
    const size_t before = obj->report->mistakes;
    if (!is_text(obj) || !obj_parse_make_room(obj)) {
        return false;
    }
    cursor self = obj_parse_begin(obj);
    read_statements(&self);
    obj->faces = self.faces;
    if (self.unknowns > 0) {
        warn_of_unknown(&self);
    }
    if (obj->report->mistakes == before && obj->faces == 0 && obj->flat > 0) {
        MISTAKE(&self, obj->file.text + obj->flat_byte,
                "no face of this body has an area");
    } else if (obj->report->mistakes == before && obj->faces == 0) {
        MISTAKE(&self, obj->file.text, "the file has no faces (lines 'f %s')",
                obj->body || obj->in_space ? "1 2 3" : "1/1 2/2 3/3");
    }
    return obj->report->mistakes == before && !obj->report->no_memory;
}
