"""Every method beside contact: it acts, against an exact case, or is refused with a place. Refusals are quick; what acts is compiled, and slow."""

import itertools

import numpy as np
import pytest
from contact_scenes import DIMENSIONS, bars, conducting, dropped, floor, pressed, up

import mpm
from mpm.scene.build import SceneError, build
from mpm.scene.refusal import placed

TRANSFERS = ("apic", "flip", "affine_flip", "pic", {"xpic": {"order": 2}})
GRADIENTS = ("mls", "bspline")
BASES = ("linear", "quadratic", "cubic")
WARM = {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}
MELTS = {"heat": {"fourier": {"kappa": 1.0, "alpha": {"bump": {"base": 1.0, "heat": 50.0, "at": 350, "width": 5}}}}}


def written(tmp_path, scene):
    """The scene from a file, so that errors have places."""
    import json

    path = tmp_path / "scene.yaml"
    path.write_text(json.dumps(scene, indent=1), encoding="utf-8")
    return mpm.load(path)


def pair(**changes):
    return conducting(1, 8) | changes


REFUSED = {
    "xpic": (pair(method={"transfer": {"xpic": {"order": 2}}}), "method.transfer"),
    "explicit heat": (pair(method={"heat": "explicit"}), "method.heat"),
    "stabilised heat": (pair(method={"heat": "stabilised"}), "method.heat"),
    "fbar": (pair(method={"locking": "fbar"}), "method.locking"),
    "latent heat": (pair(materials={"m": WARM | MELTS}), "materials.m.heat.fourier.alpha"),
    "total frame of two": (pair(method={"frame": "total"}), "method.frame"),
    "total frame and a contact wall": (dropped(1, 0.0, drag=0.0) | {"method": {"frame": "total"}}, "walls.left"),
    "total frame and a tool": (pressed(1) | {"method": {"frame": "total"}, "walls": {}}, "tools.press"),
    "implicit mechanics of two": (pair(method={"mechanics": "implicit"}), "method.mechanics"),
    "time scaling and a tool": (pressed(1) | {"time": {"end": 1.0, "scale": 10}}, "tools.press"),
    "welded apart": (conducting(1, 8) | {"contacts": [{"between": ["hot", "cold"], "welded": {}}]}, "contacts.0"),
    "a tool in a body": (pressed(1) | {"tools": {"press": {"shape": {"box": {"lower": [0.9], "upper": [1.5]}}}}}, "tools.press.shape"),
    "a small round tool": (pressed(2) | {"tools": {"press": {"shape": {"ball": {"centre": [0.4, 1.3], "radius": 0.1}}}}}, "tools.press.shape"),
    "a thin tool": (pressed(1) | {"tools": {"press": {"shape": {"box": {"lower": [1.0], "upper": [1.1]}}}}}, "tools.press.shape"),
}
REFUSED["welded apart"][0]["bodies"]["cold"]["shape"] = {"box": {"lower": [0.7], "upper": [1.2]}}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_run_is_refused_with_its_place(name, tmp_path):
    """file:line:column: path: what, why, and what to do."""
    scene, path = REFUSED[name]
    with pytest.raises((SceneError, mpm.ConfigError)) as found:
        placed(build)(written(tmp_path, scene))
    line = next(line for line in str(found.value).splitlines() if f": {path}" in line)
    file, row, column, _ = line.split(":", 3)
    assert file.endswith("scene.yaml") and int(row) > 1 and int(column) > 0


def finals(scene):
    tree = mpm.run(mpm.load(scene))
    assert int(tree.ds.status) == 0, str(tree.ds.error.values)
    return {name: values.values for name, values in tree["series"].ds.items()}


@pytest.mark.slow
@pytest.mark.parametrize(("transfer", "gradient", "basis"), [one for one in itertools.product(TRANSFERS, GRADIENTS, BASES) if one[1:] != ("mls", "linear")])
def test_a_pressed_bar_by_every_transfer(transfer, gradient, basis):
    """P = E ln F/F to 1 %, whatever carries velocities and whatever the splines: in 1-D, by a wall and a tool.

    On hats by a thousandth, with which no particle leaves its cell: those that do put hats off by themselves (under a traction that should press a bar on a
    mirror to 0.9 of its length it has 0.915 of it, on quadratic splines 0.9001).
    """
    F = 0.999 if basis == "linear" else 0.9
    grid = {"dimension": 1, "cell": 0.125, "size": [2.0], "basis": basis}
    s = finals(pressed(1, 0.3, F, method={"transfer": transfer, "gradient": gradient}) | {"grid": grid})
    for name, sign in (("press", -1.0), ("anvil", 1.0)):
        assert sign * s[f"force_{name}_x"][-1] == pytest.approx(-np.log(F) / F, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("transfer", TRANSFERS[:4])
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_bars_that_meet_by_every_transfer(dimension, transfer):
    """Momentum to rounding; the impulse is that of the first bar, less what a surface takes: of 8 cells, or of 16 by PIC, which damps a bar by itself."""
    scene = bars(dimension, n=16) if transfer == "pic" else bars(dimension, n=8, end=6.4)  # they meet at 1.9 and 3.75 s, and part two seconds later
    s = finals(scene | {"method": {"transfer": transfer}})
    p = s[f"momentum_{up(dimension)}"]
    assert np.abs(p / p[0] - 1).max() < 1e-12
    assert 0.85 < -np.sum(s[f"force_a_b_{up(dimension)}"]) * 0.1 / p[0] < 1.02


@pytest.mark.parametrize("dimension", [pytest.param(one, marks=pytest.mark.wide if one == 2 else pytest.mark.slow) for one in DIMENSIONS])
def test_single_precision(dimension):
    """A block at rest in float32: the floor bears its weight to a thousandth. Compiled: plain Python knows one kind of number only."""
    s = finals(dropped(dimension, 0.0, end=6.0, method={"precision": "float32"}))
    assert s[f"force_{floor(dimension)}_{up(dimension)}"][-1] == pytest.approx(s["mass_total"][-1], rel=1e-3)
