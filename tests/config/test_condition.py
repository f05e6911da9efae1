"""Conditions are read, never evaluated by Python."""

import numpy as np
import pytest

from mpm.config.condition import Condition, ConditionError, Formula
from mpm.config.formula import Formula as Line

VALUES = {"kappa": 0.3, "beta": 10.0, "κ": 0.3, "transfer": "apic", "a.b": 2.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("kappa > 0.2", True),
        ("kappa * beta < 3.1 and not beta > 20", True),
        ("0.1 < κ <= 0.3", True),
        ("beta ** 2 / 10 - 1 == 9 or kappa < 0", True),
        ("transfer == 'apic' and a.b != 2", False),
        ("-beta < -11", False),
        ("not (kappa > 1)", True),
        ("10 ** 300 > beta", True),
    ],
)
def test_value(text, value):
    assert Condition(text)(VALUES) is value


def test_names():
    assert list(Condition("kappa > 1 and surfaces.top.convection.beta < kappa").names) == ["kappa", "surfaces.top.convection.beta"]


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('x')",
        "kappa.__class__() > 1",
        "[x for x in kappa] == 1",
        "(lambda: 1)() > 0",
        "kappa",
        "1 + 1",
        "-kappa",
        "kappa > > 1",
        "",
        "kappa[a] > 1",
        "kappa := 3",
        "kappa in beta",
        "kappa is 3",
        "f'{kappa}' == 'x'",
        "kappa if beta else 1",
        "True == 1",
        "None == kappa",
        "b'x' == kappa",
        "1j < kappa",
        "kappa > " + "9" * 400,
        "(" * 300 + "kappa > 1" + ")" * 300,
        "not " * 200 + "kappa > 1" * 200,
        "kappa > 1; beta",
        "yield kappa",
        "kappa & 1 == 1",
        "kappa // 1 > 0",
        "kappa % 2 > 0",
        "*kappa > 1",
        "... > kappa",
        "\0 > 1",
    ],
)
def test_refused(text):
    with pytest.raises(ConditionError):
        Condition(text)


@pytest.mark.parametrize(
    "text",
    ["min(beta)", "max()", "sqrt(beta, 2)", "abs()", "-" * 900 + "beta", "+".join(["1"] * 300), "log(1, 2, 3)"],
)
def test_formulas_that_are_refused_when_they_are_read(text):
    with pytest.raises(ConditionError, match=r"takes|levels"):
        Formula(text)


@pytest.mark.parametrize(("text", "value"), [("min(beta, 3, kappa)", 0.3), ("log(8, 2)", 3.0), ("floor(2.5) ** 2", 4.0), ("(" * 90 + "beta" + ")" * 90, 10.0)])
def test_formula(text, value):
    assert Formula(text)(VALUES) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("tower", ["n" + "**n" * 5, "n*n" + "**n" * 4, "floor(n)" + "**n" * 4, "((n > 1) + (n > 1))" + "**((n > 1) + 9)" * 5])
def test_powers_of_whole_numbers_end_at_once(tower):
    """Every value is a float: a whole number's powers would take more memory than there is."""
    for kind, text in ((Condition, f"{tower} > 1"), (Condition, f"1 < abs({tower})")):
        with pytest.raises(ConditionError, match="a number is too large"):
            kind(text)({"n": 9})


@pytest.mark.parametrize("text", ["transfer == 1", "1 != transfer", "transfer + transfer == 'apicapic'", "min(transfer, transfer) == 'apic'", "not transfer",
                                  "abs((0 - beta) ** 0.5) < 9", "inf - inf < 1"])  # fmt: skip
def test_only_numbers_are_reckoned_with(text):
    with pytest.raises(ConditionError, match="no number"):
        Condition(text)(VALUES | {"inf": float("inf")})


@pytest.mark.parametrize(
    ("text", "values"), [("1/(x - 1)", [np.inf, 1.0]), ("10**400*x", [np.inf, np.inf]), ("(x - 2)**0.5", [np.nan, 0.0]), ("pi*x", [np.pi, 2 * np.pi])]
)
def test_lines_of_theory_have_gaps_and_never_fail(text, values):
    np.testing.assert_array_equal(Line(text)(np.array([1.0, 2.0])), values)


@pytest.mark.parametrize("text", ["kappa / 0 > 1", "transfer < 1", "beta ** 1000 > 1", "transfer * transfer > 1", "(0 - beta) ** 0.5 < 1"])
def test_failure_on_a_point(text):
    with pytest.raises(ConditionError, match="fails on this point"):
        Condition(text)(VALUES)
