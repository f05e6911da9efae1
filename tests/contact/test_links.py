"""Conjugate gradients of bodies side by side, with a link between them, against a dense solve."""

import numpy as np
import pytest
from contact_scenes import conducting

import mpm
from mpm.contact.conduct import Linked
from mpm.integrate.heat_matrix import Rows, conjugate_gradients

pytestmark = pytest.mark.plain


def test_one_loop_solves_bodies_alone_and_linked():
    """Two bodies of three nodes; the link alone joins them, and 1000 times as stiff as they are."""
    K, rng = 6, np.random.default_rng(1)
    rows, columns = np.zeros((K, 2)), np.full((K, 2), -1)
    rows[:, 0], rows[:-1, 1], rows[2, 1] = 3 + rng.random(K), -1, 0
    columns[:, 0], columns[:-1, 1], columns[2, 1] = np.arange(K), np.arange(1, K), -1
    between, weight, b = np.array([[0, 1], [-1, 0]]), 1 + rng.random(K), rng.random(K)
    A = np.diag(rows[:, 0]) + np.diag(rows[:-1, 1], 1) + np.diag(rows[:-1, 1], -1)
    at, t, found = np.array([[[1, 2], [3, 4]]]), np.array([[[0.3, 0.7], [0.6, 0.4]]]), np.empty(K)
    assert conjugate_gradients(Rows(rows), columns, between, weight, b.copy(), found, 1e-12) <= 2
    assert found == pytest.approx(np.linalg.solve(A, b), rel=1e-10)
    way = np.array([0, 0.3, 0.7, -0.6, -0.4, 0])
    for stiff in (5.0, 3000.0):
        whole = rows.copy()
        for block in ([1, 2], [3, 4]):
            whole[block, 0] += stiff * way[block] ** 2
            whole[block[0], 1] += stiff * way[block[0]] * way[block[1]]
        assert conjugate_gradients(Linked(rows, whole, at, t, np.array([stiff])), columns, between, weight, b.copy(), found, 1e-12) >= 1
        assert found == pytest.approx(np.linalg.solve(A + stiff * np.outer(way, way), b), rel=1e-8)


@pytest.mark.parametrize("moves", [True, False])
def test_a_pair_that_passes_no_heat_tells_so(moves):
    """`conductance: 0` of a sweep: heat.hot_cold is 0. It was refused as asked for and not told."""
    scene = conducting(1, 8, 0.0)
    scene["output"]["observables"] = ["heat.hot_cold"]
    if not moves:
        del scene["materials"]["m"]["elastic"]
    run = mpm.run_point(mpm.load(scene))
    assert run.outcome.ok and np.all(run.series["heat_hot_cold"] == 0.0) and len(run.series["heat_hot_cold"]) == 6
