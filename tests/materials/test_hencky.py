"""Hencky elasticity: stress is the derivative of energy, and the thermal part is a pressure."""

import numpy as np

from mpm.materials import Hencky, energy, moduli, stress

SOLID = Hencky(mu=1e5, lam=2e5)


def test_stress_is_the_derivative_of_energy():
    e, step = np.array([0.03, -0.02, 0.011]), 1e-4
    slope = [(energy(SOLID, *(e + step * d)) - energy(SOLID, *(e - step * d))) / (2 * step) for d in np.eye(3)]
    np.testing.assert_allclose(stress(SOLID, *e, 0.0), slope, rtol=1e-11)


def test_uniaxial_strain_and_thermal_pressure():
    assert stress(SOLID, 0.01, 0.0, 0.0, 0.0) == (0.01 * 4e5, 0.01 * 2e5, 0.01 * 2e5)
    assert stress(SOLID, 0.0, 0.0, 0.0, 700.0) == (-700.0, -700.0, -700.0)
    assert moduli(SOLID) == (2e5, 1e5)
