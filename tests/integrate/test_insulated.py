"""Mirror walls let no heat through: a slab that fills the domain between two of them levels out, by explicit and by implicit steps."""

import numpy as np
import pytest

pytestmark = pytest.mark.plain

END = 0.2


def levelled(core, heat):
    """(x, theta) of a slab of eight cells whose temperature was a cosine."""
    experiment = core.experiment(
        grid={"dimension": 1, "size": [2.0], "cell": 0.25},
        bodies={"body": {"shape": {"box": {"lower": [0.0], "upper": [2.0]}}, "temperature": core.HOT, "material": "solid"}},
        materials={"solid": core.config()["materials"]["solid"] | {"density": 1.0, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}}}},
        surfaces=[], time={"end": END}, output={"every": END}, method={"heat": heat},
    )  # fmt: skip

    def warm(scene):
        x = scene.bodies[0].particles.x[:, 0]
        scene.bodies[0].thermal.theta[:] = 50 * np.cos(np.pi * x / 2)
        scene.bodies[0].thermal.c[:, 0] = -25 * np.pi * np.sin(np.pi * x / 2)

    scene, run = core.play(experiment, warm)
    assert run.outcome.ok and run.finals["heat_exchanged"] == 0.0 and abs(run.finals["heat_total"]) < 1e-10
    return scene.bodies[0].particles.x[:, 0], scene.bodies[0].thermal.theta


def test_a_slab_between_mirrors_levels_out(core):
    (x, explicit), (_, implicit) = levelled(core, {"explicit": {}}), levelled(core, {"implicit": {"order": 2}})
    exact = 50 * np.exp(-((np.pi / 2) ** 2) * END) * np.cos(np.pi * x / 2)
    assert np.allclose(explicit, implicit, atol=0.3) and np.allclose(implicit, exact, atol=1.0)
