"""Affine FLIP over random arrangements and its spectral radius at the safe steps: `python -m mpm.benchmarks.affine [--count N] [--dimension 1 2 3]`.

Its nodes alone do not say what its particles keep (they keep their value and take the grid's slope), so mpm.benchmarks.operators has no closed form for it.
Particles carry theta and its slope c, or v, C and the strain; with P and Q the transfers of value and slope to the nodes, W back, b the blend,

    heat        t = P theta + Q c;  t+ = t - dt A t;  theta' = (1 - b) theta + W (t+ - t) + b W t;  c' = 4 d t+
    mechanics   the same for every component of v, with dt f/m in place of -dt A t;  eps' = eps + dt sym grad v+

Steps are those of mpm.integrate.timestep: CONDUCTION R0 alpha h^2/kappa, WAVE h sqrt(R0/(D lam + 2 mu)). blend = 1 is APIC, with its critical steps.
Fails when: a few particles of unequal (cut) volumes share a cell: their motion grows slowly at any step, as what they keep and what the grid makes of their
slopes part (with mls not in 1-D). The step is not at fault (docs/stability.md); the guard on energy ends such a run.
"""

import argparse
import time

import numpy as np

from mpm.benchmarks.operators import Cloud, random_cloud
from mpm.integrate.timestep import CONDUCTION, WAVE

BLEND = 0.02  # what configs take unless told otherwise
SLACK = 1e-6  # a manifold eigenvalue 1 (a body that flies and turns) is found to a root of the last bit


def radius(matrix: np.ndarray) -> float:
    """Largest magnitude of an eigenvalue."""
    return float(np.max(np.abs(np.linalg.eigvals(matrix))))


def parts(cloud: Cloud) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(to the nodes from value and slopes (n, N (1 + D)), value back (N, n), slopes back (N D, n))."""
    n, N, D = cloud.d.shape
    share = cloud.V / cloud.m[:, None]
    slopes = (cloud.d * share[:, :, None]).reshape(n, N * D)
    return np.concatenate([cloud.W * share, slopes], axis=1), cloud.W.T, 4.0 * cloud.d.reshape(n, N * D).T


def heat(cloud: Cloud, dt: float, blend: float = BLEND) -> np.ndarray:
    """The matrix of one explicit heat step; state (theta, c)."""
    up, down, slopes = parts(cloud)
    n, N, D = cloud.d.shape
    g = cloud.G.reshape(n, N * D)
    change = -dt * ((g * np.repeat(cloud.V, D)) @ (g.T @ up)) / cloud.m[:, None]
    kept = np.concatenate([np.eye(N), np.zeros((N, N * D))], axis=1)
    return np.concatenate([(1 - blend) * kept + down @ change + blend * down @ up, slopes @ (up + change)])


def mechanics(cloud: Cloud, gradient: str, lam: float, mu: float, dt: float, blend: float = BLEND) -> np.ndarray:
    """The matrix of one mechanical step; state (v, C, D v-components in turn, then D D strains)."""
    up, down, slopes = parts(cloud)
    n, N, D = cloud.d.shape
    g = cloud.G if gradient == "bspline" else cloud.L
    own = N * (1 + D)  # v and C of one component
    size = D * own + N * D * D
    at = lambda a, b: slice(D * own + (a * D + b) * N, D * own + (a * D + b + 1) * N)  # noqa: E731
    moved, rows = [], []
    for a in range(D):
        before, change = np.zeros((n, size)), np.zeros((n, size))
        before[:, a * own : (a + 1) * own] = up
        for b in range(D):
            push = -dt * g[:, :, b] * cloud.V / cloud.m[:, None]
            change[:, at(a, b)] += mu * push
            change[:, at(b, a)] += mu * push
            if a == b:
                for c in range(D):
                    change[:, at(c, c)] += lam * push
        kept = np.zeros((N, size))
        kept[:, a * own : a * own + N] = np.eye(N)
        rows += [(1 - blend) * kept + down @ change + blend * down @ before, slopes @ (before + change)]
        moved.append(before + change)
    for a in range(D):
        for b in range(D):
            strain = 0.5 * dt * (g[:, :, b].T @ moved[a] + g[:, :, a].T @ moved[b])
            strain[:, at(a, b)] += np.eye(N)
            rows.append(strain)
    return np.concatenate(rows)


def search(D: int, count: int, seed: int = 0, blend: float = BLEND) -> dict[str, tuple[float, float]]:
    """(largest radius less 1, share of the arrangements that grow) at the safe steps, over `count` random arrangements."""
    rng, found = np.random.default_rng(seed), {"heat": [], "mechanics mls": [], "mechanics bspline": []}
    for _ in range(count):
        cloud, nu = random_cloud(rng, D), float(rng.choice([0.0, 0.3, 0.49, rng.uniform(0.0, 0.499)]))
        lam, mu = nu / ((1 + nu) * (1 - 2 * nu)), 0.5 / (1 + nu)
        step = WAVE / np.sqrt(D * lam + 2.0 * mu)
        found["heat"].append(radius(heat(cloud, CONDUCTION, blend)))
        for gradient in ("mls", "bspline"):
            found[f"mechanics {gradient}"].append(radius(mechanics(cloud, gradient, lam, mu, step, blend)))
    return {name: (float(np.max(radii) - 1), float(np.mean(np.array(radii) > 1 + SLACK))) for name, radii in found.items()}


def main() -> None:
    """The most growth, a dimension a line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--dimension", type=int, nargs="*", default=[1, 2, 3])
    parser.add_argument("--blend", type=float, default=BLEND)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    for D in asked.dimension:
        began = time.process_time()
        found = search(D, asked.count, asked.seed, asked.blend)
        said = ", ".join(f"{name} {most:.1e} ({100 * share:.2g} %)" for name, (most, share) in found.items())
        print(f"{D}-D, {asked.count} arrangements ({time.process_time() - began:.0f} s), most growth a step (how many grow): {said}", flush=True)


if __name__ == "__main__":
    main()
