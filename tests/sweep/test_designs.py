"""Samples of the unit cube: seeds, growth, evenness."""

import subprocess
import sys
import warnings

import numpy as np
import pytest

from mpm.sweep.designs import unit_sample

DESIGNS = ("sobol", "latin", "halton", "uniform")


@pytest.mark.parametrize("design", DESIGNS)
def test_seed_and_range(design):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        points = unit_sample(design, 37, 5, 3)
    assert points.shape == (37, 5) and points.min() >= 0 and points.max() < 1
    assert np.array_equal(points, unit_sample(design, 37, 5, 3))
    assert not np.array_equal(points, unit_sample(design, 37, 5, 4))


@pytest.mark.parametrize("design", ["sobol", "halton", "uniform"])
def test_a_longer_sample_keeps_the_shorter_one(design):
    assert np.array_equal(unit_sample(design, 100, 3, 7)[:37], unit_sample(design, 37, 3, 7))


def test_evenness():
    ranks = np.sort(np.floor(unit_sample("latin", 20, 4, 0) * 20), axis=0)
    assert np.array_equal(ranks, np.repeat(np.arange(20.0)[:, None], 4, axis=1))
    assert np.bincount((unit_sample("sobol", 64, 1, 0)[:, 0] * 64).astype(int)).tolist() == [1] * 64


def test_unknown_design():
    with pytest.raises(ValueError, match="no design"):
        unit_sample("grid", 3, 2, 0)


def test_a_process_that_must_stay_small_asks_another():
    code = "import sys; from mpm.sweep.designs import sample_apart as made; print(repr(made('sobol', 5, 2, 3).tolist()), 'scipy.stats' in sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said == f"{unit_sample('sobol', 5, 2, 3).tolist()!r} False\n"
