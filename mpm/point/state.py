"""What a batch of material points is made of. N points, S stages, R rows of output in all (each point has its own, one after another)."""

from typing import Any, NamedTuple

import numpy as np

from mpm.state import NoSetting

RATE, NOMINAL, STRESS = range(3)  # what is prescribed in a direction: rate of the logarithmic strain, rate of the stretch, Cauchy stress
HELD = RATE  # at rate zero

NO_EQUILIBRIUM = 100  # beside the codes of mpm.outcome

COLUMNS = (
    "strain_xx", "strain_yy", "strain_zz", "strain_elastic_xx", "strain_elastic_yy", "strain_elastic_zz", "stress_xx", "stress_yy", "stress_zz",
    "kirchhoff_p", "kirchhoff_q", "J", "energy_elastic", "dissipation_total", "temperature_mean", "heat_total", "heat_exchanged", "heat_local",
)  # fmt: skip
STRAIN, ELASTIC, CAUCHY, P, Q, SWELL, ENERGY, DISSIPATION, TEMPERATURE, HEAT, EXCHANGED, LOCAL, WIDTH = 0, 3, 6, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18


class Rigid(NamedTuple):
    """Does not deform."""


class NoConduction(NamedTuple):
    """A point conducts nothing."""


class Lumped(NamedTuple):
    """A body of one temperature that exchanges through its surface: R0 alpha dTheta/dt = -conductance J^(2/3) (Theta - outside)."""

    conductance: Any  # beta S/V0 [W/(m3 K)], inf fixes the temperature
    outside: Any  # [K]


class Sourced(NamedTuple):
    """As Lumped, with heat from within."""

    conductance: Any  # [W/(m3 K)]
    outside: Any  # [K]
    rate: Any  # [W/m3 of reference]


class Matter(NamedTuple):
    """A batch of points: laws of arrays (mpm.point.pick), density, and the state that steps change."""

    density: np.ndarray  # (N,) of the undeformed material [kg/m3]
    elastic: Any
    flow: Any
    thermal: Any  # mpm.state.Thermal or Isothermal
    exchange: Any  # Lumped, Sourced or mpm.state.NoExchange
    expansion: Any
    heating: Any
    elastic_strain: np.ndarray  # (N, 3) principal elastic Hencky strains [-]
    strain: np.ndarray  # (N, 3) principal total Hencky strains [-]
    setting: Any = NoSetting()  # or mpm.state.Setting


class Program(NamedTuple):
    """What is prescribed to each point, stage by stage, and when its rows are due."""

    until: np.ndarray  # (N, S) end of each stage [s]; the last at or past the end of the run
    kind: np.ndarray  # (N, S, 3) RATE, NOMINAL or STRESS
    value: np.ndarray  # (N, S, 3) [1/s], [1/s] or [Pa]
    temperature: np.ndarray  # (N, S) reached at the end of the stage, linearly [K]; NaN: left to the material
    first: np.ndarray  # (N + 1,) rows of point i: first[i] to first[i + 1]
    times: np.ndarray  # (R,) [s]; the first of each point is 0
    step: np.ndarray  # (N,) [s]; 0: automatic
    safety: np.ndarray  # (N,) multiplies the automatic step
    thresholds: np.ndarray  # (N, K) temperatures whose first crossing is looked for [K]


class Progress(NamedTuple):
    """How far each point is. A run may be cut at any output time and go on later with the same bits."""

    row: np.ndarray  # (N,) last row written
    stage: np.ndarray  # (N,)
    entered: np.ndarray  # (N, 5) at the start of the stage: time, three strains, temperature less its zero
    rate: np.ndarray  # (N, 3) rate of strain of the last step, the first guess of the next [1/s]
    sums: np.ndarray  # (N, 3) dissipated, exchanged, heated locally [J/m3]
    zero: np.ndarray  # (N,) specific enthalpy at the start, less that at the zero of temperature [J/kg]
    crossed: np.ndarray  # (N, K) time of the first crossing [s], NaN before
    steps: np.ndarray  # (N,)
    code: np.ndarray  # (N,) mpm.outcome, or NO_EQUILIBRIUM
    time: np.ndarray  # (N,) where it stopped [s]
