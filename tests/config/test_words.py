"""Names and text of a config: one name for one thing, text that files can hold, numbers that seem meant in another unit."""

import pytest

from mpm.config import ConfigError, load
from mpm.config.cautions import cautions
from mpm.sweep.cases import plan

SLAB = """\
title: "{title}"
grid: {{dimension: 1, size: [20 mm], cell: 1 mm}}
bodies:
  s: {{shape: {{box: {{lower: [5 mm], upper: [15 mm]}}}}, temperature: {temperature}, material: d}}
materials:
  d: {{density: 1000, heat: {{fourier: {{kappa: 0.5, alpha: 2000}}}}}}
surfaces:
  - {{of: s, convection: {{beta: 50, outside: 100 degC}}}}
time: {{end: 60}}
output: {{every: 10, probes: {{{probe}: [6 mm]}}, observables: [{observables}]}}
"""


def slab(title="slab", temperature="20 degC", probe="c", observables="temperature.mean", more=""):
    return SLAB.format(title=title, temperature=temperature, probe=probe, observables=observables) + more


@pytest.fixture
def told(tmp_path):
    """(line, column, path, message) of what is wrong with a text."""

    def read(text, *overrides):
        file = tmp_path / "slab.yaml"
        file.write_bytes(text.encode("utf-8", "surrogatepass"))
        try:
            plan(load(file, *overrides))
        except ConfigError as error:
            return [(one.line, one.column, one.path, one.message) for one in error.problems]
        return []

    return read


@pytest.mark.parametrize("name", ["mean", "min", "max"])
@pytest.mark.parametrize("observables", ["", "temperature.mean, temperature.min, temperature.max"])
def test_a_probe_is_not_called_as_an_observable_is(told, name, observables):
    ((line, column, path, message),) = told(slab(probe=name, observables=observables))
    assert (line, column, path) == (10, 30, f"output.probes.{name}") and f"the probe's temperature_{name} is the name of an observable" in message


def test_a_probe_whose_name_ends_in_a_number_has_times_of_its_own(tmp_path):
    from mpm.records.variables import describe, threshold

    names = "time_to.tc_1.95_degC, time_to.tc_1.9.5_degC, time_to.tc.1.25_degC"
    file = tmp_path / "slab.yaml"
    file.write_text(slab(probe="tc: [5.5 mm], tc_1", observables=names))
    load(file)
    assert [(threshold(name).probe, threshold(name).value) for name in names.split(", ")] == [("tc_1", 95.0), ("tc_1", 9.5), ("tc", 1.25)]
    probes = ("tc", "tc_1")
    assert threshold("time_to_tc_1_95_degC", ("tc_1",)).probe == "tc_1" and threshold("time_to_tc_1_95_degC", ("tc",)).kelvin == pytest.approx(275.1)
    assert describe("time_to_tc_1_9_5_degC", probes).long_name == "time for tc_1 to reach 9.5 °C"
    assert describe("time_to_tc_1_25_degC", ("tc",)).long_name == "time for tc to reach 1.25 °C"


def test_two_observables_of_one_name_in_the_dataset(told):
    found = told(slab(probe="tc: [5.5 mm], tc_1", observables="time_to.tc.1.95_degC, time_to.tc_1.95_degC"))
    assert [message for *_, message in found] == ["time_to.tc.1.95_degC and time_to.tc_1.95_degC would both be time_to_tc_1_95_degC in the dataset"]


def test_a_swept_parameter_is_not_called_as_a_probe_s_series_is(tmp_path):
    """materials.misfit.density would be misfit_density, since density is a field, and so would the misfit of a probe called density."""
    file = tmp_path / "slab.yaml"
    text = (
        slab(probe="density", more="sweep: {axes: {materials.misfit.density: [1000, 1100]}}\n")
        .replace(" d:", " misfit:")
        .replace("material: d", "material: misfit")
    )
    file.write_text(text)
    assert [dim.name for dim in plan(load(file)).dims] == ["materials_misfit_density"]


@pytest.mark.parametrize(
    "second",
    [
        "{of: s, convection: {beta: 50, outside: 100 degC}}",
        "{of: s, side: left, convection: {beta: 5, outside: 20 degC}}",
        "{of: s, side: left, fixed: {temperature: 20 degC}}",
    ],
)
def test_a_side_has_one_convection(told, second):
    text = slab().replace("time: {", f"  - {second}\ntime: {{")
    ((line, _, path, message),) = told(text)
    assert line == 9 and path.startswith("surfaces.1.") and message == "'s' has a convection there already, from surfaces.0 (side all)"


@pytest.mark.parametrize(
    ("names", "observables", "message"),
    [
        ("a b_c a_b c", "temperature.mean", "the heat between a and b_c and the heat between a_b and c would both be heat_a_b_c in the dataset"),
        ("total b", "heat.total.b", "the heat between total and b and heat.total.b would both be heat_total_b in the dataset"),
        ("total b", "heat.total", ""),
        ("a b a_b", "heat.a_b", ""),
    ],
)
def test_what_passes_between_bodies_has_a_name_of_its_own(told, names, observables, message):
    """The heat of a pair is a series called after both."""
    bodies = "".join(
        f"  {name}: {{shape: {{box: {{lower: [{4 * k} mm], upper: [{4 * k + 4} mm]}}}}, temperature: 20 degC, material: d}}\n"
        for k, name in enumerate(names.split())
    )
    head, _, tail = slab(observables=observables, probe="p").partition("materials:")
    text = head.partition("  s:")[0] + bodies + "materials:" + tail.replace("of: s", f"of: {names.split()[0]}, side: left")
    assert [found for *_, found in told(text)] == [message] * bool(message)


def test_a_material_point_has_one_surface(told):
    """Two convections on it would silently be their sum."""
    text = slab().replace("dimension: 1, size: [20 mm], cell: 1 mm", "dimension: 0").replace("probes: {c: [6 mm]}, ", "")
    text = text.replace("box: {lower: [5 mm], upper: [15 mm]}", "point: {surface_to_volume: 200}")
    assert told(text) == []
    ((_, _, path, message),) = told(text.replace("time: {", "  - {of: s, convection: {beta: 50, outside: 100 degC}}\ntime: {"))
    assert path == "surfaces.1.convection" and message == "'s' has a convection there already, from surfaces.0 (side all)"


def test_other_exchanges_and_other_sides_are_no_conflict(told):
    """Convection and radiation act together; sides that do not overlap are apart."""
    more = "  - {of: s, side: left, radiation: {emissivity: 0.9, surroundings: 500}}\n  - {of: s, flux: {q: 10}}\n"
    assert told(slab().replace("time: {", f"{more}time: {{")) == []
    sides = slab().replace("{of: s, conv", "{of: s, side: left, conv")
    assert told(sides.replace("time: {", "  - {of: s, side: right, convection: {beta: 5, outside: 20 degC}}\ntime: {")) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (r"a\0b", "a NUL character, which no file can hold as text"),
        (r"\ud83c", r"half of a surrogate pair, \ud83c, which no file can hold as text"),
        (r"\udf5e\ud83c", r"half of a surrogate pair, \udf5e, which no file can hold as text"),
    ],
)
def test_text_that_no_file_can_hold(told, text, message):
    assert told(slab(title=text)) == [(1, 8, "title", message)]
    assert told(slab(more=f'smoke: {{"a{text}": 1}}\n'))[0][3] == message
    spoken = text.encode().decode("unicode_escape")
    assert told(slab(), {"title": f'"{text}"'})[0][2:] == ("title", message)
    with pytest.raises(ConfigError, match=r"title: .*which no file can hold"):
        load({"title": spoken})


def test_a_pair_of_surrogates_is_the_letter_that_it_stands_for(tmp_path):
    file = tmp_path / "slab.yaml"
    file.write_text(slab(title=r"bread \ud83c\udf5e"))
    assert load(file).title == "bread 🍞"


def test_a_control_character_is_told_where_it_stands(told):
    assert told(slab(title="a\x1b[31mb")) == [(1, 10, "", "this is not YAML: the control character U+001B")]
    assert told(slab(title="x", more="# a comment\n# \x07\n")) == [(12, 3, "", "this is not YAML: the control character U+0007")]
    assert told(slab(title=r"a\x1b[31mb")) == []  # escaped it is a letter as any; what shows it escapes it again


def test_messages_show_no_control_characters(tmp_path):
    file = tmp_path / "slab.yaml"
    file.write_text(slab(more='"col\\x1b[31mour\\n\\u202e": {}\n'))
    with pytest.raises(ConfigError) as caught:
        load(file)
    first = str(caught.value).splitlines()[0]
    assert first.isprintable() and r"col\x1b[31mour\n\u202e: unknown key" in first


@pytest.mark.parametrize(("given", "cold"), [("5", True), ("190", True), ("5 K", False), ("223.15", False), ("300", False), ("-20 degC", False)])
def test_a_number_that_was_rather_meant_in_degrees_celsius(tmp_path, given, cold):
    file = tmp_path / "slab.yaml"
    file.write_text(slab(temperature=given))
    said = cautions(load(file))
    assert bool(said) == cold
    if cold:
        assert said[0].startswith(f"{file}:4:67: bodies.s.temperature: {given} without a unit is {given} K") and f"say '{given} degC' or '{given} K'" in said[0]


def test_every_temperature_of_a_config_is_looked_at(tmp_path):
    """Swept ones, tables and programmes; but no differences, and no times."""
    file = tmp_path / "slab.yaml"
    laws = {"kappa: 0.5": "kappa: {table: {temperature: [1, 400], value: [0.5, 0.6]}}", "alpha: 2000": "alpha: {bump: {base: 2, heat: 3, at: 7, width: 5}}"}
    text = slab(more="sweep: {axes: {outside: [20, 100 degC, 300], bodies.s.temperature: {linear: [4, 60, 3]}}}\n")
    for plain, law in laws.items():
        text = text.replace(plain, law)
    file.write_text(text)
    places = [line.split(": ")[1] for line in cautions(load(file)) if "slab.yaml" in line]
    heat, swept = "materials.d.heat.fourier", ["sweep.axes.bodies.s.temperature"] * 2 + ["sweep.axes.outside"]
    assert sorted(places) == sorted([f"{heat}.kappa.table.temperature.0", f"{heat}.alpha.bump.at", *swept])


def test_a_named_temperature_without_a_unit_is_looked_at(tmp_path):
    file = tmp_path / "slab.yaml"
    more = "parameters: {start: 20, wide: 5, warm: 20 degC, cold: 3 K}\nsweep: {axes: {start: [30, 300]}}\n"
    text = slab(temperature="=start", more=more).replace("alpha: 2000", "alpha: {bump: {base: 2, heat: 3, at: =warm, width: =wide}}")
    file.write_text(text.replace("outside: 100 degC", "outside: =cold"))
    assert [line.split(": ")[1] for line in cautions(load(file)) if "slab.yaml" in line] == ["parameters.start.value", "sweep.axes.start"]


def test_a_range_to_fit_is_looked_at(tmp_path):
    file = tmp_path / "slab.yaml"
    curve = "measured: {c: {samples: [[3 s, 30 degC], [9 s, 40 degC]]}}, observables"
    file.write_text(slab(more="fit: {parameters: {outside: [90, 500], kappa: {log: [0.1, 1]}}, data: [c]}\n").replace("observables", curve))
    assert [line.split(": ")[1] for line in cautions(load(file))] == ["fit.parameters.outside"]


def test_a_name_is_no_longer_than_a_variable_s_may_be(loaf):
    body, probe = "a" * 101, "p" * 70_000
    data = loaf | {"bodies": {body: loaf["bodies"]["loaf"]}, "output": {"probes": {probe: [0, "21.5 mm"]}}}
    with pytest.raises(ConfigError) as caught:
        load(data | {"surfaces": [loaf["surfaces"][0] | {"of": body}]})
    assert [one.message for one in caught.value.problems] == [f"the name {'a' * 20!r}... has 101 letters", f"the name {'p' * 20!r}... has 70000 letters"]
