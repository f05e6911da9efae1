"""Numbers, units and reasons as figures say them."""

import numpy as np
import pytest

from mpm.plots import words


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.35, "0.35"), (12.5594, "12.6"), (50.0, "50"), (99.99, "100"), (1234.5, "1230"), (1e5, "100000"), (2e6, "2·10⁶"), (1e-7, "10⁻⁷"), (-3.0, "−3"),
     (0.0, "0"), (np.inf, "∞"), (np.nan, "nan"), ("apic", "apic"), ("x" * 40, "x" * 27 + "…")],
)  # fmt: skip
def test_number(value, text):
    assert words.number(value) == text


@pytest.mark.parametrize(("units", "text"), [("W/m2/K", "W/m²/K"), ("m3", "m³"), ("Pa*s", "Pa s"), ("1", ""), ("kg m/s", "kg m/s"), ("s-1", "s⁻¹")])
def test_units(units, text):
    assert words.units_text(units) == text


@pytest.mark.parametrize(
    ("top", "units", "temperature", "shown", "value"),
    [(780.0, "s", False, "min", 13.0), (100.0, "s", False, "s", 100.0), (0.02, "s", False, "ms", 20.0),
     (0.008, "m", False, "mm", 8.0), (8e-7, "m", False, "µm", 0.8), (1.5e-9, "m", False, "nm", 1.5), (3.0, "m", False, "m", 3.0),
     (373.15, "K", True, "°C", 100.0), (2.0, "K", False, "K", 2.0), (1.2e4, "Pa", False, "kPa", 12.0), (7.0, "J", False, "J", 7.0)],
)  # fmt: skip
def test_scale(top, units, temperature, shown, value):
    found = words.scale([np.nan, top], units, temperature)
    assert found.units == shown
    assert found(top) == pytest.approx(value)


def test_reason_leaves_out_what_differs_from_point_to_point():
    one = words.reason("diverged", "diverged: det F <= 0 at particle 812, t = 0.0134 s, step 2680")
    assert one == words.reason("diverged", "diverged: det F <= 0 at particle 3, t = 9 s, step 1") == "diverged: det F ≤ 0"
    assert words.reason("killed", "") == "killed"
    assert words.reason("failed", "ValueError: no\nmore") == "failed: ValueError: no"


def test_numbers_that_differ_have_different_texts():
    assert words.numbers([0.1, 0.35, 1000]) == ["0.1", "0.35", "1000"]
    assert words.numbers([0.3, 0.3001, 2e7]) == ["0.3", "0.3001", "2·10⁷"]
    assert words.numbers([0.3, 0.1 + 0.2]) == ["0.3", "0.30000000000000004"]
    assert words.numbers([-1e-9, -1.0000001e-9]) == ["−1·10⁻⁹", "−1.0000001·10⁻⁹"]
    assert words.numbers(["a" * 40, "a" * 41, "b"]) == [f"{'a' * 27}… (1)", f"{'a' * 27}… (2)", "b"]


def test_a_short_name_still_says_whose_it_is():
    assert words.short("mean temperature, weighted with the heat capacity at the start, of cheese") == "mean temperature, of cheese"
    assert words.short("kinetic, elastic and gravitational energy; the last only where") == "kinetic, elastic and gravitational energy"
