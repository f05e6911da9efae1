"""Measured curves: read from a CSV beside the config, carried as numbers, compared with the run."""

import math

import pytest

import mpm

BASE = """\
grid: {dimension: 1, size: [1.0], cell: 0.25}
bodies: {slab: {shape: {box: {lower: [0.25], upper: [0.75]}}, temperature: 300, material: unit}}
materials: {unit: {density: 1, heat: {fourier: {kappa: 1, alpha: 1}}}}
time: {end: 120}
output:
  probes: {middle: [0.5]}
  measured: {middle: {file: curve.csv, time: minute, value: oven_degC}}
"""


def written(folder, rows, config=BASE):
    (folder / "curve.csv").write_text("# a comment\nminute,oven_degC\n" + rows)
    path = folder / "scene.yaml"
    path.write_text(config)
    return path


def test_samples_are_seconds_and_kelvin_and_survive_a_round_trip(tmp_path):
    experiment = mpm.load(written(tmp_path, "1,26.85\n2,36.85\n"))
    samples = experiment.output.measured["middle"].samples
    assert [t for t, _ in samples] == [60, 120]
    assert [theta for _, theta in samples] == pytest.approx([300, 310])
    (tmp_path / "curve.csv").unlink()
    assert mpm.load(experiment.resolved()).output.measured["middle"].samples == samples


def test_misfit_is_the_root_mean_square_difference_at_times_reached(tmp_path):
    # Nothing heats the slab: it stays at 300 K, so the differences are 0 and 10 K; the third row lies beyond the end.
    run = mpm.run_point(mpm.load(written(tmp_path, "1,26.85\n2,36.85\n3,1000\n")))
    assert run.finals["misfit_middle"] == pytest.approx(10 / math.sqrt(2), rel=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("curve.csv", "none.csv", 7, "cannot read 'none.csv'"),
        ("time: minute", "time: minutes", 7, "no such column: 'minutes'; allowed: minute"),
        ("oven_degC", "oven", 7, "no such column: 'oven'; allowed: oven_degC"),
        ("{middle: {file", "{edge: {file", 7, "there is no probe 'edge'; allowed: middle"),
    ],
)
def test_what_is_wrong_with_it_has_a_place(tmp_path, old, new, line, words):
    with pytest.raises(mpm.ConfigError) as caught:
        mpm.load(written(tmp_path, "1,20\n", BASE.replace(old, new)))
    assert f"scene.yaml:{line}:" in str(caught.value)
    assert words in str(caught.value)


def test_a_row_that_is_no_number_is_told(tmp_path):
    with pytest.raises(mpm.ConfigError, match="could not convert"):
        mpm.load(written(tmp_path, "1,warm\n"))
