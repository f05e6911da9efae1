"""How far the machine's own limits are: what one core multiplies and adds at most, what memory gives it, and how much of both a particle-step needs.

Both limits are measured, in the precision of the scene: GFLOP/s of independent multiply-adds in the widest lanes, GB/s of a triad too large for the caches.
Operations are counted by hand, a multiplication and an addition one each, of the transfers in their direct form, node by node, as a plain MPM loop has
them (n^D nodes a particle, n nodes of the basis a direction):

    weight w               D - 1                            (and the weights of each direction: 10 D a particle)
    gather   sum w u       2 D        sum (w u) d   2 D^2        with the B-spline gradient   sum u grad(w)   2 D^2 + D (D - 1)
    scatter  w m           2          w (a + A d)   2 D^2 + 2 D       and                     G grad(w)       2 D^2
    where a scheme wants the change of velocity (FLIP, XPIC)   the momentum and the impulses apart: one gather of a value and one scatter more

and of what every moving body does at least (LAW; in 3-D): B <- (1 + A) B (1 + A)^T 75, J 14, a neo-Hookean stress 9, impulse and slope 27, x <- x + dt v 6.
For the cube of mpm.study.bench that is 1 565 in 3-D, 312 in 2-D. What laws cost beyond (logarithms, return maps, heat) is not counted, nor is what the
separable form of mpm.transfer saves: the share is work wanted over time taken, not how busy the units are.
"""

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from mpm.jit import kernel
from mpm.lanes import fma, join, load8, most, splat8
from mpm.transfer import Bspline
from mpm.transfer.roles import wants_change

ROUNDS, LEAST = 5, 0.05  # timings of a thing, and seconds that one lasts at least
LAW = {1: 14, 2: 49, 3: 131}
NODES = {"Linear": 2, "Quadratic": 3, "Cubic": 4}


@kernel
def multiply_add(one, times):
    """320 flops a turn in ten independent chains of sixteen lanes: what the multiply-add units can do in the precision of `one` (8,)."""
    halves = splat8(one.dtype.type(0.5))
    a, half = join(load8(one, 0), load8(one, 0)), join(halves, halves)
    b, c, d, e, f, g, h, i, j = a, a, a, a, a, a, a, a, a
    for _ in range(times):
        a, b, c, d, e = fma(a, half, half), fma(b, half, half), fma(c, half, half), fma(d, half, half), fma(e, half, half)
        f, g, h, i, j = fma(f, half, half), fma(g, half, half), fma(h, half, half), fma(i, half, half), fma(j, half, half)
    return most(a + b + c + d + e + f + g + h + i + j)


@kernel
def triad(a, b, c):
    """24 bytes a number."""
    for i in range(a.shape[0]):
        a[i] = b[i] + 0.5 * c[i]


def seconds(call: Callable[[], object]) -> float:
    """Median time of a call, repeated until it lasts LEAST; the first call is a warm-up."""
    call()
    began = time.perf_counter()
    call()
    repeats = max(1, round(LEAST / max(time.perf_counter() - began, 1e-9)))
    found = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        for _ in range(repeats):
            call()
        found.append((time.perf_counter() - began) / repeats)
    return statistics.median(found)


def gflops(dtype: Any = np.float64) -> float:
    """GFLOP/s of multiply-adds of one core."""
    one = np.ones(8, dtype)
    return 320 * 50_000 / seconds(lambda: multiply_add(one, 50_000)) / 1e9


def peaks(dtype: Any = np.float64) -> dict[str, float]:
    """GFLOP/s of multiply-adds and GB/s of a triad too large for the caches, of one core."""
    arrays = np.ones((3, 8_000_000))
    return {"gflops": gflops(dtype), "gbytes": 24 * arrays.shape[1] / seconds(lambda: triad(*arrays)) / 1e9}


def operations(scene: Any) -> int:
    """Operations of a particle and mechanical step of a scene that moves, as counted above."""
    D, slopes = scene.bodies[0].particles.x.shape[1], isinstance(scene.gradient, Bspline)
    nodes = NODES[type(scene.space.basis).__name__] ** D
    weight = D - 1 + (D * (D - 1) if slopes else 0)
    gather, scatter = 2 * D + 2 * D**2, 2 + 2 * D + 2 * D**2
    if slopes:
        gather, scatter = gather + 2 * D**2, scatter + 2 * D**2
    if wants_change(scene.scheme):
        gather, scatter = gather + 2 * D, scatter + 2 * D
    return nodes * (weight + gather + scatter) + 10 * D + LAW[D]
