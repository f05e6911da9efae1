"""What each part of contact takes: `python -m mpm.benchmarks.contact_parts [f32]`, one JSON line.

Of the cubes of speed_models `lying`, at rest and sliding, in percent of the step with a mirror: processor time, medians of rounds in turn with that step, so
that a busy machine does little harm. Each part is done over and over by itself, and what one leaves in the cache helps the next; so the impulses, which are
what is left of the whole, hold what the others wait for memory within a step. Sums: one making, and in how many steps they are made.
"""

import json
import statistics
import sys
import time

from mpm.benchmarks.speed_models import ROUNDS, on_floor
from mpm.contact.solve import pose
from mpm.contact.step import Pace, keep_books, seek
from mpm.contact.sums import add_up, make_room
from mpm.contact.weights import weigh
from mpm.jit import kernel

TIMES = 10


@kernel
def seeks(space, bodies, touching, skin, sums, times):
    """Where the pieces are, and what is near, so many times over; how many contacts."""
    count = 0
    for _ in range(times):
        _, count = seek(space, bodies, touching, skin, sums, 1e-9 * space.h)
    return count


@kernel
def adds(space, gradient, bodies, touching, skin, sums, times):
    """Sums anew."""
    contacts, count = seek(space, bodies, touching, skin, sums, 1e-9 * space.h)
    for _ in range(times):
        sums = make_room(space, touching.walls, touching.fields, sums, contacts, count, touching.number)
        add_up(space, gradient, bodies, touching.walls, touching.fields, skin, sums, touching.number)


@kernel
def poses(space, bodies, touching, skin, sums, nodes, times):
    """The nodes of all contacts."""
    contacts, count = seek(space, bodies, touching, skin, sums, 1e-9 * space.h)
    for _ in range(times):
        pose(space, touching.walls, touching.fields, contacts, count, nodes, touching.tools, touching.number)


@kernel
def weighs(space, gradient, bodies, touching, skin, sums, nodes, pace, times, books):
    """Their weights, or where `books` what is written down of them."""
    contacts, count = seek(space, bodies, touching, skin, sums, 1e-9 * space.h)
    problem = pose(space, touching.walls, touching.fields, contacts, count, nodes, touching.tools, touching.number)
    for _ in range(times):
        if books:
            keep_books(space, touching, skin, problem, pace)
        else:
            weigh(space, gradient, touching.walls, touching.fields, skin, sums, problem, touching.number)


def parts(dtype: str = "f64") -> dict:
    """Of both cubes."""
    made = on_floor(dtype)
    return {name: split(made[f"{name}_ns"], made["mirror_ns"]) for name in ("contact", "sliding")}


def split(bench, mirror) -> dict:
    """Of one."""
    step, block = shares({"step": bench.steps}, mirror)["step"] / bench.block, bench.block
    scene, met, bench.block, anew = bench.scene, bench.scene.meeting, 1, 0
    moved = met.sums.moved[0]
    for _ in range(10 * block):
        bench.steps()
        anew, moved = anew + (met.sums.moved[0] < moved), met.sums.moved[0]
    nodes, pace = bench.work.buffers.nodes[None, 0].copy(), Pace(bench.dt, bench.dt, bench.dt, 1, 0, 1.0)
    nodes[..., 3] = 1.0  # any mass: a step leaves none
    where, gradient = (scene.for_motion, met.touching, met.skin, met.sums), scene.gradient
    each = shares({
        "near": lambda n: seeks(scene.space, *where, n), "sums": lambda n: adds(scene.space, gradient, *where, n),
        "nodes": lambda n: poses(scene.space, *where, nodes, n), "weights": lambda n: weighs(scene.space, gradient, *where, nodes, pace, n, False),
        "books": lambda n: weighs(scene.space, gradient, *where, nodes, pace, n, True),
    }, mirror)  # fmt: skip
    share = anew / (10 * block)
    left = step - 100 - sum(each.values()) + (1 - share) * each["sums"]
    return {"contacts": int(seeks(scene.space, *where, 1)), "step": step, "sums_made": share} | each | {"impulses": left}


def shares(calls: dict, mirror) -> dict:
    """Percent of a step of `mirror` that each call takes; of those that take a number, what once more takes."""
    found: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(4 * ROUNDS):
        whole = spent(mirror.steps) / mirror.block
        for name, call in calls.items():
            took = spent(call) if name == "step" else (spent(lambda call=call: call(1 + TIMES)) - spent(lambda call=call: call(1))) / TIMES
            found[name].append(100 * took / whole)
    return {name: statistics.median(one) for name, one in found.items()}


def spent(call) -> float:
    """Processor seconds of a call."""
    began = time.thread_time()
    call()
    return time.thread_time() - began


if __name__ == "__main__":
    print(json.dumps(parts(*sys.argv[1:])))
