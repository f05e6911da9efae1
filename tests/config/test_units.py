"""Text with units to SI."""

import subprocess
import sys

import pytest

from mpm.config.units import UnitError, convert


@pytest.mark.parametrize(
    ("text", "unit", "difference", "value"),
    [
        ("190 degC", "K", False, 463.15),
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
        ("five", "m", "does not begin with a number", ""),
        ("5", "m", "text without a unit", "5"),
        ("5 m**99999", "m", "is not a unit", ""),
        ("1 m^9^9", "m", "powers of powers", ""),
        ("1 9**9**9", "m", "is not a unit", ""),
        ("1 ((((m", "m", "unknown unit", ""),
        ("1 __import__", "m", "unknown unit", ""),
        ("1 " + "m" * 100, "m", "is not a unit", ""),
    ],
)
def test_errors(text, unit, message, suggestion):
    with pytest.raises(UnitError, match=message.replace("*", r"\*")) as caught:
        convert(text, unit, "length")
    assert caught.value.suggestion == suggestion


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
