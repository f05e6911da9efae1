"""Fits of synthetic curves of a slab (kappa, beta, alpha; one face gets a known flux): values, intervals, what cannot be told apart, failed points."""

from dataclasses import replace

import numpy as np
import pytest

from mpm.config import load
from mpm.fit.api import solve
from mpm.fit.identify import identify
from mpm.fit.least import NoFit
from mpm.fit.problem import bare, read
from mpm.fit.sentences import limits, sentences
from mpm.records.point import from_run
from mpm.runner import run_point
from mpm.sweep.cases import plan
from mpm.sweep.lock import Refused
from mpm.sweep.rounds import Rounds

SLAB = {
    "grid": {"dimension": 1, "size": [0.05], "cell": 0.004},
    "bodies": {"slab": {"shape": {"box": {"lower": [0.005], "upper": [0.045]}}, "temperature": 298.15, "material": "dough"}},
    "materials": {"dough": {"density": 500, "heat": {"fourier": {"kappa": 0.4, "alpha": 2800}}}},
    "surfaces": [  # the flux is known: temperatures that convection alone drives tell ratios of kappa, beta and alpha only
        {"of": "slab", "side": "left", "convection": {"beta": 20, "outside": 473.15}},
        {"of": "slab", "side": "right", "flux": {"q": 1500}},
    ],
    "time": {"end": 1200},
    "output": {"every": 60, "probes": {"centre": [0.025], "face": [0.044]}},
}
RANGES = {"kappa": {"log": [0.1, 2]}, "beta": {"log": [4, 100]}, "alpha": {"log": [800, 9000]}}


@pytest.fixture(scope="session")
def truth():
    """The slab's own curves, at its own times."""
    return run_point(load(SLAB))


def measured(values, times, sigma=None):
    """A curve of a config."""
    return {"samples": [[float(t), float(v)] for t, v in zip(times, values, strict=True)], **({"sigma": sigma} if sigma else {})}


def config(curves, ranges=RANGES, **fit):
    """The slab with curves and a fit."""
    return load({**SLAB, "output": {**SLAB["output"], "measured": curves}, "fit": {"parameters": ranges, **fit}})


class InProcess:
    """What `solve` asks for points; `broken(values)` makes one fail. Counts what it ran."""

    def __init__(self, problem, bare, broken=lambda values: False):
        self.maker = Rounds(bare, [parameter.path for parameter in problem.parameters], ".")
        self.broken, self.ran = broken, []

    def __call__(self, points):
        found = []
        for case, point in zip(plan(self.maker.sweep(points)).cases, points, strict=True):
            self.ran.append(case.run_id)
            record = from_run(case.run_id, run_point(case.experiment))
            if self.broken(point):
                record.status, record.error = 4, "diverged: made to fail"
            found.append(record)
        return found


@pytest.fixture
def rng():
    return np.random.default_rng(7)


TRUE = np.array([0.4, 20, 2800])
NAMES = ("centre", "face")


def clean(truth, names=NAMES):
    return {name: measured(truth.series[f"temperature_{name}"], truth.times) for name in names}


def noisy(truth, rng, sigma, names=NAMES, given=True):
    size = len(truth.times)
    return {name: measured(truth.series[f"temperature_{name}"] + rng.normal(0, sigma, size), truth.times, sigma if given else None) for name in names}


def fitted(experiment, **more):
    problem = read(experiment)
    return solve(problem, InProcess(problem, bare(experiment), **more))


def far(problem, u):
    return np.max(np.abs(np.array(problem.values(u)) / TRUE - 1))


def test_a_curve_without_noise_gives_back_its_parameters(truth):
    done = fitted(config(clean(truth), starts=2, seed=3))
    assert len(done.searches.found) == 2
    assert all(far(done.problem, one.u) < 1e-6 for one in done.searches.found)


def test_a_short_run_goes_without_the_curves_that_it_does_not_reach(truth):
    late = measured(truth.series["temperature_face"][-4:], truth.times[-4:])
    output = {**SLAB["output"], "measured": {**clean(truth, ["centre"]), "face": late}}
    experiment = load({**SLAB, "time": {"end": 600}, "output": output, "fit": {"parameters": {"kappa": [0.1, 2]}}})
    problem = read(experiment, short=True)
    assert problem.left_out == ("face",) and [curve.name for curve in problem.curves] == ["centre"] and problem.curves[0].late == 10
    with pytest.raises(Refused, match=r"output\.measured\.face: every measured time lies after the end of the run, 600 s; set time.end to 1020 s or later"):
        read(experiment)
    with pytest.raises(Refused, match=r"set smoke\.time\.end to 1020 s or later"):
        read(experiment, hold_out=("centre",), short=True)


def test_named_parameters_are_fitted_by_name_and_formulas_follow_them(truth):
    """What a formula makes of a parameter is no parameter of its own."""
    materials = {"dough": {"density": 500, "heat": {"fourier": {"kappa": "=crumb", "alpha": 2800}}}}
    surfaces = [
        {"of": "slab", "side": "left", "convection": {"beta": "=stone", "outside": 473.15}},
        {"of": "slab", "side": "right", "flux": {"q": "=75*stone"}},
    ]
    scene = {**SLAB, "parameters": {"crumb": 0.3, "stone": {"value": 30, "label": "heat transfer of the stone"}}, "materials": materials, "surfaces": surfaces}
    output = {**SLAB["output"], "measured": clean(truth)}
    problem = read(experiment := load({**scene, "output": output, "fit": {"parameters": {"crumb": [0.1, 2], "stone": {"log": [4, 100]}}}}))
    assert problem.names == ["crumb", "stone"] and problem.parameters[1].long_name == "heat transfer of the stone"
    assert solve(problem, InProcess(problem, bare(experiment))).known.values == pytest.approx([0.4, 20], rel=1e-6)


@pytest.mark.slow
def test_ten_starts_give_back_the_parameters_to_a_millionth(truth):
    done = fitted(config(clean(truth), starts=10))
    assert len(done.searches.found) == 10
    assert max(far(done.problem, one.u) for one in done.searches.found) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("given", [True, False], ids=["sigma", "no sigma"])
def test_intervals_cover_the_truth_as_often_as_they_say(truth, given):
    rng, inside, count = np.random.default_rng(20), np.zeros((2, 3)), 300
    for _ in range(count):
        done = fitted(config(noisy(truth, rng, 0.5, given=given)))
        low, high = np.array([limits(done, k)[:2] for k in range(3)]).T
        inside[0] += (low <= TRUE) & (high >= TRUE)
        low, high = done.known.interval().T
        inside[1] += (low <= TRUE) & (high >= TRUE)
    assert np.all(inside >= 0.92 * count) and np.all(inside <= 0.98 * count), inside / count


def test_what_cannot_be_told_apart_is_said_with_what_is_fixed(truth, rng):
    """Convection alone drives it: the temperatures depend on kappa/alpha and beta/alpha only."""
    scene = {**SLAB, "surfaces": [{"of": "slab", "convection": {"beta": 20, "outside": 473.15}}]}
    run = run_point(load(scene))
    curves = {"centre": measured(run.series["temperature_centre"] + rng.normal(0, 0.2, len(run.times)), run.times, 0.2)}
    ranges = {name: RANGES[name] for name in ("kappa", "beta", "alpha")}
    experiment = load({**scene, "output": {**scene["output"], "measured": curves}, "fit": {"parameters": ranges}})
    problem = read(experiment)
    done = solve(problem, InProcess(problem, bare(experiment)))
    assert {frozenset((pair.i, pair.j)) for pair in done.pairs} >= {frozenset((0, 2)), frozenset((1, 2))}
    pair = next(pair for pair in done.pairs if {pair.i, pair.j} == {1, 2})
    assert abs(pair.power) == pytest.approx(1, abs=0.05) and pair.correlation > 0.99
    assert pair.value == pytest.approx(20 / 2800 if pair.i == 1 else 2800 / 20, rel=0.1)
    assert any("beta and alpha cannot be told apart" in text or "alpha and beta cannot be told apart" in text for text in sentences(done))


def test_the_curve_that_would_help_is_named(truth, rng):
    done = fitted(config(noisy(truth, rng, 0.02, ("face",))))
    with_both = fitted(config(noisy(truth, np.random.default_rng(7), 0.02)))
    assert done.gains["centre"] == pytest.approx(with_both.known.error, rel=0.1)


def test_failed_points_shorten_the_step_and_are_told(truth):
    experiment = config(clean(truth))
    problem = read(experiment)
    run = InProcess(problem, bare(experiment), broken=lambda values: values[0] > 0.4002)
    problem = type(problem)(**{**vars(problem), "parameters": tuple(moved(p) for p in problem.parameters)})
    done = solve(problem, run)
    assert far(problem, done.searches.best.u) < 1e-6
    assert done.evaluator.failed and any("points failed, and the search went round them" in text for text in sentences(done))
    assert done.exit_code == 3


def test_where_failed_points_keep_it_from_the_optimum_it_does_not_say_converged(truth):
    """Every point that is better than the start fails."""
    experiment = config(noisy(truth, np.random.default_rng(7), 0.5), {"kappa": {"log": [0.1, 2]}})
    problem = read(experiment)
    problem = replace(problem, parameters=tuple(moved(p) for p in problem.parameters))
    done = solve(problem, InProcess(problem, bare(experiment), broken=lambda values: values[0] > 0.201))
    assert not done.converged and done.exit_code == 3
    assert any("ended short of the optimum, and failed points stand in its way" in text for text in sentences(done))


def moved(parameter):
    """The same, begun elsewhere."""
    return replace(parameter, start={"kappa": 0.2, "beta": 40.0, "alpha": 4000.0}[parameter.name])


def test_where_nothing_can_be_computed_it_says_so(truth):
    experiment = config(clean(truth))
    problem = read(experiment)
    with pytest.raises(NoFit, match=r"no start can be computed: .* made to fail"):
        solve(problem, InProcess(problem, bare(experiment), broken=lambda values: True))


def test_the_covariance_is_that_of_linear_least_squares(truth, rng):
    """Against central differences of the model itself, in the parameters rather than in u."""
    experiment = config(noisy(truth, rng, 0.5))
    problem = read(experiment)
    run = InProcess(problem, bare(experiment))
    done = solve(problem, run)
    best = done.known.values
    rows = []
    for k in range(3):
        ends = [best * (1 + sign * 1e-3 * np.eye(3)[k]) for sign in (1, -1)]
        up, down = (np.concatenate([record.series[f"temperature_{name}"] for name in NAMES]) for record in run([tuple(e) for e in ends]))
        rows.append((up - down) / (2e-3 * best[k]))
    j = np.array(rows).T / 0.5
    assert done.known.covariance_si == pytest.approx(np.linalg.inv(j.T @ j), rel=0.05)
    assert identify(done.evaluator, done.searches.best.u).values == pytest.approx(best)


def posterior(experiment, steps):
    pytest.importorskip("emcee")
    problem = read(experiment)
    told = []
    return solve(problem, InProcess(problem, bare(experiment)), steps, told.append), told


def test_a_posterior_is_the_same_sample_each_time_and_lies_within_the_ranges(truth):
    experiment = config(noisy(truth, np.random.default_rng(7), 0.5), {"kappa": {"log": [0.1, 2]}})
    (first, told), (again, _) = posterior(experiment, 8), posterior(experiment, 8)
    assert np.array_equal(first.chain, again.chain) and first.chain.shape == (12 * 6, 1)
    assert np.all((first.chain >= 0.1) & (first.chain <= 2))
    assert any("too few steps" in text for text in told)


@pytest.mark.slow
def test_the_posteriors_spread_is_that_of_the_covariance_where_the_model_is_nearly_linear(truth):
    done, told = posterior(config(noisy(truth, np.random.default_rng(7), 0.2)), 1800)
    assert np.std(np.log(done.chain), axis=0) == pytest.approx(done.known.error / done.known.values, rel=0.15)
    assert np.mean(done.chain, axis=0) == pytest.approx(done.known.values, rel=0.05)
    assert np.corrcoef(np.log(done.chain).T) == pytest.approx(done.known.correlation, abs=0.03)
    assert not any("too few steps" in text for text in told), told
