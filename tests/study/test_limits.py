"""The operations of a step against a loop over nodes that counts its own, and the limits against each other."""

import itertools

import numpy as np
import pytest

from mpm.state import Cubic, Linear, Quadratic
from mpm.study.bench import Options, cube
from mpm.study.limits import LAW, gflops, operations
from mpm.transfer import Bspline
from mpm.transfer.flip import Flip


class Number:
    """Counts what it adds and multiplies."""

    count = 0

    def __add__(self, other):
        Number.count += 1
        return self

    __radd__ = __mul__ = __rmul__ = __add__


def transferred(nodes: int, D: int, slopes: bool, change: bool) -> int:
    """Operations of one particle, written as a plain loop writes them."""
    x, Number.count = Number(), 0
    for _ in itertools.product(range(nodes), repeat=D):
        w, grad = x, [x] * D
        for _ in range(D - 1):
            w = w * x
        if slopes:
            for k in range(D):
                for _ in range(D - 1):
                    grad[k] = grad[k] * x
        for _ in range(D):  # gather: value, slope, gradient
            share = w * x
            x + share
            for k in range(D):
                x + share * x
                if slopes:
                    x + x * grad[k]
            if change:
                x + w * x
        x + w * x  # scatter: mass, value with slope, tensor on the gradient
        for _ in range(D):
            total = x
            for _ in range(D):
                total = total + x * x
            x + w * total
            if slopes:
                for k in range(D):
                    x + x * grad[k]
            if change:
                x + w * x
    return Number.count


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(("basis", "nodes"), [(Linear(), 2), (Quadratic(), 3), (Cubic(), 4)])
@pytest.mark.parametrize("slopes", [False, True])
@pytest.mark.parametrize("change", [False, True])
def test_operations_are_those_of_a_plain_loop(dim, basis, nodes, slopes, change):
    scene = cube(Options(n=16, particles=16, dim=dim))
    scene.space = scene.space._replace(basis=basis)
    scene.gradient, scene.scheme = Bspline() if slopes else scene.gradient, Flip(0.0, 0.0) if change else scene.scheme
    assert operations(scene) == transferred(nodes, dim, slopes, change) + 10 * dim + LAW[dim]


def test_the_cube_of_the_peers():
    assert [operations(cube(Options(n=16, particles=16, dim=dim))) for dim in (2, 3)] == [312, 1565]


def test_multiply_adds():
    """A core does between a half and a few hundred thousand million a second; single precision is no slower."""
    single, double = gflops(np.float32), gflops(np.float64)
    assert 0.01 < double < 1000 and single > 0.7 * double
