"""A run by implicit mechanics that was cut goes on with the same bits."""

from pathlib import Path

import numpy as np
import pytest
from restart import cut

import mpm

LOAF = Path(__file__).parents[2] / "configs" / "scenes" / "loaf_oven_spring.yaml"
COLUMN = {
    "grid": {"dimension": 1, "size": [1.5], "cell": 0.125},
    "bodies": {"column": {"shape": {"box": {"lower": [0], "upper": [1]}}, "material": "soft"}},
    "materials": {"soft": {"density": 1e3, "elastic": {"hencky": {"lam": 0, "mu": 5e4}}}},
    "gravity": [-9.81],
    "method": {"mechanics": "implicit"},
    "time": {"end": 5},
    "output": {"every": 1},
}


def test_a_column_that_sags():
    cuts, wrong = cut(mpm.load(COLUMN), 4, np.random.default_rng(5))
    assert cuts == 4 and not wrong


@pytest.mark.slow
def test_a_loaf():
    cuts, wrong = cut(mpm.load(LOAF, {"grid.cell": "4 mm", "time.end": 60}), 4, np.random.default_rng(5))
    assert cuts == 4 and not wrong
