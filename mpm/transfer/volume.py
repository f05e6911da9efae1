"""Transfers in three directions: eight, twenty-seven or sixty-four nodes a particle, by the basis of the space."""

from mpm.basis import stencil
from mpm.jit import kernel, role
from mpm.lanes import EIGHT
from mpm.state import Cubic, Linear, Quadratic, Volume
from mpm.transfer.roles import aim, gather, gather_scalar, scatter, scatter_scalar, uses_basis_gradient
from mpm.transfer.rows import across, begin_volume, gather_volume, scatter_volume
from mpm.transfer.scalars import gather_scalar_volume, scatter_scalar_volume
from mpm.transfer.stencils import CHUNK, stencil_chunk, widen


@aim.register(Volume)
def aim_in_volume(space, chunk, count):
    aim_by_basis(space.basis, space, chunk, count)


@role(inline=True)
def aim_by_basis(basis, space, chunk, count):
    """As aim."""
    raise TypeError(f"no basis {type(basis).__name__}")


@aim_by_basis.register(Quadratic)
def aim_volume_quadratic(basis, space, chunk, count):
    stencil_chunk(space, chunk.place, count, chunk.s)
    across(chunk, count)
    begin_volume(space, chunk, count)


@aim_by_basis.register(Linear)
@aim_by_basis.register(Cubic)
def aim_volume_cubic_or_linear(basis, space, chunk, count):
    return None


@scatter.register(Volume)
def scatter_in_volume(space, gradient, x, first, chunk, count, nodes, box):
    scatter_by_basis(space.basis, space, gradient, x, first, chunk, count, nodes, box)


@role(inline=True)
def scatter_by_basis(basis, space, gradient, x, first, chunk, count, nodes, box):
    """As scatter."""
    raise TypeError(f"no basis {type(basis).__name__}")


@scatter_by_basis.register(Quadratic)
def scatter_volume_quadratic(basis, space, gradient, x, first, chunk, count, nodes, box):
    widen(chunk.s, count, box)
    scatter_volume(space, gradient, chunk, count, nodes)


@scatter_by_basis.register(Linear)
@scatter_by_basis.register(Cubic)
def scatter_volume_cubic_or_linear(basis, space, gradient, x, first, chunk, count, nodes, box):
    basis_gradient = uses_basis_gradient(gradient)
    h, inverse, n1, n2 = space.h, 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, wx, gx, dx, _ = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, dy, _ = stencil(space.basis, x[first + p, 1] * inverse)
        k0, wz, gz, dz, _ = stencil(space.basis, x[first + p, 2] * inverse)
        box[0, 0], box[0, 1] = min(box[0, 0], i0), max(box[0, 1], i0 + len(wx))
        box[1, 0], box[1, 1] = min(box[1, 0], j0), max(box[1, 1], j0 + len(wy))
        box[2, 0], box[2, 1] = min(box[2, 0], k0), max(box[2, 1], k0 + len(wz))
        m = chunk.m[p]
        Az0, Az1, Az2 = h * chunk.A[0, 2, p], h * chunk.A[1, 2, p], h * chunk.A[2, 2, p]
        for i in range(len(wx)):
            e = h * dx[i]
            b0, b1, b2 = chunk.a[0, p] + chunk.A[0, 0, p] * e, chunk.a[1, p] + chunk.A[1, 0, p] * e, chunk.a[2, p] + chunk.A[2, 0, p] * e
            for j in range(len(wy)):
                e = h * dy[j]
                c0, c1, c2 = b0 + chunk.A[0, 1, p] * e, b1 + chunk.A[1, 1, p] * e, b2 + chunk.A[2, 1, p] * e
                wxy = wx[i] * wy[j]
                row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                if basis_gradient:
                    gxw, gyw, gzw = inverse * gx[i] * wy[j], inverse * wx[i] * gy[j], inverse * wxy
                    r0 = chunk.G[0, 0, p] * gxw + chunk.G[0, 1, p] * gyw
                    r1 = chunk.G[1, 0, p] * gxw + chunk.G[1, 1, p] * gyw
                    r2 = chunk.G[2, 0, p] * gxw + chunk.G[2, 1, p] * gyw
                    for k in range(len(wz)):
                        nodes[row + k, 0] += r0 * wz[k] + chunk.G[0, 2, p] * gzw * gz[k]
                        nodes[row + k, 1] += r1 * wz[k] + chunk.G[1, 2, p] * gzw * gz[k]
                        nodes[row + k, 2] += r2 * wz[k] + chunk.G[2, 2, p] * gzw * gz[k]
                for k in range(len(wz)):
                    w = wxy * wz[k]
                    nodes[row + k, 0] += w * (c0 + Az0 * dz[k])
                    nodes[row + k, 1] += w * (c1 + Az1 * dz[k])
                    nodes[row + k, 2] += w * (c2 + Az2 * dz[k])
                    nodes[row + k, 3] += w * m


@gather.register(Volume)
def gather_in_volume(space, gradient, x, first, chunk, count, nodes):
    gather_by_basis(space.basis, space, gradient, x, first, chunk, count, nodes)


@role(inline=True)
def gather_by_basis(basis, space, gradient, x, first, chunk, count, nodes):
    """As gather."""
    raise TypeError(f"no basis {type(basis).__name__}")


@gather_by_basis.register(Quadratic)
def gather_volume_quadratic(basis, space, gradient, x, first, chunk, count, nodes):
    gather_volume(space, gradient, chunk, count, nodes)


@gather_by_basis.register(Linear)
@gather_by_basis.register(Cubic)
def gather_volume_cubic_or_linear(basis, space, gradient, x, first, chunk, count, nodes):
    basis_gradient = uses_basis_gradient(gradient)
    inverse, n1, n2 = 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, wx, gx, _, bx = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, _, by = stencil(space.basis, x[first + p, 1] * inverse)
        k0, wz, gz, _, bz = stencil(space.basis, x[first + p, 2] * inverse)
        for c in range(3):
            v, C0, C1, C2, L0, L1, L2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for i in range(len(wx)):
                s, t1, t2, q1, q2 = 0.0, 0.0, 0.0, 0.0, 0.0
                for j in range(len(wy)):
                    row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                    r, rd, rg = 0.0, 0.0, 0.0
                    for k in range(len(wz)):
                        u = nodes[row + k, c]
                        r += wz[k] * u
                        rd += bz[k] * u
                        if basis_gradient:
                            rg += gz[k] * u
                    s += wy[j] * r
                    t1 += by[j] * r
                    t2 += wy[j] * rd
                    if basis_gradient:
                        q1 += gy[j] * r
                        q2 += wy[j] * rg
                v += wx[i] * s
                C0 += bx[i] * s
                C1 += wx[i] * t1
                C2 += wx[i] * t2
                if basis_gradient:
                    L0 += gx[i] * s
                    L1 += wx[i] * q1
                    L2 += wx[i] * q2
            chunk.v[c, p] = v
            chunk.C[c, 0, p], chunk.C[c, 1, p], chunk.C[c, 2, p] = inverse * C0, inverse * C1, inverse * C2
            if basis_gradient:
                chunk.L[c, 0, p], chunk.L[c, 1, p], chunk.L[c, 2, p] = inverse * L0, inverse * L1, inverse * L2
            else:
                chunk.L[c, 0, p], chunk.L[c, 1, p], chunk.L[c, 2, p] = inverse * C0, inverse * C1, inverse * C2


@scatter_scalar.register(Volume)
def scatter_scalar_in_volume(space, x, first, count, a, A, G, nodes):
    scatter_scalar_by_basis(space.basis, space, x, first, count, a, A, G, nodes)


@role
def scatter_scalar_by_basis(basis, space, x, first, count, a, A, G, nodes):
    """As scatter_scalar."""
    raise TypeError(f"no basis {type(basis).__name__}")


@scatter_scalar_by_basis.register(Quadratic)
def scatter_scalar_volume_quadratic(basis, space, x, first, count, a, A, G, nodes):
    if count < EIGHT or count > CHUNK:
        scatter_one_by_one(space, x, first, count, a, A, G, nodes)
    else:
        scatter_scalar_volume(space, x, first, count, a, A, G, nodes)


@scatter_scalar_by_basis.register(Linear)
@scatter_scalar_by_basis.register(Cubic)
def scatter_scalar_volume_cubic_or_linear(basis, space, x, first, count, a, A, G, nodes):
    scatter_one_by_one(space, x, first, count, a, A, G, nodes)


@kernel
def scatter_one_by_one(space, x, first, count, a, A, G, nodes):
    h, inverse, n1, n2 = space.h, 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, wx, gx, dx, _ = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, dy, _ = stencil(space.basis, x[first + p, 1] * inverse)
        k0, wz, gz, dz, _ = stencil(space.basis, x[first + p, 2] * inverse)
        for i in range(len(wx)):
            for j in range(len(wy)):
                b = a[p] + A[0, p] * h * dx[i] + A[1, p] * h * dy[j]
                wxy = wx[i] * wy[j]
                g = inverse * (G[0, p] * gx[i] * wy[j] + G[1, p] * wx[i] * gy[j])
                row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                for k in range(len(wz)):
                    nodes[row + k] += wxy * wz[k] * (b + A[2, p] * h * dz[k]) + g * wz[k] + G[2, p] * inverse * wxy * gz[k]


@gather_scalar.register(Volume)
def gather_scalar_in_volume(space, x, first, count, nodes, value, slope, grad):
    gather_scalar_by_basis(space.basis, space, x, first, count, nodes, value, slope, grad)


@role
def gather_scalar_by_basis(basis, space, x, first, count, nodes, value, slope, grad):
    """As gather_scalar."""
    raise TypeError(f"no basis {type(basis).__name__}")


@gather_scalar_by_basis.register(Quadratic)
def gather_scalar_volume_quadratic(basis, space, x, first, count, nodes, value, slope, grad):
    if count < EIGHT or count > CHUNK:
        gather_one_by_one(space, x, first, count, nodes, value, slope, grad)
    else:
        gather_scalar_volume(space, x, first, count, nodes, value, slope, grad)


@gather_scalar_by_basis.register(Linear)
@gather_scalar_by_basis.register(Cubic)
def gather_scalar_volume_cubic_or_linear(basis, space, x, first, count, nodes, value, slope, grad):
    gather_one_by_one(space, x, first, count, nodes, value, slope, grad)


@kernel
def gather_one_by_one(space, x, first, count, nodes, value, slope, grad):
    inverse, n1, n2 = 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, wx, gx, _, bx = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, _, by = stencil(space.basis, x[first + p, 1] * inverse)
        k0, wz, gz, _, bz = stencil(space.basis, x[first + p, 2] * inverse)
        v, C0, C1, C2, L0, L1, L2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(len(wx)):
            s, t1, t2, q1, q2 = 0.0, 0.0, 0.0, 0.0, 0.0
            for j in range(len(wy)):
                row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                r, rd, rg = 0.0, 0.0, 0.0
                for k in range(len(wz)):
                    u = nodes[row + k]
                    r += wz[k] * u
                    rd += bz[k] * u
                    rg += gz[k] * u
                s += wy[j] * r
                t1 += by[j] * r
                t2 += wy[j] * rd
                q1 += gy[j] * r
                q2 += wy[j] * rg
            v += wx[i] * s
            C0 += bx[i] * s
            C1 += wx[i] * t1
            C2 += wx[i] * t2
            L0 += gx[i] * s
            L1 += wx[i] * q1
            L2 += wx[i] * q2
        value[p] = v
        slope[0, p], slope[1, p], slope[2, p] = inverse * C0, inverse * C1, inverse * C2
        grad[0, p], grad[1, p], grad[2, p] = inverse * L0, inverse * L1, inverse * L2
