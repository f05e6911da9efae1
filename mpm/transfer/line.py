"""Transfers on a line: two, three or four nodes a particle, by the basis of the space."""

from mpm.basis import stencil
from mpm.state import Line
from mpm.transfer.roles import aim, gather, gather_scalar, scatter, scatter_scalar, uses_basis_gradient


@aim.register(Line)
def aim_line(space, chunk, count):
    return None


@scatter.register(Line)
def scatter_line(space, gradient, x, first, chunk, count, nodes, box):
    basis_gradient = uses_basis_gradient(gradient)
    h, inverse = space.h, 1.0 / space.h
    for p in range(count):
        i0, w, g, d, _ = stencil(space.basis, x[first + p, 0] * inverse)
        box[0, 0], box[0, 1] = min(box[0, 0], i0), max(box[0, 1], i0 + len(w))
        m, a, A, G = chunk.m[p], chunk.a[0, p], h * chunk.A[0, 0, p], chunk.G[0, 0, p]
        for i in range(len(w)):
            dp = w[i] * (a + A * d[i])
            if basis_gradient:
                dp += G * g[i] * inverse
            nodes[i0 + i, 0] += dp
            nodes[i0 + i, 1] += w[i] * m


@gather.register(Line)
def gather_line(space, gradient, x, first, chunk, count, nodes):
    basis_gradient = uses_basis_gradient(gradient)
    inverse = 1.0 / space.h
    for p in range(count):
        i0, w, g, _, b = stencil(space.basis, x[first + p, 0] * inverse)
        value, slope, grad = 0.0, 0.0, 0.0
        for i in range(len(w)):
            u = nodes[i0 + i, 0]
            value += w[i] * u
            slope += b[i] * u
            grad += g[i] * u
        chunk.v[0, p] = value
        chunk.C[0, 0, p] = inverse * slope
        chunk.L[0, 0, p] = inverse * grad if basis_gradient else inverse * slope


@scatter_scalar.register(Line)
def scatter_scalar_line(space, x, first, count, a, A, G, nodes):
    h, inverse = space.h, 1.0 / space.h
    for p in range(count):
        i0, w, g, d, _ = stencil(space.basis, x[first + p, 0] * inverse)
        for i in range(len(w)):
            nodes[i0 + i] += w[i] * (a[p] + A[0, p] * h * d[i]) + G[0, p] * g[i] * inverse


@gather_scalar.register(Line)
def gather_scalar_line(space, x, first, count, nodes, value, slope, grad):
    inverse = 1.0 / space.h
    for p in range(count):
        i0, w, g, _, b = stencil(space.basis, x[first + p, 0] * inverse)
        s, t, q = 0.0, 0.0, 0.0
        for i in range(len(w)):
            u = nodes[i0 + i]
            s += w[i] * u
            t += b[i] * u
            q += g[i] * u
        value[p], slope[0, p], grad[0, p] = s, inverse * t, inverse * q
