"""Every kind of contact beside every transfer, explicit and implicit heat, in every dimension: the heat that theory gives, or a refusal with its place."""

import json

import numpy as np
import pytest
from contact_scenes import DIMENSIONS, along, block, conducting, floor, up
from scipy.optimize import brentq

import mpm
from mpm.scene.build import SceneError, build
from mpm.scene.refusal import placed

TRANSFERS = {"apic": "apic", "flip": "flip", "affine_flip": "affine_flip", "pic": "pic", "xpic": {"xpic": {"order": 2}}}
ALONE = ("contact", "slip", "stick", "tool")  # with a wall or tool at 400 K
PAIRS = {"slides": {}, "rubs": {"friction": 0.5}, "sticks": {"stick": {}}, "welded": {"welded": {}}}
BIOT, END, N, SPEED = 5.0, 0.05, 8, 0.01


def told(length: float) -> float:
    """Heat that a slab of this length, insulated at its other end, takes in through BIOT until END, of what it could: kappa, rho and alpha are 1."""
    roots = [brentq(lambda m: m * np.sin(m) - BIOT * np.cos(m), i * np.pi + 1e-9, i * np.pi + np.pi / 2) for i in range(60)]
    return 1 - sum(2 * BIOT**2 / (m * m * (m * m + BIOT**2 + BIOT)) * np.exp(-m * m * END / length**2) for m in roots)


def scene(dimension, kind, transfer, heat):
    """A column of a metre at 300 K that comes down on what is hot, or its lower half that comes up against the other."""
    base = 2 / N if kind == "tool" else 0.0
    found = conducting(dimension, N, BIOT if kind in PAIRS else None, END, base=1.0)
    found |= {"method": {"transfer": TRANSFERS[transfer], "heat": heat}, "output": {"every": END, "observables": [f"momentum.{up(dimension)}.cold"]}}
    if kind in PAIRS:
        found["contacts"][0] |= PAIRS[kind]
        found["bodies"]["hot"]["velocity"] = along(dimension, SPEED)
        return found
    hot, wide = {"beta": BIOT, "temperature": 400}, 2 / N * (2 if dimension == "axisymmetric" else 1)
    shape = block(dimension, 2 / N, wide, base, 1.0)
    found["bodies"] = {"cold": {"shape": shape, "material": "m", "temperature": 300, "velocity": along(dimension, -SPEED)}}
    if kind == "tool":
        found["tools"] = {"pan": {"shape": block(dimension, 0.0, 6 / N, 0.0, base), "heat": hot}}
    else:
        found["walls"] = {floor(dimension): {kind: {"heat": hot}}}
    return found


def placed_or_built(path, config):
    """Where a scene is refused: `path: of the config`; empty where it is not."""
    path.write_text(json.dumps(config, indent=1), encoding="utf-8")
    try:
        placed(build)(mpm.load(path))
    except (SceneError, mpm.ConfigError) as error:
        file, row, column, said = str(error).splitlines()[0].split(":", 3)
        assert file.endswith("scene.yaml") and int(row) > 1 and int(column) > 0
        return said.strip()
    return ""


def compiled(config):
    """In space plain Python takes half a minute a run, and kernels are shared by many."""
    run = mpm.run_point(mpm.load(config))
    return {"kind": run.outcome.kind, "series": run.series}


@pytest.mark.slow
@pytest.mark.parametrize("transfer", TRANSFERS)
@pytest.mark.parametrize("dimension", DIMENSIONS)
@pytest.mark.parametrize("kind", (*ALONE, *PAIRS))
def test_every_kind_of_contact_passes_heat_or_is_refused(plain, tmp_path, kind, dimension, transfer):
    """Heat to 5 % at 8 cells a metre, and what one body loses the other takes in to 1e-12; momentum is what forces gave, that of both bodies to 1e-12."""
    for heat in ("explicit", "implicit"):
        config = scene(dimension, kind, transfer, heat)
        said = placed_or_built(tmp_path / "scene.yaml", config)
        if said:
            places = ("method.transfer: ",) * (transfer == "xpic") + ("method.heat: ",) * (heat == "explicit")
            assert kind in PAIRS and said.startswith(places), (heat, said)
            continue
        (run,) = plain([config]) if dimension != 3 else [compiled(config)]
        s, volume = run["series"], run["series"]["volume_total"][0]
        assert run["kind"] == "completed", (heat, run)
        taken, most = (-s["heat_hot_cold"][-1], 50 * volume / 2) if kind in PAIRS else (s["heat_exchanged"][-1], 100 * volume)
        assert taken / most == pytest.approx(told(0.5 if kind in PAIRS else 1.0), rel=0.05), heat
        assert abs(s["heat_ledger"]).max() < 1e-12 * most, heat
        axis = up(dimension)
        p, gained = s[f"momentum_{axis}"], np.ptp(s[f"momentum_{axis}_cold"])
        if kind in PAIRS:
            assert np.abs(p / p[0] - 1).max() < 1e-12, heat
        if kind in ("contact", "tool", "slides", "rubs", "sticks"):
            name = {"contact": floor(dimension), "tool": "pan"}.get(kind, "hot_cold")
            assert abs(np.sum(s[f"force_{name}_{axis}"]) * END) == pytest.approx(gained, rel=0.05), heat
