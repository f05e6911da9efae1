"""Fitted finite elements (scikit-fem) on the beam of configs/studies/cantilever.yaml: what a user of small static deflections would pick instead.

Linear elasticity in plane strain, 1 x 0.2, E = 1e6, nu = 0.3, held at x = 0, R0 g = 29 downwards. One line of JSON a mesh: unknowns, wall and processor
seconds of mesh, assembly and solve (best of three after a warm-up), root-mean-square error of displacement over its size, against P2 on a mesh twice as fine as
the finest.
Needs scikit-fem, numpy, scipy; mpm needs none of this:  mpm chart configs/studies/cantilever.yaml --peer "P2=python configs/studies/peers/fem_beam.py 2"
"""

import argparse
import json
import time

import numpy as np
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, LinearForm, MeshTri, condense, solve
from skfem.models.elasticity import lame_parameters, linear_elasticity

LENGTH, HEIGHT, YOUNG, POISSON, WEIGHT = 1.0, 0.2, 1e6, 0.3, 29.0


def rest(order, across):
    """(basis, displacement) with `across` squares over the height, two triangles each."""
    mesh = MeshTri.init_tensor(np.linspace(0, LENGTH, 5 * across + 1), np.linspace(0, HEIGHT, across + 1))
    basis = Basis(mesh, ElementVector(ElementTriP2() if order == 2 else ElementTriP1()))
    lam, mu = lame_parameters(YOUNG, POISSON)
    K = linear_elasticity(lam, mu).assemble(basis)
    load = LinearForm(lambda v, w: -WEIGHT * v[1]).assemble(basis)
    return basis, solve(*condense(K, load, D=basis.get_dofs(lambda x: x[0] < 1e-12)))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("order", type=int, choices=[1, 2])
    given = parser.parse_args()
    meshes = (2, 4, 8, 16)
    fine, u = rest(2, 2 * meshes[-1])
    points = np.stack(np.meshgrid((np.arange(50) + 0.5) / 50 * LENGTH, (np.arange(10) + 0.5) / 10 * HEIGHT)).reshape(2, -1)
    wanted = fine.probes(points) @ u
    for across in meshes:
        runs = []
        for _ in range(4):
            wall, cpu = time.perf_counter(), time.process_time()
            basis, found = rest(given.order, across)
            runs.append((time.process_time() - cpu, time.perf_counter() - wall))
        cpu, wall = min(runs[1:])
        error = float(np.sqrt(np.mean((basis.probes(points) @ found - wanted) ** 2) / np.mean(wanted**2)))
        print(json.dumps({"peer": f"scikit-fem P{given.order}", "unknowns": int(basis.N), "seconds": wall, "cpu": cpu, "error": error}), flush=True)
