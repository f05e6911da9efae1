"""Several bodies on one grid: what they exchange where they touch, and nothing while they are apart."""

import numpy as np
import pytest

pytestmark = pytest.mark.plain


def two(core, names, velocities=(0.6, 0.0), places=(0.6, 1.5)):
    """A hot flowing body and a cold elastic one without heat, on one grid."""
    materials = {
        "dough": core.config(1)["materials"]["solid"] | {"flow": {"ellipse": {"M": 0.05, "p0": 1.0, "eta": 0.2}}, "heating": {"dissipation": {}}},
        "rubber": {"density": 1.0, "elastic": {"hencky": {"lam": 1.0, "mu": 1.0}}},
    }
    bodies = {
        name: {"shape": {"box": {"lower": [place], "upper": [place + 0.6]}}, "temperature": t, "material": name, "velocity": [v]}
        for name, place, t, v in zip(("dough", "rubber"), places, (core.HOT, core.COLD), velocities, strict=True)
        if name in names
    }
    surfaces = [{"of": "dough", "convection": {"beta": 0.5, "outside": 300}}] if "dough" in names else []
    return core.experiment(
        1,
        {"time.step": 0.02, "method.heat_step": 0.1, "time.end": 1.5},
        grid={"dimension": 1, "size": [4.5], "cell": 0.25},
        bodies=bodies,
        materials={name: materials[name] for name in bodies},
        surfaces=surfaces,
    )


def test_two_bodies_meet(core):
    """They exchange momentum where they touch and nothing is lost; the flowing one dissipates, and its heat is accounted for."""
    scene, run = core.play(two(core, ("dough", "rubber")))
    assert run.outcome.ok
    assert np.allclose(run.series["momentum_x"], run.series["momentum_x"][0], rtol=1e-13)
    assert scene.bodies[1].particles.v.mean() > 0.05, "the second should have been pushed"
    assert run.series["dissipation_total"][-1] > 1e-4 and np.all(np.diff(run.series["dissipation_total"]) >= 0)
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()


def test_bodies_apart_do_not_feel_each_other(core):
    """Each does in company what it does alone."""
    velocities, places = (0.2, -0.3), (0.6, 3.0)
    both = core.play(two(core, ("dough", "rubber"), velocities, places))[0]
    for index, name in enumerate(("dough", "rubber")):
        alone = core.play(two(core, (name,), velocities, places))[0]
        for field in ("x", "v", "B", "J"):
            assert np.allclose(getattr(both.bodies[index].particles, field), getattr(alone.bodies[0].particles, field), rtol=1e-13, atol=1e-14), (name, field)
