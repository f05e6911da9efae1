"""What transfers do to a field by themselves, beside theory."""

import numpy as np
import pytest

from mpm.benchmarks.theory import fake_conductivity, kept, loss, strained


@pytest.mark.parametrize("dt", [1e-5, 1e-3, 1e-1])
@pytest.mark.plain
def test_pic_temperatures_conduct_by_themselves(dt):
    """R0 alpha h^2/(4 dt) within 5 %, over four decades of the step (measured: 0.03 %)."""
    measured, theory = fake_conductivity(dt)
    assert measured == pytest.approx(theory, rel=0.05)


def test_apic_temperatures_lose_the_fourth_power():
    """0.024 (kh)^4 a step within 5 % for waves of ten cells and more; and the fourth power."""
    pairs = np.array([loss(kh) for kh in (0.1, 0.2, 0.4)])
    np.testing.assert_allclose(pairs[:, 1], 0.024 * pairs[:, 0] ** 4, rtol=0.05)
    assert np.polyfit(*np.log(pairs.T), 1)[0] == pytest.approx(4, abs=0.05)


def test_flip_temperatures_lose_nothing():
    assert kept("flip", 8, 64, 41, 1e-6) == pytest.approx(kept("flip", 8, 64, 1, 1e-6), abs=1e-6)
    assert kept("pic", 8, 64, 41, 1e-6) < 0.3


@pytest.mark.slow  # two compilations
def test_the_linear_basis_gets_worse_with_refinement():
    """At a strain of 0.31; the quadratic one does not."""
    linear, quadratic = ([strained(basis, cells) for cells in (8, 16, 32)] for basis in ("linear", "quadratic"))
    assert linear[0] < linear[1] < linear[2]
    assert quadratic[0] > 3 * quadratic[1] > 6 * quadratic[2]
