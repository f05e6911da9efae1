"""Potential, residual and tangent of the particles of one implicit step (docs/physics.md 17).

f = 1 + sum u grad(w), hoop 1 + u_r/r;  b_tr = f b f^T;  Pi = sum V0 W(eps_tr);  r_i = sum V0 [tau grad'(w) + e_r tau_33 w/r'],  grad' = f^-T grad
Tangent, in the axes of b_tr (values l1, l2), l = grad' du:
    dtau_ii = sum a_ij l_jj,   dtau_12 = h (l2 l12 + l1 l21),   h = (tau_1 - tau_2)/(l1 - l2)
    G_ab,cd = dtau_ab/dl_cd - tau_ad delta_cb,   G_33,33 = a_33 - tau_33;   K = V0 B^T G B
One direction is plane strain that does not move across. Components l11, l12, l21, l22, l33.
"""

import math

import numpy as np

from mpm.boundary import directions
from mpm.heat.local import thermal_stress
from mpm.heat.setting import condition
from mpm.jit import kernel, role
from mpm.materials import moduli, settled, tangent, warmed
from mpm.materials.ellipse import SQRT6
from mpm.state import Axisymmetric, Line, Plane
from mpm.tensors import dilation2, eigen2, push2

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


@kernel(inline=True)
def increment(space, nodes, u, x, p):
    """f - 1 of particle p as (11, 12, 21, 22, 33)."""
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


@kernel(inline=True)
def trial(space, B, A, i):
    """The trial state of particle i: eigenvalues of b - 1, axes, principal strains, their trace, the deviator and its norm; and whether it is sound."""
    B = push2(elastic_b(space, B, i), A)
    grow = dilation2(A)
    l1, l2, c, s = eigen2(B[0], B[1], B[3])
    largest = max(abs(A[0]), abs(A[1]), abs(A[2]), abs(A[3]), abs(A[4]))
    sound = grow > -1.0 and min(l1, l2, B[2]) > -1.0 and largest < LARGEST_INCREMENT
    if not sound:
        return l1, l2, c, s, 0.0, 0.0, 0.0, 0.0, 0.0, grow, False
    e1, e2, e3 = 0.5 * math.log1p(l1), 0.5 * math.log1p(l2), 0.5 * math.log1p(B[2])
    trace = e1 + e2 + e3
    d1, d2, d3 = ((e1 - e2) + (e1 - e3)) / 3.0, ((e2 - e1) + (e2 - e3)) / 3.0, ((e3 - e1) + (e3 - e2)) / 3.0
    return l1, l2, c, s, trace, d1, d2, d3, math.sqrt(d1 * d1 + d2 * d2 + d3 * d3), grow, True


@kernel
def turned(a, tau, h, l1, l2, c, s, T, E, G):
    """G (5, 5) in the grid's axes, from slopes a (3, 3) of principal stresses tau (3,), in axes (c, s), (-s, c). T and E are scratch, zero where unused."""
    R = ((c, s), (-s, c))
    for i in range(2):
        for j in range(2):
            for m in range(2):
                for n in range(2):
                    T[2 * i + j, 2 * m + n] = R[i][m] * R[j][n]
    T[4, 4] = 1.0
    at = (0, 3, 4)
    for i in range(3):
        for j in range(3):
            E[at[i], at[j]] = a[i, j]
        E[at[i], at[i]] -= tau[i]
    E[1, 1], E[1, 2], E[2, 1], E[2, 2] = h * l2, h * l1 - tau[0], h * l2 - tau[1], h * l1
    for i in range(5):
        for n in range(5):
            G[i, n] = 0.0
    for j in range(5):
        for n in range(5):
            found = 0.0
            for m in range(5):
                found += E[j, m] * T[m, n]
            for i in range(5):
                G[i, n] += T[j, i] * found


@kernel
def assemble(space, body, nodes, u, dt, r, band, want):
    """Sum of V0 W [J] at displacements u (A, D), inf where a particle is turned inside out; with `want` also residual r and lower band are added to."""
    x, V0, D = body.particles.x, body.particles.V0, directions(space)
    total, M = 0.0, nodes.w.shape[1]
    a, tau, G, H, T, E = np.empty((3, 3)), np.empty(3), np.empty((5, 5)), np.empty(5), np.zeros((5, 5)), np.zeros((5, 5))
    g1, g2, wr = np.zeros(M), np.zeros(M), np.zeros(M)
    for p in range(x.shape[0]):
        A = increment(space, nodes, u, x, p)
        l1, l2, c, s, trace, d1, d2, d3, size, _, sound = trial(space, body.particles.B, A, p)
        if not sound:
            return math.inf
        theta = condition(body.setting, body.thermal, p)
        elastic = warmed(body.elastic, theta)
        lam, mu = moduli(elastic)
        K = lam + 2.0 * mu / 3.0
        law = settled(body.flow, body.particles.J[p])
        thermal = thermal_stress(body.expansion, body.thermal, p, theta)
        W, pressure, share, c11, c12, c22, _, good = tangent(law, elastic, trace, size, thermal, theta, dt)
        if not good:
            return math.inf
        total += V0[p] * W
        if not want:
            continue
        t1, t2, t3 = 2.0 * mu * share * d1 - pressure, 2.0 * mu * share * d2 - pressure, 2.0 * mu * share * d3 - pressure
        s11, s22, s12 = c * c * t1 + s * s * t2, s * s * t1 + c * c * t2, c * s * (t1 - t2)
        inverse = 1.0 / ((1.0 + A[0]) * (1.0 + A[3]) - A[1] * A[2])
        across = hoop(space) / (x[p, 0] * (1.0 + A[4]))
        for k in range(M):
            q1, q2 = nodes.g[p, k, 0], (nodes.g[p, k, 1] if D == 2 else 0.0)
            g1[k], g2[k] = inverse * ((1.0 + A[3]) * q1 - A[2] * q2), inverse * ((1.0 + A[0]) * q2 - A[1] * q1)
            wr[k] = across * nodes.w[p, k]
            n = nodes.node[p, k]
            r[n, 0] += sign(nodes, p, k, 0) * V0[p] * (s11 * g1[k] + s12 * g2[k] + t3 * wr[k])
            if D == 2:
                r[n, 1] += sign(nodes, p, k, 1) * V0[p] * (s12 * g1[k] + s22 * g2[k])
        unit = 1.0 / size if size > 0.0 else 0.0
        n1, n2, n3 = unit * d1, unit * d2, unit * d3
        for i in range(3):
            ni = n1 if i == 0 else n2 if i == 1 else n3
            for j in range(3):
                nj = n1 if j == 0 else n2 if j == 1 else n3
                a[i, j] = K * c11 - SQRT6 * mu * c12 * (ni + nj) + 2.0 * mu * (c22 - share) * ni * nj - 2.0 / 3.0 * mu * share
            a[i, i] += 2.0 * mu * share
        tau[0], tau[1], tau[2] = t1, t2, t3
        apart = (l1 - l2) / (1.0 + l2)
        h = mu * share * (math.log1p(apart) / apart if abs(apart) > 1e-12 else 1.0) / (1.0 + l2)
        turned(a, tau, h, 1.0 + l1, 1.0 + l2, c, s, T, E, G)
        for k in range(M):
            for d in range(D):
                j = nodes.eq[nodes.node[p, k], d]
                if j < 0:
                    continue
                factor = V0[p] * sign(nodes, p, k, d)
                for i in range(5):
                    H[i] = factor * (G[i, 0] * g1[k] + G[i, 1] * g2[k] + G[i, 4] * wr[k] if d == 0 else G[i, 2] * g1[k] + G[i, 3] * g2[k])
                for m in range(M):
                    n = nodes.node[p, m]
                    i = nodes.eq[n, 0]
                    if i >= j:
                        band[j, i - j] += sign(nodes, p, m, 0) * (g1[m] * H[0] + g2[m] * H[1] + wr[m] * H[4])
                    if D == 2:
                        i = nodes.eq[n, 1]
                        if i >= j:
                            band[j, i - j] += sign(nodes, p, m, 1) * (g1[m] * H[2] + g2[m] * H[3])
    return total
