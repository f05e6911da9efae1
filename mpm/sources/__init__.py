"""Sources: a force and a heat of their own at every particle, by material point and time. What a manufactured solution asks for, and a config's `sources`.

Roles     push(law, X, i, c, t) -> force by mass on particle i along c [m/s2];  heat(law, X, i, t) -> [W/kg]
Shapes    X (N, D) positions at the start
May use   mpm.jit                                          May not  see particles or grids
To add    a file with a NamedTuple and both roles; list it below. integrate/body_force.py applies it; mpm.error.Motion.start puts it on a body.
Further   formula: formulas of a config, read by compiled code; given: those of a moving body; integrate/given_source.py and mpm.rigid apply them
"""

from mpm.sources.formula import Code, evaluate, values
from mpm.sources.given import Both, Force, Given, Jumping, NoForce, NoWarming, Warming, acting
from mpm.sources.manufactured import Made
from mpm.sources.roles import heat, push

__all__ = ["Both", "Code", "Force", "Given", "Jumping", "Made", "NoForce", "NoWarming", "Warming", "acting", "evaluate", "heat", "push", "values"]
