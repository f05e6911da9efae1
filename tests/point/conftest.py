"""Material points for tests: a base config and what a test changes."""

import copy

import pytest

import mpm

SOLID = {"density": 1000.0, "elastic": {"hencky": {"lam": 2.0e5, "mu": 1.0e5}}}
FLOW = {"ellipse": {"M": 1000.0, "p0": 0.8, "eta": 0.0}}
HEAT = {"fourier": {"kappa": 0.0, "alpha": 500.0}}


def config(loading, end=1.0, flow=None, every=None, material=None, **sections):
    """A point of SOLID along `loading`; `flow` changes the ellipse of FLOW, `material` adds to the material."""
    data = {
        "grid": {"dimension": 0},
        "bodies": {"body": {"shape": "point", "temperature": 300.0, "material": "solid"}},
        "materials": {"solid": copy.deepcopy(SOLID) | copy.deepcopy(material or {})},
        "loading": loading,
        "time": {"end": end},
        "output": {"every": every or end / 10},
    }
    if flow is not None:
        data["materials"]["solid"]["flow"] = {"ellipse": FLOW["ellipse"] | flow}
    return data | copy.deepcopy(sections)


@pytest.fixture(scope="session")
def point():
    """`point(loading, ...) -> Experiment`."""
    return lambda *args, **kwargs: mpm.load(config(*args, **kwargs))
