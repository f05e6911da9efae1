"""Signed distances of tools and their gradients: box, ball, upright cylinder, polygon, mesh of triangles, each about its own centre."""

import math

from mpm.contact.triangles import to_mesh
from mpm.jit import kernel

BOX, BALL, CYLINDER, POLYGON, MESH = range(5)


@kernel
def signed(tools, t, x, y, n):
    """phi [m] of tool t at x (D,), negative inside; n (D,) becomes its gradient; y (D,) is scratch."""
    D, kind, gap = len(x), tools.kind[t], 0.0
    for a in range(D):
        y[a] = 0.0
        for c in range(D):
            y[a] += tools.turn[t, c, a] * (x[c] - tools.centre[t, c])
    if kind == BALL:
        gap = to_ball(y, tools.size[t, 0])
    elif kind == POLYGON:
        gap = to_polygon(y, tools.corner[t], tools.corners[t])
    elif kind == MESH:
        gap = to_mesh(tools.mesh, t, y)
    elif kind == CYLINDER:
        gap = to_cylinder(y, tools.size[t, 0], tools.size[t, 1])
    else:
        gap = to_box(y, tools.size[t])
    for a in range(D):
        n[a] = 0.0
        for c in range(D):
            n[a] += tools.turn[t, a, c] * y[c]
    return gap


@kernel
def to_ball(y, radius):
    """Signed distance of y, which becomes the normal."""
    length = 0.0
    for a in range(len(y)):
        length += y[a] ** 2
    length = math.sqrt(length)
    for a in range(len(y)):
        y[a] = y[a] / length if length > 0.0 else (1.0 if a == len(y) - 1 else 0.0)
    return length - radius


@kernel
def to_box(y, half):
    """Signed distance of y, which becomes the normal."""
    square, most, axis = 0.0, -1e300, 0
    for a in range(len(y)):
        q = abs(y[a]) - half[a]
        square += max(q, 0.0) ** 2
        if q > most:
            most, axis = q, a
    gap = math.sqrt(square) if most > 0.0 else most
    for a in range(len(y)):
        sign, q = 1.0 if y[a] >= 0.0 else -1.0, abs(y[a]) - half[a]
        y[a] = sign * (max(q, 0.0) / gap if most > 0.0 else 1.0 if a == axis else 0.0)
    return gap


@kernel
def to_cylinder(y, radius, half):
    """Signed distance of y (3,) to an upright cylinder about its centre; y becomes the normal. In fewer directions there is none."""
    if len(y) < 3:
        return 1e300
    r, last = math.sqrt(y[0] ** 2 + y[1] ** 2), len(y) - 1
    q, p, sign = r - radius, abs(y[last]) - half, 1.0 if y[last] >= 0.0 else -1.0
    gap = math.sqrt(max(q, 0.0) ** 2 + max(p, 0.0) ** 2) if max(q, p) > 0.0 else max(q, p)
    side = max(q, 0.0) / gap if max(q, p) > 0.0 else 1.0 if q > p else 0.0
    end = max(p, 0.0) / gap if max(q, p) > 0.0 else 0.0 if q > p else 1.0
    for a in range(2):
        y[a] = side * y[a] / r if r > 0.0 else 0.0
    y[last] = sign * end
    return gap


@kernel
def to_polygon(y, corner, count):
    """Signed distance of y (2,), which becomes the normal. In one direction there is no polygon."""
    if len(y) < 2:
        return 1e300
    nearest, inside, at0, at1, out0, out1 = 1e300, False, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        j = k + 1 if k + 1 < count else 0
        run0, run1 = corner[j, 0] - corner[k, 0], corner[j, 1] - corner[k, 1]
        length = math.sqrt(run0 * run0 + run1 * run1)
        part = min(max(((y[0] - corner[k, 0]) * run0 + (y[1] - corner[k, 1]) * run1) / (length * length), 0.0), 1.0)
        foot0, foot1 = corner[k, 0] + part * run0, corner[k, 1] + part * run1
        apart = math.sqrt((y[0] - foot0) ** 2 + (y[1] - foot1) ** 2)
        if apart < nearest:
            nearest, at0, at1, out0, out1 = apart, foot0, foot1, run1 / length, -run0 / length
        if (corner[k, 1] > y[1]) != (corner[j, 1] > y[1]) and y[0] < corner[k, 0] + (y[1] - corner[k, 1]) / run1 * run0:
            inside = not inside
    sign = -1.0 if inside else 1.0
    if nearest > 1e-9 * math.sqrt(corner[0, 0] ** 2 + corner[0, 1] ** 2):
        out0, out1 = sign * (y[0] - at0) / nearest, sign * (y[1] - at1) / nearest
    y[0], y[1] = out0, out1
    return sign * nearest
