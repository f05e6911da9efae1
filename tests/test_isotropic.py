"""Half the logarithm and the exponential of tensors over lanes against the spectral forms of numpy, over all branches and both precisions."""

import numpy as np
import pytest

from mpm.isotropic import exponential3, largest, logarithm3, lowest3, norm, split
from mpm.jit import kernel
from mpm.lanes import load8, store


@kernel
def logarithms(B, out):
    """Rows: strain, smallest number of logarithm3, lower bound."""
    n = B.shape[1]
    for p in range(0, n, 8):
        e, sound = logarithm3((load8(B, p), load8(B, n + p), load8(B, 2 * n + p), load8(B, 3 * n + p), load8(B, 4 * n + p), load8(B, 5 * n + p)))
        for k in range(6):
            store(out, k * n + p, e[k])
        mean, D = split(e)
        store(out, 6 * n + p, sound)
        store(out, 7 * n + p, lowest3(e, mean, norm(D, largest(D))))


@kernel
def exponentials(e, out):
    n = e.shape[1]
    for p in range(0, n, 8):
        mean, D = split((load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p), load8(e, 4 * n + p), load8(e, 5 * n + p)))
        B = exponential3(mean, D)
        for k in range(6):
            store(out, k * n + p, B[k])


N = 20_000 if hasattr(logarithms, "signatures") else 200
PLACES = ([0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2])


def turned(values, seed=1):
    """Packed tensors of principal values (n, 3) in random axes, and the axes."""
    Q = np.linalg.qr(np.random.default_rng(seed).standard_normal((len(values), 3, 3)))[0]
    return np.ascontiguousarray(np.einsum("nik,nk,njk->nij", Q, values, Q)[:, *PLACES].T), Q


def strains(size, seed=0):
    return np.random.default_rng(seed).uniform(-size, size, (N, 3))


@pytest.mark.parametrize("real", [np.float64, np.float32])
@pytest.mark.parametrize("size", [1e-18, 1e-12, 1e-6, 1e-2, 0.1, 0.2, 0.5, 1.5], ids=str)
def test_there_and_back(size, real):
    """exp(2 eps) - 1 of principal strains, its logarithm, and the exponential of that: relative to the largest value, in units of round-off."""
    eps = strains(size)
    values = np.expm1(2 * eps)
    B, Q = turned(values)
    B = B.astype(real)
    expected = np.einsum("nik,nk,njk->nij", Q, eps, Q)[:, *PLACES].T
    out, back = np.zeros((8, N), real), np.zeros((6, N), real)
    logarithms(B, out)
    exponentials(np.ascontiguousarray(out[:6]), back)
    unit = np.finfo(real).eps
    few = 12 if size < 0.15 else 20
    # through the axes: Jacobi's own error, of the largest value, is divided by the smallest 1 + B in the logarithm
    worth = 1.0 if size < 0.15 else np.max((1 + values.max(1)) / (1 + values.min(1)))
    assert np.max(np.abs(out[:6] - expected).max(0) / np.abs(expected).max(0)) < few * unit * worth
    assert np.max(np.abs(back - B).max(0) / np.abs(B).max(0)) < few * unit * worth
    lowest = eps.min(1)
    assert (out[6] > -1).all() and (out[7] <= lowest + few * unit * worth * np.abs(eps).max(1) + 1e-17).all()
    assert (out[7] >= lowest - 0.7 * np.abs(eps).max(1) - 1e-17).all()


def test_bound_is_exact_along_one_axis():
    eps = np.zeros((N, 3))
    eps[:, 0] = -np.random.default_rng(2).uniform(0, 0.5, N)
    out = np.zeros((8, N))
    logarithms(turned(np.expm1(2 * eps))[0], out)
    assert np.allclose(out[7], eps[:, 0], rtol=0, atol=1e-14)


@pytest.mark.parametrize("wrong", [-1.0, -1.5, np.nan])
def test_no_logarithm_is_noticed(wrong):
    values = strains(0.1)[:8]
    values[5, 1] = wrong
    out = np.zeros((8, 8))
    with np.errstate(invalid="ignore", divide="ignore"):
        logarithms(turned(values)[0], out)
    assert not out[6, 5] > -1 + 1e-12 and (np.delete(out[6], 5) > -1).all()


def test_isotropic_tensors_stay_isotropic():
    B = np.zeros((6, 8))
    B[:3] = np.linspace(-0.9, 5.0, 8)
    out, back = np.zeros((8, 8)), np.zeros((6, 8))
    logarithms(B, out)
    exponentials(np.ascontiguousarray(out[:6]), back)
    assert (out[3:6] == 0).all() and (out[0] == out[1]).all() and (out[0] == out[2]).all()
    assert np.allclose(out[0], 0.5 * np.log1p(B[0]), rtol=1e-15) and np.allclose(back, B, rtol=1e-14)
