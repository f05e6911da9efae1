"""Materials and laws: moduli in pairs, kinds of laws, expansion."""

import pytest

from mpm.config import ConfigError, load
from mpm.config.laws import Bump, Constant, Logistic, Table


@pytest.mark.parametrize(
    "pair",
    [{"E": 1e4, "nu": 0.3}, {"lam": 0, "mu": "5 kPa"}, {"K": 1e4, "mu": 5e3}],
)
def test_pairs_of_moduli(block, pair):
    block["materials"]["dough"]["elastic"] = {"hencky": pair}
    assert load(block).materials["dough"].elastic.model_dump(exclude_none=True).keys() == pair.keys()


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ({"E": 1e4}, "two moduli are needed, found E"),
        ({}, "two moduli are needed, found none"),
        ({"K": {"table": {"temperature": [300, 400], "value": [1e4, 1e3]}}, "mu": 1e3}, "a number"),
        ({"E": 1e4, "nu": 0.3, "mu": 1}, "found E nu mu"),
        ({"lam": -1e4, "mu": 1e3}, "bulk modulus"),
        ({"E": 1e4, "nu": 0.5}, "Poisson ratio is out of range"),
        ({"E": 1e4, "nu": -1}, "Poisson ratio is out of range"),
    ],
)
def test_wrong_moduli(block, pair, message):
    block["materials"]["dough"]["elastic"] = {"hencky": pair}
    with pytest.raises(ConfigError, match=message):
        load(block)


@pytest.mark.parametrize(
    ("law", "kind"),
    [
        (0.4, Constant),
        ("0.4 W/m/K", Constant),
        ({"constant": "400 mW/m/K"}, Constant),
        ({"table": {"temperature": ["20 degC", "90 degC"], "value": [0.3, "0.4 W/m/K"], "interpolation": "pchip"}}, Table),
        ({"bump": {"base": 0.3, "heat": "2 W/m", "at": "80 degC", "width": "2 degC"}}, Bump),
        ({"logistic": {"low": 0.3, "high": 0.4, "at": "80 degC", "width": "2 K"}}, Logistic),
    ],
)
def test_laws(block, law, kind):
    block["materials"]["dough"]["heat"]["fourier"]["kappa"] = law
    found = load(block).materials["dough"].heat.kappa
    assert isinstance(found, kind)
    if kind is Constant:
        assert found.value == 0.4
    if kind is Bump:
        assert (found.heat, found.at, found.width) == (2.0, 353.15, 2.0)
    if kind is Table:
        assert found.temperature == (293.15, 363.15) and found.value == (0.3, 0.4)


@pytest.mark.parametrize(
    "expansion", [{"linear": {"coefficient": "2e-4 /K"}}, {"modulus": {"gamma": "3 kPa/K", "reference": "20 degC"}}, {"source": {"c": 0.01}}]
)
def test_expansion_and_heating(block, expansion):
    block["materials"]["dough"] |= {"expansion": expansion, "heating": {"elastic": {}, "dissipation": {}}}
    dough = load(block).materials["dough"]
    assert dough.expansion.reference == 293.15 and dough.heating.dissipation.fraction == 1.0
    block["materials"]["dough"]["heating"] = {"dissipation": {"fraction": "50 %"}}
    heating = load(block).materials["dough"].heating
    assert heating.elastic is None and heating.dissipation.fraction == 0.5


def test_heating_needs_its_cause(block):
    block["materials"]["dough"] |= {"heating": {"elastic": {}, "dissipation": {}}, "flow": None}
    with pytest.raises(ConfigError) as caught:
        load(block)
    assert [one.message for one in caught.value.problems] == ["elastic heating needs expansion", "dissipation heating needs flow"]


def test_rate_independent_flow_is_allowed(block):
    assert load(block, {"eta": 0}).materials["dough"].flow.eta.value == 0.0
