"""Transfers on a line: three nodes a particle."""

from mpm.basis.quadratic import slopes, weights
from mpm.state import Line
from mpm.transfer.roles import gather, gather_scalar, locate, scatter, scatter_scalar, uses_basis_gradient


@scatter.register(Line)
def _(space, gradient, x, first, chunk, count, nodes, box):
    basis_gradient = uses_basis_gradient(gradient)
    h, inverse = space.h, 1.0 / space.h
    for p in range(count):
        i0, f = locate(x[first + p, 0], inverse)
        w, g = weights(f), slopes(f)
        box[0, 0], box[0, 1] = min(box[0, 0], i0), max(box[0, 1], i0 + 3)
        m, a, A, G = chunk.m[p], chunk.a[0, p], chunk.A[0, 0, p], chunk.G[0, 0, p]
        for i in range(3):
            dp = w[i] * (a + A * (i - 1 - f) * h)
            if basis_gradient:
                dp += G * g[i] * inverse
            nodes[i0 + i, 0] += dp
            nodes[i0 + i, 1] += w[i] * m


@gather.register(Line)
def _(space, gradient, x, first, chunk, count, nodes):
    basis_gradient = uses_basis_gradient(gradient)
    inverse = 1.0 / space.h
    for p in range(count):
        i0, f = locate(x[first + p, 0], inverse)
        w, g = weights(f), slopes(f)
        value, slope, grad = 0.0, 0.0, 0.0
        for i in range(3):
            u = nodes[i0 + i, 0]
            value += w[i] * u
            slope += w[i] * (i - 1 - f) * u
            grad += g[i] * u
        chunk.v[0, p] = value
        chunk.C[0, 0, p] = 4.0 * inverse * slope
        chunk.L[0, 0, p] = inverse * grad if basis_gradient else 4.0 * inverse * slope


@scatter_scalar.register(Line)
def _(space, x, first, count, a, A, G, nodes):
    h, inverse = space.h, 1.0 / space.h
    for p in range(count):
        i0, f = locate(x[first + p, 0], inverse)
        w, g = weights(f), slopes(f)
        for i in range(3):
            nodes[i0 + i] += w[i] * (a[p] + A[0, p] * (i - 1 - f) * h) + G[0, p] * g[i] * inverse


@gather_scalar.register(Line)
def _(space, x, first, count, nodes, value, slope, grad):
    inverse = 1.0 / space.h
    for p in range(count):
        i0, f = locate(x[first + p, 0], inverse)
        w, g = weights(f), slopes(f)
        s, t, q = 0.0, 0.0, 0.0
        for i in range(3):
            u = nodes[i0 + i]
            s += w[i] * u
            t += w[i] * (i - 1 - f) * u
            q += g[i] * u
        value[p], slope[0, p], grad[0, p] = s, 4.0 * inverse * t, inverse * q
