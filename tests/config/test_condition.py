"""Conditions are read, never evaluated by Python."""

import pytest

from mpm.config.condition import Condition, ConditionError

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
        "kappa[0] > 1",
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


@pytest.mark.parametrize("text", ["kappa / 0 > 1", "transfer < 1", "beta ** 1000 > 1", "transfer * transfer > 1", "(0 - beta) ** 0.5 < 1"])
def test_failure_on_a_point(text):
    with pytest.raises(ConditionError, match="fails on this point"):
        Condition(text)(VALUES)
