"""Sensitivity against functions whose indices are exact: Ishigami's, and Sobol's g; also with failed points."""

import math

import numpy as np
import pytest
import xarray as xr

from mpm.sensitivity.sample import read
from mpm.sensitivity.surrogate import ask
from mpm.sweep.designs import unit_sample
from mpm.sweep.lock import Refused

pytest.importorskip("SALib")

A, B = 7.0, 0.1
VARIANCE = A**2 / 8 + B * math.pi**4 / 5 + B**2 * math.pi**8 / 18 + 0.5
ISHIGAMI = np.array([0.5 * (1 + B * math.pi**4 / 5) ** 2, A**2 / 8, 0]) / VARIANCE
ISHIGAMI_TOTAL = ISHIGAMI + np.array([1, 0, 1]) * 8 * B**2 * math.pi**8 / 225 / VARIANCE
G = np.array([0.0, 1.0, 4.5, 9.0])
PARTS = 1 / (3 * (1 + G) ** 2)
SOBOL = PARTS / (np.prod(1 + PARTS) - 1)


def ishigami(u):
    x = math.pi * (2 * u - 1)
    return np.sin(x[:, 0]) + A * np.sin(x[:, 1]) ** 2 + B * x[:, 2] ** 4 * np.sin(x[:, 0])


def sobol(u):
    return np.prod((np.abs(4 * u - 2) + G) / (1 + G), axis=1)


def dataset(u, y, failed=None, name="velocity_max", unit="m/s", **attrs):
    """A sweep's dataset as sensitivity reads it."""
    status = np.zeros(len(y), np.int8) if failed is None else np.where(failed, 4, 0).astype(np.int8)
    coords = {f"p{k}": ("sample", column, {"units": "1", "config_path": f"parameters.p{k}"}) for k, column in enumerate(u.T)}
    error = np.where(status == 0, "", "diverged: det F <= 0").astype(object)
    return xr.Dataset({"status": ("sample", status), "error": ("sample", error), name: ("sample", np.where(status == 0, y, np.nan), {"units": unit})}, coords,
                      {"config_resolved": "{}", "title": "test", **attrs})  # fmt: skip


def first(data, **more):
    from mpm.sensitivity.api import analyse

    return analyse(data, **more).effects[0].first


CASES = [(ishigami, ISHIGAMI), (sobol, SOBOL)]


@pytest.mark.parametrize("share", [0.0, 0.05], ids=["whole", "5 % failed"])
@pytest.mark.parametrize("count", [512, 4096])
@pytest.mark.parametrize(("function", "exact"), CASES, ids=["ishigami", "g"])
def test_exact_indices_lie_in_their_intervals(function, exact, count, share):
    u = unit_sample("sobol", count, len(exact), 1)
    failed = np.random.default_rng(2).random(count) < share
    found = first(dataset(u, function(u), failed))
    assert np.all(found[:, 1] <= exact) and np.all(exact <= found[:, 2]), (found, exact)
    assert np.max(found[:, 2] - found[:, 1]) < (0.35 if count == 512 else 0.12)


@pytest.mark.slow
@pytest.mark.parametrize(("function", "exact"), CASES, ids=["ishigami", "g"])
def test_intervals_cover_as_often_as_they_say(function, exact):
    inside = 0
    for seed in range(40):
        u = np.random.default_rng(seed).random((512, len(exact)))
        found = first(dataset(u, function(u)), seed=seed)
        inside += np.sum((found[:, 1] <= exact) & (exact <= found[:, 2]))
    assert inside >= 0.9 * 40 * len(exact)


@pytest.mark.parametrize(("function", "exact"), CASES, ids=["ishigami", "g"])
def test_a_corner_that_failed_widens_the_interval_and_is_named(function, exact):
    from mpm.sensitivity.api import analyse, sentences

    u = unit_sample("sobol", 1024, len(exact), 1)
    failed = (u[:, 0] > 1 - math.sqrt(0.2)) & (u[:, 1] > 1 - math.sqrt(0.2))
    assert failed.mean() == pytest.approx(0.2, abs=0.02)
    found = analyse(dataset(u, function(u), failed))
    effect = found.effects[0]
    assert np.all(effect.first[:, 1] <= exact) and np.all(exact <= effect.first[:, 2])
    assert {row.name for row in found.failed if row.p < 0.01} == {"p0", "p1"}
    assert found.failed[0].shares[2] > 0.3 and found.failed[0].shares[0] == 0
    assert any("failing depends on p0" in text for text in sentences(found))


@pytest.mark.parametrize("share", [0.0, 0.01])
def test_a_saltelli_design_gives_totals_from_its_whole_rows(share):
    from mpm.sensitivity.api import analyse

    u = unit_sample("saltelli", 1024 * 5, 3, 0)
    failed = np.random.default_rng(3).random(len(u)) < share
    config = '{"sweep": {"sample": {"saltelli": {"count": 1024, "ranges": {"p0": [0, 1], "p1": [0, 1], "p2": [0, 1]}}}}}'
    effect = analyse(dataset(u, ishigami(u), failed, config_resolved=config)).effects[0]
    assert effect.how.startswith("Saltelli's design") and (share == 0) == ("1024 of 1024" in effect.how)
    for found, exact in ((effect.first, ISHIGAMI), (effect.total, ISHIGAMI_TOTAL)):
        assert np.all(found[:, 1] <= exact) and np.all(exact <= found[:, 2]), (found, exact)


def test_not_reached_is_censored_and_told():
    from mpm.sensitivity.api import analyse, sentences

    u = unit_sample("sobol", 512, 2, 4)
    time = 500 + 400 * u[:, 0] + 50 * u[:, 1]
    late = time > 800
    config = '{"output": {"probes": {"centre": [0]}}, "time": {"end": 800}}'
    data = dataset(u, np.where(late, np.nan, time), name="time_to_centre_95_degC", config_resolved=config)
    found = analyse(data)
    assert (found.effects[0].late, found.effects[0].known) == (late.sum(), 512)
    assert found.effects[0].spearman[0, 0] > 0.95
    assert any("never reach it; they count as at least 800 s" in text for text in sentences(found))
    assert found.unreached["time_to_centre_95_degC"][0].name == "p0"


def test_ask_answers_with_an_interval_that_holds_the_truth_or_refuses():
    u = np.linspace(0, 1, 15)[:, None]
    time = 400 / (0.4 + u[:, 0])
    timed = dataset(u, time, name="time_to_centre_95_degC", unit="s")
    (answer,), surrogate, _ = ask(read(timed), "time_to_centre_95_degC = 10 min")
    assert answer.low <= 400 / 600 - 0.4 <= answer.high and answer.high - answer.low < 0.1
    assert surrogate.explained > 0.99
    noise = np.random.default_rng(0).normal(size=15)
    with pytest.raises(Refused, match="surrogate of velocity_max is off by"):
        ask(read(dataset(u, noise)), "velocity_max = 0")
    with pytest.raises(Refused, match=r"no p0 between 0 and 1 gives"):
        ask(read(dataset(u, time)), "velocity_max = 5000")
    with pytest.raises(Refused, match="say NAME = VALUE"):
        ask(read(dataset(u, time)), "height = 3")
