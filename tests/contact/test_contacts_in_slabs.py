"""Contacts and heat steps of scenes in slabs: the same bits for any number of threads, the physics of one thread without slabs."""

import numpy as np
import pytest

import mpm
from mpm.contact import solve_threaded, step_threaded
from mpm.integrate import heat_threaded, sorting
from mpm.scene.build import build
from mpm.simulation import simulate

pytestmark = pytest.mark.plain
H = 0.125


def scene(heat, several):
    """A warm slab that lands on the floor, or on another on the floor, cooled all round."""
    shapes = {"a": (0.3, 0.002, 1.9, 0.252, -0.5)} | ({"b": (0.55, 0.27, 1.9, 0.52, -1.0)} if several else {})
    bodies = {name: {"shape": {"box": {"lower": [left, low], "upper": [right, high]}}, "material": "m", "temperature": 400, "velocity": [0.1, v]}
              for name, (left, low, right, high, v) in shapes.items()}  # fmt: skip
    return mpm.load({
        "grid": {"dimension": 2, "size": [3.0, 1.0], "cell": H}, "bodies": bodies,
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 300, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}}}},
        "surfaces": [{"of": name, "convection": {"beta": 1.0, "outside": 300}, "radiation": {"emissivity": 0.9, "surroundings": 300}} for name in bodies],
        "method": {"frame": "updated", "heat": heat, "particles": 2, "heat_step": 2e-3},
        "walls": {"bottom": "slip" if several else "contact"}, "gravity": [0, -1.0],
        "contacts": [{"between": ["a", "b"], "conductance": 0}] if several else [],
        "time": {"end": 0.004, "step": 1e-3},
        "output": {"every": 0.004, "snapshots": {"every": 0.004, "particles": ["position", "velocity", "temperature"]}},
    })  # fmt: skip


def played(experiment, threads):
    """(scene, every array of its run)."""
    made = build(experiment)
    made.threads = threads
    run = simulate(made)
    assert run.outcome.ok, run.outcome
    assert made.meeting.touching.warm.any()
    return made, {**run.series, **{f"{name} {k}": values for k, frame in enumerate(run.particles) for name, values in frame.items()}}


@pytest.mark.parametrize(("heat", "several"), [pytest.param("explicit", True, marks=pytest.mark.wide), ("stabilised", False)])
def test_the_same_bits_for_any_number_of_threads(monkeypatch, heat, several):
    monkeypatch.setattr(sorting, "SHARED", 1)
    monkeypatch.setattr(sorting, "FULL", 1)
    monkeypatch.setattr(step_threaded, "PART", 3)
    monkeypatch.setattr(solve_threaded, "PART", 3)
    experiment = scene(heat, several)
    runs = [played(experiment, threads) for threads in (1, 3)]
    assert runs[0][0].order.starts.shape[1] > 3 and heat_threaded.shared(runs[0][0], 0)
    first, other = runs[0][1], runs[1][1]
    assert all(np.asarray(first[name]).tobytes() == np.asarray(other[name]).tobytes() for name in first)
    monkeypatch.setattr(sorting, "SHARED", 10**9)
    made, whole = played(experiment, 1)
    assert not made.order.shared
    for name, values in whole.items():
        scale = max(1.0, np.abs(values).max(initial=0.0))
        assert np.allclose(first[name], values, rtol=0, atol=1e-5 * scale), name  # sweeps go in another order, and end at 1e-7 of the speed of sound


def test_slabs_that_share_nodes_go_one_after_another(monkeypatch):
    """Particles that drifted past their slab: the same bits, by one thread."""
    monkeypatch.setattr(sorting, "SHARED", 1)
    monkeypatch.setattr(sorting, "FULL", 1)
    asked, apart = [], step_threaded.apart

    def never(*about):
        asked.append(apart(*about))
        return False

    _, first = played(scene("stabilised", False), 1)
    monkeypatch.setattr(step_threaded, "apart", never)
    _, other = played(scene("stabilised", False), 3)
    assert asked and all(asked)
    assert all(np.asarray(first[name]).tobytes() == np.asarray(other[name]).tobytes() for name in first)
