"""Fitted finite elements (scikit-fem) on the slab of configs/studies/thermal_shock.yaml: what a user of one-way thermal stress would pick instead.

Length 1, kappa = R0 alpha = 1, 100 K cooler outside at once, Bi = 10 at one end, t = 0.02 to 0.1: heat alone, L-stable implicit Runge-Kutta of order 4 (Hairer
& Wanner); stress across follows from temperature, point by point. One line of JSON a mesh: unknowns, steps, wall and processor seconds of mesh, assembly and
solve (best of three after a warm-up), root-mean-square error of the stress across over its size, over the five times.
Needs scikit-fem, numpy, scipy; mpm needs none of this:  mpm chart configs/studies/thermal_shock.yaml --peer "P2=python configs/studies/peers/fem_slab.py 2"
"""

import argparse
import json
import time

import numpy as np
import scipy.sparse.linalg as sl
from fem_disc import STAGES
from scipy.optimize import brentq
from skfem import Basis, BilinearForm, ElementLineP1, ElementLineP2, FacetBasis, MeshLine
from skfem.models.poisson import laplace, mass

BIOT, FALL, TIMES = 10.0, 100.0, 0.02 * np.arange(1, 6)
YOUNG, POISSON, EXPANSION = 1.0, 0.3, 1e-8


def exact(x, t, terms=60):
    """The series of a slab that cools through one face, as part of the fall."""
    z = np.array([brentq(lambda z: z * np.sin(z) - BIOT * np.cos(z), n * np.pi, (n + 0.5) * np.pi) for n in range(terms)])
    c = 4 * np.sin(z) / (2 * z + np.sin(2 * z))
    return np.tensordot(c * np.exp(-(z**2) * t), np.cos(np.multiply.outer(z, x)), 1)


def across(T):
    """Stress held across and free along."""
    return -YOUNG * EXPANSION / (1 - POISSON) * FALL * (T - 1)


def solve(order, elements, steps):
    """(wall, processor, error, unknowns) of one mesh, `steps` between the times."""
    wall, cpu, found = time.perf_counter(), time.process_time(), []
    mesh = MeshLine(np.linspace(0, 1, elements + 1))
    basis = Basis(mesh, ElementLineP2() if order == 2 else ElementLineP1())
    exchange = BilinearForm(lambda u, v, w: BIOT * u * v).assemble(FacetBasis(mesh, basis.elem, facets=mesh.facets_satisfying(lambda x: x[0] > 1 - 1e-9)))
    M, A, T, dt = mass.assemble(basis), laplace.assemble(basis) + exchange, np.ones(basis.N), TIMES[0] / steps
    lu = sl.splu((M + dt / 4 * A).tocsc())
    for _ in TIMES:
        for _ in range(steps):
            k = []
            for row in STAGES:
                k.append(lu.solve(-(A @ (T + dt * sum(a * q for a, q in zip(row[:-1], k, strict=True))))))
            T = T + dt * sum(a * q for a, q in zip(STAGES[-1], k, strict=True))
        found.append(T)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    x, wrong, size = basis.global_coordinates().value[0], 0.0, 0.0
    for T, t in zip(found, TIMES, strict=True):
        wanted = across(exact(x, t))
        wrong += ((across(np.asarray(basis.interpolate(T))) - wanted) ** 2 * basis.dx).sum()
        size += (wanted**2 * basis.dx).sum()
    return wall, cpu, float(np.sqrt(wrong / size)), basis.N


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("order", type=int, choices=[1, 2])
    given = parser.parse_args()
    for elements, steps in ((4, 2), (8, 4), (16, 8), (32, 16)):
        best = min((solve(given.order, elements, steps) for _ in range(4)), key=lambda run: run[1])
        said = {"peer": f"scikit-fem P{given.order}", "unknowns": int(best[3]), "steps": 5 * steps, "seconds": best[0], "cpu": best[1], "error": best[2]}
        print(json.dumps(said), flush=True)
