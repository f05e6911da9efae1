"""Hot walls: a pan heats what stands on it and what falls on it, and nothing that hangs over it."""

import numpy as np
import pytest

import mpm
from mpm.scene.build import build

pytestmark = pytest.mark.plain


def pan(lower, beta=50.0, air=True):
    """A block `lower` above the floor of a plane scene, whose floor is a pan at 450 K."""
    solid = {"density": 2.0, "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}}, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.5}}}
    return mpm.load(
        {
            "grid": {"dimension": 2, "size": [1.0, 1.0], "cell": 0.125},
            "bodies": {"block": {"shape": {"box": {"lower": [0.3, lower], "upper": [0.7, lower + 0.4]}}, "temperature": 300, "material": "solid"}},
            "materials": {"solid": solid},
            "surfaces": [{"of": "block", "convection": {"beta": 5.0, "outside": 300}}] if air else [],
            "walls": {"bottom": {"stick": {"heat": {"beta": beta, "temperature": 450}}}},
            "time": {"end": 0.05},
            "output": {"every": 0.05},
        }
    )


def test_a_pan_heats_what_touches_it():
    scene = build(pan(0.0))
    surface = scene.bodies[0].surface
    hot = surface.outside == 150.0
    assert np.allclose(np.abs(surface.area[hot].sum(axis=0)), [0, 0.4]) and np.all(surface.beta[~hot] == pytest.approx(5.0, rel=2e-3))
    assert surface.beta[hot] == pytest.approx(50.0, rel=2e-2) and np.all(surface.outside[~hot] == 0.0)
    found = ended(pan(0.0))
    assert found["heat_exchanged"] > 0 and found["temperature_max"] > 310


def test_a_pan_does_not_heat_what_hangs_over_it():
    assert not np.any(build(pan(0.2)).bodies[0].surface.outside == 150.0)
    assert ended(pan(0.2, air=False), 1.0)["heat_exchanged"] == 0.0


def test_a_pan_heats_what_falls_on_it():
    """From where its face touches (0.05 cells, 0.00625), and not before."""
    data = pan(0.1, air=False).resolved()
    data["bodies"]["block"]["velocity"], data["time"], data["output"] = [0.0, -0.5], {"end": 0.3}, {"every": 0.02}
    run = mpm.run_point(mpm.load(data))
    face, taken = run.series["position_min_y"], run.series["heat_exchanged"]
    assert run.outcome.ok and np.sum(face > 0.007) > 3 and np.sum(face < 0.005) > 2
    assert np.all(taken[face > 0.007] == 0.0) and np.all(np.diff(taken[face < 0.005]) > 0)
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * taken[-1] and run.finals["temperature_max"] > 400


def ended(experiment, ledger=1e-12):
    run = mpm.run_point(experiment)
    assert run.outcome.ok
    assert abs(run.finals["heat_ledger"]) <= ledger * abs(run.finals["heat_exchanged"])
    return run.finals
