"""Tools: rigid bodies that move as they are told, or as a force moves them along one direction. Each is a signed distance that is moved and turned.

    g = phi(R^T (x - c)),   n = R grad phi,   velocity of its surface v + W (x - c)
    free: M dw = (F - sum lambda . e) dt along e = F/|F|, with the contacts' impulses lambda on the bodies (solve.py), whose work is lambda . (v + w)/2

Fails when   a piece of a body is larger than the tool: its corners enter between pieces (refused at the start: thinner than a cell)
"""

from typing import Any, NamedTuple

import numpy as np
from numba import literal_unroll

from mpm.boundary import directions
from mpm.contact.distance import signed
from mpm.contact.found import BODY, around, faces, others, put
from mpm.jit import kernel, role
from mpm.state import NoExchange, Surface


class NoTools(NamedTuple):
    """No tools."""


class Tools(NamedTuple):
    """T tools of B bodies' scene; what moves is of the present step."""

    kind: np.ndarray  # (T,)
    size: np.ndarray  # (T, 3) half edges; a ball's radius; a cylinder's radius and half height [m]
    corner: np.ndarray  # (T, V, 2) of a polygon about its centre, counter-clockwise [m]
    corners: np.ndarray  # (T,) how many
    mesh: Any  # mpm.contact.triangles.Triangles about their centres, or NoTriangles
    bound: np.ndarray  # (T,) radius about the centre that holds all of it [m]
    mu: np.ndarray  # (T,)
    there: np.ndarray  # (T,) whether it is there
    centre: np.ndarray  # (T, D) [m]
    turn: np.ndarray  # (T, D, D)
    v: np.ndarray  # (T, D) of the centre [m/s]
    before: np.ndarray  # (T, D) the same, a step earlier [m/s]
    spin: np.ndarray  # (T, D, D) W [1/s]
    force: np.ndarray  # (T, D) on a free one [N]
    light: np.ndarray  # (T,) 1/M of a free one, else 0 [1/kg]
    way: np.ndarray  # (T, D) e of a free one, else 0
    shift: np.ndarray  # (T, D) how far forces have moved a free one [m]
    path: np.ndarray  # (steps + 1, T, D) of the centre over a block
    turns: np.ndarray  # (steps + 1, T, D, D)
    present: np.ndarray  # (steps, T)


@others.register(NoTools)
def others_no_tools(which):
    return False


@others.register(Tools)
def others_tools(which):
    return True


@role
def place_tools(tools, step, dt, acts):
    """Where tools stand at the start of a step of dt, and how fast they go; `acts`: how long forces act [s]."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@place_tools.register(NoTools)
def place_tools_no_tools(tools, step, dt, acts):
    return None


@place_tools.register(Tools)
def place_tools_tools(tools, step, dt, acts):
    for t in range(len(tools.kind)):
        tools.there[t] = tools.present[step, t]
        for a in range(tools.v.shape[1]):
            tools.centre[t, a] = tools.path[step, t, a] + tools.shift[t, a]
            tools.before[t, a] = tools.v[t, a]
            for c in range(tools.v.shape[1]):
                tools.turn[t, a, c] = tools.turns[step, t, a, c]
            if tools.light[t] > 0.0:
                tools.v[t, a] += acts * tools.light[t] * tools.force[t, a]
            else:
                tools.v[t, a] = (tools.path[step + 1, t, a] - tools.path[step, t, a]) / dt


@role
def move_tools(tools, dt):
    """Free tools move with the velocity that the contacts left them."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@move_tools.register(NoTools)
def move_tools_no_tools(tools, dt):
    return None


@move_tools.register(Tools)
def move_tools_tools(tools, dt):
    for t in range(len(tools.kind)):
        if tools.light[t] > 0.0:
            for a in range(tools.v.shape[1]):
                tools.shift[t, a] += dt * tools.v[t, a]


@role(inline=True)
def lightness(tools, t):
    """1/M of tool t; 0 of one that goes as it is told, and of none."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@lightness.register(NoTools)
def lightness_no_tools(tools, t):
    return 0.0


@lightness.register(Tools)
def lightness_tools(tools, t):
    return tools.light[t] if t >= 0 else 0.0


@role(inline=True)
def carry(tools, t, u):
    """u (D,) less the velocity of a free tool."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@carry.register(NoTools)
def carry_no_tools(tools, t, u):
    return None


@carry.register(Tools)
def carry_tools(tools, t, u):
    if t >= 0:
        for a in range(len(u)):
            u[a] -= tools.v[t, a]


@role(inline=True)
def follow(tools, t, u):
    """u (D,) plus the velocity of a free tool while impulses act: the mean of what it was and is, so that their work is what the tool loses."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@follow.register(NoTools)
def follow_no_tools(tools, t, u):
    return None


@follow.register(Tools)
def follow_tools(tools, t, u):
    if t >= 0:
        for a in range(len(u)):
            u[a] += 0.5 * (tools.before[t, a] + tools.v[t, a])


@role(inline=True)
def recoil(tools, t, change):
    """The velocity of a free tool after an impulse `change` (D,) on a body."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@recoil.register(NoTools)
def recoil_no_tools(tools, t, change):
    return None


@recoil.register(Tools)
def recoil_tools(tools, t, change):
    if t >= 0:
        along = 0.0
        for a in range(len(change)):
            along += change[a] * tools.way[t, a]
        for a in range(len(change)):
            tools.v[t, a] -= along * tools.light[t] * tools.way[t, a]


@role
def arm(tools, t, x, out):
    """out (3,): from the centre of tool t to x (D,); from the origin of coordinates for t = -1."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@arm.register(NoTools)
def arm_no_tools(tools, t, x, out):
    for a in range(len(x)):
        out[a] = x[a]


@arm.register(Tools)
def arm_tools(tools, t, x, out):
    for a in range(len(x)):
        out[a] = x[a] - (tools.centre[t, a] if t >= 0 else 0.0)


@role
def find_tools(tools, space, bodies, skin, found, count, within):
    """Pieces, and particles without one, before tools, from number `count` on; how many then."""
    raise TypeError(f"no tools of {type(tools).__name__}")


@find_tools.register(NoTools)
def find_tools_no_tools(tools, space, bodies, skin, found, count, within):
    return count


@find_tools.register(Tools)
def find_tools_tools(tools, space, bodies, skin, found, count, within):
    D, first = directions(space), BODY + len(skin.first) - 1
    x, y, n = np.empty(D), np.empty(D), np.empty(D)
    for t in range(len(tools.kind)):
        if not tools.there[t]:
            continue
        for s in range(len(skin.area)):
            for a in range(D):
                x[a] = skin.x[s, a]
            if skin.area[s] == 0.0 or far(tools, t, x, within * space.h):
                continue
            gap = signed(tools, t, x, y, n)
            if gap >= within * space.h:
                continue
            if count < len(found.gap):
                put(found, count, s, first + t, gap, tools.mu[t], (skin.body[s], skin.owner[s]), (skin.home[s], x), faces(space, skin, s, n, 1.0))
                meets_tool(tools, t, found, count, x, n)
            count += 1
        count = find_lone_before_tool(space, bodies, tools, t, first + t, found, count)
    return count


@kernel
def find_lone_before_tool(space, bodies, tools, t, against, found, count):
    """`lone_before_tool` of every body; of its own, as in the loop over tools the types of a scene in one direction were not found."""
    b = 0
    for body in literal_unroll(bodies):
        count = lone_before_tool(body.surface, space, body, b, tools, t, against, found, count)
        b += 1
    return count


@kernel
def meets_tool(tools, t, found, i, x, n):
    """Normal and velocity of tool t for contact i at x."""
    for a in range(len(x)):
        found.normal[i, a] = n[a]
        found.given[i, a] = 0.0 if tools.light[t] > 0.0 else tools.v[t, a]
        for c in range(len(x)):
            found.given[i, a] += tools.spin[t, a, c] * (x[c] - tools.centre[t, c])
    found.free[i] = t if tools.light[t] > 0.0 else -1


@role
def lone_before_tool(surface, space, body, b, tools, t, against, found, count):
    """Particles without pieces before tool t."""
    raise TypeError(f"no pieces of {type(surface).__name__}")


@lone_before_tool.register(NoExchange)
def lone_before_tool_no_exchange(surface, space, body, b, tools, t, against, found, count):
    return count


@lone_before_tool.register(Surface)
def lone_before_tool_surface(surface, space, body, b, tools, t, against, found, count):
    D = directions(space)
    x, y, n = np.empty(D), np.empty(D), np.empty(D)
    for p in range(body.particles.x.shape[0]):
        if surface.row[p] >= 0:
            continue
        for a in range(D):
            x[a] = body.particles.x[p, a]
        if far(tools, t, x, 0.5 * space.h):
            continue
        gap = signed(tools, t, x, y, n) - 0.5 * (body.particles.V0[p] * body.particles.J[p] / around(space, x[0])) ** (1.0 / D)
        if gap >= 0.1 * space.h:
            continue
        if count < len(found.gap):
            put(found, count, -1, against, gap, tools.mu[t], (b, p), (x, x), 0)
            meets_tool(tools, t, found, count, x, n)
        count += 1
    return count


@kernel
def far(tools, t, x, within):
    """Whether x is farther than `within` from a ball about the tool."""
    square = 0.0
    for a in range(len(x)):
        square += (x[a] - tools.centre[t, a]) ** 2
    return square > (tools.bound[t] + within) ** 2
