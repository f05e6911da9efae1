"""What acts on a body in the total frame beside its stress, and what averages its changes of volume: roles by the body's own objects.

push     a source (mpm.sources, or what the config gives): force m b(X, t) on w, heat r(X, t) to the particle           NoSource: nothing
press    tractions by present area, at points of the reference surface, N dA outward: sum w (T |G N| - p G N) dA, G = J F^-T (Nanson); their work is that of the
         mean of the forces before and after the motion                                                                    Still: nothing
average  F-bar (de Souza Neto et al. 1996, with the nodal averages of Zhao, Jiang & Choo 2022) on the weights of the reference shape:
         J_i = sum w V0 J_p/sum w V0,  J- = sum w J_i,  with J- + own (J - J-) for J-:   stress of F- = (J-/J)^(1/D) F,  P = tau(F-) F^-T
         In plane strain and axisymmetry the directions of the grid are scaled, the third is not.                        NoAverage: nothing
"""

import math

import numpy as np

from mpm.integrate.body_force import take_up
from mpm.integrate.deformation import cofactor
from mpm.integrate.given_source import push_at, warm
from mpm.integrate.strain import HEATED, WORKED
from mpm.integrate.traction import share
from mpm.jit import kernel, role
from mpm.sources import Given, heat, push
from mpm.state import Average, Axisymmetric, Line, NoAverage, NoSource, Plane, Source, Volume
from mpm.tensors import dilation1, dilation2, dilation3
from mpm.total.reference import Skin, Still, fold
from mpm.transfer import CHUNK, Bspline, gather, gather_scalar, lay_down, scatter, scatter_scalar


@role(inline=True)
def act_on(source, body, chunk, first, count, dt, report):
    """After the stress: heat of the past step dt to the particles, forces of the present on to chunk.a."""
    raise TypeError(f"no source {type(source).__name__}")


@act_on.register(NoSource)
def act_on_no_source(source, body, chunk, first, count, dt, report):
    return None


@act_on.register(Source)
def act_on_source(source, body, chunk, first, count, dt, report):
    particles = body.particles
    for p in range(count):
        i = first + p
        if dt > 0.0:
            report[HEATED] += particles.m[i] * take_up(body.thermal, i, dt * heat(source.law, source.X, i, source.t[i] + 0.5 * dt))
            source.t[i] += dt
        for c in range(particles.v.shape[1]):
            chunk.a[c, p] += particles.m[i] * push(source.law, source.X, i, c, source.t[i])


@act_on.register(Given)
def act_on_given(source, body, chunk, first, count, dt, report):
    m = body.particles.m
    warm(source.heat, source, body, first, count, dt, report)
    for p in range(count):
        source.t[first + p] += dt
    push_at(source.force, source, body, first, count, source.t[first])
    for p in range(count):
        for c in range(source.X.shape[1]):
            chunk.a[c, p] += m[first + p] * source.b[first + p, c]


@role
def swollen(space, X, i, chunk, p):
    """J - 1 of particle i, which is p of the chunk, where displacement was gathered."""
    raise TypeError(f"no volume change for {type(space).__name__}")


@swollen.register(Line)
def swollen_line(space, X, i, chunk, p):
    return dilation1((chunk.L[0, 0, p],))


@swollen.register(Plane)
def swollen_plane(space, X, i, chunk, p):
    L = chunk.L
    return dilation2((L[0, 0, p], L[0, 1, p], L[1, 0, p], L[1, 1, p], 0.0))


@swollen.register(Axisymmetric)
def swollen_axisymmetric(space, X, i, chunk, p):
    L = chunk.L
    return dilation2((L[0, 0, p], L[0, 1, p], L[1, 0, p], L[1, 1, p], chunk.v[0, p] / X[i, 0]))


@swollen.register(Volume)
def swollen_volume(space, X, i, chunk, p):
    L = chunk.L
    return dilation3((L[0, 0, p], L[0, 1, p], L[0, 2, p], L[1, 0, p], L[1, 1, p], L[1, 2, p], L[2, 0, p], L[2, 1, p], L[2, 2, p]))


@role
def press(skin, space, reference, chunk, dt, report):
    """After a motion of dt: nodal forces of tractions by present area, to reference.load, and their work to the report."""
    raise TypeError(f"no tractions on {type(skin).__name__}")


@press.register(Still)
def press_still(skin, space, reference, chunk, dt, report):
    return None


@press.register(Skin)
def press_skin(skin, space, reference, chunk, dt, report):
    load, gradient, D, F = reference.load, Bspline(), skin.x.shape[1], np.zeros((1, skin.x.shape[1], skin.x.shape[1]))
    half = 0.5 * dt * share(reference.ramp, reference.t[0] - 0.5 * dt, 0.0)
    report[WORKED] -= half * along(reference)
    for n in reference.touched:
        for c in range(load.shape[1]):
            load[n, c] = skin.still[n, c]
    chunk.G[:] = 0.0
    for first in range(0, skin.x.shape[0], CHUNK):
        count = min(CHUNK, skin.x.shape[0] - first)
        lay_down(space, skin.x, first, count, chunk)
        gather(space, gradient, skin.x, first, chunk, count, reference.u)
        for p in range(count):
            s, square = first + p, 0.0
            for c in range(D):
                for d in range(D):
                    F[0, c, d] = chunk.L[c, d, p]
                F[0, c, c] += 1.0
            volume = 0.0
            for k in range(D):
                volume += F[0, 0, k] * cofactor(F, 0, 0, k, D)
            out = (1.0 + swollen(space, skin.x, s, chunk, p)) / volume
            for c in range(D):
                area = 0.0
                for k in range(D):
                    area += out * cofactor(F, 0, c, k, D) * skin.area[s, k]
                square += area * area
                chunk.a[c, p] = -skin.pressure[s] * area
            size = math.sqrt(square)
            for c in range(D):
                chunk.a[c, p] += size * skin.pull[s, c]
        scatter(space, gradient, skin.x, first, chunk, count, load, chunk.reach)
    fold(load, reference)
    report[WORKED] += half * along(reference)


@kernel
def along(reference):
    """Work of the loads at full load by time [W]."""
    total, load, v = 0.0, reference.load, reference.v
    for n in reference.active:
        for c in range(reference.X.shape[1]):
            total += load[n, c] * v[n, c]
    return total


@role
def average_volume(locking, space, body, reference, chunk):
    """Nodal averages of the present changes of volume."""
    raise TypeError(f"no averaging by {type(locking).__name__}")


@average_volume.register(NoAverage)
def average_volume_no_average(locking, space, body, reference, chunk):
    return None


@average_volume.register(Average)
def average_volume_average(locking, space, body, reference, chunk):
    X, V0, total, gradient, D = reference.X, body.particles.V0, locking.change, Bspline(), reference.X.shape[1]
    for n in reference.touched:
        total[n] = 0.0
    value, zero = chunk.f[0], chunk.S[0]
    for first in range(0, X.shape[0], CHUNK):
        count = min(CHUNK, X.shape[0] - first)
        lay_down(space, X, first, count, chunk)
        gather(space, gradient, X, first, chunk, count, reference.u)
        for p in range(count):
            value[p] = V0[first + p] * swollen(space, X, first + p, chunk, p)
            for k in range(D):
                zero[k, p] = 0.0
        scatter_scalar(space, X, first, count, value, zero, zero, total)
    ghost, image, lean = reference.ghost, reference.image, reference.lean
    for k in range(len(ghost)):  # behind a wall that sticks nothing is mirrored
        if lean[k] == 0.0:
            total[image[k]] += total[ghost[k]]
    for n in reference.touched:
        if locking.volume[n] > 0.0:
            total[n] /= locking.volume[n]
    for k in range(len(ghost) - 1, -1, -1):
        if lean[k] == 0.0:
            total[ghost[k]] = total[image[k]]


@role
def relax_volume(locking, space, X, first, chunk, count):
    """F- for F in chunk.L; what it was multiplied with, less one, to chunk.none."""
    raise TypeError(f"no averaging by {type(locking).__name__}")


@relax_volume.register(NoAverage)
def relax_volume_no_average(locking, space, X, first, chunk, count):
    return None


@relax_volume.register(Average)
def relax_volume_average(locking, space, X, first, chunk, count):
    D, at, unused = X.shape[1], chunk.f[0], chunk.S[0]
    gather_scalar(space, X, first, count, locking.change, at, unused, unused)
    for p in range(count):
        alone = swollen(space, X, first + p, chunk, p)
        stretch = math.expm1((math.log1p(at[p] + locking.own * (alone - at[p])) - math.log1p(alone)) / D)
        chunk.none[p] = stretch
        for c in range(D):
            for d in range(D):
                chunk.L[c, d, p] += stretch * chunk.L[c, d, p]
            chunk.L[c, c, p] += stretch


@role
def restore(locking, chunk, count):
    """F again in chunk.L."""
    raise TypeError(f"no averaging by {type(locking).__name__}")


@restore.register(NoAverage)
def restore_no_average(locking, chunk, count):
    return None


@restore.register(Average)
def restore_average(locking, chunk, count):
    D = chunk.a.shape[0]
    for p in range(count):
        stretch = chunk.none[p]
        for c in range(D):
            chunk.L[c, c, p] -= stretch
            for d in range(D):
                chunk.L[c, d, p] /= 1.0 + stretch
        chunk.none[p] = 0.0
