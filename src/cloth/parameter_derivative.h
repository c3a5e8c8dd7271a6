/* SPDX-License-Identifier: BSD-3-Clause */
/* parameter_derivative.h -- the derivative of the right-hand side with respect
 * to a parameter of the definition, from two cloths that have less and more of it: of
 * the forces whose parameters differ, of the masses and of the motions of pins.
 *
 * That of springs, weight, air and masses is their law's, which products of the
 * Jacobian add (weft__spring_derivative). All others are a central difference. */
#pragma once

#include "cloth/model.h"
#include "forces/springs/springs_products.h"

/* J^T w to out[6 N]; net and *by as those of weft__springs.transposed. room: 9 N;
 * spaces as of weft__rhs_all. Returns as weft__rhs_blocks. */
int weft__rhs_transposed(const weft_cloth *cloth, void *const *spaces,
                         const weft__state *in, const double *w, double *room,
                         double *out, double *net, weft__parameter_gradient *by);

typedef struct weft__parameter_derivative {
    const weft_cloth *less, *more;
    double scale;               /* of the difference between the two */
    bool differs[WEFT__FORCES]; /* the other forces that change, */
    bool others;                /* of which there are any that belong to blocks, */
    bool whole;                 /* or to the whole cloth */
    bool pins;                  /* the motions change */
    weft__spring_derivative springs;
    double *inverse_mass; /* of `springs` */
} weft__parameter_derivative;

/* The derivative times `scale`, of two that are `span` apart. Errors:
 * WEFT_INVALID if the two differ from `cloth` in more than parameters; WEFT_NO_MEMORY.
 * Free it then too. */
weft_status weft__parameter_derivative_init(weft__parameter_derivative *of,
                                            const weft_cloth *cloth,
                                            const weft_cloth *less,
                                            const weft_cloth *more, double span,
                                            double scale, const weft_allocator *memory,
                                            weft_error *err);
void weft__parameter_derivative_free(const weft__parameter_derivative *of,
                                     const weft_allocator *memory);

/* Adds that of the other forces in blocks [first, end), but what whole.add adds, to the
 * accelerations in out[6 N]. room: 6 N, twice. Returns as weft__rhs_blocks. */
int weft__parameter_derivative_blocks(const weft__parameter_derivative *of,
                                      const weft__state *at, double *out,
                                      double *const room[2], size_t first, size_t end);

/* Adds w.(df/dp) to *sum; *by and net are what weft__rhs_transposed has found for w.
 * `spaces` are those of the cloth of parameter_derivative_init; room: 6 N each. Returns
 * as above. */
int weft__parameter_derivative_product(const weft__parameter_derivative *of,
                                       void *const *spaces, const weft__state *at,
                                       const double *w,
                                       const weft__parameter_gradient *by,
                                       const double *net, double *const room[3],
                                       double *sum);

/* Adds that of the forces of the whole cloth, with the pairs of `spaces`, which are
 * those of the cloth of parameter_derivative_init, or NULL. */
int weft__parameter_derivative_all(const weft__parameter_derivative *of,
                                   void *const *spaces, const weft__state *at,
                                   double *out, double *const room[2]);

/* That of a pinned particle, which does not depend on the state. */
void weft__parameter_derivative_pin(const weft__parameter_derivative *of, size_t i,
                                    const weft__state *at, double rate[6]);

/* Where one piece ends at t and the other begins, and the pin is on a table
 * (weft__pin_meets): by how much the derivative of its place jumps, and the one that
 * its velocity has then; else 0. */
void weft__parameter_derivative_jump(const weft__parameter_derivative *of, size_t i,
                                     double t, const double piece[2], double jump[6]);
