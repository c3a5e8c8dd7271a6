/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/comm.h -- one cloth in bands of rows, each in a process or thread of its own.
 *
 * A band is its own rows and the WEFT_GHOST_ROWS nearest rows of each neighbour, its
 * ghosts. Of triangles it is blocks of WEFT_BLOCK_VERTICES vertices, in an order in
 * which neighbours are near one another, and as ghosts the particles of other bands
 * that forces on its own depend on: what is said of rows here then holds for blocks.
 * The ghosts are part of the state and are integrated as the own rows are; only their
 * accelerations come from the neighbour, once per right-hand side. So all bands have
 * the bits of the whole cloth in one process, on any number of bands.
 * docs/guides/cluster.md describes this.
 *
 * A weft_comm joins the bands. weft calls it and knows nothing of what is behind: MPI
 * (weft-mpi.so), threads, or the embedder's own. All calls are collective: every band
 * makes the same ones in the same order, and each returns only after the others have
 * made it, or fails the whole job; begin and poke may return earlier. One thread of a
 * band at a time makes them. */
#ifndef WEFT_COMM_H
#define WEFT_COMM_H

#include "weft/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How far the forces reach, and the smallest number of own rows of a band. */
enum { WEFT_GHOST_ROWS = 2, WEFT_BLOCK_VERTICES = 512 };

/* Rows of a cloth. Row 0 of a band's own arrays is its first ghost row, or else its
 * first own row: row r of them is row first - above + r of the whole cloth. Fixed for
 * ever. */
typedef struct weft_band {
    size_t rows;         /* of the whole cloth */
    size_t first, own;   /* own rows: [first, first + own) of the whole */
    size_t above, below; /* ghost rows before and after them, at most WEFT_GHOST_ROWS;
                            of triangles blocks of ghosts, any number */
} weft_band;

/* Planes of rows in memory: above ghost rows, then own rows, then ghost rows below. The
 * first band has no ghosts above and the last none below. */
typedef struct weft_rows {
    double *first;            /* of plane 0 */
    size_t planes, stride;    /* [doubles] from one plane to the next */
    size_t cols;              /* [doubles] of a row */
    size_t above, own, below; /* rows; above and below 0 or WEFT_GHOST_ROWS */
} weft_rows;

/* Numbers for another band, and room for those from it. Fixed for ever. */
typedef struct weft_parcel {
    int rank;
    size_t outs, ins;
    const double *out;
    double *in;
} weft_parcel;

/* Joins the bands of a cloth; the head of this file has the rules of its calls. */
typedef struct weft_comm {
    uint32_t struct_size;
    void *self;
    int rank, size; /* bands are numbered from the first row on */

    /* The largest of what each band gives, >= 0 or NaN, to all; NaN if one is NaN. */
    double (*max)(void *self, double mine);

    /* Sends the first and last WEFT_GHOST_ROWS own rows of each plane to the neighbours
     * and receives their rows into the ghosts: begin starts, end waits until the ghosts
     * are there; between the two nobody writes to *rows' ghosts or own edge rows. poke
     * lets the transfer go on and may be NULL. */
    void (*begin)(void *self, const weft_rows *rows);
    void (*poke)(void *self);
    void (*end)(void *self);

    /* `bytes` of band 0 to all bands, in place. */
    void (*share)(void *self, void *data, size_t bytes);

    /* `bytes` of each band, which may differ from band to band, one after another in
     * the order of the bands, to band 0, whose `all` has room for them; the others' all
     * is not looked at. Both, as bytes of share, may be more than 2^31 bytes, or 0. */
    void (*gather)(void *self, const void *mine, size_t bytes, void *all);

    /* Ends all bands at once, with an exit code; does not return. Not collective. For
     * programs: libweft never calls it. */
    void (*stop)(void *self, int code);

    /* Of bands of triangles, in place of begin, and of all with contact.self, before
     * it: sends each of `parcels` and receives those of the same bands, of which each
     * appears once; `end` waits until all are there; between the two nobody writes to
     * what is sent or received. The same bands have `parcels` for this one, of these
     * sizes. NULL: rows alone, without contact.self. */
    void (*post)(void *self, const weft_parcel *parcels, size_t count);
} weft_comm;

/** Divides rows among bands, as evenly as possible: the first bands are one row larger.
 * A cloth of triangles has blocks in place of rows.
 * @param rows of the whole cloth: weft_cloth_def_blocks
 * @param rank of the band
 * @param size the number of bands
 * @param[out] first the first own row; unchanged on failure
 * @param[out] count the number of own rows; unchanged on failure
 * @return true; false if a band would have fewer than WEFT_GHOST_ROWS rows or rank is
 *   not below size
 * @par Example
 * @snippet bands.c band */
static inline bool weft_comm_band(size_t rows, size_t rank, size_t size, size_t *first,
                                  size_t *count)
{
    if (rank >= size || rows / size < WEFT_GHOST_ROWS) {
        return false;
    }
    const size_t more = rows % size;
    *count = rows / size + (rank < more);
    *first = rank * (rows / size) + (rank < more ? rank : more);
    return true;
}

/** Makes all bands return the same status. Collective: all bands call it. Nothing
 * between two calls of a comm may end one band alone.
 * @param comm NULL: the cloth is whole, and the status is returned
 * @param status of this band
 * @param[in,out] err the error of this band; receives that of the first band that
 *   failed. May be NULL
 * @return WEFT_OK if all bands have it, else the status of the first band that has
 *   another
 * @par Example
 * @snippet bands.c agree */
WEFT_API weft_status weft_comm_agree(const weft_comm *comm, weft_status status,
                                     weft_error *err);

#ifdef __cplusplus
}
#endif

#endif
