"""Fitted finite elements (scikit-fem) on the disc of configs/studies/robin_cylinder.yaml: what a user of heat-only scenes would pick instead.

Radius 1, density = alpha = kappa = 1, from 1 to 0 outside, t = 0.2, L-stable implicit Runge-Kutta of order 4 (Hairer & Wanner). One line of JSON a mesh:
unknowns, steps, wall and processor seconds of mesh, assembly and solve (best of three after a warm-up), root-mean-square error against the series.
Needs scikit-fem, numpy, scipy; mpm needs none of this:  mpm chart configs/studies/robin_cylinder.yaml --peer "P2=python configs/studies/peers/fem_disc.py 2"
"""

import argparse
import json
import time

import numpy as np
import scipy.sparse.linalg as sl
from scipy.optimize import brentq
from scipy.special import j0, j1, jn_zeros
from skfem import Basis, BilinearForm, ElementTriP1, ElementTriP2, FacetBasis, MeshTri, MeshTri2
from skfem.models.poisson import laplace, mass

STAGES = [[1 / 4], [1 / 2, 1 / 4], [17 / 50, -1 / 25, 1 / 4], [371 / 1360, -137 / 2720, 15 / 544, 1 / 4], [25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4]]


def exact(r, t, Bi, terms=60):
    """The series of a cylinder with Robin exchange."""
    lows, highs = np.concatenate([[1e-9], jn_zeros(1, terms)]), jn_zeros(0, terms)
    z = np.array([brentq(lambda z: z * j1(z) - Bi * j0(z), a, b) for a, b in zip(lows, highs, strict=False)])
    c = 2 * j1(z) / (z * (j0(z) ** 2 + j1(z) ** 2))
    return np.tensordot(c * np.exp(-(z**2) * t), j0(np.multiply.outer(z, r)), 1)


def solve(order, refine, steps, Bi, end):
    """(wall, processor, error, unknowns) of one mesh."""
    wall, cpu = time.perf_counter(), time.process_time()
    mesh = (MeshTri2 if order == 2 else MeshTri).init_circle(refine)
    basis = Basis(mesh, ElementTriP2() if order == 2 else ElementTriP1())
    exchange = BilinearForm(lambda u, v, w: Bi * u * v).assemble(FacetBasis(mesh, basis.elem))
    M, A, T, dt = mass.assemble(basis), laplace.assemble(basis) + exchange, np.ones(basis.N), end / steps
    lu = sl.splu((M + dt / 4 * A).tocsc())
    for _ in range(steps):
        k = []
        for row in STAGES:
            k.append(lu.solve(-(A @ (T + dt * sum(a * q for a, q in zip(row[:-1], k, strict=True))))))
        T = T + dt * sum(a * q for a, q in zip(STAGES[-1], k, strict=True))
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    x = basis.global_coordinates().value
    error = np.asarray(basis.interpolate(T)) - exact(np.hypot(*x), end, Bi)
    return wall, cpu, float(np.sqrt((error**2 * basis.dx).sum() / basis.dx.sum())), basis.N


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("order", type=int, choices=[1, 2])
    parser.add_argument("--biot", type=float, default=10.0)
    parser.add_argument("--end", type=float, default=0.2)
    parser.add_argument("--refine", type=int, nargs="*")
    given = parser.parse_args()
    for refine in given.refine or ([1, 2, 3, 4] if given.order == 2 else [2, 3, 4, 5]):
        steps = 4 + 2 * max(0, refine - 2)
        runs = [solve(given.order, refine, steps, given.biot, given.end) for _ in range(4)][1:]
        best = min(runs, key=lambda run: run[1])
        said = {"peer": f"scikit-fem P{given.order}", "unknowns": int(best[3]), "steps": steps, "seconds": best[0], "cpu": best[1], "error": best[2]}
        print(json.dumps(said), flush=True)
