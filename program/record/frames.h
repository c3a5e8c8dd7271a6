/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.h -- reads the frames of a run directory, for exports, pages and comparisons.
 *
 * Numbers are as in the file: single precision unless the run recorded doubles. */
#pragma once

#include "base/part.h"
#include "program/record/record.h"

/* ---- faces.c: what frames, pages and exports draw between particles: the cells of a
 * grid, or triangles ---- */

/* One of several cloths: its particles follow those of the one before. */
typedef struct record_part {
    char name[WEFT_CLOTH_NAME_MAX + 1];
    size_t first;
} record_part;

typedef struct record_faces {
    size_t particles;
    size_t rows, cols; /* of a grid, for which this is all; 0: triangles */
    size_t triangles, places;
    uint32_t *corners, *corner_uv; /* 3 of each triangle: particles, places */
    double *uv;                    /* [m] of each place in the rest shape */
    int64_t *names;                /* of particles in files; NULL: 0, 1, ... */
    record_part *parts;
    size_t part_count; /* 0: one cloth without a name */
} record_faces;

static inline record_faces record_grid(size_t rows, size_t cols)
{
    return (record_faces){ .particles = rows * cols, .rows = rows, .cols = cols };
}

/* Of a cloth, of a band those of the whole. Free it, also after an error. */
weft_status record_faces_of(const weft_cloth *cloth, record_faces *out,
                            weft_error *err);
void record_faces_free(record_faces *of);

/* Whether two of them are the same but for the rest shape. */
bool record_faces_same(const record_faces *a, const record_faces *b);
/* Sets and returns the error of two runs of which they are not. */
weft_status record_faces_differ(const char *a_directory, const record_faces *a,
                                const char *b_directory, const record_faces *b,
                                weft_status status, weft_error *err);
/* "16 x 24 particles" or "85 vertices, 140 triangles"; "particle (3, 4)" or "vertex
 * 17": to text[RECORD_FACES_TEXT], which both return. */
enum { RECORD_FACES_TEXT = 96 };
const char *record_faces_text(const record_faces *of, char text[RECORD_FACES_TEXT]);
const char *record_particle_text(const record_faces *of, size_t i,
                                 char text[RECORD_FACES_TEXT]);

/* 0 of a chain, which is drawn as a line through all particles. */
static inline size_t record_face_count(const record_faces *of)
{
    return of->cols > 0 ? (of->rows - 1) * (of->cols - 1) : of->triangles;
}

/* How many corners each face has. */
static inline size_t record_face_sides(const record_faces *of)
{
    return of->cols > 0 ? 4 : 3;
}

static inline size_t record_name(const record_faces *of, size_t i)
{
    return of->names != NULL ? (size_t)of->names[i] : i;
}

/* The number of particle i's cloth. */
WEFT__PART_OF(record_part_of, record_faces)

/* The corners of face f, around it, the same way round in every format. */
static inline void record_face(const record_faces *of, size_t f, size_t corners[4])
{
    if (of->cols > 1) {
        const size_t a = f / (of->cols - 1) * of->cols + f % (of->cols - 1);
        corners[0] = a;
        corners[1] = a + of->cols;
        corners[2] = a + of->cols + 1;
        corners[3] = a + 1;
        return;
    }
    for (size_t k = 0; k < 3; ++k) {
        corners[k] = of->corners[3 * f + k];
    }
}

/* ---- the frames ---- */

enum { RECORD_KEY = 128 }; /* room for a parameter's key, as names of sets have it */

typedef struct record_frames {
    record_faces faces;
    size_t count, planned;           /* planned: frames that the file has room for */
    bool doubles;                    /* else single precision */
    bool fields[WEFT_RECORD_FIELDS]; /* those that the run recorded */
    const double *times;             /* [s] */
    const double *numbers;           /* their numbers in series.csv: not 0, 1, 2, ... if
                                        record.every is not 1 */
    const double *rest;              /* [m] rest positions: x y z of each */
    const uint8_t *pinned;           /* 0 or 1 for each particle; NULL: not recorded */
    size_t sensitivities;            /* sensitivities, by their keys, in this order */
    char keys[WEFT_SENSITIVITIES][RECORD_KEY];
} record_frames;

/* Opens DIR/run.vtkhdf, up to its last committed frame. Errors: WEFT_IO names the file
 * and its fault. */
weft_status record_frames_open(const char *directory, record_frames **out,
                               weft_error *err);
void record_frames_close(record_frames *frames); /* NULL is allowed */

/* [m] x y z of particle 0, x y z of particle 1, ...: 3 N doubles. */
weft_status record_frames_positions(record_frames *frames, size_t i, double *xyz,
                                    weft_error *err);
/* Velocities [m/s], 3 N doubles likewise, or the largest strain (L - s) / s of the
 * springs at each particle, N doubles. WEFT_UNSUPPORTED: not recorded. */
weft_status record_frames_field(record_frames *frames, weft_record_field field,
                                size_t i, double *values, weft_error *err);
/* [m] s of the positions by keys[j], 3 N doubles likewise. */
weft_status record_frames_sensitivity(record_frames *frames, size_t j, size_t i,
                                      double *values, weft_error *err);
