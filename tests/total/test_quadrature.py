"""Points of shapes for the total frame: weights above zero, inside, exact moments, and a uniform stress that balances its traction to round-off."""

import numpy as np
import pytest

from mpm.diagnostics import nodal
from mpm.scene.quadrature import exponents, knots, points
from mpm.scene.shapes import Ball, Box, Cylinder, Polygon, Ring, cut_quadrature
from mpm.state import PAD, Axisymmetric, Line, Plane, Quadratic, Volume
from mpm.transfer import scatter_scalar

CELL = 0.1
SHAPES = {
    "bar": (Box((0.13,), (0.97,)), False),
    "box": (Box((0.13, 0.2), (0.97, 0.51)), False),
    "turned": (Box((0.2, 0.3), (0.8, 0.6), 0.4), False),
    "disc": (Ball((0.5, 0.5), 0.33), False),
    "ring": (Ring((0.5, 0.5), 0.17, 0.43), False),
    "triangle": (Polygon(((0.1, 0.1), (0.9, 0.25), (0.3, 0.8))), False),
    "sliver": (Box((0.13, 0.15 - 1e-7), (0.97, 0.51)), False),
    "cylinder": (Cylinder(0.37, 0.5, (0.0, 0.12)), True),
    "globe": (Ball((0.0, 0.5), 0.37), True),
    "torus": (Ball((0.5, 0.5), 0.2), True),
    "block": (Box((0.13, 0.2, 0.3), (0.97, 0.51, 0.62)), False),
    "rod": (Cylinder(0.28, 0.4, (0.5, 0.5, 0.22)), False),
    "ball": (Ball((0.5, 0.5, 0.5), 0.28), False),
}


def made(name):
    outline, radial = SHAPES[name]
    lower, upper = (np.array(b, float) for b in outline.bounds())
    if radial:
        lower[0] = max(lower[0], 0.0)
    edges = knots(lower, upper, CELL, "quadratic")
    return outline, radial, edges, points(outline, edges, 2, radial)


@pytest.mark.parametrize("name", SHAPES)
def test_moments(name):
    """Against the exact cut quadrature of high order: volume to 1e-10 and every kept moment; no weight below zero, no point outside."""
    outline, radial, edges, (x, V, _) = made(name)
    if radial and edges[0][0] < 0:
        edges[0] = np.concatenate([[0.0], edges[0][1:]])
    exact, _ = cut_quadrature(outline, edges, 4)
    w = exact.w * exact.x[:, 0] if radial else exact.w
    assert np.all(V > 0) and np.all(outline.distance(x) <= 1e-9)
    loose = 1e-6 if name == "ball" else 1e-9
    assert V.sum() == pytest.approx(w.sum(), rel=loose)
    for power in exponents(len(edges)):
        if power.sum() + radial <= 2 or not radial:
            assert np.sum(V * np.prod(x**power, axis=1)) == pytest.approx(np.sum(w * np.prod(exact.x**power, axis=1)), rel=loose)


def test_a_whole_span_takes_gauss_points():
    _, _, _, (x, V, _) = made("disc")
    middle = np.all(np.abs(x - 0.5) < 0.05, axis=1)
    assert middle.sum() == 4 and V[middle] == pytest.approx(0.25 * CELL**2) and np.abs(x[middle] - 0.5) == pytest.approx(CELL / np.sqrt(12))
    assert len(V) < 2.2 * 4 * np.pi * 3.3**2  # cut spans take up to eight, and there are many here


@pytest.mark.parametrize("name", ["bar", "box", "turned", "disc", "ring", "triangle", "sliver", "block"])
def test_uniform_stress_balances_its_traction(name):
    """sum V grad w = sum A n w on every node: what a patch test asks for."""
    _, _, _, (x, V, surface) = made(name)
    D = x.shape[1]
    counts = [10 + 1 + 2 * PAD] * D
    space = {1: Line, 2: Plane, 3: Volume}[D](CELL, *counts, Quadratic())
    for k in range(D):
        inner, outer = np.zeros((2, np.prod(counts)))
        gradient, none = np.zeros((D, len(V))), np.zeros((D, len(V)))
        gradient[k] = V
        scatter_scalar(space, x, 0, len(V), np.zeros(len(V)), none, gradient, inner)
        nodal(space, surface.x, surface.w * surface.normal[:, k], outer)
        assert np.abs(inner - outer).max() < 1e-9 * CELL ** (D - 1)


def test_axisymmetric_uniform_pressure(name="cylinder"):
    """The same round an axis, where the hoop takes part: sum V (d_r w + w/R) = sum A n_r w."""
    _, _, _, (x, V, surface) = made(name)
    counts = [15, 15]
    space = Axisymmetric(CELL, *counts, Quadratic())
    inner, outer = np.zeros((2, 225))
    none, gradient = np.zeros((2, len(V))), np.zeros((2, len(V)))
    gradient[0] = V
    scatter_scalar(space, x, 0, len(V), V / x[:, 0], none, gradient, inner)
    nodal(space, surface.x, surface.w * surface.normal[:, 0], outer)

    def odd(nodes):  # near the axis the mirror takes its part: a radial displacement is odd there
        table = nodes.reshape(counts)
        return table[PAD + 1 :] - np.concatenate([table[PAD - 1 :: -1], np.zeros((len(table) - 2 * PAD - 1, counts[1]))])

    assert np.abs(odd(inner) - odd(outer)).max() < 1e-11
