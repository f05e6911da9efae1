"""Quadratic B-splines: what every transfer leans on."""

import numpy as np
import pytest

from mpm.basis.quadratic import SECOND_MOMENT, slopes, weights

F = np.concatenate([np.linspace(-0.5, 0.5, 41), [1e-17, -1e-300]])
NODES = np.array([-1.0, 0.0, 1.0])  # offsets of the three nodes are NODES - f


def test_partition_of_unity_and_linear_reproduction():
    for f in F:
        w, g = np.array(weights(f)), np.array(slopes(f))
        assert abs(w.sum() - 1) < 1e-15 and abs(w @ (NODES - f)) < 1e-15
        assert abs(g.sum()) < 1e-15 and abs(g @ NODES - 1) < 1e-15


def test_weights_are_not_negative():
    assert min(min(weights(f)) for f in F) >= 0


def test_second_moment_is_a_constant():
    for f in F:
        assert np.array(weights(f)) @ (NODES - f) ** 2 == pytest.approx(SECOND_MOMENT, abs=1e-15)


def test_slopes_are_the_derivatives():
    step = 1e-6
    for f in F[1:40]:
        numeric = (np.array(weights(f + step)) - np.array(weights(f - step))) / (2 * step)
        assert np.allclose(slopes(f), numeric, atol=1e-9)


def test_smooth_where_the_nearest_node_changes():
    """f = 1/2 of node r is f = -1/2 of node r + 1: the shared nodes keep weight and slope, the others have none."""
    for shape in (weights, slopes):
        left, right = shape(0.5), shape(-0.5)
        assert left[1:] == right[:2] and left[0] == right[2] == 0.0
