"""Heat of a body in the total frame: temperatures live on the nodes, with the weights of the reference shape.

    C_i dT_i/dt = -sum_p V0 (K grad_X T) . grad_X w_i + sum_s a_s (q + beta (outside - T_s)) w_i(x_s),     K = kappa J F^-1 F^-T,   a = J |F^-T A| (Nanson)
    C_i = sum alpha m w_i,   theta_p = sum w_i T_i;   what heats particles between heat steps (adiabats, dissipation) goes to the nodes first, heat kept
Surface points are those of the exact quadrature of the reference surface. A wall that the body lies on mirrors temperature too (insulated) unless something is
exchanged through that side: then it is a free surface for heat.
Time       L-stable, order 2, two implicit stages (Alexander 1977), conjugate gradients to `tolerance` of the step's change; kappa and radiation's secant as
           they are before each stage. Any beta, any step.
Errors     order 2 in the cell; nothing is transferred, so nothing damps, however short heat steps are
Fails when alpha follows temperature (refused by the config)
"""

import math
from typing import NamedTuple

import numpy as np

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.heat.exchange import meet
from mpm.integrate.stress_hencky import warms
from mpm.jit import kernel
from mpm.materials.laws import value
from mpm.sources import Given
from mpm.total.reference import gradients_at
from mpm.transfer import CHUNK, gather_scalar, scatter_scalar

GAMMA = 1.0 - math.sqrt(0.5)
MOST_ITERATIONS = 1000  # iterations


class NoWarmth(NamedTuple):
    """No heat."""


class Warmth(NamedTuple):
    """Nodal heat of one body. Temperatures less the `zero` of mpm.state.Thermal."""

    T: np.ndarray  # (n,) [K]
    C: np.ndarray  # (n,) capacity, those of ghosts on their images [J/K]
    touched: np.ndarray
    active: np.ndarray
    ghost: np.ndarray  # (G,) T of a ghost is that of its image
    image: np.ndarray  # (G,)
    x: np.ndarray  # (S, D) points of the reference surface that exchange [m]
    area: np.ndarray  # (S, D) reference area times outward normal
    now: np.ndarray  # (S,) present area


def warm(space, body, reference, dt: float, tolerance: float) -> tuple[float, int]:
    """One heat step of dt: (heat gained [J], iterations; -1 where they do not converge)."""
    warmth, particles, D = reference.warmth, body.particles, directions(space)
    H, _ = gradients_at(space, reference, reference.X)
    inverse = np.linalg.inv(np.eye(D) + H)
    V = particles.J.astype(float) * particles.V0.astype(float) * conductivities(body.thermal)
    K = np.ascontiguousarray(V[:, None, None] * (inverse @ inverse.transpose(0, 2, 1)))
    present_areas(space, reference)
    X = reference.X.astype(float)
    if warms(body.heating) or isinstance(body.source, Given):
        take_up(space, X, particles.m.astype(float), body.thermal, warmth)
    gained, count = conduct(space, body.surface, body.thermal, X, K, warmth, dt, tolerance)
    slope = np.empty((len(X), D))
    to_particles(space, X, body.thermal, warmth, slope)
    body.thermal.c[:] = np.einsum("pji,pj->pi", inverse, slope)
    return gained, count


def present_areas(space, reference) -> None:
    """Present areas of the surface points, by Nanson; the hoop's share where there is one."""
    warmth, D = reference.warmth, directions(space)
    if not len(warmth.x):
        return
    H, hoop = gradients_at(space, reference, warmth.x)
    F = np.eye(D) + H
    turned = np.einsum("sji,sj->si", np.linalg.inv(F), warmth.area)
    warmth.now[:] = np.linalg.det(F) * (1.0 + hoop) * np.linalg.norm(turned, axis=1)


@kernel
def conductivities(thermal):
    """kappa of every particle (N,)."""
    out = np.empty(thermal.theta.shape[0])
    for i in range(out.shape[0]):
        out[i] = value(thermal.kappa, thermal.zero + thermal.theta[i])
    return out


@kernel
def mirror_heat(T, warmth):
    for k in range(len(warmth.ghost) - 1, -1, -1):
        T[warmth.ghost[k]] = T[warmth.image[k]]


@kernel
def fold_heat(heat, warmth):
    for k in range(len(warmth.ghost)):
        heat[warmth.image[k]] += heat[warmth.ghost[k]]


@kernel
def begin_heat(space, X, m, thermal, warmth):
    """Capacities are there; nodal temperatures from those of the particles and their slopes."""
    D, T = directions(space), warmth.T
    a, A, G = np.zeros(CHUNK), np.zeros((D, CHUNK)), np.zeros((D, CHUNK))
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        for p in range(count):
            capacity = m[first + p] * value(thermal.alpha, thermal.zero + thermal.theta[first + p])
            a[p] = capacity * thermal.theta[first + p]
            for k in range(D):
                A[k, p] = capacity * thermal.c[first + p, k]
        scatter_scalar(space, X, first, count, a, A, G, T)
    fold_heat(T, warmth)
    for n in warmth.active:
        T[n] /= warmth.C[n]
    mirror_heat(T, warmth)


@kernel
def take_up(space, X, m, thermal, warmth):
    """What particles have more than their nodes say, to the nodes."""
    D, rise = directions(space), np.zeros(warmth.T.shape[0])
    a, slope, grad = np.zeros(CHUNK), np.zeros((D, CHUNK)), np.zeros((D, CHUNK))
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        gather_scalar(space, X, first, count, warmth.T, a, slope, grad)
        for p in range(count):
            i = first + p
            a[p] = m[i] * value(thermal.alpha, thermal.zero + thermal.theta[i]) * (thermal.theta[i] - a[p])
            for k in range(D):
                slope[k, p] = grad[k, p] = 0.0
        scatter_scalar(space, X, first, count, a, slope, grad, rise)
    fold_heat(rise, warmth)
    for n in warmth.active:
        warmth.T[n] += rise[n] / warmth.C[n]
    mirror_heat(warmth.T, warmth)


@kernel
def to_particles(space, X, thermal, warmth, slopes):
    """theta of the particles, and grad_X T to slopes (N, D)."""
    D = directions(space)
    a, slope, grad = np.zeros(CHUNK), np.zeros((D, CHUNK)), np.zeros((D, CHUNK))
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        gather_scalar(space, X, first, count, warmth.T, a, slope, grad)
        for p in range(count):
            thermal.theta[first + p] = a[p]
            for k in range(D):
                slopes[first + p, k] = grad[k, p]


@kernel
def conduct(space, surface, thermal, X, K, warmth, dt, tolerance):
    """Two implicit stages of dt: (heat gained [J], iterations or -1)."""
    n, S, T = warmth.T.shape[0], warmth.x.shape[0], warmth.T
    start, base, met = T.copy(), T.copy(), np.zeros((3, S))
    work = np.zeros((1 + 3 * directions(space), CHUNK))
    r, z, p, q, weight = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    gained, iterations = 0.0, 0
    for stage in range(2):
        part, share = (GAMMA, 1.0 - GAMMA) if stage == 0 else (1.0, GAMMA)
        at_surface(space, warmth, T, z, work)
        for s in range(S):
            met[0, s], met[1, s], met[2, s] = meet(surface, s, z[s], thermal.zero, part)
        count = solve(space, X, K, warmth, met, GAMMA * dt, base, tolerance, (r, z, p, q, weight), work)
        if count < 0:
            T[:] = start
            return 0.0, -1
        iterations += count
        at_surface(space, warmth, base, z, work)
        for s in range(S):
            gained += share * dt * warmth.now[s] * (met[2, s] + met[0, s] * (met[1, s] - z[s]))
        for i in warmth.active:
            T[i] = base[i]
            if stage == 0:
                base[i] = start[i] + (1.0 - GAMMA) / GAMMA * (base[i] - start[i])
        mirror_heat(T, warmth)
        mirror_heat(base, warmth)
    return gained, iterations


@kernel
def at_surface(space, warmth, T, out, work):
    """T at the surface points, to out[:S]."""
    D, S = directions(space), warmth.x.shape[0]
    a, slope, grad = work[0], work[1 : 1 + D], work[1 + D : 1 + 2 * D]
    for first in range(0, S, CHUNK):
        count = min(CHUNK, S - first)
        gather_scalar(space, warmth.x, first, count, T, a, slope, grad)
        for s in range(count):
            out[first + s] = a[s]


@kernel
def flow_in(space, X, K, warmth, met, T, dt, sources, out, work):
    """out = dt f(T); sources 0 leaves outside and q away: the linear part."""
    D = directions(space)
    a, slope, grad, none = work[0], work[1 : 1 + D], work[1 + D : 1 + 2 * D], work[1 + 2 * D : 1 + 3 * D]
    for i in warmth.touched:
        out[i] = 0.0
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        gather_scalar(space, X, first, count, T, a, slope, grad)
        for p in range(count):
            a[p] = 0.0
            for k in range(D):
                none[k, p] = 0.0
                slope[k, p] = 0.0
                for m in range(D):
                    slope[k, p] -= dt * K[first + p, k, m] * grad[m, p]
        scatter_scalar(space, X, first, count, a, none, slope, out)
    for first in range(0, warmth.x.shape[0], CHUNK):
        count = min(CHUNK, warmth.x.shape[0] - first)
        gather_scalar(space, warmth.x, first, count, T, a, slope, grad)
        for p in range(count):
            s = first + p
            a[p] = dt * warmth.now[s] * (sources * (met[2, s] + met[0, s] * met[1, s]) - met[0, s] * a[p])
            for k in range(D):
                slope[k, p] = grad[k, p] = 0.0
        scatter_scalar(space, warmth.x, first, count, a, slope, grad, out)
    fold_heat(out, warmth)


@kernel
def conducted(space, X, K, dt, weight):
    """weight += dt sum_p grad w_i . K grad w_i of every node: without it steps that are long for a cell close in slowly."""
    h, D, shape, g = space.h, directions(space), extents(space), np.zeros(3)
    for p in range(X.shape[0]):
        one, two = stencil(space.basis, X[p, 0] / h), stencil(space.basis, X[p, min(1, D - 1)] / h)
        three = stencil(space.basis, X[p, D - 1] / h)
        for i in range(len(one[1])):
            for j in range(len(two[1]) if D > 1 else 1):
                for q in range(len(three[1]) if D > 2 else 1):
                    wj, wq = two[1][j] if D > 1 else 1.0, three[1][q] if D > 2 else 1.0
                    g[0] = one[2][i] * wj * wq / h
                    g[1] = one[1][i] * two[2][j] * wq / h if D > 1 else 0.0
                    g[2] = one[1][i] * wj * three[2][q] / h if D > 2 else 0.0
                    n = one[0] + i
                    if D > 1:
                        n = n * shape[1] + two[0] + j
                    if D > 2:
                        n = n * shape[2] + three[0] + q
                    for a in range(D):
                        for b in range(D):
                            weight[n] += dt * K[p, a, b] * g[a] * g[b]


@kernel
def solve(space, X, K, warmth, met, dt, T, tolerance, vectors, work):
    """T <- the T with C (T - T_before) = dt f(T), by conjugate gradients on the change; iterations, or -1. vectors: scratch."""
    r, z, p, q, weight = vectors
    D, active = directions(space), warmth.active
    a, slope, grad = work[0], work[1 : 1 + D], work[1 + D : 1 + 2 * D]
    for i in warmth.touched:
        weight[i] = 0.0
    for first in range(0, warmth.x.shape[0], CHUNK):  # the scale of each row: its capacity, what its surface passes and what it conducts
        count = min(CHUNK, warmth.x.shape[0] - first)
        for s in range(count):
            a[s] = dt * warmth.now[first + s] * met[0, first + s]
            for k in range(D):
                slope[k, s] = grad[k, s] = 0.0
        scatter_scalar(space, warmth.x, first, count, a, slope, grad, weight)
    conducted(space, X, K, dt, weight)
    fold_heat(weight, warmth)
    flow_in(space, X, K, warmth, met, T, dt, 1.0, r, work)
    change, size, first_size = np.zeros(T.shape[0]), 0.0, 0.0
    for i in active:
        weight[i] = 1.0 / (weight[i] + warmth.C[i])
        p[i] = weight[i] * r[i]
        size += p[i] * r[i]
    first_size = size
    for count in range(MOST_ITERATIONS):
        if not size > tolerance * tolerance * first_size:
            for i in active:
                T[i] += change[i]
            mirror_heat(T, warmth)
            return count if size == size else -1
        mirror_heat(p, warmth)
        flow_in(space, X, K, warmth, met, p, dt, 0.0, q, work)
        along = 0.0
        for i in active:
            q[i] = warmth.C[i] * p[i] - q[i]
            along += p[i] * q[i]
        step, before, size = size / along, size, 0.0
        for i in active:
            change[i] += step * p[i]
            r[i] -= step * q[i]
            z[i] = weight[i] * r[i]
            size += z[i] * r[i]
        for i in active:
            p[i] = z[i] + size / before * p[i]
    return -1
