"""The aspect p0 of the ellipse from porosity, by the plastic Poisson ratio (docs/physics.md 5.4).

nu_p = 1/2 (1 - phi)^n,  p0 = 1/3 sqrt((1 + nu_p)/(1/2 - nu_p)),  1 - phi = (1 - phi_0)/J
An open foam (phi -> 1) has nu_p = 0 and p0 = 0.47; as the pores close nu_p goes to 1/2 and the ellipse to von Mises' cylinder. The volume of what is not
pore does not change, so phi follows the total J: compaction hardens against pressure, swelling softens.
The first is measured on sintered powders, n = 1.92, rounded to 2 (H. A. Kuhn, C. L. Downey, Int. J. Powder Metallurgy 7 (1971) 15); the second is the
associated flow of the ellipse under uniaxial stress.
"""

import math
from typing import NamedTuple

from mpm.jit import kernel
from mpm.lanes import EIGHT, item, put
from mpm.materials.clipped import EllipseClipped
from mpm.materials.laws import LAWS, Constant
from mpm.materials.no_flow import NoFlow
from mpm.materials.radial import EllipseRadial
from mpm.materials.roles import aspects, at_volume, settled, values

DENSEST = 1e3  # p0 where the pores are closed: the largest the return maps are for; below 1e-6 of porosity with n = 2


class Porous(NamedTuple):
    """p0 of a material with pores.

    Good values  solid 0.2..0.95, exponent 1.9..2.
    Fails when   compressed below the volume of its solid: p0 stays at DENSEST there.
    """

    solid: float  # 1 - phi_0, the solid share of the volume at the start [-]
    exponent: float  # n [-]


@kernel(inline=True)
def aspect(solid, exponent):
    """p0 at a solid share of the volume."""
    dense = min(solid, 1.0) ** exponent
    return min(math.sqrt((2.0 + dense) / (1.0 - dense)) / 3.0, DENSEST) if dense < 1.0 else DENSEST


def same(law, J):
    return law


def same_lanes(law, theta, J):
    return values(law, theta)


for kind in LAWS:
    at_volume.register(kind, same)
    aspects.register(kind, same_lanes)


@at_volume.register(Porous)
def at_volume_porous(law, J):
    return Constant(aspect(law.solid / J, law.exponent))


@aspects.register(Porous)
def aspects_porous(law, theta, J):
    for k in range(EIGHT):
        J = put(J, k, aspect(law.solid / item(J, k), law.exponent))
    return J


@settled.register(NoFlow)
def settled_no_flow(law, J):
    return law


@settled.register(EllipseRadial)
def settled_ellipse_radial(law, J):
    return EllipseRadial(law.M, at_volume(law.p0, J), law.eta)


@settled.register(EllipseClipped)
def settled_ellipse_clipped(law, J):
    return EllipseClipped(law.M, at_volume(law.p0, J), law.eta)
