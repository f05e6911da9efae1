"""Roles of sources."""

from mpm.jit import role


@role
def push(law, X, i, c, t):
    """Force on particle i along c by its mass [m/s2]."""
    raise TypeError(f"no force of {type(law).__name__}")


@role
def heat(law, X, i, t):
    """Heat by mass and time [W/kg]. A law without heat answers zero."""
    raise TypeError(f"no heat of {type(law).__name__}")
