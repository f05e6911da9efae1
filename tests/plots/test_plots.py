"""Figures: files are made, axes say what and in which unit, failed points are marked with their reason, nothing raises for NaN."""

import time

import numpy as np
import pytest
import xarray as xr

import mpm.plots
from mpm.plots import UnknownFigure, _draw, figures, overview


def texts(fig):
    """Every word on a figure."""
    from matplotlib.text import Text

    fig.canvas.draw_idle()
    return [found.get_text() for found in fig.findobj(Text) if found.get_text()]


def panels(fig):
    return [ax for ax in fig.axes if ax.axison]


def marked(ax, marker):
    """Points that a panel marks with `marker`, legends apart."""
    return sum(len(line.get_xdata()) for line in ax.lines if line.get_marker() == marker)


def test_two_axes_give_a_final_with_a_line_a_value_and_series_beside_it(loaf, tmp_path):
    fig = overview(loaf, tmp_path / "sweep.png")
    assert (tmp_path / "sweep.png").stat().st_size > 10_000
    final, series = panels(fig)
    assert final.get_ylabel() == "Time for centre to reach 95 °C [s]"
    assert final.get_xlabel() == "Heat-transfer coefficient β [W/m²/K]"
    assert final.get_xscale() == "log"
    assert series.get_xlabel() == "Time [s]"
    assert series.get_ylabel() == "Temperature [°C]"
    assert fig.get_suptitle() == "A title"
    assert {"κ [W/m/K]", "0.2", "0.35", "0.5", "centre", "crust", "centre, measured"} <= set(texts(fig))


def test_width_is_that_of_a_page(loaf, tmp_path):
    from matplotlib.image import imread

    overview(loaf, tmp_path / "sweep.png")
    assert imread(tmp_path / "sweep.png").shape[1] == 1600


def test_points_that_are_not_ok_are_crosses_with_their_reason(loaf):
    fig = overview(loaf)
    final = panels(fig)[0]
    assert marked(final, "x") == 2
    assert marked(final, "^") == 1
    assert {"diverged: det F ≤ 0 (2 points)", "pending (1 point)", "not reached within 100 s (1 point)"} <= set(texts(fig))


def test_the_point_nearest_to_measured_stands_for_the_sweep(loaf):
    fig = overview(loaf)
    series = panels(fig)[1]
    assert series.get_title(loc="left") == "β = 10.8 W/m²/K"
    dots = next(line for line in series.lines if line.get_marker() == "o" and len(line.get_xdata()) == 3)
    np.testing.assert_allclose(dots.get_ydata(), np.array([310.0, 330, 350]) - 273.15)
    assert any("κ = 0.35 W/m/K, rms off the measured curve: centre 0.0 K" in text for text in texts(fig))


def test_series_that_ended_early_say_so(loaf):
    beside = loaf.isel(beta=[3, 2])
    assert "the run ended here" in texts(_draw(beside, "series"))


@pytest.mark.parametrize("error", ["", "diverged: det F <= 0 at particle 1, t = 2 s, step 3"])
def test_a_sweep_without_one_good_point_says_so(tree, tmp_path, error):
    bad = tree({"kappa": [0.1, 0.2]}, {"temperature_mean": [1.0, 2.0]}, status=[4, 1], error=[error, "failed: ValueError: no"])
    for kind in ("overview", "series", "finals"):
        assert _draw(bad, kind) is not None
    words = "\n".join(texts(overview(bad, tmp_path / "sweep.png")))
    assert "None of 2 points is ok" in words
    assert "failed: ValueError: no" in words
    assert (tmp_path / "sweep.png").exists()


def test_a_sweep_that_has_not_begun_says_so(tree):
    assert "No point has run yet." in texts(overview(tree({"kappa": [0.1, 0.2]}, {}, status=[6, 6])))


def test_errors_over_cells_are_logarithmic_both_ways_and_tell_their_order(tree):
    cells = np.array([1, 2, 4, 8]) * 1e-3
    fig = overview(tree({"cell": cells}, {"error_l2": 3 * cells**2, "error_max": 9 * cells**2}))
    ax = panels(fig)[0]
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert ax.get_xlabel() == "Edge of a cell [mm]"
    assert ax.get_ylabel() == "Error against the exact solution [K]"  # a difference: not in degrees Celsius
    assert "root mean square, order 2.00" in texts(fig)


def test_infinity_has_a_place_on_the_axis(tree):
    fig = overview(tree({"beta": [0.1, 1.0, 10.0, np.inf]}, {"error_l2": [1e-4, 2e-4, 3e-4, 4e-4]}))
    ax = panels(fig)[0]
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["0.1", "1", "10", "∞"]
    np.testing.assert_allclose(ax.lines[0].get_xdata(), [0.1, 1, 10, 100])


def test_two_coefficients_of_one_name_say_whose_they_are(tree):
    data = tree({"pan_convection_beta": [1.0, 5.0, 9.0], "air_convection_beta": [2.0, 3.0]}, {"temperature_mean": np.ones((3, 2)) * 300})
    panel = _draw(data, "overview").axes[0]
    assert panel.get_xlabel() == "Heat-transfer coefficient, pan convection β [W/m²/K]"
    assert "air convection β [W/m²/K]" in texts(panel.figure)


def test_kinds_on_an_axis_are_words(tree):
    fig = overview(tree({"transfer": np.array(["apic", "flip"], dtype=object)}, {"temperature_mean": [300.0, 301.0]}))
    assert [tick.get_text() for tick in panels(fig)[0].get_xticklabels()] == ["apic", "flip"]


def test_three_axes_give_a_panel_a_value_of_the_third(tree):
    shape = (2, 4, 3)
    axes = {"cell": [1e-3, 2e-3], "beta": [5.0, 10, 20, 40], "kappa": [0.2, 0.3, 0.4]}
    fig = overview(tree(axes, {"time_to_centre_95_degC": np.arange(24.0).reshape(shape) + 1}))
    assert [ax.get_title(loc="left") for ax in panels(fig)] == ["cell = 1 mm", "cell = 2 mm"]


def test_many_points_are_drawn_at_once(tree, tmp_path):
    """Colours were once worked out anew for each point: 3000 of them took minutes, of processor time."""
    kappa = np.linspace(0.1, 1.0, 3000)
    whole = tree({"kappa": kappa}, {"temperature_mean": 300 + kappa}, {"temperature_mean": 300 + kappa[:, None] * np.arange(5)})
    began = time.process_time()
    overview(whole, tmp_path / "many.png")
    assert time.process_time() - began < 10


def test_lines_beyond_a_legend_get_a_colour_bar(tree):
    axes = {"kappa": np.linspace(0.1, 0.5, 10), "beta": np.geomspace(5, 50, 12)}
    fig = overview(tree(axes, {"time_to_centre_95_degC": np.random.default_rng(0).random((10, 12)) + 1}))
    assert "Heat conductivity κ [W/m/K]" in [ax.get_ylabel() for ax in fig.axes]


def test_a_single_run_gives_its_series(tree):
    time = np.linspace(0, 1, 11)
    config = {"output": {"observables": ["energy.kinetic", "energy.elastic", "position.mean_z"]}}
    series = {"energy_kinetic": time, "energy_elastic": 1 - time, "position_mean_z": time / 100, "mass_total": time * 0 + 1}
    fig = overview(tree({}, {"energy_kinetic": 1.0}, series, config=config, time=time))
    assert sorted(ax.get_ylabel() for ax in panels(fig)) == ["Centre of mass along z [mm]", "Energy [J]"]


def test_a_run_that_asks_for_nothing_shows_what_changes(tree):
    time = np.linspace(0, 1, 11)
    series = {"mass_total": time * 0 + 1, "pressure_mean": 1e-15 * time, "energy_kinetic": time, "energy_elastic": 1e-12 * time, "temperature_mean": time + 300}
    fig = overview(tree({}, {"mass_total": 1.0}, series, time=time))
    assert sorted(ax.get_ylabel() for ax in panels(fig)) == ["Kinetic energy [J]", "Mean temperature [°C]"]
    fig = overview(tree({}, {"mass_total": 1.0}, {"mass_total": time * 0 + 1}, time=time))
    assert [ax.get_ylabel() for ax in panels(fig)] == ["Total mass [kg]"]


def test_series_in_one_legend_have_names_of_their_own(tree):
    """Once both were called `force, on bodies by bottom`."""
    time = np.linspace(0, 1, 5)
    series = {"force_bottom_x": time, "force_bottom_y": 2 * time}
    assert {"force, along x", "force, along y"} <= set(texts(overview(tree({}, {"force_bottom_x": 1.0}, series, time=time))))


def test_a_line_that_lies_on_another_lets_it_through(tree):
    from matplotlib.legend import Legend

    time = np.linspace(0, 1, 6)
    series = {"temperature_max": 300 + time, "temperature_mean": 300 + 0.999 * time, "temperature_min": 300 + 0.9 * time}
    ax = mpm.plots.over_time(tree({}, {"temperature_max": 301.0}, series, time=time), list(series)).axes[0]
    assert [line.is_dashed() for line in ax.lines] == [False, True, False]
    assert [line.is_dashed() for legend in ax.findobj(Legend) for line in legend.get_lines()] == [False, True, False]


def test_what_no_point_reached_is_told_under_the_figure(tree):
    time = np.linspace(0, 10, 11)
    finals = {"temperature_mean": [300.0, 310.0], "time_to_centre_95_degC": [np.nan, np.nan]}
    said = "Time for centre to reach 95 °C: not reached"
    series = np.array([time, time]) + 300
    assert f"{said} by any point" in texts(overview(tree({"kappa": [0.1, 0.2]}, finals, {"temperature_mean": series}, time=time)))
    drawn = texts(overview(tree({"kappa": [0.1, 0.2]}, finals, {"temperature_mean": series}, time=time, sample=True)))
    assert f"{said} by any point\n2 points ok: too few for rank correlations" in drawn
    one = {"temperature_mean": 300.0, "time_to_centre_95_degC": np.nan}
    assert said in texts(overview(tree({}, one, {"temperature_mean": time + 300}, time=time)))


def test_every_kind_is_made_of_every_shape_that_has_it(tree, loaf):
    """What cannot be drawn is an error with advice, not a picture of words; an overview tells its numbers."""
    one = tree({"kappa": [0.1]}, {"temperature_mean": [300.0]})
    bare = tree({}, {"temperature_mean": 300.0})
    empty = tree({"kappa": [0.1, 0.2]}, {"time_to_centre_95_degC": [np.nan, np.nan]})
    for each in (one, bare, empty, loaf):
        assert _draw(each, "overview").get_suptitle() == "A title"
    assert "Mean temperature: 26.9 °C" in texts(_draw(bare, "overview"))
    assert any("not reached by any point" in text for text in texts(_draw(empty, "overview")))
    for kind in ("series", "finals"):
        assert _draw(loaf, kind).get_suptitle() == "A title"
        for each in (one, bare, empty):
            with pytest.raises(UnknownFigure, match="one point" if kind == "finals" and each is not empty else "no (series|finals) with a number"):
                _draw(each, kind)


def test_the_overview_shows_the_series_that_it_is_asked_for(tree):
    time = np.linspace(0, 10, 5)
    series = {"temperature_mean": time[None] + [[300.0], [310.0]], "extent_x": time[None] * [[1e-3], [2e-3]]}
    config = {"output": {"overview": ["extent_x", "temperature_mean"]}}
    made = tree({"kappa": [0.1, 0.2]}, {"temperature_mean": [310.0, 320.0], "extent_x": [0.01, 0.02]}, series, time=time, config=config)
    assert [ax.get_ylabel() for ax in overview(made).axes] == ["Extent of the material along x [mm]"] * 2


def test_a_list_of_points_that_differ_in_words(tree):
    """Once a picture that said `The sample varies no number.`"""
    made = tree({"transfer": np.array(["apic", "flip", "pic"])}, {"temperature_mean": [300.0, 301.0, 302.0]}, sample=True)
    axes = overview(made).axes
    assert [label.get_text() for label in axes[0].get_xticklabels()] == ["apic", "flip", "pic"]
    assert axes[0].lines[0].get_linestyle() == "None"  # kinds have no order: no line joins them
    same = tree({"kappa": np.full(2, 0.1)}, {"temperature_mean": [300.0, 300.0]}, sample=True)
    assert [label.get_text() for label in overview(same).axes[0].get_xticklabels()] == ["0", "1"]


def test_figures_of_a_folder(loaf, tmp_path):
    loaf.to_netcdf(tmp_path / "sweep.nc", engine="h5netcdf")
    assert figures(tmp_path) == [tmp_path / "overview.png"]
    assert figures(tmp_path, ["series", "finals"], svg=True) == [tmp_path / "series.svg", tmp_path / "finals.svg"]
    assert (tmp_path / "series.svg").read_text().startswith("<?xml")
    assert figures(tmp_path, "series", tmp_path / "a.png") == [tmp_path / "a.png"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "finals.svg", "overview.png", "series.svg", "sweep.nc"]


def test_what_cannot_be_drawn_is_told_before_anything_is_written(loaf, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"sweep\.nc"):
        figures(tmp_path)
    loaf.to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    with pytest.raises(UnknownFigure, match="overview, series"):
        figures(tmp_path, "overveiw")
    with pytest.raises(UnknownFigure, match="one file"):
        figures(tmp_path, ["series", "finals"], tmp_path / "a.png")
    with pytest.raises(UnknownFigure, match=r"\.png"):
        figures(tmp_path, "series", tmp_path / "a.gif")
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]


def test_points_with_warnings_are_rings_that_say_their_kinds(tree):
    axes = {"kappa": [0.2, 0.3, 0.4, 0.5]}
    found = tree(axes, {"temperature_mean": np.array([300.0, 301.0, 302.0, 303.0])}, status=[0, 0, 0, 1], error=["", "", "", "diverged: det F <= 0"])
    flags = {"flag_meanings": "volume temperature heat", "flag_masks": np.array([1, 2, 4], np.int32)}
    found["warning_flags"] = xr.DataArray(np.array([0, 3, 1, 1], np.int32), dims=["kappa"], attrs=flags)
    fig = overview(found)
    rings = [line for line in panels(fig)[0].lines if line.get_markerfacecolor() == "white" and line.get_marker() == "o"]
    assert [line.get_xdata().tolist() for line in rings] == [[0.3, 0.4]]
    assert "with warnings (2 points): volume 2, temperature 1" in texts(fig)
    assert not any("warnings" in text for text in texts(overview(tree(axes, {"temperature_mean": np.arange(4.0)}))))


@pytest.mark.parametrize(
    ("values", "log", "shown"), [([0.5, 0.52, 0.85], False, 2), ([1, 2, 3, 4], False, 4), ([1, 1.02, 1000], False, 2), ([1, 10, 100], True, 3)]
)
def test_labels_of_ticks_do_not_run_into_each_other(values, log, shown):
    from mpm.plots.axis import apart

    texts = apart(np.array(values, float), [f"{value}" for value in values], log, 30.0)
    assert sum(map(bool, texts)) == shown and texts[0] and texts[-1]


def test_figures_on_axes_of_ones_own(loaf):
    from matplotlib.figure import Figure

    mine = Figure()
    left, right = mine.subplots(1, 2)
    assert mpm.plots.final(loaf, "time_to_centre_95_degC", over="beta", ax=left) is mine
    assert mpm.plots.over_time(loaf, ["temperature_centre"], ax=right) is mine
    assert left.get_xlabel().startswith("Heat-transfer coefficient") and right.get_xlabel() == "Time [s]"
    assert len([line for line in left.lines if line.get_linestyle() == "-"]) == 3
    by_hand = Figure().add_axes((0.2, 0.2, 0.7, 0.7))
    assert mpm.plots.final(loaf, ax=by_hand) is by_hand.figure
    assert [ax.get_ylabel() for ax in mpm.plots.over_time(loaf).axes] == ["Temperature [°C]"]
    for call, said in ((mpm.plots.final, "there is no final 'no'"), (mpm.plots.over_time, "there is no series 'no'")):
        with pytest.raises(UnknownFigure, match=said):
            call(loaf, "no")
