"""Two bodies that flow and press on each other are warned of once the surfaces of both are stretched three times; one of them alone is not."""

import numpy as np
import pytest
from contact_scenes import block, dropped

import mpm
from mpm.contact.found import BODY
from mpm.contact.stretched import growth, look, warned
from mpm.scene.build import build

pytestmark = pytest.mark.plain
H = 0.125


def squeezed(far):
    """Two blocks of dough, a cell each, under a plate that comes down by a share of their height."""
    scene = dropped(2, 0.0, E=100.0, drag=0.0, gravity=[0.0, 0.0], end=0.15)
    scene["grid"]["size"] = [9 * H, 4 * H]
    scene["bodies"] = {name: {"shape": block(2, 4 * H, H, H * k, H), "material": "m"} for k, name in enumerate(("low", "high"))}
    scene["materials"]["m"]["flow"] = {"ellipse": {"M": 0.5, "p0": 100.0, "eta": 0.5}}
    path = {"time": [0.0, 0.15], "displacement": [[0.0, 0.0], [0.0, -far * 2 * H]]}
    scene["tools"] = {"plate": {"shape": {"box": {"lower": [0.0, 2 * H], "upper": [9 * H, 3.5 * H]}}, "motion": {"path": path}}}
    return scene


@pytest.mark.slow
def test_both_stretched():
    """Squeezed to a fifth, the faces between them grow five times and less."""
    run = mpm.run_point(mpm.load(squeezed(0.8)))
    said = [text for text in run.facts.get("warnings", ()) if text.startswith("pieces: ")]
    assert run.outcome.ok and len(said) == 1 and said[0].startswith("pieces: low and high press on each other, and the surfaces of both are stretched ")
    assert 3.0 < float(said[0].split(" stretched ")[1].split()[0]) < 8.0


def test_the_growth_of_a_piece():
    """That of Nanson's formula, of a body that is sheared and stretched; of a pair that of the one that grew less, and none before they press."""
    met = build(mpm.load(squeezed(0.3))).meeting
    F = np.array([[2.5, 0.4], [0.0, 0.8]])
    sides = [2.0 * np.linalg.norm(np.linalg.solve(F.T, n)) for n in ([1.0, 0.0], [0.0, 1.0])]
    for b, found in ((0, 1.0), (1, max(sides))):
        body = met.bodies[b]
        body.surface.F[:], body.particles.J[:] = F, 2.0
        assert growth(met, b) == pytest.approx(max(sides), rel=1e-12)
        before = met.grown.copy()
        look(met)
        assert np.array_equal(met.grown, before)
        met.touching.pushed[1, BODY] = met.touching.pushed[0, BODY + 1] = 1.0
        look(met)
        assert met.grown[0, 1] == pytest.approx(found, rel=1e-12) and len(list(warned(met))) == (found > 3)
        met.touching.pushed[:] = 0.0
