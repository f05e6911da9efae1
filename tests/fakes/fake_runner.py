"""A runner that computes nothing and fails on demand: the conductivity of material `m` says how. Needs neither numba nor the model."""

import os
import signal
import sys
import time
from pathlib import Path

import numpy as np

from mpm.outcome import INVERTED, Outcome, Run, outcome
from mpm.warned import warning

NEEDS = ()  # no numba: these tests start many workers
RAISES, DIES, HANGS, SLOW, DIVERGES, DIES_ONCE, EXITS, BRIEF = 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0
GROWS, GRABS, WARNS = 11.0, 12.0, 10.0
WARNINGS = [warning("volume", "48 % of the volume is lost"), warning("temperature", "block: 7 % out of range")]


def slab(axes, **output):
    """Config of a slab that it pretends to run, with the temperature on the grid every 2 s."""
    return {
        "grid": {"dimension": 1, "size": [0.1], "cell": 1e-3},
        "bodies": {"s": {"shape": {"box": {"lower": [0], "upper": [0.05]}}, "material": "m", "temperature": 300}},
        "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
        "time": {"end": 10},
        "output": {"every": 1, "snapshots": {"every": 2, "grid": ["temperature"]}} | output,
        "sweep": {"axes": axes},
    }


def mark(text):
    """Leave a line where the test looks, if it does."""
    if folder := os.environ.get("FAKE_MARKS"):
        with open(Path(folder) / "marks", "a") as file:
            file.write(f"{text} {os.getpid()}\n")


def warm(experiment):
    mark("warm")


def physics(experiment):
    return {"compiled": ["heat"], "absent": ["mechanics", "flow"]}


def estimate(experiment):
    return {
        "particles": 100,
        "unknowns": 51,
        "steps": 10,
        "seconds": 0.5,
        "memory_bytes": 1e6,
        "output_bytes": 2e4,
        "limits": {"conduction": 0.25, "exchange": 0.5},
        "binds": "conduction",
        "physics": physics(experiment),
    }


def run_point(experiment, beat=None, keeper=None):
    kappa = experiment.materials["m"].heat.kappa.value
    end, every = experiment.time.end, experiment.output.every
    mark(f"run {kappa}")
    times = np.arange(round(end / every) + 1) * every
    if kappa == RAISES:
        raise ValueError("no such luck\nsecond line")
    if kappa == DIES:
        os.kill(os.getpid(), signal.SIGKILL)
    if DIES_ONCE <= kappa < EXITS and Path(os.environ["FAKE_MARKS"], "marks").read_text().count(f"run {kappa} ") < 2:
        os.kill(os.getpid(), signal.SIGKILL)
    if kappa == EXITS:
        print("out of tea", file=sys.stderr, flush=True)
        os._exit(5)
    if kappa == GROWS:
        kept = []
        while len(kept) < 100:
            kept.append(np.ones(2_000_000))
            time.sleep(0.05)
    if kappa == GRABS:
        np.ones(1_000_000_000)
    if kappa == HANGS:
        time.sleep(60)
    ending = Outcome("completed")
    if kappa == DIVERGES:
        times, ending = times[: len(times) // 2], outcome(INVERTED, particle=812, time=0.0134, step=2680)
    if kappa == SLOW or kappa >= BRIEF:
        found = keeper.found if keeper is not None else None
        first = found["step"] if found else 0
        mark(f"from {first}")
        for step in range(first, 3000 if kappa == SLOW else 100):
            time.sleep(0.01)
            stop = beat(step / 3000, step * 0.01)
            if keeper is not None and keeper.due(stop):
                keeper.save({"step": step + 1})
            if stop:
                times, ending = times[:3], Outcome("budget", f"stopped at t = {step * 0.01:.3g} s")
                break
    elif beat is not None:
        beat(0.5, end / 2)
    series = {"temperature_centre": 300 + kappa * times, "heat_ledger": 0 * times}
    finals = {"temperature_mean": 300 + kappa, "time_to_centre_95_degC": 1 / kappa}
    run = Run(ending, times, series, finals, steps=10, wall_time=0.01, facts={"binds": "conduction"} | ({"warnings": WARNINGS} if kappa == WARNS else {}))
    if experiment.output.snapshots is not None:
        run.snapshot_times = times[::2]
        run.axes = {"x": np.linspace(0, 0.1, 5)}
        run.grid = {"temperature": np.full((len(times[::2]), 5), kappa, dtype=np.float32)}
        run.particles = [{"position": np.full((2 + i, 1), kappa), "body": np.zeros(2 + i, dtype=int)} for i in range(len(times[::2]))]
    return run
