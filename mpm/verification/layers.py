"""Layers in contact, slabs or coaxial cylinders, each of its own material and temperature at the start (Carslaw & Jaeger 1959, 2.14 and 14.6).

theta = out + sum_n A_n exp(-z_n^2 t) phi_n,   (kappa r^m phi')' = -z^2 rho alpha r^m phi in every layer,   m = 0 slabs, 1 cylinders,
kappa phi' the same on both sides of a contact, phi_- - phi_+ = -kappa phi'/H there; -kappa phi' = beta phi outside;
A_n = int rho alpha r^m (start - out) phi_n/int rho alpha r^m phi_n^2. The roots are changes of sign of the outer condition; that none is missing is seen from
sum A_n^2 int rho alpha r^m phi_n^2, which tends to int rho alpha r^m (start - out)^2.
Order   3 in the cell where layers are some cells thick (declared 1.8)
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from mpm.verification.setup import constants, moved

ORDER = 1.8
TERMS, POINTS, SCAN, SHARE = 240, 600, 60, 0.02  # roots and Gauss points a layer, tries a root, share of the sum of squares that may lie in higher roots


class Layer(NamedTuple):
    """From a to b [m], with what conducts across its outer end [W/(m2 K)]."""

    a: float
    b: float
    kappa: float
    capacity: float  # rho alpha [J/(m3 K)]
    start: float  # [K]
    beyond: float  # H at b, inf where perfect; of the last layer beta


class Layers:
    """theta(r (P,), t). inner: beta at the first layer's inner end, 0 where it is insulated or the axis; cylinders: round the axis."""

    def __init__(self, layers: list[Layer], inner: float, out: float, cylinders: bool):
        self.layers, self.inner, self.out, self.cylinders = layers, inner, out, cylinders
        travel = sum((one.b - one.a) * math.sqrt(one.capacity / one.kappa) for one in layers)
        z = np.concatenate([[1e-6], np.linspace(1e-2, TERMS * math.pi, SCAN * TERMS)]) / travel
        sign = np.sign(self.beyond(z))
        k = np.flatnonzero(sign[:-1] * sign[1:] < 0)
        low, high, side = z[k], z[k + 1], sign[k]
        for _ in range(60):
            middle = 0.5 * (low + high)
            same = np.sign(self.beyond(middle)) == side
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        self.roots, self.still = 0.5 * (low + high), 0.0
        self.weights = [gauss_over(one, cylinders) for one in layers]
        modes = [self.modes(self.roots, k, r) for k, (r, _) in enumerate(self.weights)]  # (N, P) a layer
        norm, part, whole, capacity = np.zeros(len(self.roots)), np.zeros(len(self.roots)), 0.0, 0.0
        for one, (_, w), phi in zip(layers, self.weights, modes, strict=True):
            norm, part = norm + phi**2 @ w, part + (one.start - out) * (phi @ w)
            whole, capacity, self.still = whole + (one.start - out) ** 2 * w.sum(), capacity + w.sum(), self.still + (one.start - out) * w.sum()
        self.still = self.still / capacity if inner == 0.0 and layers[-1].beyond == 0.0 else 0.0  # insulated: the mean stays
        self.amplitudes = part / norm
        told = float(self.amplitudes**2 @ norm) + self.still**2 * capacity
        if not (1 - SHARE) * whole <= told <= (1 + 1e-6) * whole:
            raise ValueError(f"layers: the series holds {told / whole:.4g} of the start's sum of squares: roots are missing")

    def across(self, z, layer: Layer, value, flow, r):
        """phi and kappa r^m phi' (N, P) at r (P,) from those at the layer's inner end (N,)."""
        mu, value, flow = z[:, None] * math.sqrt(layer.capacity / layer.kappa), value[:, None], flow[:, None]
        if not self.cylinders:
            c, s, size = np.cos(mu * (r - layer.a)), np.sin(mu * (r - layer.a)), layer.kappa * mu
            return value * c + flow / size * s, flow * c - size * value * s
        from scipy.special import j0, j1, y0, y1

        if layer.a == 0.0:
            return value * j0(mu * r), -value * layer.kappa * r * mu * j1(mu * r)
        a, slope = mu * layer.a, flow / (layer.kappa * layer.a * mu)
        one, two = -0.5 * np.pi * a * (value * y1(a) + slope * y0(a)), 0.5 * np.pi * a * (slope * j0(a) + value * j1(a))
        return one * j0(mu * r) + two * y0(mu * r), -layer.kappa * r * mu * (one * j1(mu * r) + two * y1(mu * r))

    def begin(self, z, upto: int):
        """phi and kappa r^m phi' (N,) at the inner end of a layer."""
        turn = self.layers[0].a if self.cylinders else 1.0
        value, flow = np.ones_like(z), np.full_like(z, 0.0 if self.inner == 0.0 else self.inner * turn)
        if math.isinf(self.inner):
            value, flow = np.zeros_like(z), np.ones_like(z)
        for one in self.layers[:upto]:
            value, flow = (found[:, 0] for found in self.across(z, one, value, flow, np.array([one.b])))
            value = value + flow / (one.beyond * (one.b if self.cylinders else 1.0))
        return value, flow

    def modes(self, z, layer: int, r):
        """phi (N, P) in a layer."""
        return self.across(z, self.layers[layer], *self.begin(z, layer), r)[0]

    def beyond(self, z):
        """What the outer condition leaves (N,)."""
        last = self.layers[-1]
        value, flow = (found[:, 0] for found in self.across(z, last, *self.begin(z, len(self.layers) - 1), np.array([last.b])))
        return value if math.isinf(last.beyond) else flow + last.beyond * (last.b if self.cylinders else 1.0) * value

    def __call__(self, r: np.ndarray, t: float) -> np.ndarray:
        found = np.full(len(r), np.nan)
        for k, one in enumerate(self.layers):
            here = (r >= one.a - 1e-9 * one.b) & ((r < one.b) | (k == len(self.layers) - 1))
            if t <= 0:
                found[here] = one.start
                continue
            fade = self.amplitudes * np.exp(-(self.roots**2) * t)
            seen = np.abs(fade) > 1e-18 * np.abs(self.amplitudes).max()
            found[here] = self.out + self.still + fade[seen] @ self.modes(self.roots[seen], k, r[here])
        return found


def gauss_over(layer: Layer, cylinders: bool) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points of a layer and their weights times rho alpha r^m."""
    x, w = np.polynomial.legendre.leggauss(POINTS)
    r = layer.a + 0.5 * (layer.b - layer.a) * (x + 1)
    return r, 0.5 * (layer.b - layer.a) * w * layer.capacity * (r if cylinders else 1.0)


def extent(experiment, body) -> tuple[float, float, np.ndarray]:
    """(inner end, outer end, centre) of a box in 1-D, a disc or ring in 2-D, a cylinder or box round the axis."""
    kind, dimension, shape = type(body.shape).kind, experiment.grid.dimension, body.shape
    if kind == "box" and dimension == 1:
        return *(float(moved(experiment, end)[0]) for end in (shape.lower, shape.upper)), np.zeros(0)
    if kind == "ball" and dimension == 2:
        return 0.0, shape.radius, moved(experiment, shape.centre)
    if kind == "ring" and dimension == 2:
        return shape.inner, shape.outer, moved(experiment, shape.centre)
    if kind in ("cylinder", "box") and dimension == "axisymmetric" and experiment.method.offset[0] == 0:
        return (0.0, shape.radius, np.zeros(1)) if kind == "cylinder" else (shape.lower[0], shape.upper[0], np.zeros(1))
    raise ValueError("layers needs boxes in 1-D, a disc and rings in 2-D, or a cylinder and boxes round the axis of an axisymmetric scene")


def robin(experiment, name: str, side: str) -> tuple[float, float | None]:
    """beta and the temperature outside on a side of a body; 0 and None where nothing acts there."""
    sides = {"left": ("left", "all"), "right": ("right", "all"), "lateral": ("lateral", "all")}[side]
    entries = [entry for entry in experiment.surfaces if entry.of == name and entry.side in sides]
    if len(entries) > 1 or any(entry.flux is not None or entry.radiation is not None for entry in entries):
        raise ValueError("layers needs convection or a fixed temperature outside, once a side")
    if not entries:
        return 0.0, None
    beta, out = (entries[0].convection.beta, entries[0].convection.outside) if entries[0].fixed is None else (math.inf, entries[0].fixed.temperature)
    if not isinstance(beta, float) or not isinstance(out, float):
        raise ValueError("layers needs a beta and a temperature outside that do not change over time")
    return beta, out


def exact(experiment):
    """theta(x, t) of the config's scene."""
    found = sorted(((*extent(experiment, body), name, body) for name, body in experiment.bodies.items()), key=lambda one: one[0])
    size, line = found[-1][1], experiment.grid.dimension == 1
    if any(abs(one[1] - two[0]) > 1e-9 * size or not np.allclose(one[2], two[2]) for one, two in pairwise(found)):
        raise ValueError("layers needs bodies that touch, one beside or round the other")
    pairs = {frozenset(pair.between): pair.conductance for pair in experiment.contacts}
    ends = [robin(experiment, found[0][3], "left") if line else (0.0, None), robin(experiment, found[-1][3], "right" if line else "lateral")]
    outs = {out for _, out in ends if out is not None}
    if len(outs) > 1 or (not line and found[0][0] != 0.0):
        raise ValueError("layers needs one temperature outside, and cylinders from the axis on")
    layers = []
    for k, (a, b, _, name, body) in enumerate(found):
        kappa, diffusivity = constants(experiment, body)
        given = pairs.get(frozenset((name, found[k + 1][3]))) if k + 1 < len(found) else ends[1][0]
        layers.append(Layer(a, b, kappa, kappa / diffusivity, body.temperature, math.inf if given is None else given))
    theta, centre = Layers(layers, ends[0][0], outs.pop() if outs else 0.0, not line), found[0][2]
    return lambda x, t: theta(x[:, 0] if line else np.linalg.norm(x[:, : len(centre)] - centre, axis=1), t)
