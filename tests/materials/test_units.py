"""The laws on quantities with units: a metre for a pascal fails. In plain Python, as compiled code has no units."""

import os
import subprocess
import sys

SCRIPT = """
import pint
import pytest

from mpm.materials import Bump, Constant, EllipseClipped, EllipseRadial, Hencky, Logistic, energy, enthalpy, flow, stress, temperature_of, value

u = pint.UnitRegistry()
solid = Hencky(1e5 * u.Pa, 1.5e5 * u.Pa)
trial, thermal, theta, dt = (0.02, -0.03, 0.001), 100 * u.Pa, 340 * u.K, 1e-4 * u.s
stress(solid, *trial, thermal)[0].to("Pa")
energy(solid, *trial).to("J/m^3")

steps = Logistic(2 * u.kPa, 500 * u.Pa, 330 * u.K, 3 * u.K)
for kind in (EllipseRadial, EllipseClipped):
    law = kind(steps, Constant(0.8), Constant(50 * u.Pa * u.s))
    e1, e2, e3, work, ok = flow(law, solid, *trial, thermal, theta, dt)
    assert ok
    bare = kind(Constant(value(steps, theta).to("Pa").m), Constant(0.8), Constant(50.0))
    same = flow(bare, Hencky(1e5, 1.5e5), *trial, 100.0, 340.0, 1e-4)
    for one, other in zip((e1, e2, e3), same, strict=False):
        assert abs(u.Quantity(one).to("").m - other) < 1e-15
    assert abs(work.to("J/m^3").m - same[3]) < 1e-12 * same[3]
    for wrong in (
        (law._replace(eta=Constant(50 * u.Pa)), solid, thermal, theta, dt),
        (law._replace(M=Constant(1e3 * u.m)), solid, thermal, theta, dt),
        (law._replace(p0=Constant(800 * u.Pa)), solid, thermal, theta, dt),
        (law, Hencky(1e5 * u.m, 1.5e5 * u.Pa), thermal, theta, dt),
        (law, solid, 100 * u.m, theta, dt),
        (law, solid, thermal, 340 * u.Pa, dt),
        (law, solid, thermal, theta, 1e-4 * u.m),
    ):
        with pytest.raises(pint.DimensionalityError):
            law_, solid_, thermal_, theta_, dt_ = wrong
            flow(law_, solid_, *trial, thermal_, theta_, dt_)

alpha = u.J / u.kg / u.K
for law in (Constant(2200 * alpha), Bump(2247 * alpha, 2.46e5 * u.J / u.kg, 372.75 * u.K, 1.5 * u.K), Logistic(2000 * alpha, 4000 * alpha, 345 * u.K, 3 * u.K)):
    h = enthalpy(law, 371 * u.K)
    h.to("J/kg")
    assert abs(temperature_of(law, h, 300 * u.K).to("K").m - 371) < 1e-9
    value(law, 371 * u.K).to("J/kg/K")
with pytest.raises(pint.DimensionalityError):
    enthalpy(Bump(2247 * alpha, 2.46e5 * alpha, 372.75 * u.K, 1.5 * u.K), 371 * u.K)
print("units hold")
"""


def test_laws_on_quantities():
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=False)
    assert done.stdout == "units hold\n", done.stderr
