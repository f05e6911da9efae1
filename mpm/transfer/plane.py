"""Transfers in two directions: four, nine or sixteen nodes a particle, by the basis of the space.

Axisymmetric bodies use the same: the factor r sits in their masses and volumes.
"""

from mpm.basis import stencil
from mpm.jit import kernel, role
from mpm.lanes import EIGHT
from mpm.state import Axisymmetric, Cubic, Linear, Plane, Quadratic
from mpm.transfer.roles import aim, gather, gather_scalar, scatter, scatter_scalar, uses_basis_gradient
from mpm.transfer.rows import begin_plane, gather_plane, scatter_plane
from mpm.transfer.scalars import gather_scalar_plane, scatter_scalar_plane
from mpm.transfer.stencils import CHUNK, stencil_chunk, widen


@aim.register(Plane)
@aim.register(Axisymmetric)
def aim_axisymmetric_or_plane(space, chunk, count):
    aim_by_basis(space.basis, space, chunk, count)


@role(inline=True)
def aim_by_basis(basis, space, chunk, count):
    """As aim."""
    raise TypeError(f"no basis {type(basis).__name__}")


@aim_by_basis.register(Quadratic)
def aim_plane_quadratic(basis, space, chunk, count):
    stencil_chunk(space, chunk.place, count, chunk.s)
    begin_plane(space, chunk, count)


@aim_by_basis.register(Linear)
@aim_by_basis.register(Cubic)
def aim_plane_cubic_or_linear(basis, space, chunk, count):
    return None


@scatter.register(Plane)
@scatter.register(Axisymmetric)
def scatter_axisymmetric_or_plane(space, gradient, x, first, chunk, count, nodes, box):
    scatter_by_basis(space.basis, space, gradient, x, first, chunk, count, nodes, box)


@role(inline=True)
def scatter_by_basis(basis, space, gradient, x, first, chunk, count, nodes, box):
    """As scatter."""
    raise TypeError(f"no basis {type(basis).__name__}")


@scatter_by_basis.register(Quadratic)
def scatter_plane_quadratic(basis, space, gradient, x, first, chunk, count, nodes, box):
    widen(chunk.s, count, box)
    scatter_plane(space, gradient, chunk, count, nodes)


@scatter_by_basis.register(Linear)
@scatter_by_basis.register(Cubic)
def scatter_plane_cubic_or_linear(basis, space, gradient, x, first, chunk, count, nodes, box):
    basis_gradient = uses_basis_gradient(gradient)
    h, inverse, n1 = space.h, 1.0 / space.h, space.n1
    for p in range(count):
        i0, wx, gx, dx, _ = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, dy, _ = stencil(space.basis, x[first + p, 1] * inverse)
        box[0, 0], box[0, 1] = min(box[0, 0], i0), max(box[0, 1], i0 + len(wx))
        box[1, 0], box[1, 1] = min(box[1, 0], j0), max(box[1, 1], j0 + len(wy))
        m, a0, a1 = chunk.m[p], chunk.a[0, p], chunk.a[1, p]
        A00, A01, A10, A11 = h * chunk.A[0, 0, p], h * chunk.A[0, 1, p], h * chunk.A[1, 0, p], h * chunk.A[1, 1, p]
        G00, G01, G10, G11 = inverse * chunk.G[0, 0, p], inverse * chunk.G[0, 1, p], inverse * chunk.G[1, 0, p], inverse * chunk.G[1, 1, p]
        for i in range(len(wx)):
            r0, r1 = a0 + A00 * dx[i], a1 + A10 * dx[i]
            row = (i0 + i) * n1 + j0
            for j in range(len(wy)):
                w = wx[i] * wy[j]
                p0, p1 = w * (r0 + A01 * dy[j]), w * (r1 + A11 * dy[j])
                if basis_gradient:
                    g0, g1 = gx[i] * wy[j], wx[i] * gy[j]
                    p0 += G00 * g0 + G01 * g1
                    p1 += G10 * g0 + G11 * g1
                nodes[row + j, 0] += p0
                nodes[row + j, 1] += p1
                nodes[row + j, 2] += w * m


@gather.register(Plane)
@gather.register(Axisymmetric)
def gather_axisymmetric_or_plane(space, gradient, x, first, chunk, count, nodes):
    gather_by_basis(space.basis, space, gradient, x, first, chunk, count, nodes)


@role(inline=True)
def gather_by_basis(basis, space, gradient, x, first, chunk, count, nodes):
    """As gather."""
    raise TypeError(f"no basis {type(basis).__name__}")


@gather_by_basis.register(Quadratic)
def gather_plane_quadratic(basis, space, gradient, x, first, chunk, count, nodes):
    gather_plane(space, gradient, chunk, count, nodes)


@gather_by_basis.register(Linear)
@gather_by_basis.register(Cubic)
def gather_plane_cubic_or_linear(basis, space, gradient, x, first, chunk, count, nodes):
    basis_gradient = uses_basis_gradient(gradient)
    inverse, n1 = 1.0 / space.h, space.n1
    for p in range(count):
        i0, wx, gx, _, bx = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, _, by = stencil(space.basis, x[first + p, 1] * inverse)
        v0, v1 = 0.0, 0.0
        C00, C01, C10, C11 = 0.0, 0.0, 0.0, 0.0
        L00, L01, L10, L11 = 0.0, 0.0, 0.0, 0.0
        for i in range(len(wx)):
            row = (i0 + i) * n1 + j0
            s0, s1, t0, t1, q0, q1 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for j in range(len(wy)):
                u0, u1 = nodes[row + j, 0], nodes[row + j, 1]
                s0 += wy[j] * u0
                s1 += wy[j] * u1
                t0 += by[j] * u0
                t1 += by[j] * u1
                q0 += gy[j] * u0
                q1 += gy[j] * u1
            v0 += wx[i] * s0
            v1 += wx[i] * s1
            C00 += bx[i] * s0
            C01 += wx[i] * t0
            C10 += bx[i] * s1
            C11 += wx[i] * t1
            L00 += gx[i] * s0
            L01 += wx[i] * q0
            L10 += gx[i] * s1
            L11 += wx[i] * q1
        chunk.v[0, p], chunk.v[1, p] = v0, v1
        chunk.C[0, 0, p], chunk.C[0, 1, p], chunk.C[1, 0, p], chunk.C[1, 1, p] = inverse * C00, inverse * C01, inverse * C10, inverse * C11
        if basis_gradient:
            chunk.L[0, 0, p], chunk.L[0, 1, p], chunk.L[1, 0, p], chunk.L[1, 1, p] = inverse * L00, inverse * L01, inverse * L10, inverse * L11
        else:
            chunk.L[0, 0, p], chunk.L[0, 1, p], chunk.L[1, 0, p], chunk.L[1, 1, p] = inverse * C00, inverse * C01, inverse * C10, inverse * C11


@scatter_scalar.register(Plane)
@scatter_scalar.register(Axisymmetric)
def scatter_scalar_axisymmetric_or_plane(space, x, first, count, a, A, G, nodes):
    scatter_scalar_by_basis(space.basis, space, x, first, count, a, A, G, nodes)


@role
def scatter_scalar_by_basis(basis, space, x, first, count, a, A, G, nodes):
    """As scatter_scalar."""
    raise TypeError(f"no basis {type(basis).__name__}")


@scatter_scalar_by_basis.register(Quadratic)
def scatter_scalar_plane_quadratic(basis, space, x, first, count, a, A, G, nodes):
    if count < EIGHT or count > CHUNK:
        scatter_one_by_one(space, x, first, count, a, A, G, nodes)
    else:
        scatter_scalar_plane(space, x, first, count, a, A, G, nodes)


@scatter_scalar_by_basis.register(Linear)
@scatter_scalar_by_basis.register(Cubic)
def scatter_scalar_plane_cubic_or_linear(basis, space, x, first, count, a, A, G, nodes):
    scatter_one_by_one(space, x, first, count, a, A, G, nodes)


@kernel
def scatter_one_by_one(space, x, first, count, a, A, G, nodes):
    h, inverse, n1 = space.h, 1.0 / space.h, space.n1
    for p in range(count):
        i0, wx, gx, dx, _ = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, dy, _ = stencil(space.basis, x[first + p, 1] * inverse)
        for i in range(len(wx)):
            r, g = a[p] + A[0, p] * h * dx[i], G[0, p] * gx[i] * inverse
            row = (i0 + i) * n1 + j0
            for j in range(len(wy)):
                nodes[row + j] += wx[i] * wy[j] * (r + A[1, p] * h * dy[j]) + g * wy[j] + G[1, p] * inverse * wx[i] * gy[j]


@gather_scalar.register(Plane)
@gather_scalar.register(Axisymmetric)
def gather_scalar_axisymmetric_or_plane(space, x, first, count, nodes, value, slope, grad):
    gather_scalar_by_basis(space.basis, space, x, first, count, nodes, value, slope, grad)


@role
def gather_scalar_by_basis(basis, space, x, first, count, nodes, value, slope, grad):
    """As gather_scalar."""
    raise TypeError(f"no basis {type(basis).__name__}")


@gather_scalar_by_basis.register(Quadratic)
def gather_scalar_plane_quadratic(basis, space, x, first, count, nodes, value, slope, grad):
    if count < EIGHT or count > CHUNK:
        gather_one_by_one(space, x, first, count, nodes, value, slope, grad)
    else:
        gather_scalar_plane(space, x, first, count, nodes, value, slope, grad)


@gather_scalar_by_basis.register(Linear)
@gather_scalar_by_basis.register(Cubic)
def gather_scalar_plane_cubic_or_linear(basis, space, x, first, count, nodes, value, slope, grad):
    gather_one_by_one(space, x, first, count, nodes, value, slope, grad)


@kernel
def gather_one_by_one(space, x, first, count, nodes, value, slope, grad):
    inverse, n1 = 1.0 / space.h, space.n1
    for p in range(count):
        i0, wx, gx, _, bx = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, _, by = stencil(space.basis, x[first + p, 1] * inverse)
        s, t0, t1, q0, q1 = 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(len(wx)):
            row = (i0 + i) * n1 + j0
            r, rd, rg = 0.0, 0.0, 0.0
            for j in range(len(wy)):
                u = nodes[row + j]
                r += wy[j] * u
                rd += by[j] * u
                rg += gy[j] * u
            s += wx[i] * r
            t0 += bx[i] * r
            t1 += wx[i] * rd
            q0 += gx[i] * r
            q1 += wx[i] * rg
        value[p] = s
        slope[0, p], slope[1, p] = inverse * t0, inverse * t1
        grad[0, p], grad[1, p] = inverse * q0, inverse * q1
