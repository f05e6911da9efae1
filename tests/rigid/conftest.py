"""Exact series for Robin exchange (radius or half-thickness 1, all coefficients 1, start 1, outside 0), independent of mpm."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import j0, j1, jn_zeros

TERMS = 80


def roots(f, brackets):
    return np.array([brentq(f, a, b, xtol=1e-15) for a, b in brackets])


def slab(x, t, bi):
    """sum C exp(-z^2 t) cos(z x), z tan z = Bi, C = 4 sin z/(2 z + sin 2 z)."""
    starts = np.pi * np.arange(TERMS)
    z = starts + np.pi / 2 if np.isinf(bi) else roots(lambda z: z * np.sin(z) - bi * np.cos(z), zip(starts + 1e-12, starts + np.pi / 2, strict=True))
    return (4 * np.sin(z) / (2 * z + np.sin(2 * z)) * np.exp(-z * z * t)) @ np.cos(np.multiply.outer(z, x))


def cylinder(r, t, bi):
    """sum C exp(-z^2 t) J0(z r), z J1(z) = Bi J0(z), C = 2 J1/[z (J0^2 + J1^2)]."""
    ends = jn_zeros(0, TERMS)
    z = ends if np.isinf(bi) else roots(lambda z: z * j1(z) - bi * j0(z), zip(np.concatenate([[1e-9], jn_zeros(1, TERMS - 1)]), ends, strict=True))
    return (2 * j1(z) / (z * (j0(z) ** 2 + j1(z) ** 2)) * np.exp(-z * z * t)) @ j0(np.multiply.outer(z, r))


def sphere(r, t, bi):
    """sum C exp(-z^2 t) sin(z r)/(z r), 1 - z cot z = Bi, C = 4 (sin z - z cos z)/(2 z - sin 2 z)."""
    starts = np.pi * np.arange(TERMS)
    z = starts + np.pi if np.isinf(bi) else roots(lambda z: z * np.cos(z) - (1 - bi) * np.sin(z), zip(starts + 1e-9, starts + np.pi - 1e-9, strict=True))
    return (4 * (np.sin(z) - z * np.cos(z)) / (2 * z - np.sin(2 * z)) * np.exp(-z * z * t)) @ np.sinc(np.multiply.outer(z, r) / np.pi)


def rms(run, exact, radius):
    """Root-mean-square error over the body, `radius(x)` giving the series' coordinate."""
    x, w = run.points()
    error = run.sample(x, 0) - exact(radius(x))
    return float(np.sqrt((w * error**2).sum() / w.sum()))


def order(errors, ratio=2.0):
    """Fitted order of errors at cells that shrink by `ratio`."""
    return float(-np.polyfit(np.arange(len(errors)) * np.log(ratio), np.log(errors), 1)[0])


@pytest.fixture(scope="session")
def series():
    return SimpleNamespace(slab=slab, cylinder=cylinder, sphere=sphere, rms=rms, order=order)
