"""Potential, residual and tangent of the particles of one implicit step in one and two directions (docs/physics.md 17).

f = 1 + sum u grad(w), hoop 1 + u_r/r;  b_tr = f b f^T;  Pi = sum V0 W(eps_tr);  r_i = sum V0 [tau grad'(w) + e_r tau_33 w/r'],  grad' = f^-T grad
Tangent, in the axes of b_tr (values l1, l2), l = grad' du:
    dtau_ii = sum a_ij l_jj,   dtau_12 = h (l2 l12 + l1 l21),   h = (tau_1 - tau_2)/(l1 - l2)
    G_ab,cd = dtau_ab/dl_cd - tau_ad delta_cb,   G_33,33 = a_33 - tau_33;   K = V0 B^T G B
One direction is plane strain that does not move across. Components l11, l12, l21, l22, l33.
"""

import math

import numpy as np

from mpm.boundary import directions
from mpm.implicit.spans import average_stresses, average_volumes, extra_strain, extra_stress, tie
from mpm.implicit.trial import answered, gradients, sign
from mpm.jit import kernel
from mpm.materials import turning


@kernel
def turned(a, tau, h, l1, l2, axes, T, E, G):
    """G (5, 5) in the grid's axes, from slopes a (3, 3) of principal stresses tau (3,), in axes (c, s), (-s, c). T and E are scratch, zero where unused."""
    c, s = axes
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
    total, M, spans = 0.0, nodes.w.shape[1], nodes.spans
    if not average_volumes(spans, space, body, nodes, u):
        return math.inf
    if want:
        average_stresses(spans, space, body, nodes, u, dt)
    a, tau, G, H, T, E = np.empty((3, 3)), np.empty(3), np.empty((5, 5)), np.empty(5), np.zeros((5, 5)), np.zeros((5, 5))
    g, wr, bulk, t, z = np.zeros((M, 2)), np.zeros(M), np.zeros((3, 3)), np.zeros((M, D)), np.zeros((M, D))
    for p in range(x.shape[0]):
        A, values, axes, elastic, W, share = answered(space, body, nodes, u, p, extra_strain(spans, p), dt, tau, a)
        if W == math.inf:
            return math.inf
        total += V0[p] * W
        if not want:
            continue
        for i in range(3):
            tau[i] += extra_stress(spans, p)
        c, s = axes
        s11, s22, s12 = c * c * tau[0] + s * s * tau[1], s * s * tau[0] + c * c * tau[1], c * s * (tau[0] - tau[1])
        gradients(space, nodes, A, x, p, g, wr)
        for k in range(M):
            r[nodes.node[p, k], 0] += sign(nodes, p, k, 0) * V0[p] * (s11 * g[k, 0] + s12 * g[k, 1] + tau[2] * wr[k])
            if D == 2:
                r[nodes.node[p, k], 1] += sign(nodes, p, k, 1) * V0[p] * (s12 * g[k, 0] + s22 * g[k, 1])
        turned(a, tau, turning(elastic, share, values[0], values[1]), 1.0 + values[0], 1.0 + values[1], axes, T, E, G)
        for k in range(M):
            for e in range(D):
                j = nodes.eq[nodes.node[p, k], e]
                if j < 0:
                    continue
                factor = V0[p] * sign(nodes, p, k, e)
                for i in range(5):
                    H[i] = factor * (G[i, 0] * g[k, 0] + G[i, 1] * g[k, 1] + G[i, 4] * wr[k] if e == 0 else G[i, 2] * g[k, 0] + G[i, 3] * g[k, 1])
                for m in range(M):
                    i = nodes.eq[nodes.node[p, m], 0]
                    if i >= j:
                        band[j, i - j] += sign(nodes, p, m, 0) * (g[m, 0] * H[0] + g[m, 1] * H[1] + wr[m] * H[4])
                    if D == 2:
                        i = nodes.eq[nodes.node[p, m], 1]
                        if i >= j:
                            band[j, i - j] += sign(nodes, p, m, 1) * (g[m, 0] * H[2] + g[m, 1] * H[3])
        b1, b2, b3 = a[0, 0] + a[1, 0] + a[2, 0], a[0, 1] + a[1, 1] + a[2, 1], a[0, 2] + a[1, 2] + a[2, 2]
        bulk[0, 0], bulk[1, 1], bulk[2, 2] = c * c * b1 + s * s * b2, s * s * b1 + c * c * b2, b3
        bulk[0, 1] = bulk[1, 0] = c * s * (b1 - b2)
        tie(spans, nodes, p, V0[p], g, wr, bulk, t, z, band)
    return total
