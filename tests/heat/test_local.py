"""What deformation and temperature do to each other at a particle, called in plain Python."""

import math

import numpy as np
import pytest

from mpm.heat.local import heat_locally, latch, rise, temperature, thermal_stress
from mpm.materials import Bump, Constant, Hencky, Logistic, enthalpy, stress, table
from mpm.state import Expansion, GridHeating, Heating, Isothermal, Latched, NoExpansion, NoHeating, Softening, Thermal

R0 = 1.7


def thermal(alpha, theta=300.0, zero=250.0):
    return Thermal(np.array([theta - zero]), np.zeros((1, 1)), zero, Constant(0.1), alpha)


def test_adiabat_whatever_the_step(core):
    """Theta = Theta_0 J^-Gamma after any split of ln J (adiabatic.csv)."""
    for row in core.table("adiabatic.csv"):
        exponent, J, ratio = row.values()
        for steps in (1, 7):
            state = thermal(Constant(2.5))
            for _ in range(steps):
                heat_locally(Heating(exponent * R0 * 2.5, 0.0), state, 0, R0, math.log(J) / steps, 0.0)
            assert temperature(state, 0) / 300.0 == pytest.approx(ratio, rel=1e-12)


@pytest.mark.parametrize("alpha", [Constant(2.5), Bump(2.0, 50.0, 305.0, 1.0), Logistic(1.0, 3.0, 300.0, 4.0), table([290, 310], [1, 3])])
def test_dissipation_becomes_enthalpy(alpha):
    state, lost = thermal(alpha), 40.0
    gained = heat_locally(Heating(0.0, 0.75), state, 0, R0, 0.3, lost)
    assert gained == pytest.approx(0.75 * lost, rel=1e-14)
    assert enthalpy(alpha, temperature(state, 0)) - enthalpy(alpha, 300.0) == pytest.approx(gained / R0, rel=1e-10)


def test_no_step_jumps_over_latent_heat():
    """Ten times the latent heat's base capacity warms by what the bump leaves over."""
    alpha = Bump(2.0, 1000.0, 305.0, 0.5)
    assert rise(alpha, 300.0, 500.0) == pytest.approx(5.0, abs=0.5)
    assert rise(alpha, 300.0, 1000.0 + 40.0) == pytest.approx(20.0, rel=1e-9)
    assert rise(alpha, 320.0, -1000.0 - 40.0) == pytest.approx(-20.0, rel=1e-9)


def test_absence_is_nothing():
    state = thermal(Constant(2.5))
    assert heat_locally(NoHeating(), state, 0, R0, 0.3, 40.0) == 0.0 and temperature(state, 0) == 300.0
    assert thermal_stress(NoExpansion(), state, 0, 300.0) == 0.0
    assert temperature(Isothermal(321.0), 5) == 321.0


def test_thermal_stress_is_gamma_times_the_rise_over_the_reference():
    assert thermal_stress(Expansion(20.0, 250.0 - 290.0), thermal(Constant(1.0)), 0, 300.0) == pytest.approx(200.0, rel=1e-15)


def test_stress_at_thermal_expansion(core):
    """Free, plane strain, uniaxial and clamped (thermal_expansion.csv)."""
    for row in core.table("thermal_expansion.csv"):
        law, heat = Hencky(row["mu"], row["lambda"]), row["c_lambda"] * row["dTheta"]
        close = pytest.approx
        e = math.log(row["free3D_stretch"])
        assert stress(law, e, e, e, heat) == close((0, 0, 0), abs=1e-10 * abs(heat))
        assert math.exp(3 * e) == close(row["free3D_J"], rel=1e-14)
        e = math.log(row["planestrain_inplane_stretch"])
        assert stress(law, e, e, 0.0, heat) == close((0, 0, row["planestrain_tau33"]), abs=1e-10 * abs(heat))
        e = math.log(row["uniaxial_stretch"])
        assert stress(law, e, 0.0, 0.0, heat) == close((0, row["uniaxial_tau_lateral"], row["uniaxial_tau_lateral"]), abs=1e-10 * abs(heat))
        assert stress(law, 0.0, 0.0, 0.0, heat) == close((row["constrained_tau_iso"],) * 3, rel=1e-14)


def test_latched_expansion_swells_sets_and_stays():
    """gamma (min(max over time of Theta, set) - reference): up with the temperature, no further than `set`, never down."""
    state = thermal(Constant(1.0), 300.0)
    law = Latched(2.0, 250.0 - 290.0, np.array([50.0]), 330.0 - 250.0)
    seen = []
    for theta in (300.0, 310.0, 305.0, 340.0, 360.0, 280.0):
        state.theta[0] = theta - 250.0
        seen.append(thermal_stress(law, state, 0, 300.0))
        latch(law, state, 0)
        assert thermal_stress(law, state, 0, 300.0) == seen[-1]
    assert seen == pytest.approx([20.0, 40.0, 40.0, 80.0, 80.0, 80.0], rel=1e-14)


def test_thermal_stress_of_moduli_that_follow_temperature():
    """E(Theta) times that of E = 1: at 300 K a table from 2 Pa to 4 Pa gives 3 Pa, and gamma 0.5/K times 310 - 300 K + 10 K of shift."""
    law = Softening(Expansion(0.5, 10.0), table([250.0, 350.0], [2.0, 4.0]))
    assert thermal_stress(law, thermal(Constant(2.5), theta=300.0, zero=290.0), 0, 300.0) == pytest.approx(3.0 * 0.5 * 20.0)


def test_dissipation_heats_also_where_the_grid_heats_elastically():
    """Half of 6 J/m3 over density 1.7 and alpha 2.5; the stretch is the grid's to heat."""
    state, none = thermal(Constant(2.5)), np.zeros(1)
    assert heat_locally(GridHeating(0.3, 0.5, none, none), state, 0, R0, 0.2, 6.0) == 3.0
    assert temperature(state, 0) - 300.0 == pytest.approx(3.0 / (R0 * 2.5), rel=1e-12)
