"""Algebra of small tensors on numbers or lanes (mpm.lanes) in tuples, in the precision of what comes in.

Components   line (xx, yy, zz); plane and axisymmetric (xx, yy, zz, xy), zz out of plane or hoop; volume (xx, yy, zz, xy, yz, xz)
Increments   A = dt grad v, so that F <- (1 + A) F:
             line (xx,); plane and axisymmetric (xx, xy, yx, yy, zz), zz = 0 in plane strain; volume (xx, xy, xz, yx, yy, yz, zx, zy, zz)
State        B = b_e - 1 = F_e F_e^T - 1, which keeps small strains precise in float32; principal Hencky strain 1/2 log1p(B_i)

Numbers are cast with `like`: a bare 0.5 would turn float32 into float64 inside Numba.
"""

from mpm.jit import kernel
from mpm.lanes import absolute, below, choose, like, maximum, precision, sqrt


@kernel(inline=True)
def turn(a, b, w):
    """The rotation by at most 45 degrees that diagonalises [[a, w], [w, b]]: (t, c, s), t = tan; values a + t w and b - t w, axes (c, s) and (-s, c).

    Exact to round-off of the largest entry also for equal values (and to 1e-24 absolutely: far below any strain); branch-free
    (Golub & Van Loan, Matrix Computations, 8.5.2).
    """
    one, nought = like(a, 1.0), like(a, 0.0)
    tiny = like(a, 1e-30)  # 0/0 for an isotropic tensor
    d = a - b
    twice = choose(below(like(a, 0.01) * precision(a) * absolute(d), absolute(w)), w + w, nought)  # else Jacobi's leavings would go, slowly, through subnormals
    size = maximum(sqrt(d * d + twice * twice), absolute(twice))  # the second where the squares underflow
    t = choose(below(d, nought), -twice, twice) / (absolute(d) + size + tiny)
    c = one / sqrt(one + t * t)
    return t, c, t * c


@kernel(inline=True)
def eigen2(xx, yy, xy):
    """Values and axes of a symmetric 2x2 tensor: (l1, l2, c, s), n1 = (c, s), n2 = (-s, c). Not sorted: l1 belongs to the axis nearer x."""
    t, c, s = turn(xx, yy, xy)
    return xx + t * xy, yy - t * xy, c, s


@kernel(inline=True)
def compose2(l1, l2, c, s):
    """The inverse of `eigen2`: (xx, yy, xy). Equal values give an exactly isotropic tensor."""
    d = l1 - l2
    return l1 - s * s * d, l2 + s * s * d, c * s * d


@kernel(inline=True)
def sweep(m, v):
    """One rotation in each plane of the tensor m (xx, yy, zz, xy, yz, xz), gathered in the axes v."""
    xx, yy, zz, xy, yz, xz = m
    ax, ay, az, bx, by, bz, cx, cy, cz = v
    zero = like(xx, 0.0)
    t, c, s = turn(xx, yy, xy)
    xx, yy, xy = xx + t * xy, yy - t * xy, zero
    xz, yz = c * xz + s * yz, c * yz - s * xz
    ax, bx, ay, by, az, bz = c * ax + s * bx, c * bx - s * ax, c * ay + s * by, c * by - s * ay, c * az + s * bz, c * bz - s * az
    t, c, s = turn(xx, zz, xz)
    xx, zz, xz = xx + t * xz, zz - t * xz, zero
    xy, yz = s * yz, c * yz
    ax, cx, ay, cy, az, cz = c * ax + s * cx, c * cx - s * ax, c * ay + s * cy, c * cy - s * ay, c * az + s * cz, c * cz - s * az
    t, c, s = turn(yy, zz, yz)
    yy, zz, yz = yy + t * yz, zz - t * yz, zero
    xy, xz = c * xy, -s * xy
    bx, cx, by, cy, bz, cz = c * bx + s * cx, c * cx - s * bx, c * by + s * cy, c * cy - s * by, c * bz + s * cz, c * cz - s * bz
    return (xx, yy, zz, xy, yz, xz), (ax, ay, az, bx, by, bz, cx, cy, cz)


@kernel(inline=True)
def eigen3(xx, yy, zz, xy, yz, xz):
    """Values and axes of a symmetric 3x3 tensor by Jacobi rotations: (l1, l2, l3, n1x, n1y, n1z, n2x, n2y, n2z, n3x, n3y, n3z). Not sorted.

    Error about 2e-15 (float32 2e-6) of the largest entry, axes orthonormal to the same, also for repeated values. Branch-free; four sweeps,
    of which the last is at round-off already.
    """
    zero, one = like(xx, 0.0), like(xx, 1.0)
    m, v = sweep((xx, yy, zz, xy, yz, xz), (one, zero, zero, zero, one, zero, zero, zero, one))
    m, v = sweep(m, v)
    m, v = sweep(m, v)
    m, v = sweep(m, v)
    return m[0], m[1], m[2], v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]


@kernel(inline=True)
def compose3(l1, l2, l3, ax, ay, az, bx, by, bz):
    """The inverse of `eigen3`: (xx, yy, zz, xy, yz, xz). The third axis is implied; equal values give an exactly isotropic tensor."""
    a, b = l1 - l3, l2 - l3
    xx, yy, zz = l3 + (a * ax * ax + b * bx * bx), l3 + (a * ay * ay + b * by * by), l3 + (a * az * az + b * bz * bz)
    return xx, yy, zz, a * ax * ay + b * bx * by, a * ay * az + b * by * bz, a * ax * az + b * bx * bz


@kernel(inline=True)
def push1(B, A):
    """B of the trial state in uniaxial strain: (1 + A)(1 + B)(1 + A)^T - 1 with nothing of order one that cancels."""
    xx, yy, zz = B
    w = A[0] + A[0] * xx
    return xx + (w + w + w * A[0]), yy, zz


@kernel(inline=True)
def push2(B, A):
    """B of the trial state in plane strain and axisymmetry: B + W + W^T + W A^T, W = A + A B."""
    xx, yy, zz, xy = B
    axx, axy, ayx, ayy, azz = A
    wxx, wxy = axx + (axx * xx + axy * xy), axy + (axx * xy + axy * yy)
    wyx, wyy = ayx + (ayx * xx + ayy * xy), ayy + (ayx * xy + ayy * yy)
    wzz = azz + azz * zz
    return (
        xx + (wxx + wxx + (wxx * axx + wxy * axy)),
        yy + (wyy + wyy + (wyx * ayx + wyy * ayy)),
        zz + (wzz + wzz + wzz * azz),
        xy + (wxy + wyx + (wxx * ayx + wxy * ayy)),
    )


@kernel(inline=True)
def push3(B, A):
    """B of the trial state in three dimensions: B + W + W^T + W A^T, W = A + A B."""
    xx, yy, zz, xy, yz, xz = B
    axx, axy, axz, ayx, ayy, ayz, azx, azy, azz = A
    wxx, wxy, wxz = axx + (axx * xx + axy * xy + axz * xz), axy + (axx * xy + axy * yy + axz * yz), axz + (axx * xz + axy * yz + axz * zz)
    wyx, wyy, wyz = ayx + (ayx * xx + ayy * xy + ayz * xz), ayy + (ayx * xy + ayy * yy + ayz * yz), ayz + (ayx * xz + ayy * yz + ayz * zz)
    wzx, wzy, wzz = azx + (azx * xx + azy * xy + azz * xz), azy + (azx * xy + azy * yy + azz * yz), azz + (azx * xz + azy * yz + azz * zz)
    return (
        xx + (wxx + wxx + (wxx * axx + wxy * axy + wxz * axz)),
        yy + (wyy + wyy + (wyx * ayx + wyy * ayy + wyz * ayz)),
        zz + (wzz + wzz + (wzx * azx + wzy * azy + wzz * azz)),
        xy + (wxy + wyx + (wxx * ayx + wxy * ayy + wxz * ayz)),
        yz + (wyz + wzy + (wyx * azx + wyy * azy + wyz * azz)),
        xz + (wxz + wzx + (wxx * azx + wxy * azy + wxz * azz)),
    )


@kernel(inline=True)
def dilation1(A):
    """det(1 + A) - 1."""
    return A[0]


@kernel(inline=True)
def dilation2(A):
    """det(1 + A) - 1, precise for small A. A volume ratio J kept as J - 1 grows by dilation * J."""
    axx, axy, ayx, ayy, azz = A
    plane = axx + ayy + (axx * ayy - axy * ayx)
    return plane + azz + plane * azz


@kernel(inline=True)
def dilation3(A):
    """det(1 + A) - 1, precise for small A: trace, second and third invariant."""
    axx, axy, axz, ayx, ayy, ayz, azx, azy, azz = A
    cx, cy, cz = ayy * azz - ayz * azy, ayz * azx - ayx * azz, ayx * azy - ayy * azx
    second = (axx * ayy - axy * ayx) + (axx * azz - axz * azx) + cx
    return axx + ayy + azz + (second + (axx * cx + axy * cy + axz * cz))
