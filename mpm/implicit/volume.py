"""Potential, residual and tangent of the particles of one implicit step in three directions (docs/physics.md 17): as assemble.py, with blocks for a matrix.

In the axes of b_tr (values l_i):  dtau_ii = sum a_ij l_jj,   dtau_ij = h_ij (l_j l_ij + l_i l_ji),   h_ij = (tau_i - tau_j)/(l_i - l_j),
    G_ab,cd = dtau_ab/dl_cd - tau_ad delta_cb;   block of nodes k and m: K_ac = V0 sum_bd G_ab,cd grad'_b w_k grad'_d w_m
"""

import math

import numpy as np

from mpm.implicit.matrix import between
from mpm.implicit.spans import average_stresses, average_volumes, extra_strain, extra_stress, tied, tilt
from mpm.implicit.trial import answered, gradients, sign
from mpm.jit import kernel
from mpm.materials import turning


@kernel
def turned3(elastic, a, tau, b, share, R, E, G):
    """G (3, 3, 3, 3) in the grid's axes, from slopes a (3, 3) of principal stresses tau (3,) along the rows of R. E is scratch."""
    for i in range(3):
        for j in range(3):
            for m in range(3):
                for n in range(3):
                    E[i, j, m, n] = 0.0
    for i in range(3):
        for j in range(3):
            E[i, i, j, j] += a[i, j]
            if i != j:
                h = turning(elastic, share, b[i], b[j])
                E[i, j, i, j] += h * (1.0 + b[j])
                E[i, j, j, i] += h * (1.0 + b[i])
            E[i, j, j, i] -= tau[i]
    for _ in range(4):  # one index after another
        for i in range(3):
            for j in range(3):
                for m in range(3):
                    for n in range(3):
                        total = 0.0
                        for k in range(3):
                            total += E[k, j, m, n] * R[k, i]
                        G[j, m, n, i] = total
        for i in range(3):
            for j in range(3):
                for m in range(3):
                    for n in range(3):
                        E[i, j, m, n] = G[i, j, m, n]


@kernel
def assemble_volume(space, body, nodes, u, dt, r, blocks, want):
    """Sum of V0 W [J] at displacements u (A, 3), inf where a particle is turned inside out; with `want` also residual r and blocks are added to."""
    x, V0, total, M, spans = body.particles.x, body.particles.V0, 0.0, nodes.w.shape[1], nodes.spans
    if not average_volumes(spans, space, body, nodes, u):
        return math.inf
    if want:
        average_stresses(spans, space, body, nodes, u, dt)
    a, tau, b, R, bulk = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    E, G, H = np.empty((3, 3, 3, 3)), np.empty((3, 3, 3, 3)), np.empty((3, 3, 3))
    g, wr, t, z, B = np.zeros((M, 3)), np.zeros(M), np.zeros((M, 3)), np.zeros((M, 3)), np.empty((3, 3))
    for p in range(x.shape[0]):
        A, values, axes, elastic, W, share = answered(space, body, nodes, u, p, extra_strain(spans, p), dt, tau, a)
        if W == math.inf:
            return math.inf
        total += V0[p] * W
        if not want:
            continue
        for i in range(3):
            b[i] = values[i]
            tau[i] += extra_stress(spans, p)
            for j in range(3):
                R[i, j] = axes[3 * i + j]
        gradients(space, nodes, A, x, p, g, wr)
        for i in range(3):
            for j in range(3):
                B[i, j], bulk[i, j] = 0.0, 0.0
                for k in range(3):
                    B[i, j] += tau[k] * R[k, i] * R[k, j]
                    bulk[i, j] += (a[0, k] + a[1, k] + a[2, k]) * R[k, i] * R[k, j]
        for k in range(M):
            for c in range(3):
                r[nodes.node[p, k], c] += sign(nodes, p, k, c) * V0[p] * (B[c, 0] * g[k, 0] + B[c, 1] * g[k, 1] + B[c, 2] * g[k, 2])
        turned3(elastic, a, tau, b, share, R, E, G)
        tilt(spans, p, g, wr, bulk, t, z)
        for k in range(M):
            for i in range(3):
                for c in range(3):
                    for e in range(3):
                        H[i, c, e] = V0[p] * (G[i, 0, c, e] * g[k, 0] + G[i, 1, c, e] * g[k, 1] + G[i, 2, c, e] * g[k, 2])
            first = nodes.node[p, k]
            for m in range(k, M):
                second = nodes.node[p, m]
                at, back = between(blocks, first, second), between(blocks, second, first)
                for i in range(3):
                    for c in range(3):
                        part = H[i, c, 0] * g[m, 0] + H[i, c, 1] * g[m, 1] + H[i, c, 2] * g[m, 2]
                        part = (part + tied(spans, V0[p], t, z, k, i, m, c)) * sign(nodes, p, k, i) * sign(nodes, p, m, c)
                        blocks.values[first, at, i, c] += part
                        if m > k:
                            blocks.values[second, back, c, i] += part
    return total
