"""Measured curves: read from a CSV beside the config, carried as numbers, compared with the run."""

import math
import os
import re

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


def test_the_only_column_beside_the_time_needs_no_name(tmp_path):
    bare = BASE.replace(", time: minute, value: oven_degC", "")
    named = mpm.load(written(tmp_path, "1,26.85\n2,36.85\n")).output.measured["middle"].samples
    assert mpm.load(written(tmp_path, "1,26.85\n2,36.85\n", bare)).output.measured["middle"].samples == named
    (tmp_path / "curve.csv").write_text("minute,oven_degC,core_degC\n1,26.85,20\n")
    with pytest.raises(mpm.ConfigError, match=r"curve.csv:1: which column is it\? Name it by `value`; allowed: oven_degC, core_degC"):
        mpm.load(tmp_path / "scene.yaml")


def test_a_column_is_named_with_or_without_the_unit_in_brackets(tmp_path):
    path = written(tmp_path, "", BASE.replace("time: minute, value: oven_degC", "time: Elapsed, value: core"))
    (tmp_path / "curve.csv").write_text("Elapsed [min],core [°F],oven [°F]\n1,80.33,400\n")
    assert mpm.load(path).output.measured["middle"].samples[0] == pytest.approx((60, 300), abs=1e-9)  # 80.33 °F
    (tmp_path / "curve.csv").write_text("Elapsed [min],core [°F],core [°C]\n1,80.33,400\n")
    with pytest.raises(mpm.ConfigError, match=r"no such column: 'core'; allowed: core \[°F\], core \[°C\]"):
        mpm.load(path)


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


HEAD = "minute,oven_degC\n"


def curve(folder, content, config=BASE):
    """The samples of a file with this content, bytes and all."""
    (folder / "curve.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    path = folder / "scene.yaml"
    path.write_text(config)
    return mpm.load(path).output.measured["middle"].samples


@pytest.mark.parametrize(
    ("content", "line", "words"),
    [
        (HEAD, 2, "no rows follow the header"),
        ("", 1, "the file is empty"),
        (HEAD + "1,20\n2\n", 3, "1 fields under a header of 2"),
        (HEAD + "1,20\n2,30,40\n", 3, "3 fields under a header of 2"),
        (HEAD + "1,20\n2," + "9" * 200_000 + "\n", 3, "field larger than field limit"),
        (HEAD + "1,20\n2,warm\n", 3, "oven_degC is no finite number: 'warm'"),
        (HEAD + "1,20\n\n# gap\n2,\n", 5, "oven_degC is no finite number: ''"),
        (HEAD + "nan,20\n", 2, "minute is no finite number"),
        (HEAD + "1,1_0\n", 2, "oven_degC is no finite number"),
        (HEAD + "-1,20\n", 2, "a time before the start of the run"),
        (HEAD + "1,-300\n", 2, "below absolute zero"),
        (HEAD + '1,"20\n2,30\n', 2, "this is not CSV"),
        (HEAD.encode() + b"1,20\n2,\xff\n", 3, "not UTF-8 text (byte 0xff)"),
        ("minute|oven_degC\n1|20\n", 1, "no such column: 'oven_degC'"),
        (HEAD + '1,"1,000"\n', 2, "'1,000'; allowed: 1000 or 1.000, or semicolons between the fields"),
        ("minute,oven_degC\n12:75,20\n", 2, "'12:75' is no time of day"),
        ("minute,oven_degC\n31.02.2026 12:00,20\n", 2, "is no date"),
        ("minute,oven_degC\n5/1/2026 23:00,20\n5/2/2026 1:00,20\n", 3, "5/2/2026 may be two days, and dates of this column differ"),
        ("minute;oven_degC;\n0;20;\n1;;\n", 3, "oven_degC is no finite number: ''"),
        ("minute;oven_degC\n1;20,5\n2;1.000,5\n", 3, "oven_degC is no finite number: '1.000,5'"),
        ("minute,oven_degC,oven_degC\n1,20,30\n", 1, "two columns are called 'oven_degC'"),
        (HEAD + "1,20\n" * 100_001, 100_002, "more than 100000 rows"),
    ],
    ids=lambda value: value if isinstance(value, str) and len(value) < 40 else "",
)
def test_a_bad_row_is_told_with_config_file_and_line(tmp_path, content, line, words):
    with pytest.raises(mpm.ConfigError) as caught:
        curve(tmp_path, content)
    said = str(caught.value)
    assert re.search(r"scene\.yaml:7:\d+: output\.measured\.middle", said) and f"curve.csv:{line}: " in said and words in said
    assert len(said) < 1000


@pytest.mark.parametrize(("unit", "seconds"), [("second", 1), ("minute", 60), ("hour", 3600)])
def test_every_unit_of_time(tmp_path, unit, seconds):
    samples = curve(tmp_path, f"{unit},oven_K\n2,300\n3,310\n", BASE.replace("time: minute, value: oven_degC", f"time: {unit}, value: oven_K"))
    assert samples == ((2 * seconds, 300), (3 * seconds, 310))


def test_a_byte_order_mark_blanks_and_other_line_ends_do_not_matter(tmp_path):
    samples = curve(tmp_path, b"\xef\xbb\xbf# a comment\r\nminute, oven_degC\r\n1, 26.85\r\n\r\n2, 36.85\r\n")
    assert [t for t, _ in samples] == [60, 120]
    assert [theta for _, theta in samples] == pytest.approx([300, 310])


SCENE = BASE.replace("  probes:", "  observables: [temperature.mean, heat.total]\n  probes:").partition("  measured:")[0] + "  measured: {middle: {%s}}\n"


@pytest.mark.parametrize(
    ("content", "how", "samples"),
    [
        ("minute;Ofen [°F]\n1,5;68\n2,25;104\n", "value: 'Ofen [°F]'", [(90, 293.15), (135, 313.15)]),
        ("time [min]\toven_degC\n0\t20\n1.5\t40\n", "value: oven_degC", [(0, 293.15), (90, 313.15)]),
        ("Time,Heat (kJ/m2)\n12:30:00,1.5\n12:31:30,2\n", "of: heat.total, value: Heat (kJ/m2)", [(0, 1500), (90, 2000)]),
        ("Time,T\n23:59,20\n", "unit: degC, value: T, start: '23:58'", [(60, 293.15)]),
        ("Timestamp,T_degC\n2026-05-01 23:59:30,20\n2026-05-02 00:00:15,30\n", "value: T_degC", [(0, 293.15), (45, 303.15)]),
        ("minute,oven_degC,spread_K\n0,20,0.5\n1,40,1\n", "value: oven_degC, sigma: spread_K", [(0, 293.15, 0.5), (60, 313.15, 1)]),
        ("minute,oven_degC\n1,10\n2,20\n4,40\n", "value: oven_degC, start: 2", [(0, 293.15), (120, 313.15)]),
        ("Zeit [min];Ofen [°C]\n0;20\n1;40\n".encode("cp1252"), "time: 'Zeit [min]', value: 'Ofen [°C]'", [(0, 293.15), (60, 313.15)]),
        ("minute\tT [°C]\n0\t20\n1\t40\n".encode("utf-16"), "value: 'T [°C]'", [(0, 293.15), (60, 313.15)]),
        ("Time,T (°F)\n11:59 AM,68\n12:00:30 p.m.,104\n", "value: T (°F)", [(0, 293.15), (90, 313.15)]),
        ("Time,T_C\n23:58,20\n0:03,40\n", "value: T_C", [(0, 293.15), (300, 313.15)]),
        ("Time,T_C\n0:03,40\n", "value: T_C, start: '23:58'", [(300, 313.15)]),
        ("Datum;T_C\n01.05.2026 23:59:30;20\n02.05.2026 0:00:15;40\n", "time: Datum, value: T_C", [(0, 293.15), (45, 313.15)]),
        ("Timestamp,T_F\n2026-10-25T02:30:00+02:00,68\n2026-10-25T02:30:00.500+01:00,104\n", "value: T_F", [(0, 293.15), (3600.5, 313.15)]),
        ("Lap [mm:ss],T (Celsius)\n00:00,20\n01:30,40\n", "value: T (Celsius)", [(0, 293.15), (90, 313.15)]),
        ("probe_minute,T_C\n0,20\n1,40\n", "time: probe_minute, value: T_C", [(0, 293.15), (60, 313.15)]),
        ("Clock,T_C\n30:00:00,20\n30:00:10,40\n", "value: T_C", [(0, 293.15), (10, 313.15)]),
        ("sep=;\nt / min;T / °C;\n0,5;20,0;\n1;40;\n", "unit: ''", [(30, 293.15), (60, 313.15)]),
        ('"Time, min","Core, °F"\n"0,0",68\n"1,5","104,0"\n', "weight: 1", [(0, 293.15), (90, 313.15)]),
        ("Zeit;Kern\nmin;°C\n0;20\n1,5;40\n", "value: Kern", [(0, 293.15), (90, 313.15)]),
        ("a_min;a_C;b_min;b_C\n0;20;0;20\n1;30;1,5;40\n2;40;;\n", "time: b_min, value: b_C", [(0, 293.15), (90, 313.15)]),
        ("Date,Time,CH1 (deg C)\n2026-05-01,23:59,20\n2026-05-02,0:00,40\n", "weight: 1", [(0, 293.15), (60, 313.15)]),
        ("Timestamp,T (°F)\n4/30/2026 11:59:00 PM,68\n5/1/2026 12:00:30 AM,104\n", "weight: 1", [(0, 293.15), (90, 313.15)]),
        ("Zeit;T_C\n30/04/26 23:59;20\n01/05/26 00:00;40\n", "weight: 1", [(0, 293.15), (60, 313.15)]),
        ("Time (min);T_C\n0:30;20\n100:30;−40\n", "weight: 1", [(30, 293.15), (6030, 233.15)]),
        ("# s, T_K, sd_K\n0, 293.15, 1\n60, 313.15, 2\n", "value: T_K, sigma: sd_K", [(0, 293.15, 1), (60, 313.15, 2)]),
        ("s;T (ºC)\n0;20\n60;40\n".encode("cp1252"), "weight: 1", [(0, 293.15), (60, 313.15)]),
        ("s;T [℉]\n0;68\n60;104\n", "weight: 1", [(0, 293.15), (60, 313.15)]),
        ("s,T_F,spread\n0,68,1.8\n60,104,3.6\n", "value: T_F, sigma: spread", [(0, 293.15, 1), (60, 313.15, 2)]),
    ],
)
def test_curves_as_people_write_them(tmp_path, content, how, samples):
    found = curve(tmp_path, content, SCENE % f"file: curve.csv, {how}")
    assert [item for row in found for item in row] == pytest.approx([item for row in samples for item in row])


PROBE = "\n".join(["Combustion Inc. Probe Data", "App: iOS 2.1.0", "CSV version: 4", "Probe S/N: 10001A2B", "Probe FW version: v1.2.2",
    "Probe HW revision: v0.31-A1", "Framework: iOS", "Sample Period: 5000", "Created: 2026-05-01 12:00:00", "",
    "Timestamp,SessionID,SequenceNumber,T1,T2,T3,T4,T5,T6,T7,T8,VirtualCoreTemperature",
    "100.0,77,20,4.25,4.3,4.5,5.0,6.5,9.0,14.0,21.55,4.25", "105.0,77,21,4.35,4.4,4.6,5.2,6.9,9.8,15.5,28.1,4.35",
    "110.0,77,22,4.55,4.5,4.7,5.5,7.4,10.8,17.2,35.4,4.55", ""])  # fmt: skip


def test_the_export_of_an_eight_sensor_probe(tmp_path):
    found = curve(tmp_path, PROBE, SCENE % "file: curve.csv, value: T1, sigma: 0.5 K")
    assert [t for t, _ in found] == [0, 5, 10]
    assert [theta for _, theta in found] == pytest.approx([277.4, 277.5, 277.7])
    assert curve(tmp_path, PROBE.replace("Combustion Inc.", "Another maker's"), SCENE % "file: curve.csv, value: T1, sigma: 0.5 K") == found


@pytest.mark.parametrize(
    ("content", "how", "words"),
    [
        ("minute,oven\n1,20\n", "value: oven", "curve.csv:1: the column 'oven' tells no unit; allowed: a name that ends in one, as oven_degC, or `unit: degC`"),
        ("minute,oven_mm\n1,20\n", "value: oven_mm", "is a length, but a value is expected"),
        ("Time,oven_degC\n1,20\n", "value: oven_degC", "curve.csv:2: Time is no clock time, and its column tells no unit: '1'"),
        ("minute,oven_degF\n1,20\n", "value: oven_degF, unit: degC", "curve.csv:1: the column 'oven_degF' tells a unit of its own, and `unit` says degC"),
        ("minute,oven_degC\n1,20\n", "value: oven_degC, sigma: spread", "no such column: 'spread'"),
        ("minute,oven_degC\n1,20\n", "value: oven_degC, sigma: 2 mm", "is a length"),
        ("minute,oven_degC\n1,20\n", "value: oven_degC, of: mass.total", "'mass.total' is not recorded"),
    ],
)
def test_what_cannot_be_read_is_told(tmp_path, content, how, words):
    with pytest.raises(mpm.ConfigError, match=re.escape(words)):
        curve(tmp_path, content, SCENE % f"file: curve.csv, {how}")


def test_numbers_in_the_config_are_curves_too(tmp_path):
    text = SCENE.replace("heat.total", "heat.total, time_to.middle.40_degC").partition("  measured:")[0] + (
        "  measured: {rest: {of: temperature.mean, samples: [[1 min, 30 degC]], sigma: 2 K}, reached: {of: time_to.middle.40_degC, equals: 2 min}}\n"
    )
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    experiment = mpm.load(path)
    rest, reached = experiment.output.measured.values()
    assert (rest.samples, rest.sigma, reached.equals, reached.units) == (((60.0, 303.15),), 2.0, 120.0, "s")
    tree = mpm.run(experiment)
    assert float(tree.misfit_rest) == pytest.approx(3.15)  # the slab stays at 300 K
    assert tree.misfit_rest.attrs["units"] == "K" and math.isnan(float(tree.misfit_reached))


def test_rows_in_any_order_of_time_are_the_same_curve(tmp_path):
    assert curve(tmp_path, HEAD + "3,30\n1,10\n2,20\n") == curve(tmp_path, HEAD + "1,10\n2,20\n3,30\n")


def test_what_is_no_plain_file_of_some_size_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "folder.csv").mkdir()
    with (tmp_path / "large.csv").open("wb") as file:
        file.truncate(65 * 2**20)
    for name, words in (("pipe.csv", "no plain file"), ("/dev/zero", "no plain file"), ("folder.csv", "no plain file|Is a directory"), ("large.csv", "65 MiB"),
                        ("no\\0name", "a NUL character")):  # fmt: skip
        with pytest.raises(mpm.ConfigError, match=words) as caught:
            curve(tmp_path, HEAD + "1,20\n", BASE.replace("file: curve.csv", f'file: "{name}"'))
        assert "scene.yaml:7:" in str(caught.value)


@pytest.mark.parametrize("rows", ["[[3, 300], [4, 301, 1]]", "[[3, 300, 1], [4, 301]]", "[[3], [4]]", "[[3, 300, 1, 1]]"])
def test_samples_of_other_lengths_are_refused(tmp_path, rows):
    with pytest.raises(mpm.ConfigError, match=r"each sample is .*, all alike"):
        curve(tmp_path, "", BASE.replace("file: curve.csv, time: minute, value: oven_degC", f"samples: {rows}"))


def test_what_is_wrong_with_a_whole_file_names_the_file_once(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(mpm.ConfigError) as told:
        curve(tmp_path, "", BASE.replace("curve.csv", "pipe.csv"))
    assert "output.measured.middle.file: pipe.csv: this is no plain file" in str(told.value)


def test_a_curve_of_a_base_lies_beside_the_base(tmp_path):
    (tmp_path / "bases").mkdir()
    written(tmp_path / "bases", "1,26.85\n2,36.85\n")
    path = tmp_path / "mine.yaml"
    path.write_text("extends: bases/scene.yaml\ntime: {end: 200}\n")
    assert [t for t, _ in mpm.load(path).output.measured["middle"].samples] == [60, 120]
    (tmp_path / "bases" / "curve.csv").unlink()
    with pytest.raises(mpm.ConfigError, match=r"bases/scene.yaml:7:.*cannot read 'bases/curve.csv'"):
        mpm.load(path)
