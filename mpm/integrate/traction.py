"""Tractions and drag on a body: forces beside the stress, taken from the config's `loads`.

f_i += share(t) sum_p (f_p w_ip + D_p F_p^T grad w_ip),  f_p and D_p of each particle from mpm.scene.faded: on flat and round faces the stress that the
traction asks for, faded out inside, else the force at its pieces of surface and its moment. A nominal T is force by reference area and keeps its direction.
Tractions by present area (Present) add, with G = J F^-T of the particle and N the reference normal of its pieces of surface,
    pressure  (G - 1) f_p, (G - 1) D_p        cauchy  (|G N| - 1) f_p, (|G N| - 1) D_p
by the forces f_p at these, or, of a pressure around which no free surface lies, by those of the faded stress: particles then bear it at any strain.
drag  f_p = -rate m_p v_p;   share(t) = s^2 (3 - 2 s), s = t/ramp up to 1: without a kick at either end. Of a load within a time, from its beginning on
and nothing after its end: the impulse at a jump, part of which acts before it, takes that part of the share before (momentum is exact)
A static answer is the end of a ramp of several periods of the slowest mode omega, with a drag rate of about 2 omega.
Good values  displacement of a pulled bar to 1e-4 with 16 cells, its strain to 0.3 % (tests/integrate/test_traction.py).
Fails when   the face is neither flat nor all of a round one, or a load on a flat one beside free faces grows with its area: then the quadrature of a cell that
             is cut balances that as a whole, not point by point, and the stress of particles in the last cell is off by as much. The run warns (`traction`).
A body without loads compiles none of this.
"""

import math
from typing import NamedTuple

import numpy as np

from mpm.heat.programmes import SAME
from mpm.integrate.body_force import act
from mpm.integrate.deformation import carry_one, cofactor
from mpm.integrate.strain import WORKED
from mpm.jit import kernel, role
from mpm.state import PER_PARTICLE, Load, Ramp, Within

BORNE, GROWS, ROUGH = 0.0, 1.0, 2.0  # of a load, at pieces of surface: nothing; what a change of area adds; some of it, or all (mpm.scene.faded)


class Nominal(NamedTuple):
    """Tractions by reference area: forces stay as they are at the start."""


class Present(NamedTuple):
    """Tractions by present area (integrate/traction.py): what forces and moments are at the start, those that turn with the surface, those that do not."""

    still: np.ndarray  # (N, D) force of all loads [N]
    moment: np.ndarray  # (N, D, D) its moment [N m]
    press: np.ndarray  # (N, D) force at pieces of surface, of pressures [N]
    press_moment: np.ndarray  # (N, D, D)
    pull: np.ndarray  # (N, D) of Cauchy tractions [N]
    pull_moment: np.ndarray  # (N, D, D)
    normal: np.ndarray  # (N, D) unit normal of the pieces that are pulled, a mean; 0 without
    hoop: np.ndarray  # (N,) radial force of a pressure on the hoop, which grows with the area across it [N]; 0 unless axisymmetric


PER_PARTICLE[Present] = Present._fields


@kernel(inline=True)
def risen(t, ramp):
    """s^2 (3 - 2 s), s = t/ramp up to 1."""
    if t >= ramp:
        return 1.0
    s = t / ramp
    return s * s * (3.0 - 2.0 * s)


@role(inline=True)
def share(ramp, t, past):
    """Part of the full load at time t, of which `past` as just before it."""
    raise TypeError(f"no course of a load {type(ramp).__name__}")


@share.register(Ramp)
def share_ramp(ramp, t, past):
    return risen(t, ramp.time)


@share.register(Within)
def share_within(ramp, t, past):
    return within(ramp, t, past) * risen(max(t - ramp.begin, 0.0), ramp.time)


@role(inline=True)
def within(ramp, t, past):
    """1 while a load lasts, else 0; at time t, `past` of it as just before."""
    raise TypeError(f"no course of a load {type(ramp).__name__}")


@within.register(Ramp)
def within_ramp(ramp, t, past):
    return 1.0


@within.register(Within)
def within_within(ramp, t, past):
    first = 1.0 if ramp.begin * (1.0 + SAME) < t <= ramp.end * (1.0 + SAME) else 0.0
    then = 1.0 if ramp.begin * (1.0 - SAME) <= t < ramp.end * (1.0 - SAME) else 0.0
    return past * first + (1.0 - past) * then


@role(inline=True)
def opening(ramp):
    """How much of the first impulse of a block of steps acts before the block."""
    raise TypeError(f"no course of a load {type(ramp).__name__}")


@opening.register(Ramp)
def opening_ramp(ramp):
    return 0.0


@opening.register(Within)
def opening_within(ramp):
    return ramp.past[0]


@role(inline=True)
def turn(area, load, i, J, D):
    """Force and moment of particle i by what its surface is now; J: its change of volume."""
    raise TypeError(f"no tractions by {type(area).__name__}")


@turn.register(Nominal)
def turn_nominal(area, load, i, J, D):
    return None


@turn.register(Present)
def turn_present(area, load, i, J, D):
    volume, square = 0.0, 0.0
    for k in range(D):
        volume += load.F[i, 0, k] * cofactor(load.F, i, 0, k, D)
    out = J / volume  # what widens out of the plane, as the hoop does
    for c in range(D):
        normal = 0.0
        for k in range(D):
            normal += out * cofactor(load.F, i, c, k, D) * area.normal[i, k]
        square += normal * normal
    more = math.sqrt(square) - 1.0
    for c in range(D):
        load.force[i, c] = area.still[i, c] - area.press[i, c] + more * area.pull[i, c]
        for d in range(D):
            load.dipole[i, c, d] = area.moment[i, c, d] - area.press_moment[i, c, d] + more * area.pull_moment[i, c, d]
        for k in range(D):
            G = out * cofactor(load.F, i, c, k, D)
            load.force[i, c] += G * area.press[i, k]
            for d in range(D):
                load.dipole[i, c, d] += G * area.press_moment[i, k, d]
    load.force[i, 0] += (volume - 1.0) * area.hoop[i]


@kernel
def turn_all(load, J, D):
    """Of every particle that is loaded."""
    for i in range(J.shape[0]):
        if load.loaded[i]:
            turn(load.area, load, i, J[i], D)


@kernel(inline=True)
def power(source, m, i, chunk, p, D):
    """What loads work on particle i in the step that is over [W]: at the velocity and the gradient that it gathered."""
    total, now, rate = 0.0, share(source.ramp, source.t[i], 0.0), source.rate * within(source.ramp, source.t[i], 0.0)
    for c in range(D):
        total -= rate * m * chunk.v[c, p] * chunk.v[c, p]
        if source.loaded[i]:
            total += now * source.force[i, c] * chunk.v[c, p]
            for d in range(D):
                for k in range(D):
                    total += now * source.dipole[i, c, k] * source.F[i, d, k] * chunk.L[c, d, p]
    return total


@act.register(Load)
def act_load(source, body, chunk, first, count, dt, next_dt, report):
    particles = body.particles
    D = particles.v.shape[1]
    for p in range(count):
        i = first + p
        if dt > 0.0:
            report[WORKED] += dt * power(source, particles.m[i], i, chunk, p, D)
            source.t[i] += dt
        past = opening(source.ramp) if dt == 0.0 else 0.0
        drag = next_dt * source.rate * within(source.ramp, source.t[i], past) * particles.m[i]
        for c in range(D):
            chunk.f[c, p] -= drag * chunk.u[c, p]
        if not source.loaded[i]:
            continue
        if dt > 0.0:
            carry_one(source.F, chunk.L, i, p, dt, D)
            turn(source.area, source, i, particles.J[i], D)
        now = next_dt * share(source.ramp, source.t[i], past)
        for c in range(D):
            chunk.f[c, p] += now * source.force[i, c]
            for d in range(D):
                moment = 0.0
                for k in range(D):
                    moment += source.dipole[i, c, k] * source.F[i, d, k]
                chunk.S[c, d, p] += now * source.scale * moment
