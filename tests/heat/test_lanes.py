"""Heat over lanes against its scalar form, compiled: rises through enthalpy of a row, heating of eight particles."""

import numpy as np
import pytest

from mpm.heat.lanes import heat_eight, specify, warm_up
from mpm.heat.local import heat_locally, rise
from mpm.jit import kernel
from mpm.lanes import load8, store
from mpm.materials import Bump, Constant, Logistic, table, value
from mpm.state import GridHeating, Heating, Isothermal, NoHeating, Thermal

LAWS = [Constant(2247.0), Bump(2247.0, 2.46e5, 372.75, 1.5), Logistic(2000.0, 4000.0, 345.0, 3.0), table([290.0, 330.0, 400.0], [2000.0, 5000.0, 2500.0])]
every_law = pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)


@every_law
def test_rows(law):
    """45 particles of a chunk of 64; what stands behind them does not matter."""
    rng, count = np.random.default_rng(2), 45
    theta, change = rng.uniform(300, 400, 64), rng.normal(size=64) * 10.0 ** rng.integers(-6, 2, 64)
    theta[count:], change[count:] = np.nan, np.inf
    row, found = theta.copy(), change.copy()
    specify(law, row, count)
    warm_up(law, theta.copy(), found, count)
    wanted = [rise(law, t, value(law, t) * c) for t, c in zip(theta[:count], change[:count], strict=True)]
    np.testing.assert_allclose(row[:count], [value(law, t) for t in theta[:count]], rtol=2e-15)
    np.testing.assert_allclose(found[:count], wanted, rtol=1e-12, atol=3e-12)  # differences of temperatures and enthalpies of 1e6 J/kg


@kernel
def heated(heating, thermal, state, out):
    """Rows of state: temperature, density, strain, dissipated."""
    gained, risen = heat_eight(heating, thermal, load8(state, 0), load8(state, 8), load8(state, 16), load8(state, 24))
    store(out, 0, gained)
    store(out, 8, risen)


@every_law
@pytest.mark.parametrize("heating", [Heating(1e5, 0.9), GridHeating(1e5, 0.9, np.zeros(1), np.zeros(1))], ids=["adiabat", "grid"])
def test_eight(law, heating):
    rng = np.random.default_rng(3)
    state, out = np.stack([rng.uniform(300, 400, 8), rng.uniform(900, 1100, 8), rng.normal(size=8) * 0.01, rng.uniform(0, 1e4, 8)]), np.zeros((2, 8))
    heated(heating, Thermal(np.zeros(8), np.zeros((8, 1)), 0.0, Constant(1.0), law), state, out)
    for k, (theta, density, stretched, lost) in enumerate(state.T):
        one = Thermal(np.array([theta]), np.zeros((1, 1)), 0.0, Constant(1.0), law)
        gained = heat_locally(heating, one, 0, density, stretched, lost)
        assert out[0, k] == pytest.approx(gained, rel=1e-13) and out[1, k] == pytest.approx(one.theta[0] - theta, rel=1e-10, abs=1e-11)


def test_without_heating_nothing_warms():
    out = np.ones((2, 8))
    heated(NoHeating(), Isothermal(300.0), np.ones((4, 8)), out)
    assert not out.any()
