"""Loadings of a material point: what may be left out, what text means, how they sweep."""

import pytest

from mpm.config import ConfigError, load
from mpm.sweep.cases import plan

BASE = {
    "grid": {"dimension": 0},
    "bodies": {"body": {"shape": "point", "material": "solid"}},
    "materials": {"solid": {"density": 1000, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}}},
    "loading": [{"until": "1 min", "strain_rate": {"zz": "-5 %/s"}, "stress": {"xx": "2 kPa"}}, {"stretch_rate": {"zz": 0.1}}],
    "time": {"end": 100},
}


def test_units_and_defaults():
    first, last = load(BASE).loading
    assert first.until == 60 and first.strain_rate.zz == -0.05 and first.stress.xx == 2000
    assert last.until is None and last.stress.xx is None and last.temperature is None


def test_reads_back_and_has_one_key():
    experiment = load(BASE)
    assert load(experiment.resolved()) == experiment
    assert load(BASE | {"loading": [{**BASE["loading"][0], "until": 60, "stress": {"xx": 2e3, "yy": None}}, BASE["loading"][1]]}).run_id == experiment.run_id
    assert load(BASE, {"loading.0.until": 50}).run_id != experiment.run_id


def test_rates_and_whole_stages_sweep():
    cases = plan(load(BASE | {"sweep": {"axes": {"loading.0.strain_rate.zz": [-0.1, -0.2], "loading.1.stress": [{}, {"xx": 0}]}}})).cases
    found = [(case.experiment.loading[0].strain_rate.zz, case.experiment.loading[1].stress.xx) for case in cases]
    assert found == [(-0.1, None), (-0.1, 0), (-0.2, None), (-0.2, 0)]
    assert len({case.run_id for case in cases}) == 4


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"loading": []}, "'loading' is missing"),
        ({"grid.size": [1]}, "a material point has no grid"),
        ({"materials.solid.elastic": None, "loading": [], "materials.solid.heat": {"fourier": {"kappa": 1, "alpha": 1}}}, "nothing happens"),
        ({"loading.1.until": 90}, "ends before time.end"),
        ({"loading.0.temperature": 400}, "has no heat"),
        ({"time.scale": 100}, "no inertia"),
        ({"bodies.other": {"shape": "point", "material": "solid"}}, "one body"),
    ],
)
def test_what_does_not_fit_is_said(changes, said):
    base = BASE
    if "bodies.other" in changes:
        base, changes = BASE | {"bodies": {**BASE["bodies"], "other": changes["bodies.other"]}}, {}
    with pytest.raises(ConfigError, match=said):
        load(base, changes)
