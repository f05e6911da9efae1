"""A material point that leaves the model says so."""

import pytest

import mpm

LAW = {"fourier": {"kappa": 0.0, "alpha": {"table": {"temperature": [250.0, 310.0], "value": [10.0, 1000.0]}}}}


@pytest.mark.plain
def test_below_absolute_zero_is_no_result(point):
    """A long step on an adiabat takes up what alpha of its start allows; where alpha falls with temperature that may be more than there is."""
    material = {"density": 1.0, "heat": LAW, "expansion": {"modulus": {"gamma": 3e3, "reference": 300.0}}, "heating": {"elastic": {}}}
    run = mpm.run_point(point([{"strain_rate": {"xx": 0.5}}], material=material, every=0.5, time={"end": 1.0, "step": 0.5}))
    assert run.outcome.kind == "max_principle" and run.outcome.advice and run.finals["temperature_mean"] > 0
