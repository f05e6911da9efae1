"""A partly wrong config, as far as it can be read."""

import pytest

from mpm.config.checks import check, unread
from mpm.config.experiment import Experiment
from mpm.config.names import ROOT
from mpm.config.partial import MISSING, Unknown, loose
from mpm.config.schema_paths import leaves


def test_what_is_right_is_kept(block):
    block["grid"]["cell"] = "1 s"
    block["materials"]["dough"]["elastic"]["hencky"]["nu"] = 7
    block["bodies"]["block"] = {"shape": {"bal": {}}, "material": "dogh"}
    found = loose(ROOT, block)
    assert found.grid.cell is MISSING and found.grid.size == (0.1, 0.1)
    hencky = found.materials["dough"].elastic
    assert hencky.nu is MISSING and hencky.E.value == 1e4
    assert found.bodies["block"].shape is MISSING and found.bodies["block"].material == "dogh"
    assert [finding.path for finding in check(found)] == [("bodies", "block", "material")]


@pytest.mark.parametrize(
    "use", [lambda x: x.a, lambda x: x[0], len, bool, list, float, lambda x: x == 1, lambda x: x < 1, lambda x: 1 in x, lambda x: x + 1, lambda x: 2 * x, hash]
)
def test_missing_cannot_be_used(use):
    with pytest.raises(Unknown):
        use(MISSING)


def test_nothing_at_all():
    found = loose(ROOT, {})
    assert found.grid is MISSING and found.surfaces == () and check(found) == []


@pytest.mark.parametrize("scene", ["loaf", "block"])
def test_values_that_no_rule_reads(scene, request):
    """Points of a sweep that change only these are not checked again: so no rule may touch them.

    But for one: whether a surface exchanges with what does not conduct is looked at where the config is read, and by each point as it runs (scene/exchange.py).
    """
    data = request.getfixturevalue(scene)
    experiment = Experiment.model_validate(data)
    free = [path for path, slot in leaves(ROOT, experiment) if unread(path, slot) and path[-1] not in ("kappa", "beta", "emissivity")]
    assert len(free) >= 2

    class Read(Exception):
        pass

    class Trap:
        def __getattribute__(self, name):
            raise Read(name)

        __eq__ = __lt__ = __gt__ = __le__ = __ge__ = __len__ = __iter__ = __getattribute__

    for path in free:
        trapped = Experiment.model_validate(data)
        owner = trapped
        for key in path[:-1]:
            owner = owner[key] if isinstance(owner, dict | tuple) else getattr(owner, key, owner)
        owner.__dict__[path[-1]] = Trap()
        assert check(trapped) == check(experiment) == [], path
