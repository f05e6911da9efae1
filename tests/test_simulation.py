"""Runs as wholes: repeatable, neutral to physics left out, honest about failure."""

import numpy as np
import pytest

FAILURES = {"inverted", "overstretched", "left_grid", "non_finite", "step_underflow"}


def flow_out(scene, rate):
    p = scene.bodies[0].particles
    p.v[:, 0], p.C[:] = rate * (p.x[:, 0] - p.x[:, 0].mean()), rate


def state(scene):
    return [field.copy() for body in scene.bodies for field in (*body.particles, *(f for f in body.thermal if isinstance(f, np.ndarray)))]


def test_the_same_run_twice_gives_the_same_bits(core):
    experiment = core.experiment(2, {"materials.solid.expansion.modulus.gamma": 0.01}, surfaces=[{"of": "body", "convection": {"beta": 2.0, "outside": 300}}])
    (one, run), (other, again) = core.play(experiment), core.play(experiment)
    assert all(np.array_equal(a, b) for a, b in zip(state(one), state(other), strict=True))
    assert all(np.array_equal(run.series[name], again.series[name]) for name in run.series)


def neutral(core, dimension):
    """Mechanics alone, and the same with heat that does nothing, also by zeros of exchange and coupling: the same bits in every field and series of both."""

    def stir(scene):
        p = scene.bodies[0].particles
        p.v[:], p.C[:] = 0.3 * (p.x - 1.0), 0.3 * np.eye(p.x.shape[1])

    zeros = {"kappa": 0.0, "beta": 0.0, "materials.solid.expansion.modulus.gamma": 0.0}
    bare = core.experiment(dimension, drop=("surfaces", "expansion", "heating", "heat"))
    idle = [core.experiment(dimension, {"kappa": 0.0}, drop=("surfaces", "expansion", "heating")), core.experiment(dimension, zeros)]
    cold, other = core.play(bare, stir)
    for warm, run in (core.play(experiment, stir) for experiment in idle):
        assert run.outcome.ok and run.steps == other.steps > 3
        a, b = warm.bodies[0].particles, cold.bodies[0].particles
        assert np.ptp(a.J) > 1e-3
        for name in ("x", "v", "C", "B", "J"):
            assert np.array_equal(getattr(a, name), getattr(b, name)), (name, np.abs(getattr(a, name) - getattr(b, name)).max())
        assert len(other.series) > 10 and not any(name.startswith(("heat", "temperature")) for name in other.series)
        for name, values in other.series.items():
            assert np.array_equal(run.series[name], values), name


def test_physics_left_out_is_neutral(core):
    neutral(core, 1)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
def test_physics_left_out_is_neutral_in_every_dimension(core, dimension):
    neutral(core, dimension)


def single_and_double(core, dimension):
    """Largest relative difference of the series of a flying, stretching, cooling body in float32 and float64."""

    def stir(scene):
        p = scene.bodies[0].particles
        p.v[:], p.C[:] = 0.3 * (p.x - 0.5), 0.3 * np.eye(p.x.shape[1])

    air = [{"of": "body", "convection": {"beta": 1.0, "outside": 300}}]
    changes = {"materials.solid.expansion.modulus.gamma": 0.01, "time.step": 0.02}
    runs = [core.play(core.experiment(dimension, changes | {"method.precision": p}, surfaces=air), stir) for p in ("float64", "float32")]
    assert runs[1][0].bodies[0].particles.x.dtype == np.float32
    return {name: (runs[0][1].series[name], runs[1][1].series[name]) for name in runs[0][1].series}


SCALES = {"temperature_mean": 100, "temperature_min": 100, "heat_total": None, "position_mean_x": 1, "extent_x": 1, "J_max": 1, "momentum_x": None}


@pytest.mark.wide
def test_float32_agrees_with_float64(core):
    series = single_and_double(core, 1)
    for name, scale in SCALES.items():
        double, single = series[name]
        assert np.abs(single - double).max() < 1e-4 * (scale or np.abs(double).max()), name


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
def test_float32_agrees_with_float64_in_every_dimension(core, dimension):
    series = single_and_double(core, dimension)
    for name, scale in {"temperature_mean": 100, "heat_total": None, "J_max": 1}.items():
        double, single = series[name]
        assert np.abs(single - double).max() < 1e-4 * (scale or np.abs(double).max()), name


def failed(run, *kinds):
    """The run failed in one of these ways, says where and when, gives advice, and keeps what it had."""
    assert run.outcome.kind in kinds and run.outcome.advice
    assert "step" in run.outcome.message and "t = " in run.outcome.message
    assert 1 <= len(run.times) < 6 and all(len(values) == len(run.times) and np.isfinite(values).all() for values in run.series.values())
    assert all(np.isfinite(run.finals[name]) for name in run.series)


@pytest.mark.plain
def test_steps_far_past_the_limit_diverge(core):
    run = core.play(core.experiment(1, {"time.safety": 10.0, "time.end": 20.0, "output.every": 4.0}), lambda scene: flow_out(scene, 0.1))[1]
    failed(run, *FAILURES)
    assert "particle" in run.outcome.message and run.steps >= 1


@pytest.mark.plain
@pytest.mark.parametrize(("rate", "kind"), [(-12.0, "inverted"), (-7.0, "overstretched"), (7.0, "overstretched")])
def test_a_step_that_inverts_or_overstretches(core, rate, kind):
    run = core.play(core.experiment(1, {"time.step": 0.1}), lambda scene: flow_out(scene, rate))[1]
    failed(run, kind)
    assert "particle 0" in run.outcome.message and "step 0" in run.outcome.message


@pytest.mark.plain
def test_a_particle_leaves_the_grid(core):
    body = core.config(1)["bodies"]["body"] | {"velocity": [60.0]}
    run = core.play(core.experiment(1, {"time.step": 0.1}, bodies={"body": body}))[1]
    failed(run, "left_grid")
    assert "grid.size" in run.outcome.advice


@pytest.mark.parametrize("field", ["theta", "v"])
def test_a_value_that_is_not_finite(core, field):
    """A NaN reaches positions through the stress within a step."""

    bodies = []

    def beat(fraction, time):
        if 0.22 < fraction < 0.38:  # inside an output interval
            (bodies[0].thermal.theta if field == "theta" else bodies[0].particles.v[:, 0])[3] = np.nan
        return False

    run = core.play(core.experiment(1, {"time.safety": 0.01}), lambda scene: bodies.append(scene.bodies[0]), beat)[1]
    failed(run, "non_finite")
    assert len(run.times) > 1


@pytest.mark.plain
def test_a_step_that_shrinks_without_bound(core):
    """A body that falls for ever, far faster than its waves: the step falls under 1/256 of the first."""
    soft = {"materials.solid.elastic.hencky.lam": 1e-5, "materials.solid.elastic.hencky.mu": 1e-5, "kappa": 1e-6, "beta": 1e-6}
    run = core.play(core.experiment(1, soft | {"time.end": 2.0, "output.every": 0.02}, gravity=[2.0]))[1]
    assert run.outcome.kind == "step_underflow" and "advection" in run.outcome.message and len(run.times) > 5


def test_a_run_that_is_stopped(core):
    asked = []

    def beat(fraction, time):
        asked.append((fraction, time))
        return fraction > 0.5

    run = core.play(core.experiment(1), beat=beat)[1]
    assert run.outcome.kind == "budget" and 0.2 <= run.times[-1] <= 0.5 and len(asked) >= 3
    assert all(fraction == pytest.approx(time / 0.5) for fraction, time in asked)
