"""Named parameters: used by name or formula, overridden, swept, and told where they are wrong."""

import math

import pytest

import mpm
from mpm.sweep.cases import plan

SLAB = """\
parameters:
  thickness: 25 mm
  pan: {value: 0.35 W/m/K, label: conductivity}
  half: "=thickness / 2"
  hot: 190 degC
grid: {dimension: 1, size: [60 mm], cell: 1 mm}
bodies: {slab: {shape: {box: {lower: [0.01], upper: ["=thickness + 0.01"]}}, temperature: 300, material: unit}}
materials: {unit: {density: 500, heat: {fourier: {kappa: =pan, alpha: 2000}}}}
surfaces: [{of: slab, convection: {beta: 20, outside: =hot}}]
time: {end: 120}
output: {probes: {middle: ["=half + 0.01"]}}
"""
PLAIN = SLAB.partition("grid")[1] + SLAB.partition("grid")[2].replace('"=thickness + 0.01"', "0.035").replace("=pan", "0.35").replace(
    "=hot", "190 degC"
).replace('"=half + 0.01"', "0.0225")  # fmt: skip


def scene(folder, text=SLAB, **overrides):
    path = folder / "slab.yaml"
    path.write_text(text)
    return mpm.load(path, overrides)


def upper(experiment):
    return experiment.bodies["slab"].shape.upper[0]


def test_a_name_is_its_number_and_the_run_is_that_of_the_numbers(tmp_path):
    experiment = scene(tmp_path)
    assert upper(experiment) == pytest.approx(0.035)
    assert experiment.surfaces[0].convection.outside == pytest.approx(463.15)
    assert experiment.run_id == scene(tmp_path, PLAIN).run_id


def test_it_survives_being_written_down(tmp_path):
    experiment = scene(tmp_path)
    again = mpm.load(experiment.resolved())
    assert again == experiment
    assert upper(mpm.load(experiment.resolved(), {"thickness": "30 mm"})) == pytest.approx(0.04)
    alone = mpm.load(experiment.resolved(), {"bodies.slab.shape.box.upper": [0.05], "thickness": "30 mm"})
    assert upper(alone) == 0.05, "what is set follows no formula any more"


@pytest.mark.parametrize("value", [0.03, "30 mm", "0.03", "3 cm"])
def test_an_override_keeps_the_unit_and_everything_follows(tmp_path, value):
    experiment = scene(tmp_path, thickness=value)
    assert (upper(experiment), experiment.output.probes["middle"][0]) == pytest.approx((0.04, 0.025))
    assert experiment.parameters["thickness"].unit == "m"


def test_a_sweep_by_name_moves_what_follows_and_is_labelled(tmp_path):
    points = plan(scene(tmp_path, SLAB + "sweep: {axes: {thickness: [20 mm, 25 mm], pan: [0.3, 0.4]}}\n"))
    assert [dim.name for dim in points.dims] == ["thickness", "pan"]
    assert [dim.coords[0].units for dim in points.dims] == ["m", "W/m/K"]
    assert points.dims[1].coords[0].long_name == "conductivity"
    assert {upper(case.experiment) for case in points.cases} == {0.03, 0.035}
    assert sorted({case.experiment.materials["unit"].heat.kappa.value for case in points.cases}) == [0.3, 0.4]
    middle = next(row for _, row in points.derived if row.config_path == "output.probes.middle.0")
    assert middle.values == pytest.approx([0.02, 0.0225])


def test_indexed_paths_in_derive_and_places_in_one_dimension_as_numbers(tmp_path):
    text = PLAIN + "sweep: {axes: {bodies.slab.shape.box.upper: [[0.035], [0.04]]}, derive: {beta: '100 * bodies.slab.shape.box.upper[0]'}}\n"
    points = plan(scene(tmp_path, text))
    assert points.dims[0].coords[0].values.tolist() == [0.035, 0.04]
    assert points.dims[0].coords[0].units == "m"
    assert [case.words["upper"] for case in points.cases] == ["0.035", "0.04"]
    assert points.derived[0][1].values == pytest.approx([3.5, 4.0])


@pytest.mark.parametrize("form", ["bodies.slab.shape.box.upper[0]", "bodies.slab.shape.box.upper.0", "upper.0", "upper[0]"])
def test_entries_of_lists_are_named_by_dots_or_brackets(tmp_path, form):
    text = (
        PLAIN
        + f"sweep: {{axes: {{'{form}': [0.035, 0.04]}}, derive: {{beta: '1.0e2 * {form}', 'output.probes.middle[0]': '{form} - .01'}}, where: '{form} > 0'}}\n"
    )
    points = plan(scene(tmp_path, text))
    assert [row.values for _, row in points.derived] == [pytest.approx([3.5, 4.0]), pytest.approx([0.025, 0.03])]
    assert upper(scene(tmp_path, PLAIN, **{form: 0.05})) == 0.05


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("=pan", "=pam", 8, "there is no parameter 'pam' (given '=pam'); allowed: thickness, pan, half, hot; did you mean 'pan'?"),
        ("kappa: =pan", "kappa: =thickness", 8, "thickness is in m, and a heat conductivity in W/m/K is expected"),
        ("=hot", "=hot *", 9, "this is no formula"),
        ("=thickness / 2", "=hot / 2", 4, "there is no parameter 'hot' above this one"),
        ("thickness: 25 mm", "thickness: 25 mmm", 2, "unknown unit 'mmm'"),
        ("hot: 190 degC", "sin: 190 degC\n  hot: 460", 5, "'sin' means something else in formulas"),
        ("outside: =hot", "outside: '=log(hot - 1000)'", 9, "the formula fails"),
        ("hot: 190 degC", "hot: {value: 190, unit: degC}", 5, "'degC' is no SI unit, and numbers are in SI; allowed: value: 190 degC"),
        ("thickness: 25 mm", "thickness: {value: 25, unit: mm}", 2, "allowed: value: 25 mm, and no unit, or unit: m"),
        (
            "alpha: 2000",
            "alpha: {bump: {base: 2000, heat: 1, at: 400, width: =hot}}",
            8,
            "hot is a temperature (190 degC), and a temperature difference is expected (given '=hot'); allowed: parameters: {hot: 190 K}",
        ),
    ],
)
def test_what_is_wrong_is_told_at_its_place(tmp_path, old, new, line, words):
    with pytest.raises(mpm.ConfigError) as caught:
        scene(tmp_path, SLAB.replace(old, new))
    assert f"slab.yaml:{line}:" in str(caught.value)
    assert words in str(caught.value)
    assert len(caught.value.problems) == 1


def test_degrees_of_a_named_difference_are_kelvin(tmp_path):
    """20 degC as the width of a bump is 20 K, in a sweep by name too."""
    text = SLAB.replace("alpha: 2000", "alpha: {bump: {base: 2000, heat: 1, at: 400, width: =wide}}").replace("parameters:\n", "parameters:\n  wide: 5 K\n")
    points = plan(scene(tmp_path, text + "sweep: {axes: {wide: [20 degC, 30 delta_degC, 40]}}\n"))
    assert [case.experiment.materials["unit"].heat.alpha.width for case in points.cases] == [20.0, 30.0, 40.0]


@pytest.mark.parametrize(("text", "value", "unit"), [("5 %", 0.05, ""), ("180 deg", math.pi, "rad"), ("3 mm/m", 0.003, ""), ("60 rpm", 2 * math.pi, "1/s")])
def test_a_share_is_no_angle(tmp_path, text, value, unit):
    found = scene(tmp_path, SLAB.replace("thickness: 25 mm", f"thickness: 25 mm\n  more: {text}")).parameters["more"]
    assert (found.value, found.unit) == (pytest.approx(value), unit)
