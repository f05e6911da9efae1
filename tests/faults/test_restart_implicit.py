"""A run by implicit mechanics that was cut goes on with the same bits."""

from pathlib import Path

import numpy as np
import pytest
from restart import cut

import mpm

CONFIGS = Path(__file__).parents[2] / "configs"
LOAF = CONFIGS / "scenes" / "loaf_oven_spring.yaml"
COLUMN = CONFIGS / "verification" / "hydrostatic_column.yaml"
SAGS = {"exact": None, "sweep": None, "grid.cell": 0.125, "method.mechanics": "implicit", "output.every": 1}  # it begins without stress


@pytest.mark.wide
def test_a_column_that_sags():
    cuts, wrong = cut(mpm.load(COLUMN, SAGS), 4, np.random.default_rng(5))
    assert cuts == 4 and not wrong


@pytest.mark.plain
@pytest.mark.parametrize("changes", [
    pytest.param({"method.frame": "total"}, marks=pytest.mark.wide),
    {"tools": {"plate": {"shape": {"box": {"lower": [1.02], "upper": [1.4]}}, "motion": {"force": [-0.02], "mass": 0.1}}}},
])  # fmt: skip
def test_a_column_on_its_own_nodes_or_under_a_weight(changes):
    cuts, wrong = cut(mpm.load(COLUMN, SAGS | changes | {"time": {"end": 5, "step": 0.5}, "output.every": 1.25}), 4, np.random.default_rng(5))
    assert cuts == 4 and not wrong


@pytest.mark.slow
def test_a_loaf():
    cuts, wrong = cut(mpm.load(LOAF, {"grid.cell": "4 mm", "time.end": 60}), 4, np.random.default_rng(5))
    assert cuts == 4 and not wrong


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_block_that_slides(dimension):
    """With F-bar and friction, whose springs remember; in space by conjugate gradients."""
    flat = dimension == 2
    block = {
        "grid": {"dimension": dimension, "size": [1, 0.5] if flat else [1, 0.5, 0.5], "cell": 0.125},
        "bodies": {"block": {"shape": {"box": {"lower": [0.3, 0] if flat else [0.3, 0.1, 0], "upper": [0.55, 0.25] if flat else [0.55, 0.35, 0.25]}},
                             "material": "stiff"}},
        "materials": {"stiff": {"density": 1, "elastic": {"neo_hookean": {"E": 400, "nu": 0.45}}}},
        "walls": {"bottom": {"contact": {"friction": 0.3}}}, "gravity": [0.5, -0.9] if flat else [0.5, 0, -0.9],
        "method": {"mechanics": "implicit", "locking": {"fbar": {}}}, "time": {"end": 0.5}, "output": {"every": 0.125},
    }  # fmt: skip
    cuts, wrong = cut(mpm.load(block), 4, np.random.default_rng(5))
    assert cuts == 4 and not wrong
