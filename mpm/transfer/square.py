"""Squares of weights: the diagonal of sum_p scale (a w + G grad(w)) (a w + G grad(w))^T, for preconditioning."""

from mpm.basis import stencil
from mpm.jit import role
from mpm.state import Axisymmetric, Line, Plane, Volume


@role
def scatter_square(space, x, first, count, scale, a, G, nodes):
    """node += scale (a w + G grad(w))^2 of `count` particles from `first` on: scale and a (n,), G (D, n). B-spline gradient."""
    raise TypeError(f"no transfer for {type(space).__name__}")


@scatter_square.register(Line)
def _(space, x, first, count, scale, a, G, nodes):
    inverse = 1.0 / space.h
    for p in range(count):
        i0, w, g, _, _ = stencil(space.basis, x[first + p, 0] * inverse)
        for i in range(len(w)):
            value = a[p] * w[i] + G[0, p] * inverse * g[i]
            nodes[i0 + i] += scale[p] * value * value


@scatter_square.register(Plane)
@scatter_square.register(Axisymmetric)
def _(space, x, first, count, scale, a, G, nodes):
    inverse, n1 = 1.0 / space.h, space.n1
    for p in range(count):
        i0, wx, gx, _, _ = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, _, _ = stencil(space.basis, x[first + p, 1] * inverse)
        for i in range(len(wx)):
            row = (i0 + i) * n1 + j0
            for j in range(len(wy)):
                value = a[p] * wx[i] * wy[j] + inverse * (G[0, p] * gx[i] * wy[j] + G[1, p] * wx[i] * gy[j])
                nodes[row + j] += scale[p] * value * value


@scatter_square.register(Volume)
def _(space, x, first, count, scale, a, G, nodes):
    inverse, n1, n2 = 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, wx, gx, _, _ = stencil(space.basis, x[first + p, 0] * inverse)
        j0, wy, gy, _, _ = stencil(space.basis, x[first + p, 1] * inverse)
        k0, wz, gz, _, _ = stencil(space.basis, x[first + p, 2] * inverse)
        for i in range(len(wx)):
            for j in range(len(wy)):
                row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                for k in range(len(wz)):
                    along = G[0, p] * gx[i] * wy[j] * wz[k] + G[1, p] * wx[i] * gy[j] * wz[k] + G[2, p] * wx[i] * wy[j] * gz[k]
                    value = a[p] * wx[i] * wy[j] * wz[k] + inverse * along
                    nodes[row + k] += scale[p] * value * value
