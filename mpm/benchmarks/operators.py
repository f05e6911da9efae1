"""Critical steps of particle arrangements, exactly: `python -m mpm.benchmarks.operators [--count N] [--dimension 1 2 3] [--json FILE]`.

The weights are those of mpm.basis, the safe steps those of mpm.integrate.timestep. With M the nodal masses, K = sum V B^T C B, A = M^-1/2 K M^-1/2 and the
transfer there and back on the nodes T = M^-1/2 (W V W^T) M^-1/2 (APIC: with its slopes, S), one step from the nodes to the nodes is

    heat        theta' = X theta - dt T A theta                     APIC X = T = S; PIC X = T; FLIP X = 1; XPIC(m) X = 1 - (1 - T)^m
    mechanics   w = u + dt a;  u' = X u + T dt a (APIC, PIC: T w);  a' = a - dt A w

The symmetric pencils of both meet the circle at z = -1 first (their roots have product at most 1 where 0 <= T <= 1), so the critical steps are

    heat        dt   = 1/lambda_max(R A R),  R^2 = T/(1 + X)
    mechanics   dt^2 = 2/lambda_max(R A R),  R^2 = 1 - T/(1 + X)

mpm.benchmarks.coupled builds the whole step of the particles and takes its spectral radius; tests/benchmarks/test_operators.py compares the two, for XPIC
too, where the argument does not cover roots off the real axis. The blocks are at rest and unstressed: loads, strain and motion have limits of their own.
"""

import argparse
import json
import sys
import time

import numpy as np

from mpm.basis import stencil
from mpm.integrate.heat_chebyshev import DAMPING
from mpm.integrate.timestep import CONDUCTION, SUBSTEPS, WAVE
from mpm.jit import kernel
from mpm.state import PAD, Quadratic

METHODS = ("APIC", "PIC", "FLIP", "XPIC(2)")
ROOM = {1: 9, 2: 6, 3: 5}  # nodes a direction that hold a cloud
MOST_PARTICLES = {1: 8, 2: 5, 3: 3}  # particles in a cloud


@kernel
def dense(basis, x, n):
    """Weights, gradients, mls gradients and offsets (nodes, N, ...) of particles x (N, D) in cells, on n nodes a direction, the first at -1; wraps round."""
    N, D = x.shape
    W, G, L, d = np.zeros((n**D, N)), np.zeros((n**D, N, D)), np.zeros((n**D, N, D)), np.zeros((n**D, N, D))
    for p in range(N):
        for corner in range(3**D):
            node, w, rest = 0, 1.0, corner
            weight, slope, fit, away = np.ones(3), np.zeros(3), np.zeros(3), np.zeros(3)
            for a in range(D):
                first, values, slopes, offsets, fits = stencil(basis, x[p, a])
                k = rest % 3
                rest //= 3
                node = node * n + (first - PAD + 1 + k) % n
                weight[a], slope[a], fit[a], away[a] = values[k], slopes[k], fits[k], offsets[k]
                w *= weight[a]
            W[node, p] += w
            for a in range(D):
                others = 1.0
                for b in range(D):
                    if b != a:
                        others *= weight[b]
                G[node, p, a] += others * slope[a]
                L[node, p, a] += others * fit[a]
                d[node, p, a] += w * away[a]
    return W, G, L, d


def functions(X: str, s: np.ndarray) -> np.ndarray:
    """X as a function of T's eigenvalues."""
    return {"APIC": s, "PIC": s, "FLIP": np.ones_like(s), "XPIC(2)": 1.0 - (1.0 - s) ** 2}[X]


def modes(P: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(eigenvalues, vectors) of P P^T that are not zero, at most 1 by the partition of unity."""
    U, s, _ = np.linalg.svd(P, full_matrices=False)
    return np.clip(s * s, 0.0, 1.0), U


def top(B: np.ndarray) -> float:
    """Largest eigenvalue of B B^T, from the smaller of the two products."""
    return float(np.linalg.eigvalsh(B @ B.T if B.shape[0] < B.shape[1] else B.T @ B)[-1])


class Cloud:
    """One arrangement of particles on quadratic B-splines; cell and density are 1."""

    def __init__(self, x: np.ndarray, V: np.ndarray, n: int | None = None):
        self.D = x.shape[1]
        W, self.G, self.L, d = dense(Quadratic(), np.ascontiguousarray(x, dtype=float), n or ROOM[self.D])
        m = W @ V
        held = m > 0
        self.root = 1.0 / np.sqrt(m[held])
        self.W, self.G, self.L, d = W[held], self.G[held], self.L[held], d[held]
        self.V, self.m, self.d = V, m[held], d
        P = self.root[:, None] * self.W * np.sqrt(V)
        Q = (self.root[:, None, None] * d * (2.0 * np.sqrt(V))[:, None]).reshape(len(self.root), -1)  # sum w d^2 = 1/4
        self.plain, self.affine = modes(P), modes(np.concatenate([P, Q], axis=1))
        self.kept: dict[str, np.ndarray] = {}

    def largest(self, B: np.ndarray, name: str, method: str, heat: bool) -> float:
        """lambda_max(R A R) with A = B B^T; B (nodes, parts, strains): the components share R."""
        s, U = self.affine if method == "APIC" else self.plain
        ratio = s / (1.0 + functions(method, s))
        n, parts, strains = B.shape
        seen = (U.T @ B.reshape(n, -1)).reshape(-1, strains)
        if heat:
            return max(top(np.sqrt(ratio)[:, None] * seen), 1e-12)  # a lone particle of PIC or FLIP conducts nothing to itself
        gram = seen.T @ (np.repeat(ratio, parts)[:, None] * seen)
        if name not in self.kept:
            self.kept[name] = B.reshape(-1, strains).T @ B.reshape(-1, strains)
        return float(np.linalg.eigvalsh(self.kept[name] - gram)[-1])

    def heat(self, method: str, gradient: str = "bspline") -> float:
        """Critical dt kappa/(R0 alpha h^2) of a step that ends in a transfer; `grid`: of the nodes alone."""
        g = self.G if gradient == "bspline" else self.L
        B = (self.root[:, None, None] * g * np.sqrt(self.V)[:, None]).reshape(len(self.root), 1, -1)
        if method == "grid":
            return 2.0 / top(B[:, 0])
        return 1.0 / self.largest(B, "", method, True)

    def strains(self, gradient: str, lam: float, mu: float) -> np.ndarray:
        """(nodes, D, strains): M^-1/2 B^T sqrt(C V)."""
        g = self.root[:, None, None] * (self.G if gradient == "bspline" else self.L) * np.sqrt(self.V)[:, None]
        n, N, D = g.shape
        rows = []
        for a in range(D):
            row = np.zeros((n, D, N))
            row[:, a] = g[:, :, a] * np.sqrt(2.0 * mu)
            rows.append(row)
            for b in range(a):
                row = np.zeros((n, D, N))
                row[:, a], row[:, b] = g[:, :, b] * np.sqrt(mu), g[:, :, a] * np.sqrt(mu)
                rows.append(row)
        rows.append(np.moveaxis(g, 2, 1) * np.sqrt(lam))
        return np.concatenate(rows, axis=2)

    def mechanics(self, method: str, gradient: str, lam: float, mu: float) -> float:
        """Critical dt sqrt(.../R0)/h of a step, as a multiple of h/sqrt((D lam + 2 mu)/R0)."""
        name = f"strains {gradient} {lam} {mu}"
        if name not in self.kept:
            self.kept[name] = self.strains(gradient, lam, mu)
        worst = self.largest(self.kept[name], f"A {gradient} {lam} {mu}", method, False)
        return float(np.sqrt(2.0 / worst * (self.D * lam + 2.0 * mu)))


def substeps(cloud: Cloud, method: str, dt: float, count: int) -> float:
    """Spectral radius of `count` sub-steps of the nodes and one transfer (APIC, FLIP)."""
    B = (cloud.root[:, None, None] * cloud.G * np.sqrt(cloud.V)[:, None]).reshape(len(cloud.root), -1)
    powers = np.linalg.matrix_power(np.eye(len(B)) - dt * (B @ B.T), count)
    s, U = cloud.affine if method == "APIC" else cloud.plain
    S = (U * s) @ U.T
    step = S @ powers if method in ("APIC", "PIC") else np.eye(len(B)) + S @ (powers - np.eye(len(B)))
    return float(np.max(np.abs(np.linalg.eigvals(step))))


def stabilised(cloud: Cloud, method: str, dt: float, count: int) -> float:
    """Spectral radius of a Runge-Kutta-Chebyshev step of `count` stages on the nodes (mpm.integrate.heat_chebyshev) and one transfer (APIC, PIC, FLIP)."""
    T = np.polynomial.chebyshev.Chebyshev([0.0] * count + [1.0])
    w0 = 1.0 + DAMPING / count**2
    first, second = T.deriv()(w0), T.deriv(2)(w0)
    b = second / first**2
    B = (cloud.root[:, None, None] * cloud.G * np.sqrt(cloud.V)[:, None]).reshape(len(cloud.root), -1)
    rates, modes = np.linalg.eigh(B @ B.T)
    polynomial = (modes * (1.0 - b * T(w0) + b * T(w0 - first / second * dt * rates))) @ modes.T
    s, U = cloud.affine if method == "APIC" else cloud.plain
    S, one = (U * s) @ U.T, np.eye(len(B))
    return float(np.max(np.abs(np.linalg.eigvals(S @ polynomial if method in ("APIC", "PIC") else one + S @ (polynomial - one)))))


def random_cloud(rng: np.random.Generator, D: int) -> Cloud:
    """Few particles close together, many apart, pairs, jittered lattices; whole and cut volumes."""
    kind, N = rng.integers(4), int(rng.integers(1, MOST_PARTICLES[D] + 1))
    extent = {1: 6.0, 2: 3.0, 3: 2.0}[D]
    if kind == 0:
        x = rng.uniform(0, 1, (N, D)) * rng.uniform(0.05, 1.0) * extent
    elif kind == 1:  # pairs and triples almost on one place
        x = rng.uniform(0, extent, D) * 0.6 + rng.normal(0, 10 ** rng.uniform(-3, -0.3), (N, D))
    elif kind == 2:
        side = int(np.ceil(N ** (1 / D)))
        x = np.stack(np.meshgrid(*[np.arange(side)] * D, indexing="ij"), -1).reshape(-1, D)[:N] * 0.5 + rng.uniform(0, 1, D) + rng.uniform(-0.25, 0.25, (N, D))
    else:
        x = rng.uniform(0, extent, (N, D))
    V = np.ones(N) if rng.integers(2) else 10.0 ** rng.uniform(-2, 0, N)
    low = x.min(axis=0)
    x = x - np.floor(low) + 1.0
    return Cloud(np.clip(x, 1.0, ROOM[D] - 2.5), V)


def search(D: int, count: int, seed: int = 0, told=None) -> dict:
    """Least critical steps over `count` random arrangements, over the safe steps of mpm.integrate.timestep; below 1 would be unsafe."""
    rng, worst = np.random.default_rng(seed), {}
    began = time.perf_counter()
    for number in range(count):
        cloud = random_cloud(rng, D)
        nu = rng.choice([0.0, 0.3, 0.49, rng.uniform(-0.5, 0.499)])
        lam, mu = nu / ((1 + nu) * (1 - 2 * nu)), 0.5 / (1 + nu)
        found = {f"heat {method}": cloud.heat(method) for method in (*METHODS, "grid")}
        if lam >= 0:
            found |= {f"mechanics {method} {g}": cloud.mechanics(method, g, lam, mu) for method in METHODS for g in ("mls", "bspline")}
        for name, value in found.items():
            worst[name] = min(worst.get(name, np.inf), value)
        if told and number % 2000 == 1999:
            told(f"{D}-D: {number + 1} of {count}, {time.perf_counter() - began:.0f} s")
    return {"dimension": D, "count": count, "seconds": time.perf_counter() - began, "worst": worst}


def regular(D: int, particles: int = 2, cells: int = 12) -> Cloud:
    """A lattice that fills a periodic grid: `particles` a cell and direction."""
    n = cells if D == 1 else 6
    place = (np.arange(n * particles) + 0.5) / particles
    x = np.stack(np.meshgrid(*[place] * D, indexing="ij"), -1).reshape(-1, D) + 0.5
    return Cloud(x, np.ones(len(x)), n)


def main(arguments=None) -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m mpm.benchmarks.operators", description="Critical steps of random and regular arrangements.")
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--dimension", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", default="")
    asked = parser.parse_args(arguments)
    found = []
    for D in asked.dimension:
        one = regular(D)
        table = {"heat grid": one.heat("grid"), "heat grid mls": one.heat("grid", "mls")}
        table |= {f"heat {method}": one.heat(method) for method in METHODS}
        table |= {f"mechanics {method} {g}": one.mechanics(method, g, 0.2, 0.4) for method in METHODS for g in ("mls", "bspline")} if D == 1 else {}
        found.append({**search(D, asked.count, asked.seed, lambda text: print(text, file=sys.stderr)), "regular": table})
        print(f"\n{D}-D, regular 2 a cell: " + ", ".join(f"{name} {value:.3f}" for name, value in table.items()))
        print(
            f"{D}-D, least of {asked.count} random arrangements ({found[-1]['seconds']:.0f} s); safe are {CONDUCTION} for heat, "
            f"{SUBSTEPS * CONDUCTION:.2f} where it takes sub-steps (grid), and {WAVE} for mechanics:"
        )
        for name, value in found[-1]["worst"].items():
            safe = SUBSTEPS * CONDUCTION if name == "heat grid" else CONDUCTION if name.startswith("heat") else WAVE
            print(f"  {name:28} {value:.4f}   {value / safe:.2f} of the safe step{'' if value >= safe else '   BELOW'}")
    if asked.json:
        with open(asked.json, "w", encoding="utf-8") as file:
            json.dump(found, file, indent=1)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
