"""What is drawn as a trend and what is not: round-off, books that close, narrow ranges; and the ticks that tell values apart."""

import numpy as np

import mpm.plots
from mpm.plots import _draw, overview


def panels(fig):
    return [ax for ax in fig.axes if ax.axison]


def test_round_off_and_what_never_changes_is_no_trend(tree):
    kappa, time = np.array([1.0, 2.0, 3.0]), np.linspace(0, 10, 6)
    finals = {"error_l2": np.array([0, 6e-14, 3e-14]), "mass_total": np.ones(3), "energy_kinetic": np.full(3, 1e-21), "temperature_mean": 300 + kappa}
    series = {"temperature_mean": 300 + kappa[:, None] * time, "energy_kinetic": np.full((3, 6), 1e-21), "energy_elastic": np.full((3, 6), 2.0)}
    made = tree({"kappa": kappa}, finals, series, time=time)
    assert overview(made).axes[0].get_ylabel() == "Mean temperature [°C]"
    low, high = mpm.plots.over_time(made, "energy_kinetic").axes[0].get_ylim()
    assert high - low > 1e9 * 1e-21


def test_a_momentum_of_round_off_is_no_trend(tree):
    time = np.linspace(0, 1, 6)
    series = {"momentum_x": 1e-19 * time, "momentum_y": -2e-19 * time, "mass_total": 3 + 0 * time, "velocity_max": 0.006 * time, "error_l2": 0.1 * time}
    said = [ax.get_ylabel() for ax in panels(overview(tree({}, {"error_l2": 0.1}, series, time=time)))]
    assert not any("omentum" in text for text in said) and any("speed" in text for text in said)
    series["momentum_x"] *= 1e12
    assert any("omentum" in ax.get_ylabel() for ax in panels(overview(tree({}, {"error_l2": 0.1}, series, time=time))))


def test_ticks_of_a_narrow_logarithmic_axis_tell_apart(tree):
    ax = panels(overview(tree({"cell": np.array([0.1, 0.2, 0.4])}, {"error_l2": np.array([48.505, 48.495, 48.47])})))[0]
    shown = [text.get_text() for text in ax.get_yticklabels() if text.get_text()]
    assert ax.get_yscale() == "log" and len(shown) > 2 and len(set(shown)) == len(shown)


def test_books_that_hold_what_they_miss_are_not_drawn(tree):
    time = np.linspace(0, 1, 6)
    series = {"heat_total": 1e-15 * np.sin(9 * time), "heat_ledger": 1e-15 * np.cos(7 * time), "temperature_max": 300 + time, "error_l2": 0.1 * time}
    made = tree({}, {"temperature_max": 301.0}, series, time=time)
    said = [ax.get_ylabel().replace("\n", " ") for ax in panels(overview(made))]
    assert said == ["Root-mean-square error against the exact solution [K]", "Highest temperature [°C]"]


def test_no_axis_writes_mathematics_or_a_factor_at_its_end(tree, tmp_path):
    kappa = np.array([1.0, 2.0, 3.0, 4.0])
    wide = tree({"kappa": kappa}, {"error_l2": np.array([1e-9, 1e-7, 1e-5, 1e-4]), "energy_kinetic": kappa * 1e13, "temperature_mean": 99.99 + 1e-5 * kappa})
    for name in ("overview", "finals"):
        figure = _draw(wide, name)
        figure.savefig(tmp_path / "a.png")
        for ax in panels(figure):
            labels = [label.get_text() for axis in (ax.xaxis, ax.yaxis) for label in axis.get_ticklabels()]
            assert not any("$" in text or "e+" in text or "e-" in text for text in labels)
            assert ax.yaxis.get_offset_text().get_text() == ax.xaxis.get_offset_text().get_text() == ""
    mine = mpm.plots.final(wide, "temperature_mean")
    mine.savefig(tmp_path / "b.png")
    texts = [label.get_text() for label in mine.axes[0].get_yticklabels()]
    assert len(set(texts)) == len(texts)
