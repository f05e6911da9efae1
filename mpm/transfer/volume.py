"""Transfers in three directions: twenty-seven nodes a particle."""

from mpm.basis.quadratic import slopes, weights
from mpm.state import Volume
from mpm.transfer.roles import gather, gather_scalar, locate, scatter, scatter_scalar, uses_basis_gradient


@scatter.register(Volume)
def _(space, gradient, x, first, chunk, count, nodes, box):
    basis_gradient = uses_basis_gradient(gradient)
    h, inverse, n1, n2 = space.h, 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, fx = locate(x[first + p, 0], inverse)
        j0, fy = locate(x[first + p, 1], inverse)
        k0, fz = locate(x[first + p, 2], inverse)
        wx, wy, wz, gx, gy, gz = weights(fx), weights(fy), weights(fz), slopes(fx), slopes(fy), slopes(fz)
        box[0, 0], box[0, 1] = min(box[0, 0], i0), max(box[0, 1], i0 + 3)
        box[1, 0], box[1, 1] = min(box[1, 0], j0), max(box[1, 1], j0 + 3)
        box[2, 0], box[2, 1] = min(box[2, 0], k0), max(box[2, 1], k0 + 3)
        m = chunk.m[p]
        Az0, Az1, Az2 = h * chunk.A[0, 2, p], h * chunk.A[1, 2, p], h * chunk.A[2, 2, p]
        for i in range(3):
            dx = h * (i - 1 - fx)
            b0, b1, b2 = chunk.a[0, p] + chunk.A[0, 0, p] * dx, chunk.a[1, p] + chunk.A[1, 0, p] * dx, chunk.a[2, p] + chunk.A[2, 0, p] * dx
            for j in range(3):
                dy = h * (j - 1 - fy)
                c0, c1, c2 = b0 + chunk.A[0, 1, p] * dy, b1 + chunk.A[1, 1, p] * dy, b2 + chunk.A[2, 1, p] * dy
                wxy = wx[i] * wy[j]
                row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                if basis_gradient:
                    gxw, gyw, gzw = inverse * gx[i] * wy[j], inverse * wx[i] * gy[j], inverse * wxy
                    r0 = chunk.G[0, 0, p] * gxw + chunk.G[0, 1, p] * gyw
                    r1 = chunk.G[1, 0, p] * gxw + chunk.G[1, 1, p] * gyw
                    r2 = chunk.G[2, 0, p] * gxw + chunk.G[2, 1, p] * gyw
                    for k in range(3):
                        nodes[row + k, 0] += r0 * wz[k] + chunk.G[0, 2, p] * gzw * gz[k]
                        nodes[row + k, 1] += r1 * wz[k] + chunk.G[1, 2, p] * gzw * gz[k]
                        nodes[row + k, 2] += r2 * wz[k] + chunk.G[2, 2, p] * gzw * gz[k]
                for k in range(3):
                    w, dz = wxy * wz[k], k - 1 - fz
                    nodes[row + k, 0] += w * (c0 + Az0 * dz)
                    nodes[row + k, 1] += w * (c1 + Az1 * dz)
                    nodes[row + k, 2] += w * (c2 + Az2 * dz)
                    nodes[row + k, 3] += w * m


@gather.register(Volume)
def _(space, gradient, x, first, chunk, count, nodes):
    basis_gradient = uses_basis_gradient(gradient)
    inverse, n1, n2 = 1.0 / space.h, space.n1, space.n2
    four = 4.0 * inverse
    for p in range(count):
        i0, fx = locate(x[first + p, 0], inverse)
        j0, fy = locate(x[first + p, 1], inverse)
        k0, fz = locate(x[first + p, 2], inverse)
        wx, wy, wz, gx, gy, gz = weights(fx), weights(fy), weights(fz), slopes(fx), slopes(fy), slopes(fz)
        for c in range(3):
            v, C0, C1, C2, L0, L1, L2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for i in range(3):
                s, t1, t2, q1, q2 = 0.0, 0.0, 0.0, 0.0, 0.0
                for j in range(3):
                    row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                    r, rd, rg = 0.0, 0.0, 0.0
                    for k in range(3):
                        u = nodes[row + k, c]
                        r += wz[k] * u
                        rd += wz[k] * (k - 1 - fz) * u
                        if basis_gradient:
                            rg += gz[k] * u
                    s += wy[j] * r
                    t1 += wy[j] * (j - 1 - fy) * r
                    t2 += wy[j] * rd
                    if basis_gradient:
                        q1 += gy[j] * r
                        q2 += wy[j] * rg
                v += wx[i] * s
                C0 += wx[i] * (i - 1 - fx) * s
                C1 += wx[i] * t1
                C2 += wx[i] * t2
                if basis_gradient:
                    L0 += gx[i] * s
                    L1 += wx[i] * q1
                    L2 += wx[i] * q2
            chunk.v[c, p] = v
            chunk.C[c, 0, p], chunk.C[c, 1, p], chunk.C[c, 2, p] = four * C0, four * C1, four * C2
            if basis_gradient:
                chunk.L[c, 0, p], chunk.L[c, 1, p], chunk.L[c, 2, p] = inverse * L0, inverse * L1, inverse * L2
            else:
                chunk.L[c, 0, p], chunk.L[c, 1, p], chunk.L[c, 2, p] = four * C0, four * C1, four * C2


@scatter_scalar.register(Volume)
def _(space, x, first, count, a, A, G, nodes):
    h, inverse, n1, n2 = space.h, 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, fx = locate(x[first + p, 0], inverse)
        j0, fy = locate(x[first + p, 1], inverse)
        k0, fz = locate(x[first + p, 2], inverse)
        wx, wy, wz, gx, gy, gz = weights(fx), weights(fy), weights(fz), slopes(fx), slopes(fy), slopes(fz)
        for i in range(3):
            for j in range(3):
                b = a[p] + A[0, p] * (i - 1 - fx) * h + A[1, p] * (j - 1 - fy) * h
                wxy = wx[i] * wy[j]
                g = inverse * (G[0, p] * gx[i] * wy[j] + G[1, p] * wx[i] * gy[j])
                row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                for k in range(3):
                    nodes[row + k] += wxy * wz[k] * (b + A[2, p] * (k - 1 - fz) * h) + g * wz[k] + G[2, p] * inverse * wxy * gz[k]


@gather_scalar.register(Volume)
def _(space, x, first, count, nodes, value, slope, grad):
    inverse, n1, n2 = 1.0 / space.h, space.n1, space.n2
    for p in range(count):
        i0, fx = locate(x[first + p, 0], inverse)
        j0, fy = locate(x[first + p, 1], inverse)
        k0, fz = locate(x[first + p, 2], inverse)
        wx, wy, wz, gx, gy, gz = weights(fx), weights(fy), weights(fz), slopes(fx), slopes(fy), slopes(fz)
        v, C0, C1, C2, L0, L1, L2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(3):
            s, t1, t2, q1, q2 = 0.0, 0.0, 0.0, 0.0, 0.0
            for j in range(3):
                row = ((i0 + i) * n1 + j0 + j) * n2 + k0
                r, rd, rg = 0.0, 0.0, 0.0
                for k in range(3):
                    u = nodes[row + k]
                    r += wz[k] * u
                    rd += wz[k] * (k - 1 - fz) * u
                    rg += gz[k] * u
                s += wy[j] * r
                t1 += wy[j] * (j - 1 - fy) * r
                t2 += wy[j] * rd
                q1 += gy[j] * r
                q2 += wy[j] * rg
            v += wx[i] * s
            C0 += wx[i] * (i - 1 - fx) * s
            C1 += wx[i] * t1
            C2 += wx[i] * t2
            L0 += gx[i] * s
            L1 += wx[i] * q1
            L2 += wx[i] * q2
        value[p] = v
        slope[0, p], slope[1, p], slope[2, p] = 4.0 * inverse * C0, 4.0 * inverse * C1, 4.0 * inverse * C2
        grad[0, p], grad[1, p], grad[2, p] = inverse * L0, inverse * L1, inverse * L2
