"""What the table of surfaces says, on its two smallest cells."""

import numpy as np
import pytest

from mpm.benchmarks.surfaces import OFFSETS, WAYS, case, table


@pytest.fixture(scope="module")
def found():
    return {way: [case("slab", 10.0, way, n) for n in (8, 16)] for way in WAYS}


def order(cases):
    return np.log2(cases[0][0] / cases[1][0])


def test_the_exact_surface_is_of_order_two_and_the_others_are_not(found):
    assert order(found["exact"]) > 1.8 and found["exact"][1][0] < 2.5e-3
    assert 0.9 < order(found["depth"]) < 1.3 and order(found["samples"]) < 1


def test_samples_lose_where_no_particle_is(found):
    """At the last offset the surface lies in slivers without particles."""
    assert OFFSETS[-1] == 0.503
    assert found["samples"][1][2] > 1e-7 and abs(found["exact"][1][2]) < 1e-12 and found["samples"][1][0] > 20 * found["exact"][1][0]


def test_depth_takes_longer_explicit_steps_behind_a_fixed_temperature():
    exact, depth = (case("slab", np.inf, way, 8) for way in ("exact", "depth"))
    assert depth[1] > 10 * exact[1]


def test_the_table_has_a_row_each():
    rows = table(("disc",), (1.0,), (3, 6)).splitlines()
    assert len(rows) == 2 + len(WAYS) and all(len(row.split("|")) == 10 for row in rows)
