"""Small scenes that the tests of the core share. One set of physics for most of them, so that each dimension and transfer compiles once."""

import copy
import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import mpm

REFERENCE = Path(__file__).parent / "reference"
DIRECTIONS = {1: 1, 2: 2, "axisymmetric": 2, 3: 3}
HOT, COLD = 400.0, 300.0
TRANSFERS = {
    "apic": ({"apic": {}}, {"apic": {}}),
    "flip": ({"flip": {}}, {"flip": {}}),
    "flip blend": ({"flip": {"blend": 0.05}}, {"flip": {"blend": 0.02}}),
    "pic": ({"pic": {}}, {"pic": {}}),
}  # velocity, temperature


def config(dimension=1, **sections):
    """A warm elastic body of 3 cells a direction, off the grid lines, in air as warm as itself: nothing happens until a test changes something."""
    D = DIRECTIONS[dimension]
    lower, upper = [0.6] * D, [1.35] * D
    if dimension == "axisymmetric":
        lower[0], upper[0] = 0.0, 0.85
    data = {
        "grid": {"dimension": dimension, "size": [2.0] * D, "cell": 0.25},
        "bodies": {"body": {"shape": {"box": {"lower": lower, "upper": upper}}, "temperature": HOT, "material": "solid"}},
        "materials": {
            "solid": {
                "density": 2.0,
                "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}},
                "heat": {"fourier": {"kappa": 0.1, "alpha": 1.5}},
                "expansion": {"modulus": {"gamma": 0.0, "reference": HOT}},
                "heating": {"elastic": {}},
            }
        },
        "surfaces": [{"of": "body", "convection": {"beta": 0.5, "outside": HOT}}],
        "time": {"end": 0.5},
        "output": {"every": 0.1},
    }
    return data | copy.deepcopy(sections)


def experiment(dimension=1, changes=None, drop=(), **sections):
    """`config` with whole `sections` replaced, then `changes` by path (short names allowed); `drop` lists parts of the material to leave out."""
    data = config(dimension, **sections)
    for part in drop:
        if part == "surfaces":
            data["surfaces"] = []
        else:
            del data["materials"]["solid"][part]
    return mpm.load(data, changes or {})


def methods(transfer, gradient="mls"):
    """The method section of a pair of transfers by name."""
    velocity, temperature = TRANSFERS[transfer]
    return {"transfer": velocity, "temperature": temperature, "gradient": gradient}


def play(experiment, prepare=None, beat=None):
    """Build, let `prepare(scene)` change the arrays, simulate: (scene at its end, run)."""
    from mpm.scene.build import build
    from mpm.simulation import simulate

    scene = build(experiment)
    if prepare is not None:
        prepare(scene)
    return scene, simulate(scene, beat)


def table(name):
    """A reference table as a list of {column: float or text}."""
    with open(REFERENCE / name, newline="") as file:
        return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def order(errors, ratio=2.0):
    """Least-squares order of errors at cells that shrink by `ratio`."""
    return -np.polyfit(np.arange(len(errors)) * np.log(ratio), np.log(errors), 1)[0]


@pytest.fixture(scope="session")
def core():
    """The helpers of this file: tests are not a package."""
    return SimpleNamespace(
        DIRECTIONS=DIRECTIONS,
        HOT=HOT,
        COLD=COLD,
        TRANSFERS=TRANSFERS,
        config=config,
        experiment=experiment,
        methods=methods,
        play=play,
        table=table,
        order=order,
    )
