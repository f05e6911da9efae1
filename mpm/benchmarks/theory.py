"""What transfers do to a field by themselves, measured beside the line of theory: `python -m mpm.benchmarks.theory` draws docs/theory.png.

PIC of temperature      each transfer takes (kh)^2/4 of a mode: a fake conductivity R0 alpha h^2/(4 dt), larger for smaller steps (docs/physics.md 3)
APIC of temperature     each transfer takes 0.024 (kh)^4 with 2 particles a cell (docs/physics.md 3)
linear basis            particles that cross cells jump in force: at a strain of 0.3 refinement makes it worse (docs/physics.md 15, mode 1)

Measured: a 1-D insulated body at rest (so soft that heat alone limits the step), theta = cos kx at the start, its amplitude after N heat steps.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

KAPPA = 1e-6  # so little that the transfer's own damping is all there is
LENGTH = 1.0


@dataclass(frozen=True)
class Wave:
    """theta = 300 + cos(pi m x), which the scene starts from."""

    m: int
    starts: bool = True

    def __call__(self, x: np.ndarray, t: float) -> np.ndarray:
        return 300.0 + np.cos(math.pi * self.m * x[:, 0])


def scene(transfer: Any, cells: int, steps: int, dt: float, particles: int) -> Any:
    """The config of `steps` heat steps of `dt` seconds."""
    from mpm.config import load

    return load(
        {
            "grid": {"dimension": 1, "size": [LENGTH], "cell": LENGTH / cells},
            "bodies": {"bar": {"shape": {"box": {"lower": [0], "upper": [LENGTH]}}, "temperature": 300, "material": "soft"}},
            "materials": {"soft": {"density": 2, "elastic": {"hencky": {"lam": 1e-12, "mu": 1e-12}}, "heat": {"fourier": {"kappa": KAPPA, "alpha": 3}}}},
            "time": {"end": steps * dt},
            "output": {"every": steps * dt},
            "method": {"temperature": transfer, "heat_step": dt, "particles": particles},
        }
    )


def kept(transfer: Any, m: int, cells: int, steps: int, dt: float, particles: int = 2) -> float:
    """The fraction of the amplitude of cos(pi m x) that is left."""
    from mpm.scene.build import build
    from mpm.simulation import simulate

    made = build(scene(transfer, cells, steps, dt, particles), Wave(m))
    made.watch.exact = None
    run = simulate(made)
    if not run.outcome.ok or run.facts["heat_steps"] != steps:
        raise RuntimeError(f"{transfer}: {run.outcome}, {run.facts.get('heat_steps')} heat steps of {steps}")
    body = made.bodies[0]
    shape, V = np.cos(math.pi * m * body.particles.x[:, 0]), body.particles.V0
    return float(np.sum(V * shape * body.thermal.theta) / np.sum(V * shape**2))


def per_step(transfer: Any, m: int, cells: int, steps: int, dt: float) -> float:
    """The factor of the amplitude a step; without the first step, into which the exact gradients of the start still go."""
    return (kept(transfer, m, cells, steps + 1, dt) / kept(transfer, m, cells, 1, dt)) ** (1 / steps)


def fake_conductivity(dt: float, cells: int = 64, m: int = 4, steps: int = 20, transfer: Any = "pic") -> tuple[float, float]:
    """(measured, theory R0 alpha h^2/(4 dt)) [W/m/K] of PIC temperatures."""
    rate = -math.log(per_step(transfer, m, cells, steps, dt)) / (dt * (math.pi * m / LENGTH) ** 2)
    return 2 * 3 * rate - KAPPA, 2 * 3 * (LENGTH / cells) ** 2 / (4 * dt)


def loss(kh: float, steps: int = 40, transfer: Any = "apic", cells: int = 64) -> tuple[float, float]:
    """(kh as it is on this grid, what a mode loses a step) with APIC temperatures; the step is as good as zero, so conduction takes nothing."""
    m = max(1, round(kh * cells / math.pi))
    return math.pi * m / cells, 1 - per_step(transfer, m, cells, steps, 1e-6)


def strained(basis: str, cells: int, particles: int = 2) -> float:
    """Relative error of displacement of the manufactured 1-D motion at a strain of 0.31."""
    from mpm.config import load
    from mpm.runner import run_point

    data = {
        "grid": {"dimension": 1, "size": [1], "cell": 1 / cells, "basis": basis},
        "bodies": {"block": {"shape": {"box": {"lower": [0], "upper": [1]}}, "temperature": 1, "material": "made"}},
        "materials": {
            "made": {
                "density": 1.5,
                "elastic": {"hencky": {"lam": 2.1, "mu": 1.3}},
                "heat": {"fourier": {"kappa": 0.3, "alpha": 0.8}},
                "expansion": {"modulus": {"gamma": 0.07, "reference": 1}},
                "heating": {"elastic": {}},
            }
        },
        "time": {"end": 0.5},
        "method": {"particles": particles},
        "output": {"every": 0.1},
        "exact": {"manufactured": {"displacement": 0.1, "temperature": 0.2}},
    }
    run = run_point(load(data))
    return run.finals["error_displacement"] if run.outcome.ok else math.nan


def dataset(cells=(8, 16, 32, 64, 128)) -> Any:
    """All three, as an xarray.Dataset."""
    import xarray

    steps = 10.0 ** np.arange(-5, -0.9, 0.5)
    pic = np.array([fake_conductivity(float(dt)) for dt in steps])
    apic = np.array([loss(float(kh)) for kh in (0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 1.8)])
    bar = np.array([[strained(basis, n) for n in cells] for basis in ("linear", "quadratic", "cubic")])
    return xarray.Dataset(
        {
            "fake": ("dt", pic[:, 0], {"units": "W/m/K", "long_name": "fake conductivity of PIC temperatures"}),
            "fake_theory": ("dt", pic[:, 1], {"units": "W/m/K", "long_name": "R₀ α h²/(4 Δt)"}),
            "loss": ("kh", apic[:, 1], {"units": "1", "long_name": "loss of amplitude a step of APIC temperatures"}),
            "loss_theory": ("kh", 0.024 * apic[:, 0] ** 4, {"units": "1", "long_name": "0.024 (kh)⁴"}),
            "error": (("basis", "cells"), bar, {"units": "1", "long_name": "relative error of displacement at a strain of 0.31"}),
        },
        {"dt": steps, "kh": apic[:, 0], "basis": ["linear", "quadratic", "cubic"], "cells": list(cells)},
    )
