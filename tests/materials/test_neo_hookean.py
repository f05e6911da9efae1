"""Compressible neo-Hookean elasticity: the stored energy of the textbook, and stresses that are its derivatives."""

import numpy as np
import pytest

from mpm.materials import NeoHookean, energy, moduli, stress

SOLID = NeoHookean(mu=1e5, lam=2e5)
STRAINS = [(0.3, -0.2, 0.11), (-0.4, 0.05, 0.25), (0.02, 0.03, -0.6)]


@pytest.mark.parametrize("e", STRAINS)
def test_stored_energy(e):
    """mu/2 (I1 - 3) - mu ln J + lam/2 (J - 1)^2."""
    stretch = np.exp(e)
    J = stretch.prod()
    exact = SOLID.mu / 2 * ((stretch**2).sum() - 3) - SOLID.mu * np.log(J) + SOLID.lam / 2 * (J - 1) ** 2
    assert energy(SOLID, *e) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("e", STRAINS)
def test_stress_is_the_derivative_of_energy_less_the_thermal_pressure(e):
    e, step = np.array(e), 1e-5
    slope = [(energy(SOLID, *(e + step * d)) - energy(SOLID, *(e - step * d))) / (2 * step) for d in np.eye(3)]
    np.testing.assert_allclose(stress(SOLID, *e, 700.0), np.array(slope) - 700.0, rtol=1e-7)
    assert moduli(SOLID) == (2e5, 1e5)
