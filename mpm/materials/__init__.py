"""Materials: how a particle answers deformation, and the functions of temperature that its parameters may be.

Roles (the law chooses the function; all work compiled and in plain Python)
          stress(law, e1, e2, e3, thermal) -> t1, t2, t3                               elastic laws: hencky, neo_hookean
          energy(law, e1, e2, e3) -> psi
          moduli(law) -> lam, mu
          flow(law, elastic, e1, e2, e3, thermal, theta, dt) -> e1, e2, e3, dissipated, ok
                                                                                      flow laws: no_flow, radial, clipped
          moduli_lanes(law, theta), flow_lanes(law, trace, deviator, ...): the same over lanes of eight particles (mpm.lanes)
          tangent(law, elastic, trace, size, thermal, theta, dt): potential, stress and slopes of one step, for implicit mechanics; no_flow, radial
          response(elastic, law, trace, d, ...): the same along principal axes, of both laws; turning(elastic, ...)   hencky, neo_hookean
          warmed(law, theta) -> the elastic law at a temperature;  settled(law, J) -> the flow law at a volume   itself, but for warm, porous
          value(law, theta), enthalpy(law, theta), temperature_of(law, h, guess)      laws of temperature: laws
          values(law, theta), enthalpies(law, theta), temperatures(law, h, guess)     over lanes: lanes
Shapes    e: principal elastic Hencky strains [-]; t: principal Kirchhoff stresses [Pa], in the same order, any order
          thermal = gamma (Theta - Theta_0) [Pa], 0.0 without expansion; theta: temperature [K]; dt [s]
          dissipated, psi: energy per reference volume [J/m3]
May use   mpm.tensors, mpm.jit                                                        May not  see particles, grids or other roles
To add    a file here that registers its NamedTuple with the roles of its kind, a line below, a menu entry in config;
          tests/materials/test_menu.py finds it in ELASTIC, FLOW or LAWS by itself.

Further files
    ellipse       what both return maps share
    setting       laws that follow a degree of setting, and its rate
    return_maps   the return map on arrays, for notebooks and calibration
"""

from mpm.materials.clipped import EllipseClipped
from mpm.materials.hencky import Hencky
from mpm.materials.lanes import enthalpies, temperatures, values
from mpm.materials.laws import LAWS, Bump, Constant, Logistic, Table, table
from mpm.materials.neo_hookean import NeoHookean
from mpm.materials.no_flow import NoFlow
from mpm.materials.porous import Porous
from mpm.materials.radial import EllipseRadial
from mpm.materials.return_maps import return_map
from mpm.materials.roles import (
    energy,
    enthalpy,
    flow,
    flow_lanes,
    moduli,
    moduli_lanes,
    response,
    settled,
    stress,
    tangent,
    temperature_of,
    turning,
    value,
    warmed,
)  # fmt: skip
from mpm.materials.setting import GAS, Alike, Arrhenius, Condition, Sets
from mpm.materials.warm import HenckyWarm

ELASTIC = (Hencky,)  # those that may flow; NeoHookean is elastic only
FLOW = (NoFlow, EllipseRadial, EllipseClipped)

__all__ = [
    "ELASTIC", "FLOW", "GAS", "LAWS", "Alike", "Arrhenius", "Bump", "Condition", "Constant", "EllipseClipped", "EllipseRadial", "Hencky", "HenckyWarm",
    "Logistic", "NeoHookean", "NoFlow", "Porous", "Sets", "Table", "energy", "enthalpies", "enthalpy", "flow", "flow_lanes", "moduli", "moduli_lanes",
    "response", "return_map", "settled", "stress", "table", "tangent", "temperature_of", "temperatures", "turning", "value", "values", "warmed",
]  # fmt: skip
