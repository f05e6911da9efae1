"""Sources: a force and a heat of their own at every particle, by material point and time. What a manufactured solution asks for.

Roles     push(law, X, i, c, t) -> force by mass on particle i along c [m/s2];  heat(law, X, i, t) -> [W/kg]
Shapes    X (N, D) positions at the start
May use   mpm.jit                                          May not  see particles or grids
To add    a file with a NamedTuple and both roles; list it below. integrate/body_force.py applies it; mpm.error.Motion.start puts it on a body.
"""

from mpm.sources.manufactured import Made
from mpm.sources.roles import heat, push

__all__ = ["Made", "heat", "push"]
