"""Text with units to SI."""

import json
import re
import subprocess
import sys

import pytest

from mpm.config.units import UnitError, convert


@pytest.mark.parametrize(
    ("text", "unit", "difference", "value"),
    [
        ("190 degC", "K", False, 463.15),
        ("190 ℃", "K", False, 463.15),
        ("190 ºC", "K", False, 463.15),
        ("190 °C", "K", False, 463.15),
        ("1.5 K", "K", False, 1.5),
        ("1.5 degC", "K", True, 1.5),
        ("1.8 degF", "K", True, 1.0),
        ("212 degF", "K", False, 373.15),
        ("2mm", "m", False, 0.002),
        ("36 mm", "m", False, 0.036),
        ("21.5 mm", "m", False, 0.0215),
        ("0.35 W/(m K)", "W/m/K", True, 0.35),
        ("2 W/m/degC", "W/m/K", True, 2.0),
        ("1 kJ/kg/K", "J/kg/K", True, 1000.0),
        ("1 g/cm³", "kg/m**3", False, 1000.0),
        ("10 %", "", False, 0.1),
        ("5 min", "s", False, 300.0),
        ("90 deg", "rad", False, 1.5707963267949),
        ("5 W·m⁻²·K⁻¹", "W/m**2/K", True, 5.0),
        ("2e-4 /K", "1/K", True, 2e-4),
        ("1 kPa*s", "Pa*s", False, 1000.0),
        ("5 µm", "m", False, 5e-6),
        ("50 W/m2/K", "W/m**2/K", False, 50.0),
        ("0.5 W m-1 K-1", "W/m/K", False, 0.5),
        ("301 kg m-3", "kg/m**3", False, 301.0),
        ("13 W m−2 K−1", "W/m**2/K", False, 13.0),
        ("13 W/(m2⋅K)", "W/m**2/K", False, 13.0),
        ("3 s-1", "1/s", False, 3.0),
        ("0.25 1", "", False, 0.25),
        ("20 delta_degC", "K", True, 20.0),
        ("2 W/m2/delta_degC", "W/m**2/K", False, 2.0),
    ],
)
def test_conversion(text, unit, difference, value):
    assert convert(text, unit, "thing", difference) == value


@pytest.mark.parametrize(
    ("text", "unit", "message", "suggestion"),
    [
        ("5 s", "m", "is a time, but a length is expected", ""),
        ("2 mmm", "m", "unknown unit 'mmm'", '"2 mm"'),
        ("190 C", "K", "but a length is expected", '"190 degC"'),
        ("190 deg C", "K", "but a length is expected", '"190 degC"'),
        ("190 degc", "K", "unknown unit 'degc'", '"190 degC"'),
        ("five", "m", "does not begin with a number", ""),
        ("5", "m", "text without a unit", "5"),
        ("5 m**99999", "m", "is not a unit", ""),
        ("1 m^9^9", "m", "powers of powers", ""),
        ("1 9**9**9", "m", "is not a unit", ""),
        ("1 ((((m", "m", "unknown unit", ""),
        ("1 __import__", "m", "unknown unit", ""),
        ("1 " + "m" * 100, "m", "is not a unit", ""),
        ("0.5 W/mK", "W/m/K", "has the dimension", '"0.5 W/m/K"'),
        ("5 W/m2K", "W/m**2/K", "'W/m2K' is not a unit", '"5 W/m**2/K"'),
        ("5 J/kgK", "J/kg/K", "unknown unit 'J/kgK'", '"5 J/kg/K"'),
        ("20 delta_degC", "K", "'20 delta_degC' is a temperature difference", '"20 degC"'),
        ("2 Hz", "rad/s", "may be turns or radians a second", '"120 rpm"'),
        ("5 deg", "", "is an angle, but a length is expected", ""),
        ("5 %", "rad", "is a share, but a length is expected", ""),
        ("20 Δ°F", "K", "is a temperature difference", '"20 degF"'),
        ("1 m2**9", "m", "powers of powers", ""),
    ],
)
def test_errors(text, unit, message, suggestion):
    with pytest.raises(UnitError, match=message.replace("*", r"\*")) as caught:
        convert(text, unit, "length")
    assert caught.value.suggestion == suggestion


def printed():
    """(text, unit, value in it) of every unit that the product prints: of its variables, in the schema, and on figures."""
    from mpm.config import schema
    from mpm.plots import words
    from mpm.records.variables import TABLE

    plain = {re.sub(r"(?<=[a-z])(\d)", r"**\1", row[2]) for row in TABLE} | set(re.findall(r"like \\\"1 (.*?)\\\"", json.dumps(schema())))
    for unit in sorted(plain - {"1", "%"}):
        for text in sorted({unit, unit.replace("**", ""), words.units_text(unit)}):
            yield f"3 {text}", unit, 3.0
    yield from (("3 1", "", 3.0), ("3 %", "", 0.03))
    for unit in ("s", "m", "Pa"):
        for shown in sorted({words.scale([10.0**power], unit) for power in range(-9, 9)}, key=str):
            yield f"3 {shown.units}", unit, 3.0 / shown.factor
    yield "20 °C", "K", 293.15


@pytest.mark.parametrize(("text", "unit", "value"), list(printed()))
def test_every_unit_that_is_printed_is_read_back(text, unit, value):
    assert convert(text, unit, "thing") == pytest.approx(value, rel=1e-14)


def test_pint_is_loaded_only_for_text_with_a_unit():
    code = """
import sys, mpm.config as config
assert not {"pint", "ruamel.yaml", "scipy", "numba", "xarray"} & set(sys.modules)
scene = {"grid": {"dimension": 1, "size": [1], "cell": 0.1}, "bodies": {"a": {"shape": {"box": {"lower": [0], "upper": [1]}}, "material": "m"}},
         "materials": {"m": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}}, "time": {"end": 1}}
config.load(scene)
assert "pint" not in sys.modules and "ruamel.yaml" not in sys.modules
config.load({**scene, "time": {"end": "1 s"}})
assert "pint" in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_parameter_s_unit_is_one_that_configs_may_hold():
    from mpm.config.units import si

    with pytest.raises(UnitError):
        si("5 m**99999")
