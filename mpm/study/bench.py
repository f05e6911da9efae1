"""`mpm bench` without a config: an elastic cube thrown at the floor of a unit box, the scene that other MPM codes are timed on.

Neo-Hookean, MLS gradient, APIC, quadratic splines, explicit; nodes stop two cells from the edge of the box; jittered lattice, `ppc` particles a cell, a
step of 0.2 h/c. One JSON line: milliseconds a step (smallest, median, largest block), million particle-steps a second, and `check`, the means of y, v_y,
v^2 and the spread of x after all steps, which agrees with another code's to 5 digits in float32 and 7 in float64 when it does the same work.

To compare with another code honestly: the same scene and options, both pinned to one core (`taskset -c 0`) of an idle machine; whole runs of the one and
of the other in turn, three rounds at least; ratios of medians, never a figure of today beside a figure of last week (the same binary drifts by 1.4
between minutes); compiling apart; and look at `check` first: a faster wrong answer is no answer.

`flops` is what a particle-step wants of multiplications and additions, counted by hand (mpm.study.limits), `peak_gflops` what the cores can multiply and
add at most in that precision, measured here, `fma_share` the one over the other at the median step.
"""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

E, NU, DENSITY, GRAVITY, SPEED = 1.0e5, 0.3, 1000.0, -9.81, -3.0
MU, LAM = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
EDGE = 2  # cells from the edge of the box to its walls


@dataclass(frozen=True)
class Options:
    """n cells of the unit box a direction; about `particles`, ppc a cell (0: 8 in 3-D, 4 in 2-D); order lattice or shuffle."""

    n: int = 64
    particles: int = 100_000
    ppc: int = 0
    dim: int = 3
    dtype: str = "f32"
    warm: int = 10
    steps: int = 10
    reps: int = 9
    order: str = "lattice"
    threads: int = 1


class BenchError(ValueError):
    """Options that do not make a scene."""


def lattice(options: Options) -> tuple[np.ndarray, float]:
    """Positions (N, D) in the unit box and the volume of a particle."""
    dim, n = options.dim, options.n
    ppc = options.ppc or (8 if dim == 3 else 4)
    per = round(ppc ** (1 / dim))
    cells = max(1, round((options.particles / ppc) ** (1 / dim)))
    if cells > n - 8:
        most = ppc * (n - 8) ** dim
        raise BenchError(f"--np {options.particles}: a cube of {cells} cells does not fit a box of {n}: at most {most} particles, or a larger --n")
    spacing = 1.0 / n / per
    axis = (np.arange(cells * per) + 0.5) * spacing
    x = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), -1).reshape(-1, dim)
    random = np.random.default_rng(0)
    x += random.uniform(-0.2, 0.2, x.shape) * spacing
    corner = np.full(dim, (n - cells) // 2 / n)
    corner[1] = 4.0 / n
    x += corner
    x = x[np.lexsort(np.floor(x * n + 0.5).T[::-1])]  # as a config's particles come: cell by cell (mpm.scene.contents.by_nodes)
    if options.order == "shuffle":
        x = x[random.permutation(len(x))]
    return x, spacing**dim


def cube(options: Options) -> Any:
    """The scene, ready to run, in coordinates from the walls."""
    from mpm.boundary import STOP
    from mpm.materials import NeoHookean, NoFlow
    from mpm.simulation import Scene
    from mpm.state import PAD, Body, Isothermal, NoExchange, NoExpansion, NoHeating, Particles, Plane, Volume
    from mpm.transfer import Apic, Mls

    x, volume = lattice(options)
    dim, h, real = options.dim, 1.0 / options.n, {"f32": np.float32, "f64": np.float64}[options.dtype]
    N, K = len(x), {2: 4, 3: 6}[dim]
    v = np.zeros((N, dim))
    v[:, 1] = SPEED
    arrays = (x - EDGE * h, v, np.zeros((N, dim, dim)), np.zeros((N, K)), np.ones(N), np.full(N, volume * DENSITY), np.full(N, volume))
    particles = Particles(*(np.ascontiguousarray(a, real) for a in arrays))
    body = Body(particles, Isothermal(300.0), NoExchange(), NeoHookean(MU, LAM), NoFlow(), NoExpansion(), NoHeating())
    nodes = options.n - 2 * EDGE + 1 + 2 * PAD
    space = Plane(h, nodes, nodes) if dim == 2 else Volume(h, nodes, nodes, nodes)
    gravity = np.zeros((1, dim))
    gravity[0, 1] = GRAVITY
    return Scene(space, Mls(), Apic(), ("cube",), (body,), np.full((3, 2), STOP), gravity, 1.0, 1.0, np.array([0.0, 1.0]), None, 1.0, None)


def bench(options: Options) -> dict:
    """Run and time; the fields of the JSON line."""
    from mpm.simulation import Clock, advance_block, work_arrays
    from mpm.study.limits import gflops, operations

    scene, h = cube(options), 1.0 / options.n
    scene.threads = options.threads
    clock, work = Clock(scene), work_arrays(scene)
    dt = 0.2 * h / np.sqrt((LAM + 2 * MU) / DENSITY)
    clock.lag = dt / 2  # the peers' first impulse acts for a whole step, and their velocities are those of the middle of the last one

    def run(steps: int) -> None:
        advance_block(scene, clock, work, dt, steps)

    began = time.perf_counter()
    run(1)
    first = time.perf_counter() - began
    if options.warm > 1:
        run(options.warm - 1)
    scene.order.restore()  # so that the timed blocks hold what sorting costs
    blocks = []
    for _ in range(options.reps):
        began = time.perf_counter()
        run(options.steps)
        blocks.append((time.perf_counter() - began) / options.steps)
    threads = options.threads if scene.order.shared else 1
    found = {"first_s": round(first, 3), "threads": threads} | figures_of(options, scene.bodies[0].particles, np.array(blocks), EDGE * h)
    flops, peak = operations(scene), gflops(scene.bodies[0].particles.x.dtype) * threads
    return found | {"flops": flops, "peak_gflops": round(peak, 1), "fma_share": round(flops * found["Mpps_med"] / 1e3 / peak, 3)}


def figures_of(options: Options, particles: Any, blocks: np.ndarray, shift: float) -> dict:
    """Times and the check of a finished run."""
    N, x, v = len(particles.m), particles.x.astype(float) + shift, particles.v.astype(float)
    state = sum(array.nbytes for array in particles)
    middle, least = float(np.median(blocks)), float(blocks.min())
    return {
        "N": N,
        "min_ms": round(least * 1e3, 4),
        "med_ms": round(middle * 1e3, 4),
        "max_ms": round(float(blocks.max()) * 1e3, 4),
        "total_ms": round(float(blocks.sum()) * options.steps * 1e3, 3),
        "Mpps_med": round(N / middle / 1e6, 3),
        "Mpps_max": round(N / least / 1e6, 3),
        "bytes_particle": state // N,
        "check": [float(f"{q:.7g}") for q in (x[:, 1].mean(), v[:, 1].mean(), (v**2).sum(1).mean(), x.std())],
        "nsteps": options.warm + options.reps * options.steps,
    }
