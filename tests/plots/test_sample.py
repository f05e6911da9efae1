"""Figures of samples, and rank correlations with intervals that deserve the name."""

import numpy as np
import pytest
from matplotlib.legend import Legend

from mpm.plots import UnknownFigure, _draw, final, overview
from mpm.plots.sample import correlation, ranks, spearman

RANDOM = np.random.default_rng(3)


def sample(tree, count, status=None, error=None):
    u = np.random.default_rng(5).random((count, 3))
    axes = {"kappa": 0.1 * 20 ** u[:, 0], "beta": 50 * 100 ** u[:, 1], "eta": u[:, 2]}
    ranges = {"κ": {"log": [0.1, 2]}, "beta": {"log": [50, 5000]}, "eta": [0, 1]}
    config = {"output": {"observables": ["extent.x"]}, "sweep": {"sample": {"sobol": {"count": count, "ranges": ranges}}}}
    finals = {"extent_x": 1e-2 + 1e-3 * u[:, 0], "mass_total": np.ones(count), "temperature_mean": 300 + u[:, 1]}
    return tree(axes, finals, sample=True, config=config, status=status, error=error)


def test_scatter_a_parameter_and_bars(tree, tmp_path):
    status, error = np.zeros(32, np.int8), np.full(32, "", dtype=object)
    status[4], error[4] = 4, "diverged: det F <= 0 at particle 2, t = 1 s, step 4"
    fig = overview(sample(tree, 32, status, error), tmp_path / "sweep.png")
    kappa, beta, eta, bars = fig.axes
    assert [ax.get_xscale() for ax in (kappa, beta, eta)] == ["log", "log", "linear"]
    assert [ax.get_xlabel() for ax in (kappa, beta, eta)] == ["κ [W/m/K]", "β [W/m²/K]", "η [Pa s]"]
    assert kappa.get_ylabel().split() == "Extent of the material along x [mm]".split()
    assert len(kappa.lines[1].get_xdata()) == 1  # the cross of the point that diverged
    assert fig.legends[0].get_texts()[0].get_text() == "diverged: det F ≤ 0 (1 point)"
    assert bars.get_title(loc="left") == "Rank correlation, n = 31"
    assert bars.patches[0].get_width() == pytest.approx(1.0)
    colours = [bar.get_facecolor() for bar in bars.patches]
    assert colours[0] != colours[1]  # the interval of beta holds zero: pale


def test_one_result_over_one_parameter(tree):
    """What `mpm plot OUT finals --of extent_x --over kappa` draws of a sample; it once said that nothing is swept."""
    whole = sample(tree, 32)
    ax = _draw(whole, "finals", "extent_x", "kappa").axes[0]
    assert ax.get_ylabel() == "Extent of the material along x [mm]" and ax.get_xlabel().endswith("κ [W/m/K]")
    assert len(ax.lines[0].get_xdata()) == 32 and ax.lines[0].get_linestyle() == "None"
    assert final(whole, "extent_x", over="beta").axes[0].get_xlabel().endswith("β [W/m²/K]")
    with pytest.raises(UnknownFigure, match="kappa, beta, eta"):
        _draw(whole, "finals", "extent_x", "cell")


def test_few_points_give_no_bars(tree):
    fig = overview(sample(tree, 6))
    assert len(fig.axes) == 3
    assert "6 points ok: too few" in fig.get_supxlabel()


def test_refined_axes_whose_answer_no_point_has(tree):
    kappa, beta = np.meshgrid([0.2, 0.3, 0.5], [5.0, 10.0, 50.0])
    config = {"output": {"observables": ["time_to.centre.95_degC"]}, "sweep": {"refine": {"of": "time_to_centre_95_degC", "level": 100.0}}}
    finals = {"time_to_centre_95_degC": np.full(9, np.nan), "temperature_mean": 300 + kappa.ravel()}
    fig = overview(tree({"kappa": kappa.ravel(), "beta": beta.ravel()}, finals, sample=True, config=config))
    fig.canvas.draw()
    assert fig.axes[0].get_xlabel() == "κ [W/m/K]"


def test_ranks_share_ties():
    np.testing.assert_array_equal(ranks(np.array([3.0, 1, 1, 5])), [3, 1.5, 1.5, 4])


def test_correlation_agrees_with_scipy():
    from scipy.stats import spearmanr

    one, two = RANDOM.random(40), np.round(RANDOM.random(40), 1)
    assert correlation(one, two) == pytest.approx(spearmanr(one, two).statistic, abs=1e-12)
    assert correlation(one, np.ones(40)) == 0.0


@pytest.mark.wide
def test_interval_covers_the_truth_about_as_often_as_it_says():
    """Of 60 independent pairs of 30, the 95 % interval should hold zero in all but a few: binomial(60, 0.05) exceeds 9 once in 1 400."""
    missed = 0
    for seed in range(60):
        random = np.random.default_rng(seed)
        _, low, high = spearman(random.random(30), random.random(30), np.arange(30), seed)
        missed += not low <= 0 <= high
    assert missed <= 9


def test_groups_are_resampled_together():
    """Each point given ten times over is no more evidence than once: the interval stays as wide."""
    one, two = RANDOM.random(20), RANDOM.random(20)
    _, low, high = spearman(one, two, np.arange(20))
    _, low_ten, high_ten = spearman(np.repeat(one, 10), np.repeat(two, 10), np.repeat(np.arange(20), 10))
    assert high_ten - low_ten == pytest.approx(high - low, rel=0.1)


def test_points_that_did_not_reach_are_triangles_and_measured_curves_have_a_panel(tree):
    kappa = np.linspace(1, 4, 16)
    reached = np.where(kappa > 2, 100 / kappa, np.nan)
    warm = 300 + kappa[:, None] * np.linspace(0, 10, 11)
    measured = {"measured_temperature_centre": ("measured_time_centre", np.array([305.0, 315, 320]))}
    config = {"output": {"probes": {"centre": [0]}, "observables": ["time_to.centre.95_degC"]}}
    finals = {"time_to_centre_95_degC": reached, "misfit_centre": np.abs(kappa - 3)}
    figure = overview(tree({"kappa": kappa, "beta": kappa[::-1] * 3}, finals, {"temperature_centre": warm}, sample=True, config=config, measured=measured))
    upper, lower = figure.subfigs
    triangles = [line for line in upper.axes[0].lines if line.get_marker() == "^"]
    assert [len(line.get_xdata()) for line in triangles] == [np.isnan(reached).sum()]
    assert "not reached within 100 s" in [text.get_text() for text in upper.legends[0].get_texts()]
    dots = [line for line in lower.axes[0].lines if line.get_linestyle() == "None" and len(line.get_xdata()) == 3]
    assert len(dots) == 1 and dots[0].get_ydata() == pytest.approx([31.85, 41.85, 46.85])


def test_two_refined_axes_are_a_plane_with_the_line_that_was_followed(tree, tmp_path):
    """ln beta + 2 kappa = 4: the line runs through it, straight between the points, also beside a point that failed and one that was not reached."""
    kappa, u = (row.ravel() for row in np.meshgrid([0.0, 0.5, 1.0], np.log([5.0, 15.811388300841896, 50.0]), indexing="ij"))
    kappa, u = np.append(kappa, [0.25, 0.75]), np.append(u, [3.5, 2.5])
    status, error = np.zeros(11, np.int8), np.full(11, "", dtype=object)
    status[0], error[0] = 4, "diverged: det F <= 0 at particle 2, t = 1 s, step 4"
    answer = 300 + u + 2 * kappa
    answer[1] = np.nan
    config = {"sweep": {"refine": {"of": "temperature.mean", "level": 304.0}}}
    fig = overview(tree({"kappa": kappa, "beta": np.exp(u)}, {"temperature_mean": answer}, status=status, error=error, sample=True, config=config))
    plane = fig.axes[0]
    assert (plane.get_xscale(), plane.get_yscale(), len(plane.collections[0].get_offsets())) == ("linear", "log", 9)
    x, y = np.vstack([path.vertices for path in plane.collections[1].get_paths()]).T
    assert np.log(y) + 2 * x == pytest.approx(4, abs=1e-9)
    said = [text.get_text() for found in plane.get_children() if isinstance(found, Legend) for text in found.get_texts()]
    assert said[0].endswith("°C, straight between the points") and said[1] == "not reached (1 point)" and said[2].startswith("diverged")


@pytest.mark.parametrize("config", [{"formulas": {"surfaces.0.convection.beta": "40 * kappa"}}, {"sweep": {"derive": {"beta": "40 * kappa"}}}])
def test_what_follows_from_another_parameter_has_no_panel_of_its_own(tree, config):
    kappa = np.random.default_rng(5).random(20)
    fig = overview(tree({"kappa": kappa, "beta": 40 * kappa}, {"temperature_mean": 300 + kappa}, sample=True, config=config))
    assert [ax.get_xlabel() for ax in fig.axes] == ["κ [W/m/K]", "Spearman, 95 % bootstrap"]
