"""A convergence study of a shipped config: run its points, or others of it."""

from pathlib import Path

import pytest

import mpm

CONFIGS = Path(__file__).parents[2] / "configs" / "verification"


def problem(name, changes=None):
    """The config as one point, with changes by path."""
    return mpm.load(mpm.load(CONFIGS / f"{name}.yaml").resolved() | {"sweep": None}, changes or {})


def study(name, path, values, changes=None):
    """A run for each value of `path`; every one must complete."""
    runs = [mpm.run_point(problem(name, (changes or {}) | {path: value})) for value in values]
    assert all(run.outcome.ok for run in runs)
    return runs


@pytest.fixture(scope="session")
def shipped():
    return problem


@pytest.fixture(scope="session")
def points():
    return study
