"""Sums of products in an order of their own: the same bits wherever the arrays lie in memory and however many threads there are, which BLAS does not promise.

Kernels neither, where a loop adds up and stores: LLVM asks at run time whether the arrays are near neighbours, and takes eight terms at a time or one by one.
There a loop that adds up stores nothing (tests/test_ordered.py).

    combined(weights, columns) = sum_m weights[..., m] columns[m]      dot(a, b) = sum_i a_i b_i
Cost  m passes over the columns; both are limited by memory, as BLAS is.
"""

import numpy as np


def combined(weights: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """`weights @ columns` of shapes (..., m) and (m, ...), term by term from the first on."""
    total = np.zeros((*weights.shape[:-1], *columns.shape[1:]))
    for m, column in enumerate(columns):
        total += np.multiply.outer(weights[..., m], column)
    return total


def dot(a: np.ndarray, b: np.ndarray) -> float:
    """`a @ b` of shapes (N,), by numpy's pairwise sum."""
    return float(np.sum(a * b))
