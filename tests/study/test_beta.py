"""beta from 1e-3 to 1e12 and infinity: every point ends ok, monotone in beta, with a heat step that is bounded below."""

import numpy as np
import pytest

BETAS = [*np.logspace(-3, 12, 16), np.inf]


@pytest.mark.parametrize("heat", ["auto", "explicit"])
def test_any_beta(core, heat):
    from mpm.integrate.timestep import limits
    from mpm.scene.build import build
    from mpm.simulation import Clock

    means, least = [], []
    for beta in BETAS:
        air = [{"of": "body", "convection": {"beta": beta, "outside": core.COLD}}]
        changes = {"method.heat": heat, "time.end": 0.1, "output.every": 0.1}
        experiment = core.experiment(1, changes, surfaces=air)
        scene = build(experiment)
        least.append(limits(scene.space, 1, scene.bodies, Clock(scene).reports).substep())
        run = core.play(experiment)[1]
        assert run.outcome.ok, (beta, run.outcome)
        assert core.COLD < run.series["temperature_min"][-1] and run.series["temperature_max"][-1] < core.HOT * (1 + 1e-12)
        means.append(run.series["temperature_mean"][-1])
    assert np.all(np.diff(means) <= 1e-9) and means[0] - means[-1] > 1.0
    h, kappa, capacity = 0.25, 0.1, 3.0
    assert min(least) >= capacity * h * h / kappa / (2 * 1e3 + 1 / 0.4) * (1 - 1e-9)  # beta is held at 1e3 kappa/h
