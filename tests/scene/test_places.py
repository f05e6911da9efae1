"""What no method can run is refused with file, line and column, and says what to change."""

import re

import pytest

import mpm
from mpm.scene.refusal import SceneError
from mpm.sweep.plan_report import outlook

SCENE = """grid: {{dimension: 2, size: [2, 1], cell: 0.125}}
bodies:
  one: {{shape: {{box: {{lower: [0.25, 0.25], upper: [0.75, 0.75]}}}}, temperature: 300, velocity: [0.1, 0], material: solid}}
  two: {{shape: {{box: {{lower: [{at}, 0.25], upper: [1.5, 0.75]}}}}, temperature: 320, material: {of}}}
materials:
  solid: {{density: 2, elastic: {{hencky: {{E: 9.0, nu: 0.3}}}}, heat: {{fourier: {{kappa: 0.1, alpha: {alpha}}}}}}}
  stone: {{density: 2, heat: {{fourier: {{kappa: 0.1, alpha: 1}}}}}}
method: {{{method}}}
{more}
time: {{end: {end}}}
output: {{every: {end}}}
"""
FITTING = {"at": 1.0, "of": "solid", "alpha": 1.0, "method": "precision: float64", "more": "gravity: [0, -0.1]", "end": 3.0}
MELTS = "{bump: {base: 1, heat: 9, at: 310, width: 2}}"
REFUSED = {  # what is changed: (line, column, path, words of the message)
    "transfer": ({"method": "transfer: {xpic: {order: 2}}"}, 8, 10, "method.transfer", "take apic, flip or affine_flip"),
    "locking": ({"method": "locking: fbar"}, 8, 10, "method.locking", "leave it out"),
    "heat": ({"method": "heat: explicit"}, 8, 10, "method.heat", "auto or implicit"),
    "alpha": ({"alpha": MELTS}, 6, 90, "materials.solid.heat.fourier.alpha", "a number"),
    "overlap": ({"at": 0.7}, 4, 9, "bodies.two.shape", "move one of them"),
    "weld": ({"more": "contacts: [{between: [one, two], welded: {}}]"}, 9, 12, "contacts.0", "let them touch"),
    "still": ({"at": 0.75, "of": "stone", "more": "contacts: [{between: [one, two], welded: {}}]"}, 9, 34, "contacts.0.welded", "stands still"),
    "endless": ({"end": 1e12}, 10, 8, "time.end", "at most"),
}


def placed(tmp_path, changes):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.format(**FITTING | changes))
    return mpm.load(path)


@pytest.mark.parametrize("what", REFUSED)
def test_refusal_has_a_place(what, tmp_path, monkeypatch):
    changes, line, column, at, said = REFUSED[what]
    monkeypatch.chdir(tmp_path)
    try:
        outlook(placed(tmp_path, changes), None, 1)
        pytest.fail("not refused")
    except (SceneError, mpm.ConfigError) as refused:
        text = str(refused)
    found = re.search(r"scene\.yaml:(\d+):(\d+): ([\w.]+): (.*)", text)
    assert found, text
    assert found[3] == at and said in found[4] and int(found[1]) == line and int(found[2]) == column, text


def test_the_scene_itself_is_planned(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert outlook(placed(tmp_path, {}), None, 1)["estimate"]["particles"] == 2 * 8 * 8


def test_without_text_the_path_is_told(tmp_path):
    read = mpm.load(placed(tmp_path, {}).resolved())
    assert str(SceneError(("contacts", 0), "apart").within(read)).endswith("contacts.0: apart")
