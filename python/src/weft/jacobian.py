# SPDX-License-Identifier: BSD-3-Clause
"""The derivative of a cloth's right-hand side as a sparse matrix, made of products with it.

Forces join only particles that are near each other, in the cloth or where it touches itself. So many columns of the matrix, of particles that have
no neighbours in common, follow from one product (A. R. Curtis, M. J. D. Powell, J. K. Reid, IMA J. Appl. Math. 13,
1974)."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from weft.simulation import Sim

def _groups(near: Any) -> Any:
    """A number for each particle; none of one number share a neighbour."""
    apart = (near @ near).tocsr()
    group = np.full(near.shape[0], -1)
    for i in range(len(group)):
        taken = group[apart.indices[apart.indptr[i]:apart.indptr[i + 1]]]
        free = np.ones(len(taken) + 1, dtype=bool)
        free[taken[(taken >= 0) & (taken < len(free))]] = False
        group[i] = free.argmax()
    return group


def assemble(sim: Sim, t: float, y: Any) -> Any:
    from scipy import sparse
    n = sim.particles
    p, q = np.concatenate([sim._joined(), sim._folded(y)]).astype(np.intp).T
    i = np.arange(n)
    near = sparse.coo_matrix((np.ones(2 * len(p) + n), (np.r_[p, q, i], np.r_[q, p, i])), (n, n)).tocsr()
    group, pairs = _groups(near), near.tocoo()
    rows, cols, values = [], [], []
    for g in range(group.max() + 1):
        members, of_group = np.flatnonzero(group == g), group[pairs.col] == g
        to, source = pairs.row[of_group], pairs.col[of_group]
        for plane in range(6):
            dy = np.zeros(6 * n)
            dy[plane * n + members] = 1.0
            product = sim.jacobian_product(t, y, dy).reshape(6, n)[:, to]
            k, there = np.nonzero(product)
            rows.append(k * n + to[there])
            cols.append(plane * n + source[there])
            values.append(product[k, there])
    return sparse.csc_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))), (6 * n, 6 * n))
