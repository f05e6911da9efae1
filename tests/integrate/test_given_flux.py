"""A given flux heats a body that conducts nothing as it does any other: the mean rises by q S t/(m alpha), in every scheme, law and dimension."""

import numpy as np
import pytest

LAW = {"table": {"temperature": [1.0, 1000.0], "value": [1.5, 1.5]}}
CASES = [(heat, alpha) for heat in ("stabilised", "explicit", "implicit") for alpha in (1.5, LAW)]
slow = pytest.mark.slow


@pytest.mark.parametrize("dimension", [1, 2, pytest.param("axisymmetric", marks=slow), pytest.param(3, marks=slow)])
@pytest.mark.parametrize(("heat", "alpha"), [pytest.param(*case, marks=[slow] if k else []) for k, case in enumerate(CASES)])
@pytest.mark.parametrize("q", [5.0, -5.0])
def test_without_conduction(core, dimension, heat, alpha, q):
    """No particle becomes warmer than it was by a flux that cools it."""
    material = core.config(dimension)["materials"]["solid"] | {"heat": {"fourier": {"kappa": 0.0, "alpha": alpha}}}
    run = core.play(core.experiment(dimension, {"method.heat": heat}, materials={"solid": material}, surfaces=[{"of": "body", "flux": {"q": q}}]))[1]
    over = {1: 2 / 0.75, 2: 4 / 0.75, "axisymmetric": 2 / 0.85 + 2 / 0.75, 3: 6 / 0.75}[dimension]  # S/V
    assert run.outcome.ok and run.finals["temperature_mean"] == pytest.approx(core.HOT + q * over * 0.5 / (2.0 * 1.5), abs=1e-9)
    worst = run.series["temperature_min"].min() - core.HOT if q > 0 else core.HOT - run.series["temperature_max"].max()
    assert worst > -1e-9
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()
