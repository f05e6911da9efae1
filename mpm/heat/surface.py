"""Surface pieces that follow the body: areas by Nanson, offsets by F (docs/physics.md 3 and 11).

a = J F^-T A,  d = F D, with A and D of the reference shape. Plane strain has F33 = 1; axisymmetric areas carry the factor r in A and the
hoop stretch in J. In one direction a piece is an end point of constant area.
"""

from mpm.jit import role
from mpm.state import Axisymmetric, Line, Plane, Volume


@role
def area_and_offset(space, F, row, J, A, D, s, offset):
    """Current area [m^(D-1)] of piece s, whose owner has volume ratio J and deformation gradient F[row]; its current offset is written to `offset`."""
    raise TypeError(f"no surface for {type(space).__name__}")


@area_and_offset.register(Line)
def area_and_offset_line(space, F, row, J, A, D, s, offset):
    offset[0, 0] = F[row, 0, 0] * D[s, 0]
    return abs(A[s, 0])


@area_and_offset.register(Plane)
@area_and_offset.register(Axisymmetric)
def area_and_offset_axisymmetric_or_plane(space, F, row, J, A, D, s, offset):
    F00, F01, F10, F11 = F[row, 0, 0], F[row, 0, 1], F[row, 1, 0], F[row, 1, 1]
    offset[0, 0] = F00 * D[s, 0] + F01 * D[s, 1]
    offset[1, 0] = F10 * D[s, 0] + F11 * D[s, 1]
    out_of_plane = J / (F00 * F11 - F01 * F10)
    a0, a1 = F11 * A[s, 0] - F10 * A[s, 1], F00 * A[s, 1] - F01 * A[s, 0]
    return out_of_plane * (a0 * a0 + a1 * a1) ** 0.5


@area_and_offset.register(Volume)
def area_and_offset_volume(space, F, row, J, A, D, s, offset):
    f = F[row]
    for a in range(3):
        offset[a, 0] = f[a, 0] * D[s, 0] + f[a, 1] * D[s, 1] + f[a, 2] * D[s, 2]
    total = 0.0
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        area = 0.0
        for k in range(3):
            o, m = (k + 1) % 3, (k + 2) % 3
            area += (f[b, o] * f[c, m] - f[b, m] * f[c, o]) * A[s, k]
        total += area * area
    return total**0.5
