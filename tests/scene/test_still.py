"""Bodies that do not move and touch, from a config: what conducts, what is refused, what is told."""

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.scene.inventory import physics
from mpm.scene.refusal import SceneError


def scene(more=None, gap=0.0, kappa=0.5):
    heat = {"density": 1000, "heat": {"fourier": {"kappa": kappa, "alpha": 2000}}}
    bodies = {"a": (0.02, 0.1, 370.0), "b": (0.1 + gap, 0.2 + gap, 290.0)}
    return mpm.load({
        "grid": {"dimension": 1, "size": [0.3], "cell": 0.01}, "materials": {"m": heat}, "time": {"end": 100.0}, "output": {"every": 50},
        "bodies": {name: {"shape": {"box": {"lower": [low], "upper": [high]}}, "temperature": T, "material": "m"} for name, (low, high, T) in bodies.items()},
        **(more or {}),
    })  # fmt: skip


def test_touching_bodies_conduct_unless_told(core):
    """Two halves at 370 and 290 K: what has passed is that of two half spaces, 2 sqrt(kappa rho alpha t/pi) over 2 times the difference."""
    run = mpm.run_point(scene())
    assert run.outcome.ok and not run.facts["warnings"]
    passed = 80.0 * np.sqrt(0.5 * 1000 * 2000 * 100 / np.pi)
    np.testing.assert_allclose(run.finals["temperature_max"], 370.0, atol=0.5)
    mean = (0.08 * 370 + 0.1 * 290) / 0.18
    np.testing.assert_allclose(run.finals["temperature_mean"], mean, rtol=1e-12)
    apart = mpm.run_point(scene({"contacts": [{"between": ["a", "b"], "conductance": 0}]}))
    np.testing.assert_allclose(apart.finals["temperature_min"], 290.0, rtol=1e-12)
    assert passed > 0 and np.abs(run.series["heat_total"]).max() < 1e-9 * passed


@pytest.mark.parametrize(("more", "gap", "kappa", "said"), [
    ({"contacts": [{"between": ["a", "b"], "conductance": 5}]}, 0.02, 0.5, r"contacts.0: a and b do not touch"),
    ({"method": {"rigid": "bounded"}}, 0.0, 0.5, "method.rigid.*a and b touch and pass heat"),
    ({"contacts": [{"between": ["a", "b"], "conductance": 5}]}, 0.0, 0.0, "kappa is 0"),
    ({}, -0.01, 0.5, "overlap at the start"),
    ({"surfaces": [{"of": "a", "side": "right", "convection": {"beta": 5, "outside": 300}}]}, 0.0, 0.5, r"surfaces.0: other bodies cover side 'right' of a"),
])  # fmt: skip
def test_what_cannot_be_is_refused(more, gap, kappa, said):
    with pytest.raises(SceneError, match=said):
        mpm.run_point(scene(more, gap, kappa))


def test_nothing_slides_where_nothing_moves():
    with pytest.raises(ConfigError, match="only heat can pass"):
        scene({"contacts": [{"between": ["a", "b"], "friction": 0.3}]})


def test_the_plan_tells_every_pair():
    assert "contact: a and b touch and pass heat freely (not named)" in physics(scene())["compiled"]
    named = scene({"contacts": [{"between": ["a", "b"], "conductance": 40}]})
    assert "contact: a and b touch and pass heat (40 W/m2K)" in physics(named)["compiled"]
    assert not [text for text in physics(scene(gap=0.02))["compiled"] if text.startswith("contact")]
