"""Return maps: error against nanoseconds a state (docs/chart_return_map.png, by `python -m mpm.benchmarks.figures return_map`).

States outside the ellipse are held for a time; a map takes it in 1, 2, 4, ... implicit Euler steps. Error: root mean square over the states of (p, q)/M against
the rate equations (docs/physics.md 5.3), integrated to 1e-10 by a Runge-Kutta method of order 8. Time: least of the rounds, interleaved, per state.
The sample: p0 in 0.3 .. 3, K t/eta in 0.1 .. 10, |p|/(p0 M) in 1.05 .. 3, q/M in 0.05 .. 0.95 (so that both maps are defined), even in logarithms.
"""

import os
import time
from typing import Any

import numpy as np

STEPS = (1, 2, 4, 8, 16, 32, 64, 128)
M, MU, LAM = 1000.0, 1.6e5, 2.2e5
K = LAM + 2 * MU / 3


def states(count: int, seed: int = 5) -> tuple[np.ndarray, ...]:
    """(strains (N, 3), p0 (N,), eta (N,), p (N,), q (N,)); held for one second."""
    random = np.random.default_rng(seed)
    p0, number, over, shear = np.exp(random.uniform(*np.log([[0.3, 0.1, 1.05, 0.05], [3.0, 10.0, 3.0, 0.95]]), (count, 4))).T
    p, q = over * p0 * M * random.choice([-1, 1], count), shear * M
    angle = random.uniform(0, 2 * np.pi, count)
    axes = np.sqrt(2 / 3) * np.cos(angle[:, None] + np.array([0, 2, 4]) * np.pi / 3)  # deviators of norm 1
    return -p[:, None] / (3 * K) + q[:, None] / (np.sqrt(6) * MU) * axes, p0, K / number, p, q


def relaxed(p: np.ndarray, q: np.ndarray, p0: np.ndarray, eta: np.ndarray, form: str) -> np.ndarray:
    """(p, q) after one second at held strain, (2, N)."""
    from scipy.integrate import solve_ivp

    def rates(_, state):
        p, q = state.reshape(2, -1)
        if form == "radial":
            s = np.sqrt(p**2 / p0**2 + q**2) / M
            over, by_p, by_q = np.maximum(s - 1, 0), p / (p0**2 * M**2 * s), q / (M**2 * s)
        else:
            room = np.sqrt(np.maximum(M**2 - q**2, 1e-6 * M**2))  # stages of the integrator may overshoot
            over, by_p, by_q = np.maximum(np.abs(p) / (p0 * room) - 1, 0), np.sign(p) / (p0 * room), np.abs(p) * q / (p0 * room**3)
        return np.concatenate([-K * M**2 / eta * over * by_p, -3 * MU * M**2 / eta * over * by_q])

    with np.errstate(over="ignore", invalid="ignore"):  # trial stages that the integrator rejects
        return solve_ivp(rates, (0.0, 1.0), np.concatenate([p, q]), method="DOP853", rtol=1e-10, atol=1e-12 * M).y[:, -1].reshape(2, -1)


def mapped(e: np.ndarray, p0: np.ndarray, eta: np.ndarray, form: str, steps: int) -> tuple[np.ndarray, float]:
    """(strains after one second in `steps` steps, processor seconds a state)."""
    from mpm.materials.return_maps import map_all

    ones = np.ones_like(p0)
    out, held = np.empty_like(e), e.copy()
    began = time.process_time()
    for _ in range(steps):
        if map_all(held, LAM * ones, MU * ones, M * ones, p0, eta, ones / steps, 0 * ones, form == "clipped", out) >= 0:
            raise ArithmeticError(f"{form}: a state was not mapped")
        held, out = out, held
    return held, (time.process_time() - began) / len(e)


def stresses(e: np.ndarray) -> np.ndarray:
    """(p, q) of strains, (2, N)."""
    e = e.astype(float)
    return np.stack([-K * e.sum(axis=1), np.sqrt(6) * MU * np.linalg.norm(e - e.mean(axis=1, keepdims=True), axis=1)])


def dataset(count: int = 4096, rounds: int = 7) -> Any:
    """Errors and times in the form of a chart (mpm.plots.chart)."""
    import xarray

    from mpm.study.front import pareto

    strains, p0, eta, p, q = states(count)
    kinds = [(f"{form}, {np.dtype(dtype).name}", form, dtype) for form in ("radial", "clipped") for dtype in (np.float64, np.float32)]
    true = {form: relaxed(p, q, p0, eta, form) for form in ("radial", "clipped")}
    rows = [(name, form, dtype, steps) for name, form, dtype in kinds for steps in STEPS]
    arrays = {dtype: tuple(array.astype(dtype) for array in (strains, p0, eta)) for dtype in (np.float64, np.float32)}
    error, seconds, load = np.zeros(len(rows)), np.zeros((len(rows), rounds)), []
    for _, form, dtype in kinds:
        mapped(*arrays[dtype], form, 1)  # compiles
    for k in range(rounds):
        load.append(os.getloadavg()[0])
        for i, (_, form, dtype, steps) in enumerate(rows):
            held, seconds[i, k] = mapped(*arrays[dtype], form, steps)
            error[i] = np.sqrt(np.mean(np.sum((stresses(held) - true[form]) ** 2, axis=0))) / M
    least = seconds.min(axis=1)
    names = np.array([row[0] for row in rows], dtype=object)
    data = {
        "relative_error": ("setting", error, {"units": "1", "long_name": "error of (p, q)/M, root mean square over the states", "reference_error": 1e-10}),
        "cpu_time": (("setting", "round"), seconds, {"units": "s", "long_name": "processor time a state"}),
        "cpu_min": ("setting", least, {"units": "s"}),
        "cpu_median": ("setting", np.median(seconds, axis=1), {"units": "s"}),
        "front": ("setting", pareto(error, least).astype(np.int8)),
        "compiling": ("setting", np.full(len(rows), np.nan), {"units": "s"}),
        "error": ("setting", np.full(len(rows), "", dtype=object)),
        "load": ("round", np.array(load)),
    }
    coords = {"method": ("setting", names), "path": ("setting", np.full(len(rows), "", dtype=object)), "place": ("setting", np.array([row[3] for row in rows]))}
    return xarray.Dataset(data, coords, {"title": "Return maps, 1 to 128 steps a relaxation", "time_of": "a state"})
