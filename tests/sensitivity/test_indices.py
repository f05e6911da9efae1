"""Sensitivity against functions whose indices are exact: Ishigami's, and Sobol's g; also with failed points."""

import math

import numpy as np
import pytest
import xarray as xr

from mpm.sensitivity import projection
from mpm.sensitivity.failing import bounded
from mpm.sensitivity.sample import read
from mpm.sensitivity.surrogate import ask
from mpm.sweep.designs import unit_sample
from mpm.sweep.lock import Refused

A, B = 7.0, 0.1
VARIANCE = A**2 / 8 + B * math.pi**4 / 5 + B**2 * math.pi**8 / 18 + 0.5
ISHIGAMI = np.array([0.5 * (1 + B * math.pi**4 / 5) ** 2, A**2 / 8, 0]) / VARIANCE
ISHIGAMI_TOTAL = ISHIGAMI + np.array([1, 0, 1]) * 8 * B**2 * math.pi**8 / 225 / VARIANCE
G = np.array([0.0, 1.0, 4.5, 9.0])
PARTS = 1 / (3 * (1 + G) ** 2)
SOBOL = PARTS / (np.prod(1 + PARTS) - 1)
SOBOL_TOTAL = np.array([part * np.prod(1 + np.delete(PARTS, k)) for k, part in enumerate(PARTS)]) / (np.prod(1 + PARTS) - 1)


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


CASES = [(ishigami, np.stack([ISHIGAMI, ISHIGAMI_TOTAL])), (sobol, np.stack([SOBOL, SOBOL_TOTAL]))]
NAMES = ["ishigami", "g"]


def effects(data, **more):
    """(first and total, parameter, (value, lower, upper)) and all that was found."""
    from mpm.sensitivity.api import analyse

    found = analyse(data, **more)
    return np.stack([found.effects[0].first, found.effects[0].total]), found


def inside(found, exact):
    return (found[..., 1] <= exact) & (exact <= found[..., 2])


@pytest.mark.parametrize("share", [0.0, pytest.param(0.05, marks=pytest.mark.wide)], ids=["whole", "5 % failed"])
@pytest.mark.parametrize("count", [512, pytest.param(4096, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("function", "exact"), CASES, ids=NAMES)
def test_exact_indices_lie_in_their_intervals(function, exact, count, share):
    u = unit_sample("sobol", count, exact.shape[1], 1)
    found, _ = effects(dataset(u, function(u), np.random.default_rng(2).random(count) < share))
    assert inside(found, exact).all(), (found, exact)
    assert np.max(found[..., 2] - found[..., 1]) < (0.06 if count == 512 else 0.015)  # no use if wider


def linear(u):
    return 3 * u[:, 0] + 2 * u[:, 1]


def product(u):
    return np.prod(1 + u * C, axis=1)


def step(u):
    sign = np.sign(u - [0.3, 0.6, 0.5])
    return sign[:, 0] + 0.5 * sign[:, 1] * sign[:, 2]


def morris(u):
    """Main effects, products of two, and one of three."""
    w = 2 * u - 1
    return sum(c * np.prod(w[:, list(which)], axis=1) for which, c in TERMS.items())


C = np.array([1, 2, 0.5, 0.1])
OF_C = C**2 / 12 / (1 + C / 2) ** 2
TERMS = {(0,): 20, (1,): 10, (2,): 5, (4,): 3, (0, 1): -15, (2, 3): 8, (3, 4, 5): -10}
SHARES = {which: c**2 / 3 ** len(which) for which, c in TERMS.items()}
WHOLE = np.prod(1 + OF_C) - 1
FURTHER = {
    "linear": (linear, np.array([[9, 4, 0], [9, 4, 0]]) / 13),
    "linear and noise": (lambda u: linear(u) + 0.5 * np.random.default_rng(int(1e9 * u[0, 0])).normal(size=len(u)), np.array([[9, 4, 0], [9, 4, 0]]) / 16),
    "product": (product, np.stack([OF_C, OF_C * (1 + WHOLE) / (1 + OF_C)]) / WHOLE),
    "step": (step, np.array([[0.84, 0, 0.01], [0.84, 0.24, 0.25]]) / 1.09),
    "morris": (morris, np.array([[SHARES.get((k,), 0) for k in range(6)], [sum(v for which, v in SHARES.items() if k in which) for k in range(6)]])
               / sum(SHARES.values())),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("count", "samples", "share"), [(512, 40, 0.0), (512, 40, 0.05), (4096, 10, 0.05)])
@pytest.mark.parametrize("name", [*NAMES, *FURTHER])
def test_intervals_cover_as_often_as_they_say(name, count, samples, share):
    """Random samples, no constant is fitted to any of the functions. At most 1 of 20 may lie outside on the average, and of each index 3 of 40, or 1 of 10."""
    function, exact = dict(zip(NAMES, CASES, strict=True)).get(name) or FURTHER[name]
    hits, width = 0, 0
    for seed in range(samples):
        random = np.random.default_rng(1000 + seed)
        u = random.random((count, exact.shape[1]))
        u = u[random.random(count) >= share]
        y = function(u)
        found = projection.estimate(projection.chosen(u, y), y, seed)
        hits = hits + inside(np.stack([found.first, found.total]), exact)
        width = max(width, np.max(found.first[:, 2] - found.first[:, 1]))
    print(f"{name}, {count} points: {100 * np.mean(hits) / samples:.0f} % inside, the least {100 * np.min(hits) / samples:.0f} %, widest first {width:.3f}")
    assert np.all(hits >= int(0.925 * samples)) and np.mean(hits) >= 0.95 * samples, hits / samples


@pytest.mark.parametrize("share", [pytest.param(0.0, marks=pytest.mark.wide), 0.3], ids=["whole", "30 % failed"])
def test_a_function_that_no_polynomial_follows_gets_wide_intervals_that_hold_the_truth(share):
    """A step in one parameter, noise that no parameter makes, and a product of signs: first 0.4, 0; total 0.4 + 0.2, 0.2 and the noise's 0.4 to none."""
    random = np.random.default_rng(5)
    u = random.random((2000, 3))
    sign = np.sign(u - 0.5)
    y = math.sqrt(0.4) * sign[:, 0] + math.sqrt(0.2) * sign[:, 1] * sign[:, 2] + math.sqrt(0.4) * random.normal(size=2000)
    known = random.random(2000) >= share
    found = projection.estimate(projection.chosen(u[known], y[known]), y[known])
    assert np.all(inside(found.first, np.array([0.4, 0, 0])))
    assert found.total[0, 1] <= 0.4 and found.total[0, 2] >= 0.4 and np.all(found.total[1:, 2] >= 0.2)
    assert np.all(found.total[:, 2] - found.total[:, 1] > 0.4)


def test_levels_of_a_grid_have_polynomials_of_their_own():
    """A full grid of 3 x 5 x 6 values: the indices are those of its own levels, by sums."""
    levels = [np.array([0, 0.3, 1.0]), np.linspace(0, 1, 5), np.linspace(0, 1, 6)]
    u = np.stack(np.meshgrid(*levels, indexing="ij"), axis=-1).reshape(-1, 3)
    y = np.exp(u[:, 0]) + u[:, 1] * u[:, 2]
    cube = y.reshape(3, 5, 6)
    exact = np.array([np.var(cube.mean(axis=tuple({0, 1, 2} - {k}))) for k in range(3)]) / np.var(y)
    total = np.array([np.mean(np.var(cube, axis=k)) for k in range(3)]) / np.var(y)
    found = projection.estimate(projection.chosen(u, y), y)
    assert found.first[:, 0] == pytest.approx(exact, abs=0.01) and found.total[:, 0] == pytest.approx(total, abs=0.01)


@pytest.mark.wide
@pytest.mark.parametrize(("function", "exact"), CASES, ids=NAMES)
def test_a_corner_that_failed_widens_the_interval_and_is_named(function, exact):
    from mpm.sensitivity.api import sentences

    u = unit_sample("sobol", 1024, exact.shape[1], 1)
    found, all_ = effects(dataset(u, function(u), corner(u)))
    assert corner(u).mean() == pytest.approx(0.2, abs=0.02)
    assert inside(found, exact).all(), (found, exact)
    assert np.max(found[0, :, 2] - found[0, :, 1]) < 0.6
    assert {row.name for row in all_.failed if row.p < 0.01} == {"p0", "p1"}
    assert all_.failed[0].shares[2] > 0.3 and all_.failed[0].shares[0] == 0
    assert any("failing depends on p0" in text for text in sentences(all_))


def corner(u):
    return (u[:, 0] > 1 - math.sqrt(0.2)) & (u[:, 1] > 1 - math.sqrt(0.2))


@pytest.mark.slow
@pytest.mark.parametrize("count", [512, 4096])
@pytest.mark.parametrize(("function", "exact"), CASES, ids=NAMES)
def test_bounds_with_a_corner_failed_hold_the_truth(function, exact, count):
    hits, samples = 0, 200 if count == 512 else 20
    for seed in range(samples):
        u = np.random.default_rng(seed).random((count, exact.shape[1]))
        found = bounded(u, np.where(corner(u), np.nan, function(u)), ~corner(u), seed)
        hits = hits + inside(np.stack([found.first, found.total]), exact)
    assert np.all(hits >= 0.95 * samples), hits / samples


@pytest.mark.parametrize("share", [0.0, 0.01])
def test_a_saltelli_design_gives_totals_from_its_whole_rows(share):
    from mpm.sensitivity.api import analyse

    pytest.importorskip("SALib")
    u = unit_sample("saltelli", 1024 * 5, 3, 0)
    failed = np.random.default_rng(3).random(len(u)) < share
    config = '{"sweep": {"sample": {"saltelli": {"count": 1024, "ranges": {"p0": [0, 1], "p1": [0, 1], "p2": [0, 1]}}}}}'
    effect = analyse(dataset(u, ishigami(u), failed, config_resolved=config)).effects[0]
    assert effect.how.startswith("Saltelli's design") and (share == 0) == ("1024 of 1024" in effect.how)
    for found, exact in ((effect.first, ISHIGAMI), (effect.total, ISHIGAMI_TOTAL)):
        assert np.all(found[:, 1] <= exact) and np.all(exact <= found[:, 2]), (found, exact)


def test_the_surrogates_indices_hold_the_exact_ones():
    pytest.importorskip("SALib")
    u = unit_sample("sobol", 512, 3, 1)
    found, all_ = effects(dataset(u, ishigami(u)), surrogate=True)
    assert all_.effects[0].how == "surrogate" and inside(found, CASES[0][1]).all(), found


def test_not_reached_is_censored_told_and_written(tmp_path):
    from mpm.sensitivity.api import analyse, sentences, write

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
    share = xr.load_dataset(write(found, tmp_path / "sensitivity.nc"), engine="h5netcdf").unreached_share.sel(
        observable="time_to_centre_95_degC", parameter="p0"
    )
    assert share.values == pytest.approx([late[np.clip((u[:, 0] * 3).astype(int), 0, 2) == third].mean() for third in range(3)], abs=0.02)


def test_points_that_refinement_placed_are_no_sample():
    from mpm.sensitivity.api import analyse, sentences

    u = unit_sample("sobol", 64, 2, 4)
    found = analyse(dataset(u, u[:, 0], config_resolved='{"sweep": {"refine": {"of": "velocity.max"}}}'))
    assert found.effects[0].first is None and found.effects[0].spearman[0, 0] > 0.99
    assert any("no sample of the ranges: no indices" in text for text in sentences(found))


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
