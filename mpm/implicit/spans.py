"""F-bar over knot spans, against volumetric locking in implicit steps (docs/physics.md 17; T. J. R. Hughes, Int. J. Numer. Meth. Engng. 15 (1980) 1413).

    eps_bar = eps_tr + extra 1,   extra = (1 - own)(<ln det f> - ln det f)/3,   <a> = sum V0 a/sum V0 over the particles of a span
    Pi = sum V0 W(eps_bar)   so   tau_bar = tau + lift 1,   lift = (1 - own)(<tr tau> - tr tau)/3
    K = sum V0 [B^T G(tau_bar) B + t (z + c t/2)^T + (z + c t/2) t^T],   t = (1 - own)(<m.B> - m.B)/3,   z = B^T a m,   c = m.a m,   m = 1
A span holds the particles that see the same nodes, so no row of the matrix grows longer, and what is minimised stays one energy.
Good values  Poisson ratio above 0.45; own 0.02: changes of volume that alternate from span to span average to nothing otherwise.
Fails when   a span holds one particle: nothing is averaged there. Volume changes within a cell are the answer: they are smeared.
"""

import math
from typing import NamedTuple

import numpy as np

from mpm.basis import stencil
from mpm.boundary import directions, extents
from mpm.implicit.trial import answered, dilation, gradients, increment
from mpm.jit import kernel, role
from mpm.state import NoAverage


class NoSpans(NamedTuple):
    """Each particle keeps its own change of volume."""


class Spans(NamedTuple):
    """G spans of N particles with M nodes each, and what an assembly averages over them."""

    of: np.ndarray  # (N,) span of a particle
    own: float  # share of its own change of volume that a particle keeps
    volume: np.ndarray  # (G,) sum V0 [m^D]
    mean: np.ndarray  # (G,) <ln det f>, then <-p> [Pa]
    slope: np.ndarray  # (G, M, D) <m.B> [1/m]
    grown: np.ndarray  # (N,) ln det f, then -p [Pa]
    extra: np.ndarray  # (N,)
    lift: np.ndarray  # (N,) [Pa]


@kernel
def first_nodes(space, x):
    """Number of the first node that each particle sees, before mirrors fold it."""
    shape, h, D = extents(space), space.h, directions(space)
    first = np.empty(x.shape[0], np.int64)
    for p in range(x.shape[0]):
        first[p] = stencil(space.basis, x[p, 0] / h)[0]
        for a in range(1, D):
            first[p] = first[p] * shape[a] + stencil(space.basis, x[p, a] / h)[0]
    return first


def new_spans(locking, space, particles, count: int):
    """Spans of a body's particles with `count` nodes each; NoSpans where nothing is averaged."""
    if isinstance(locking, NoAverage):
        return NoSpans()
    _, of = np.unique(first_nodes(space, particles.x), return_inverse=True)
    volume, N = np.bincount(of, particles.V0), len(of)
    return Spans(of, locking.own, volume, np.empty(len(volume)), np.empty((len(volume), count, directions(space))), *np.zeros((3, N)))


@kernel(inline=True)
def share_out(spans, V0, out, factor):
    """out <- factor (1 - own)(mean - grown) of each particle."""
    spans.mean[:] = 0.0
    for p in range(V0.shape[0]):
        spans.mean[spans.of[p]] += V0[p] * spans.grown[p] / spans.volume[spans.of[p]]
    for p in range(V0.shape[0]):
        out[p] = factor * (1.0 - spans.own) * (spans.mean[spans.of[p]] - spans.grown[p])


@role
def extra_strain(spans, p):
    """What averaging adds to each principal strain of particle p."""
    raise TypeError(f"no spans {type(spans).__name__}")


@extra_strain.register(NoSpans)
def extra_strain_no_spans(spans, p):
    return 0.0


@extra_strain.register(Spans)
def extra_strain_spans(spans, p):
    return spans.extra[p]


@role
def extra_stress(spans, p):
    """What averaging adds to each principal stress of particle p [Pa]."""
    raise TypeError(f"no spans {type(spans).__name__}")


@extra_stress.register(NoSpans)
def extra_stress_no_spans(spans, p):
    return 0.0


@extra_stress.register(Spans)
def extra_stress_spans(spans, p):
    return spans.lift[p]


@role
def average_volumes(spans, space, body, nodes, u):
    """Fill `extra` of the spans at displacements u; false where a particle is turned inside out."""
    raise TypeError(f"no spans {type(spans).__name__}")


@average_volumes.register(NoSpans)
def average_volumes_no_spans(spans, space, body, nodes, u):
    return True


@average_volumes.register(Spans)
def average_volumes_spans(spans, space, body, nodes, u):
    for p in range(body.particles.x.shape[0]):
        grow = dilation(space, increment(space, nodes, u, body.particles.x, p))
        if grow <= -1.0:
            return False
        spans.grown[p] = math.log1p(grow)
    share_out(spans, body.particles.V0, spans.extra, 1.0 / 3.0)
    return True


@role
def average_stresses(spans, space, body, nodes, u, dt):
    """Fill `lift` and `slope` of the spans, at displacements u whose volumes are averaged."""
    raise TypeError(f"no spans {type(spans).__name__}")


@average_stresses.register(NoSpans)
def average_stresses_no_spans(spans, space, body, nodes, u, dt):
    return None


@average_stresses.register(Spans)
def average_stresses_spans(spans, space, body, nodes, u, dt):
    x, V0, M, D = body.particles.x, body.particles.V0, nodes.w.shape[1], directions(space)
    g, wr, tau, a = np.zeros((M, max(D, 2))), np.zeros(M), np.empty(3), np.empty((3, 3))
    spans.slope[:] = 0.0
    for p in range(x.shape[0]):
        A, _, _, _, _, _ = answered(space, body, nodes, u, p, spans.extra[p], dt, tau, a)
        spans.grown[p] = (tau[0] + tau[1] + tau[2]) / 3.0
        gradients(space, nodes, A, x, p, g, wr)
        part = V0[p] / spans.volume[spans.of[p]]
        for k in range(M):
            spans.slope[spans.of[p], k, 0] += part * wr[k]
            for c in range(D):
                spans.slope[spans.of[p], k, c] += part * g[k, c]
    share_out(spans, V0, spans.lift, 1.0)


@role
def tilt(spans, p, g, wr, bulk, t, z):
    """t and z (M, D) of particle p from its gradients g, hoops wr and bulk (3, 3) = a m in the grid's axes."""
    raise TypeError(f"no spans {type(spans).__name__}")


@tilt.register(NoSpans)
def tilt_no_spans(spans, p, g, wr, bulk, t, z):
    return None


@tilt.register(Spans)
def tilt_spans(spans, p, g, wr, bulk, t, z):
    whole = bulk[0, 0] + bulk[1, 1] + bulk[2, 2]
    for k in range(t.shape[0]):
        for c in range(t.shape[1]):
            alone = g[k, c] + (wr[k] if c == 0 else 0.0)
            t[k, c] = (1.0 - spans.own) * (spans.slope[spans.of[p], k, c] - alone) / 3.0
            z[k, c] = 0.5 * whole * t[k, c] + (bulk[2, 2] * wr[k] if c == 0 else 0.0)
            for d in range(g.shape[1]):
                z[k, c] += bulk[c, d] * g[k, d]


@role(inline=True)
def tied(spans, V0, t, z, k, c, m, d):
    """What averaging adds to K of components c and d at nodes k and m of a particle, but for mirrors."""
    raise TypeError(f"no spans {type(spans).__name__}")


@tied.register(NoSpans)
def tied_no_spans(spans, V0, t, z, k, c, m, d):
    return 0.0


@tied.register(Spans)
def tied_spans(spans, V0, t, z, k, c, m, d):
    return V0 * (t[k, c] * z[m, d] + z[k, c] * t[m, d])


@role
def tie(spans, nodes, p, V0, g, wr, bulk, t, z, band):
    """Add to the lower band what averaging adds to the tangent of particle p; t and z (M, D) are scratch."""
    raise TypeError(f"no spans {type(spans).__name__}")


@tie.register(NoSpans)
def tie_no_spans(spans, nodes, p, V0, g, wr, bulk, t, z, band):
    return None


@tie.register(Spans)
def tie_spans(spans, nodes, p, V0, g, wr, bulk, t, z, band):
    tilt(spans, p, g, wr, bulk, t, z)
    M, D = t.shape
    for k in range(M):
        for c in range(D):
            j = nodes.eq[nodes.node[p, k], c]
            if j < 0:
                continue
            for m in range(M):
                for d in range(D):
                    i = nodes.eq[nodes.node[p, m], d]
                    if i >= j:
                        turned = (nodes.flip[p, k] >> c & 1) != (nodes.flip[p, m] >> d & 1)
                        part = tied(spans, V0, t, z, k, c, m, d)
                        band[j, i - j] += -part if turned else part
