"""What a basis is asked; the package docstring has the contract."""

from mpm.jit import role


@role(inline=True)
def stencil(basis, s):
    """First node, weights, derivatives, offsets and fitting weights of a particle at s = x/h."""
    raise TypeError(f"no basis {type(basis).__name__}")


@role
def second_moment(basis, s):
    """sum w d^2 in cells squared; s may be an array where Python calls."""
    raise TypeError(f"no basis {type(basis).__name__}")


@role
def inverse_moment(basis):
    """1/(sum w d^2): the factor of the MLS gradient. A constant at compile time; NaN where the moment depends on the position."""
    raise TypeError(f"no basis {type(basis).__name__}")


@role
def room(basis):
    """Cells between a particle and the outermost node of an array, at least."""
    raise TypeError(f"no basis {type(basis).__name__}")
