"""A particle in an implicit step (docs/physics.md 17): increment, trial strains and axes, what its laws answer, gradients in the moved shape."""

import math

from mpm.boundary import directions
from mpm.heat.local import thermal_stress
from mpm.heat.setting import condition
from mpm.jit import kernel, role
from mpm.materials import response, settled, warmed
from mpm.state import Axisymmetric, Line, Plane, Volume
from mpm.tensors import dilation2, dilation3, eigen2, eigen3, push2, push3

LARGEST_INCREMENT = 0.9  # largest entry of f - 1 in a step


@role
def elastic_b(space, B, i):
    """b - 1 of particle i: (xx, yy, zz, xy)."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@elastic_b.register(Line)
def elastic_b_line(space, B, i):
    return float(B[i, 0]), float(B[i, 1]), float(B[i, 2]), 0.0


@elastic_b.register(Plane)
@elastic_b.register(Axisymmetric)
def elastic_b_plane_or_axisymmetric(space, B, i):
    return float(B[i, 0]), float(B[i, 1]), float(B[i, 2]), float(B[i, 3])


@elastic_b.register(Volume)
def elastic_b_volume(space, B, i):
    return float(B[i, 0]), float(B[i, 1]), float(B[i, 2]), float(B[i, 3]), float(B[i, 4]), float(B[i, 5])


@role
def hoop(space):
    """1 where a radial displacement stretches the hoop."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@hoop.register(Line)
@hoop.register(Plane)
def hoop_line_or_plane(space):
    return 0.0


@hoop.register(Axisymmetric)
def hoop_axisymmetric(space):
    return 1.0


@kernel(inline=True)
def sign(nodes, p, k, c):
    """Of component c at node k of particle p: -1 where a mirror turns it."""
    return -1.0 if nodes.flip[p, k] >> c & 1 else 1.0


@role
def increment(space, nodes, u, x, p):
    """f - 1 of particle p as mpm.tensors has it."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@increment.register(Line)
@increment.register(Plane)
@increment.register(Axisymmetric)
def increment_line_plane_or_axisymmetric(space, nodes, u, x, p):
    a11, a12, a21, a22, ur = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(nodes.w.shape[1]):
        n = nodes.node[p, k]
        u1 = sign(nodes, p, k, 0) * u[n, 0]
        a11 += u1 * nodes.g[p, k, 0]
        ur += u1 * nodes.w[p, k]
        if directions(space) == 2:
            u2 = sign(nodes, p, k, 1) * u[n, 1]
            a12 += u1 * nodes.g[p, k, 1]
            a21 += u2 * nodes.g[p, k, 0]
            a22 += u2 * nodes.g[p, k, 1]
    return a11, a12, a21, a22, hoop(space) * ur / x[p, 0]


@increment.register(Volume)
def increment_volume(space, nodes, u, x, p):
    a11, a12, a13, a21, a22, a23, a31, a32, a33 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(nodes.w.shape[1]):
        n, g1, g2, g3 = nodes.node[p, k], nodes.g[p, k, 0], nodes.g[p, k, 1], nodes.g[p, k, 2]
        u1, u2, u3 = sign(nodes, p, k, 0) * u[n, 0], sign(nodes, p, k, 1) * u[n, 1], sign(nodes, p, k, 2) * u[n, 2]
        a11, a12, a13 = a11 + u1 * g1, a12 + u1 * g2, a13 + u1 * g3
        a21, a22, a23 = a21 + u2 * g1, a22 + u2 * g2, a23 + u2 * g3
        a31, a32, a33 = a31 + u3 * g1, a32 + u3 * g2, a33 + u3 * g3
    return a11, a12, a13, a21, a22, a23, a31, a32, a33


@role
def dilation(space, A):
    """det(1 + A) - 1."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@dilation.register(Line)
@dilation.register(Plane)
@dilation.register(Axisymmetric)
def dilation_line_plane_or_axisymmetric(space, A):
    return dilation2(A)


@dilation.register(Volume)
def dilation_volume(space, A):
    return dilation3(A)


@role
def principal(space, B):
    """Eigenvalues of B in their order of axes, and the axes: (c, s) in a plane, the rows of a rotation in space."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@principal.register(Line)
@principal.register(Plane)
@principal.register(Axisymmetric)
def principal_line_plane_or_axisymmetric(space, B):
    l1, l2, c, s = eigen2(B[0], B[1], B[3])
    return (l1, l2, B[2]), (c, s)


@principal.register(Volume)
def principal_volume(space, B):
    found = eigen3(B[0], B[1], B[2], B[3], B[4], B[5])
    return found[:3], found[3:]


@role
def pushed(space, B, A, i):
    """b - 1 of particle i after the increment."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@pushed.register(Line)
@pushed.register(Plane)
@pushed.register(Axisymmetric)
def pushed_line_plane_or_axisymmetric(space, B, A, i):
    return push2(elastic_b(space, B, i), A)


@pushed.register(Volume)
def pushed_volume(space, B, A, i):
    return push3(elastic_b(space, B, i), A)


@kernel(inline=True)
def trial(space, B, A, extra, i):
    """The trial state of particle i with `extra` added to each strain: eigenvalues of b - 1, axes, trace, deviator and its norm, det f - 1; is it sound?"""
    b, axes = principal(space, pushed(space, B, A, i))
    grow, largest = dilation(space, A), 0.0
    for a in A:
        largest = max(largest, abs(a))
    sound = grow > -1.0 and min(b[0], b[1], b[2]) > -1.0 and largest < LARGEST_INCREMENT
    if not sound:
        return b, axes, 0.0, (0.0, 0.0, 0.0), 0.0, grow, False
    e1, e2, e3 = 0.5 * math.log1p(b[0]), 0.5 * math.log1p(b[1]), 0.5 * math.log1p(b[2])
    trace = e1 + e2 + e3
    if extra != 0.0:
        trace, grow = trace + 3.0 * extra, math.expm1(math.log1p(grow) + 3.0 * extra)
    d1, d2, d3 = ((e1 - e2) + (e1 - e3)) / 3.0, ((e2 - e1) + (e2 - e3)) / 3.0, ((e3 - e1) + (e3 - e2)) / 3.0
    return b, axes, trace, (d1, d2, d3), math.sqrt(d1 * d1 + d2 * d2 + d3 * d3), grow, True


@kernel(inline=True)
def answered(space, body, nodes, u, p, extra, dt, tau, a):
    """(increment, eigenvalues and axes of its trial b, its elastic law, W [J/m3], share of the deviator that is left) of particle p at displacements u.

    `extra` is added to each strain. Principal stresses go to tau (3,), their slopes to a (3, 3). W is inf where the trial state or the return map is unsound.
    """
    A, theta = increment(space, nodes, u, body.particles.x, p), condition(body.setting, body.thermal, p)
    values, axes, trace, d, size, _, sound = trial(space, body.particles.B, A, extra, p)
    elastic, law = warmed(body.elastic, theta), settled(body.flow, body.particles.J[p])
    if not sound:
        return A, values, axes, elastic, math.inf, 1.0
    thermal = thermal_stress(body.expansion, body.thermal, p, theta)
    W, share, good = response(elastic, law, trace, d, size, thermal, theta, dt, tau, a)
    return A, values, axes, elastic, W if good else math.inf, share


@role
def gradients(space, nodes, A, x, p, g, wr):
    """Of particle p's weights in the moved shape: f^-T grad w to g (M, D or 2), w/r' (0 where there is no hoop) to wr (M,)."""
    raise TypeError(f"no implicit mechanics for {type(space).__name__}")


@gradients.register(Line)
@gradients.register(Plane)
@gradients.register(Axisymmetric)
def gradients_line_plane_or_axisymmetric(space, nodes, A, x, p, g, wr):
    inverse = 1.0 / ((1.0 + A[0]) * (1.0 + A[3]) - A[1] * A[2])
    across = hoop(space) / (x[p, 0] * (1.0 + A[4]))
    for k in range(nodes.w.shape[1]):
        q1, q2 = nodes.g[p, k, 0], (nodes.g[p, k, 1] if directions(space) == 2 else 0.0)
        g[k, 0], g[k, 1] = inverse * ((1.0 + A[3]) * q1 - A[2] * q2), inverse * ((1.0 + A[0]) * q2 - A[1] * q1)
        wr[k] = across * nodes.w[p, k]


@gradients.register(Volume)
def gradients_volume(space, nodes, A, x, p, g, wr):
    f11, f12, f13, f21, f22, f23, f31, f32, f33 = 1.0 + A[0], A[1], A[2], A[3], 1.0 + A[4], A[5], A[6], A[7], 1.0 + A[8]
    c11, c12, c13 = f22 * f33 - f23 * f32, f23 * f31 - f21 * f33, f21 * f32 - f22 * f31
    c21, c22, c23 = f13 * f32 - f12 * f33, f11 * f33 - f13 * f31, f12 * f31 - f11 * f32
    c31, c32, c33 = f12 * f23 - f13 * f22, f13 * f21 - f11 * f23, f11 * f22 - f12 * f21
    inverse = 1.0 / (f11 * c11 + f12 * c12 + f13 * c13)
    for k in range(nodes.w.shape[1]):
        q1, q2, q3 = nodes.g[p, k, 0], nodes.g[p, k, 1], nodes.g[p, k, 2]
        g[k, 0], g[k, 1] = inverse * (c11 * q1 + c12 * q2 + c13 * q3), inverse * (c21 * q1 + c22 * q2 + c23 * q3)
        g[k, 2] = inverse * (c31 * q1 + c32 * q2 + c33 * q3)
