"""`mpm chart`: settings from a config, errors and times that can be resumed, failures as points, what may be ranked, and the figure."""

import json

import numpy as np
import pytest
import xarray
from beams import TIP, beam

import mpm
from mpm.benchmarks.figures import STUDIES
from mpm.benchmarks.promises import PROBLEMS
from mpm.study.chart import chart, with_chart
from mpm.study.front import cheapest, pareto, sentence
from mpm.study.richardson import limit
from mpm.study.timing import Timings
from mpm.sweep.engine import Options
from mpm.sweep.settings import plan

SLAB = {
    "title": "Slab",
    "grid": {"dimension": 1, "size": [3.0], "cell": 0.25},
    "bodies": {"slab": {"shape": {"box": {"lower": [0.5], "upper": [2.5]}}, "temperature": 301, "material": "unit"}},
    "materials": {"unit": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
    "surfaces": [{"of": "slab", "convection": {"beta": 10, "outside": 300}}],
    "time": {"end": 0.2},
    "output": {"every": 0.1},
    "exact": {"robin_slab": {}},
}
METHODS = {
    "order 4": {"set": {"method.rigid": {"implicit": {"order": 4}}}},
    "hats": {"set": {"grid.basis": "linear"}, "refine": {"cell": {"grid.cell": [0.25]}}},  # rigid bodies refuse them
}


def slab(**more):
    return mpm.load(SLAB | {"chart": {"scale": 1, "repeats": 2, "methods": METHODS, "refine": {"cell": {"grid.cell": [0.5, 0.25]}}}} | more)


@pytest.fixture(scope="module")
def charted(tmp_path_factory):
    out = tmp_path_factory.mktemp("chart")
    return chart(slab(), out, Options(jobs=0), cold=False), out


def test_a_setting_may_set_what_the_base_has_not():
    elastic = {"set": {"materials.unit.elastic": {"hencky": {"lam": 1e-4, "mu": 1e-4}}}}
    cases = plan(slab(chart={"methods": {"rigid": {}, "particles": elastic}, "refine": {"cell": {"grid.cell": [0.5, 0.25]}}})).cases
    assert [case.experiment.moving for case in cases] == [False, False, True, True]
    assert [case.experiment.grid.cell for case in cases] == [0.5, 0.25, 0.5, 0.25]
    assert len({case.run_id for case in cases}) == 4


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"methods": {"a": {"set": {"grid.basis": "cubist"}}}, "refine": {"cell": {"grid.cell": [0.5]}}}, "cubist"),
        ({"methods": {"a": {}}, "refine": {"cell": {"grid.cell": [0.5, 0.25], "time.step": [0.1]}}}, "one length"),
        ({"methods": {"a": {"set": {"grid.cel": 1}}}, "refine": {"cell": {"grid.cell": [0.5]}}}, "cel"),
    ],
)
def test_what_is_wrong_is_said(wrong, said):
    with pytest.raises(mpm.ConfigError, match=said):
        plan(slab(chart=wrong))


def test_errors_times_and_failures_are_in_one_dataset(charted):
    result, out = charted
    assert result.exit_code == 3  # some settings failed, as they should
    with xarray.open_dataset(out / "chart.nc", engine="h5netcdf") as data:
        assert list(data.method.values) == ["order 4", "order 4", "hats"]
        assert data.relative_error.values[0] > 4 * data.relative_error.values[1] > 0
        assert np.isnan(data.relative_error.values[2]) and "quadratic splines only" in str(data.error.values[2])
        assert data.cpu_time.shape == (3, 2) and (data.cpu_time.values[:2] > 0).all() and (data.cpu_min <= data.cpu_median).values[:2].all()
        assert data.front.values[1] == 1
    assert len(result.sentences) == 3 and all("order 4" in line for line in result.sentences)


def test_the_same_again_does_nothing_and_an_interrupted_one_goes_on(charted):
    _, out = charted
    before = (out / "timing.json").read_bytes()
    chart(slab(), out, Options(jobs=0), cold=False)
    assert json.loads(before)["rounds"] == json.loads((out / "timing.json").read_text())["rounds"]
    cut = Timings.at(out / "timing.json")
    kept = dict(cut.rounds[0]["cpu"])
    dropped = cut.rounds[1]["cpu"].popitem()[0]
    cut.write()
    chart(slab(), out, Options(jobs=0), cold=False)
    again = Timings.at(out / "timing.json")
    assert again.rounds[0]["cpu"] == kept and dropped in again.rounds[1]["cpu"]


def test_the_folder_of_a_chart_is_an_ordinary_one(charted):
    from mpm.sweep.api import collect_folder
    from mpm.sweep.status import status

    _, out = charted
    assert collect_folder(out)[2]["ok"] == 2
    assert status(out)["counts"]["failed"] == 1


def test_the_figure_shows_failures_with_their_reason(charted, tmp_path):
    from mpm.plots.chart import speed_accuracy

    with xarray.open_dataset(charted[1] / "chart.nc", engine="h5netcdf") as data:
        fig = speed_accuracy(data.load(), tmp_path / "chart.png")
    assert (tmp_path / "chart.png").stat().st_size > 20_000
    texts = [text.get_text() for artist in fig.axes[0].artists for text in getattr(artist, "texts", [])]
    assert any("linear: bodies that do not move have quadratic splines only" in text for text in texts) and "order 4" in texts


def test_a_limit_stands_in_where_nothing_is_exact(tmp_path):
    """Without `exact`, the error of the mean temperature against the Richardson limit is that against the finest of all, within the reference's own error."""
    wanted = {"observables": ["temperature_mean"], "scale": 1, "repeats": 1, "methods": {"a": {}}, "refine": {"cell": {"grid.cell": [0.75, 0.5, 0.25]}}}
    tree = {key: value for key, value in SLAB.items() if key != "exact"} | {"method": {"rigid": {"implicit": {"tolerance": 1e-9}}}}
    chart(mpm.load(tree | {"chart": wanted}), tmp_path, Options(jobs=0), cold=False)
    fine = mpm.run_point(mpm.load(tree, {"grid.cell": 0.0625})).finals["temperature_mean"]
    with xarray.open_dataset(tmp_path / "chart.nc", engine="h5netcdf") as data:
        own = float(data.relative_error.attrs["reference_error"])
        true = np.abs(xarray.open_dataset(tmp_path / "sweep.nc", engine="h5netcdf").temperature_mean.values - fine)
        assert 0 < own < true[0]
        np.testing.assert_allclose(data.relative_error.values, true, atol=2 * own)


def test_a_deflection_is_measured_by_itself_wherever_the_beam_lies(tmp_path):
    """Of `position.mean_y`, 0.5 m less 0.4 mm: the chart's errors are those of the deflection, as finite elements see them, not of 0.5 m."""
    wanted = {"observables": ["position.mean_y"], "repeats": 1, "methods": {"total": {}}, "refine": {"cell": {"grid.cell": [0.1, 0.05, 0.04]}}}
    chart(beam(chart=wanted), tmp_path, Options(jobs=0), cold=False)
    tips = np.array([mpm.run_point(beam(**{"grid.cell": cell})).finals["displacement_tip_y"] for cell in (0.1, 0.05)])
    with xarray.open_dataset(tmp_path / "chart.nc", engine="h5netcdf") as data:
        own = float(data.relative_error.attrs["reference_error"])
        np.testing.assert_allclose(data.relative_error.values[:2], np.abs(tips / TIP - 1), atol=own)
        assert own < 0.0015 and data.relative_error.values[0] > 0.002  # of 0.5 m it would be 5e-6


def test_what_counts_as_all_of_a_quantity():
    """The largest change of what moves, along any direction and from any origin; the range of temperatures; else the range, at least a thousandth."""
    from mpm.reduce.change import size

    t = np.linspace(0, 1, 11)
    series = {"position_mean_x": 500 + 1e-4 * t, "position_mean_y": 0.5 - 0.02 * t, "temperature_min": 300 + 0 * t, "temperature_max": 300 + 7 * t,
              "temperature_tip": 300 + t, "energy_total": 8 + 0 * t, "pressure_mean": 3 * t}  # fmt: skip
    found = {name: size(name, series, series[name][-1]) for name in series}
    assert found["position_mean_x"] == pytest.approx(0.02) == found["position_mean_y"]
    assert found["temperature_tip"] == pytest.approx(7) and size("temperature_tip", series, 301, 40.0) == 40
    assert found["energy_total"] == pytest.approx(8e-3) and found["pressure_mean"] == pytest.approx(3)
    assert size("time_to_tip_300_5_K", series, 0.5) == 0.5


def test_scale_acts_and_is_one_unit(tmp_path):
    wanted = {"observables": ["position.mean_y"], "scale": 0.05, "repeats": 1, "methods": {"total": {}}, "refine": {"cell": {"grid.cell": [0.2, 0.1]}}}
    chart(beam(chart=wanted), tmp_path, Options(jobs=0), cold=False)
    with xarray.open_dataset(tmp_path / "chart.nc", engine="h5netcdf") as data:
        ends = xarray.open_dataset(tmp_path / "sweep.nc", engine="h5netcdf").position_mean_y.values
        limit_of_two = ends[1] + (ends[1] - ends[0])
        np.testing.assert_allclose(data.relative_error.values, np.abs(ends - limit_of_two) / 0.05, rtol=1e-6)


@pytest.mark.parametrize(("wrong", "said"), [
    ({"observables": ["position.mean"]}, r"chart\.observables\.0: unknown observable"),
    ({"observables": ["displacement.tip_x"]}, "it is not recorded"),
    ({"observables": ["displacement.top_y"]}, "there is no probe 'top'"),
    ({"observables": ["position.mean_z"]}, "no such direction"),
    ({"error": ["error_displacement"]}, "no exact solution to err from"),
    ({"error": ["error_placement"]}, "unknown error"),
    ({"observables": ["position.mean_y", "energy.elastic"], "scale": 1}, "one number cannot be 100 %"),
    ({"methods": {"a": {}}, "reference": "b"}, "no such method"),
])  # fmt: skip
def test_what_a_chart_compares_is_checked_before_anything_runs(wrong, said):
    with pytest.raises(mpm.ConfigError, match=said):
        beam(chart=wrong)


def test_a_chart_without_anything_to_compare_is_refused():
    tree = {key: value for key, value in SLAB.items() if key != "exact"}
    with pytest.raises(mpm.ConfigError, match="nothing can be compared"):
        with_chart(mpm.load(tree))
    with pytest.raises(mpm.ConfigError, match=r"an error in Pa needs what counts as 100 %"):
        mpm.load(SLAB | {"chart": {"error": ["error_stress_max"]}})


def test_richardson_finds_limit_and_order():
    sizes = np.array([0.4, 0.2, 0.1])
    value, error = limit(sizes, 3 + 5 * sizes**2)
    assert value == pytest.approx(3, abs=1e-12) and error == pytest.approx(1.25 * 0.05)
    uneven = np.array([0.75, 0.5, 0.25])
    assert limit(uneven, 3 - 2 * uneven**3)[0] == pytest.approx(3, abs=1e-12)
    value, error = limit(sizes, 3 + 5 * sizes**0.5)
    assert value == pytest.approx(3, abs=1e-9)
    assert limit(sizes, 3 + 5 * sizes**0.3)[1] == pytest.approx(1.25 * 5 * (0.2**0.3 - 0.1**0.3) / (2**0.5 - 1))  # slower: as if of order 0.5
    value, error = limit(sizes, np.array([1.0, 1.2, 1.1]))  # does not settle: the last change is the error
    assert error == pytest.approx(1.25 * 0.1)
    assert np.isnan(limit(sizes, np.array([np.nan, np.nan, 1.0]))[0])


def test_front_and_cheapest_leave_what_overlaps_unranked():
    error, least = np.array([0.1, 0.01, 0.02, np.nan, 0.001]), np.array([1.0, 2.0, 1.9, 1.0, 8.0])
    assert pareto(error, least).tolist() == [True, True, True, False, True]
    assert pareto(np.array([0.1, 0.2]), np.array([1.0, 2.0])).tolist() == [True, False]
    median = np.array([1.1, 2.2, 1.95, 1.1, 9.0])
    found = cheapest(error, least, median, 0.05)
    assert found.index == 2 and found.ties == ()
    assert cheapest(error, least, np.array([1.1, 2.2, 2.1, 1.1, 9.0]), 0.05).ties == (1,)
    assert cheapest(error, least, median, 1e-9).index is None
    assert "cannot be told" in sentence(cheapest(error, least, median, 0.05), list("abcde"), error, least, median, 0.06)
    assert "not ranked: b" in sentence(cheapest(error, least, np.full(5, 2.1), 0.05), list("abcde"), error, least, median)


def test_defaults_follow_the_physics_of_the_config():
    rigid = with_chart(mpm.load(SLAB)).chart
    assert any("explicit" in name for name in rigid.methods) and set(rigid.refine) == {"cell"}
    moving = with_chart(mpm.load(SLAB, {"materials.unit.elastic": {"hencky": {"lam": 1.0, "mu": 1.0}}})).chart
    assert {"APIC", "FLIP", "PIC", "affine FLIP"} <= set(moving.methods) and set(moving.refine) == {"Co = const", "dt* = const"}
    bending = with_chart(beam()).chart
    assert bending.refine["Co = const"]["grid.cell"] == (0.1, 0.05, 0.025)  # two over its height at least
    assert next(iter(bending.methods)) == "total frame" and bending.methods["FLIP"].set == {"method.frame": "updated", "method.transfer": "flip"}
    ratio = {name: np.array(path["method.heat_step"][:-1]) / path["method.heat_step"][1:] for name, path in moving.refine.items()}
    np.testing.assert_allclose(ratio["Co = const"], 2)
    np.testing.assert_allclose(ratio["dt* = const"], 4)
    swept = with_chart(mpm.load(SLAB | {"sweep": {"axes": {"beta": [1, 10], "grid.cell": [0.25, 0.5], "method.offset": [[0.0], [0.3]]}}})).chart
    assert len(swept.methods) == 2 and next(iter(swept.methods.values())).refine["cell"]["grid.cell"] == (0.5, 0.25)
    quick = with_chart(mpm.load(SLAB), quick=True).chart
    assert len(next(iter(quick.refine["cell"].values()))) == 3 == quick.repeats
    assert with_chart(slab(), quick=True).chart.repeats == 2


def test_the_command_says_the_answer_and_draws(tmp_path, capsys):
    """From the shell: exit code, one JSON document with the answer, the picture; a wrong chart is told at its place."""
    from mpm_cli.main import main

    config = tmp_path / "slab.yaml"
    config.write_text(json.dumps(SLAB | {"chart": {"scale": 1, "repeats": 1, "methods": {"rigid": {}}, "refine": {"cell": {"grid.cell": [0.5, 0.25]}}}}))
    assert main(["chart", str(config), "--quick", "--json", "-j", "1", "-o", str(tmp_path / "out")]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["counts"]["ok"] == 2 and "for 1 %: rigid" in told["answer"][1]
    assert (tmp_path / "out" / "chart.png").exists() and told["dataset"].endswith("chart.nc")
    config.write_text(json.dumps(SLAB | {"chart": {"methods": {"a": {"set": {"grid.cel": 1}}}, "refine": {"cell": {"grid.cell": [0.5]}}}}, indent=1))
    assert main(["chart", str(config)]) == 2
    assert "chart.methods.a" in capsys.readouterr().err


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_six_charts_refine_cell_and_step_together(name):
    """Along Co = const steps go as the cell, along dt* = const as its square (manufactured and coupled ones: those of mechanics and of heat)."""
    chart = mpm.load(STUDIES / f"{name}.yaml").chart
    assert {"Co = const", "dt* = const"} <= set(chart.refine) and "PIC" in chart.methods and "APIC" in chart.methods
    for path, power in (("Co = const", 1), ("dt* = const", 2)):
        refined = {key: np.array(values, float) for key, values in chart.refine[path].items()}
        cells = refined.pop("grid.cell")
        assert refined and len(cells) >= 3
        for steps in refined.values():
            np.testing.assert_allclose(steps / steps[0], (cells / cells[0]) ** power, rtol=2e-3)
