"""Critical steps of arrangements: those of docs/physics.md 6, the safe steps of mpm.integrate.timestep, the theory against whole steps, the old velocity."""

import numpy as np
import pytest

from mpm.benchmarks import affine
from mpm.benchmarks.coupled import last_stable, radius, step
from mpm.benchmarks.operators import METHODS, Cloud, random_cloud, regular, search, stabilised, substeps
from mpm.integrate.heat_chebyshev import stages
from mpm.integrate.timestep import CONDUCTION, SUBSTEPS, WAVE

TABLE = {"APIC": (1.31, 1.65), "PIC": (1.10, 1.42), "FLIP": (1.07, 1.35)}  # mls, bspline: regular, 2 a cell


def test_regular_arrangements_are_those_of_the_table():
    one = regular(1)
    for method, (mls, bspline) in TABLE.items():
        assert one.mechanics(method, "mls", 0.2, 0.4) == pytest.approx(mls, rel=0.01)
        assert one.mechanics(method, "bspline", 0.2, 0.4) == pytest.approx(bspline, rel=0.01)
    for D, limit in ((1, 1.5), (2, 1.434)):
        assert regular(D).heat("grid") == pytest.approx(limit, rel=0.1)
        assert regular(D).heat("grid", "mls") == pytest.approx(1.055, rel=0.01)


def test_an_isolated_particle_has_the_limits_of_the_table():
    """Over its worst place in a cell; lam = 0.2, mu = 0.4, as multiples of h/sqrt((d lam + 2 mu)/R0)."""
    places = [np.full((1, 1), s) for s in np.linspace(1.5, 2.4999, 41)]
    for method, (mls, bspline) in {"APIC": (1.0, 0.5**0.5), "PIC": (0.5**0.5, 3**-0.5), "FLIP": (0.5**0.5, 3**-0.5)}.items():
        assert min(Cloud(x, np.ones(1)).mechanics(method, "mls", 0.2, 0.4) for x in places) == pytest.approx(mls, rel=1e-3)
        assert min(Cloud(x, np.ones(1)).mechanics(method, "bspline", 0.2, 0.4) for x in places) == pytest.approx(bspline, rel=1e-3)


@pytest.mark.parametrize("D", [1, 2, 3])
def test_random_arrangements_are_never_below_the_safe_steps(D):
    """A short form of `python -m mpm.benchmarks.operators --count 100000`."""
    for name, value in search(D, 150, seed=7)["worst"].items():
        if name == "heat grid":
            assert value >= SUBSTEPS * CONDUCTION
        else:
            assert value >= (CONDUCTION if name.startswith("heat") else WAVE), name


def test_the_critical_step_is_where_the_whole_step_begins_to_grow():
    """The matrix of a step at 0.99 and 1.01 of it: every method, both gradients, irregular clouds."""
    rng = np.random.default_rng(2)
    for _ in range(25):
        cloud = random_cloud(rng, 1)
        for method in METHODS:
            for gradient in ("mls", "bspline"):
                limit = cloud.mechanics(method, gradient, 0.2, 0.4)
                assert radius(step(cloud, method, gradient, 0.99 * limit)) <= 1 + 1e-6
                assert radius(step(cloud, method, gradient, 1.01 * limit)) > 1 + 1e-6


def test_sub_steps_need_a_shorter_step_than_steps_that_end_in_a_transfer():
    """A lone APIC particle at the edge of a cell: 0.4 is stable with a transfer after each, grows tenfold in eight without, and 0.32 does not."""
    lone = Cloud(np.full((1, 1), 1.499), np.ones(1))
    assert substeps(lone, "APIC", CONDUCTION, 1) <= 1 + 1e-9
    assert substeps(lone, "APIC", CONDUCTION, 8) > 5
    assert all(substeps(lone, "APIC", SUBSTEPS * CONDUCTION, count) <= 1 + 1e-9 for count in range(1, 9))


def test_stabilised_steps_have_stages_enough_for_any_cloud():
    """The stages that a heat step takes hold APIC and FLIP in random clouds; one in five fewer would not (it was so: 3.4-fold in a step of 3)."""
    rng, worst, before = np.random.default_rng(1), 0.0, 0.0
    for _ in range(300):
        cloud = random_cloud(rng, 1)
        for dt in (0.15, 0.3, 0.6, 1.0, 2.0, 3.0):
            for method in ("APIC", "FLIP"):
                worst = max(worst, stabilised(cloud, method, dt, stages(dt, CONDUCTION)))
        before = max(before, stabilised(cloud, "APIC", 3.0, 5))
    assert worst <= 1.0 + 1e-9
    assert stages(3.0, CONDUCTION) > 5 and before > 1.5


def test_coupling_takes_the_adiabatic_wave_and_fails_with_the_old_velocity():
    """New velocity: 1/sqrt(1 + eps_c). Old: APIC holds to Co 0.26 at eps_c = 0.1, FLIP grows at every step."""
    one = regular(1)
    for coupling in (0.1, 0.3):
        for method in ("APIC", "FLIP", "PIC"):
            expected = one.mechanics(method, "mls", 0.2, 0.4) / np.sqrt(1 + coupling)
            assert last_stable(one, method, "mls", coupling, old=False) == pytest.approx(expected, rel=0.01)
    assert last_stable(one, "APIC", "mls", 0.1, old=True) == pytest.approx(0.26, abs=0.01)
    assert all(radius(step(one, "FLIP", "mls", co, 0.1, old=True)) > 1 + 1e-7 for co in (0.01, 0.03, 0.1, 0.3, 1.0))


@pytest.mark.parametrize("D", [1, 2, 3])
def test_affine_flip_whole_step(D):
    """With blend 1 it is APIC, and begins to grow where APIC does. With 0.02 heat is safe; motion is with mls in 1-D, and where it grows it does so slowly."""
    rng = np.random.default_rng(3)
    for _ in range(10):
        cloud, lam, mu = random_cloud(rng, D), 0.2, 0.4
        for gradient in ("mls", "bspline"):
            limit = cloud.mechanics("APIC", gradient, lam, mu) / np.sqrt(D * lam + 2 * mu)
            assert radius(affine.mechanics(cloud, gradient, lam, mu, 0.99 * limit, 1.0)) <= 1 + 1e-6
            assert radius(affine.mechanics(cloud, gradient, lam, mu, 1.01 * limit, 1.0)) > 1 + 1e-6
        warm = cloud.heat("APIC")
        assert radius(affine.heat(cloud, 0.99 * warm, 1.0)) <= 1 + 1e-9 < radius(affine.heat(cloud, 1.01 * warm, 1.0))
    found = affine.search(D, 150, seed=7)
    assert found["heat"][1] == 0.0
    for gradient in ("mls", "bspline"):
        assert found[f"mechanics {gradient}"][0] < (1e-9 if (D, gradient) == (1, "mls") else 0.02)
