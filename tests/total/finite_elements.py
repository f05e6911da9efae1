"""An independent answer for a cantilever of Hencky material in plane strain: nine-node elements on a fitted mesh, Newton's method, dead loads.

    sum_e int P(F) : grad delta u dV = int b . delta u dV,   P = F S,  S = V diag(tau_i/lambda_i^2) V^T of F^T F = V diag(lambda^2) V^T
Held at x = 0. The tangent is by central differences of P. Nothing of it is shared with mpm.
"""

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve


def piola(F, lam, mu):
    C = np.einsum("pki,pkj->pij", F, F)
    square, axes = np.linalg.eigh(C)
    e = 0.5 * np.log(square)
    tau = 2 * mu * e + lam * e.sum(axis=1, keepdims=True)
    return np.einsum("pil,plk,pk,pjk->pij", F, axes, tau / square, axes)


def shapes(s, t):
    def line(x):
        return np.array([x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2]), np.array([x - 0.5, -2 * x, x + 0.5])

    (a, da), (b, db) = line(s), line(t)
    return np.outer(a, b).ravel(), np.stack([np.outer(da, b).ravel(), np.outer(a, db).ravel()], axis=1)


def cantilever(length, height, lam, mu, force, elements, steps=6):
    """Displacement of the middle of the free end under a body force (2,) by reference volume; elements (along, across)."""
    nx, ny = elements
    columns = 2 * ny + 1
    first = (2 * np.arange(nx)[:, None] * columns + 2 * np.arange(ny)).ravel()
    nodes = first[:, None] + (np.arange(3)[:, None] * columns + np.arange(3)).ravel()
    dofs = (2 * nodes[:, :, None] + np.arange(2)).reshape(len(nodes), 18)
    half = np.array([length / nx / 2, height / ny / 2])
    x, w = np.polynomial.legendre.leggauss(3)
    rule = [(w[i] * w[j] * half.prod(), *shapes(x[i], x[j])) for i in range(3) for j in range(3)]
    n = 2 * (2 * nx + 1) * columns
    free = np.arange(2 * columns, n)
    load = np.zeros(n)
    for weight, value, _ in rule:
        np.add.at(load, dofs.reshape(len(nodes), 9, 2), weight * value[:, None] * np.array(force))
    u = np.zeros(n)
    for step in range(1, steps + 1):
        for _ in range(30):
            residual, blocks = step / steps * load, np.zeros((len(nodes), 18, 18))
            for weight, _, slope in rule:
                grad = slope / half
                F = np.eye(2) + np.einsum("eac,ad->ecd", u[dofs].reshape(-1, 9, 2), grad)
                np.subtract.at(residual, dofs.reshape(len(nodes), 9, 2), weight * np.einsum("ecd,ad->eac", piola(F, lam, mu), grad))
                A = np.zeros((len(nodes), 2, 2, 2, 2))
                for c in range(2):
                    for d in range(2):
                        more = np.zeros((2, 2))
                        more[c, d] = 1e-6
                        A[..., c, d] = (piola(F + more, lam, mu) - piola(F - more, lam, mu)) / 2e-6
                blocks += weight * np.einsum("bj,eijcd,kd->ebikc", grad, A, grad).reshape(-1, 18, 18)
            rows, cols = np.repeat(dofs, 18, axis=1).ravel(), np.tile(dofs, (1, 18)).ravel()
            K = sparse.coo_matrix((blocks.ravel(), (rows, cols)), shape=(n, n)).tocsr()[free][:, free]
            change = spsolve(K.tocsc(), residual[free])
            u[free] += change
            if np.abs(change).max() < 1e-10 * length:
                break
        else:
            raise ArithmeticError("Newton's method does not converge")
    return u.reshape(-1, 2)[2 * nx * columns + ny]
