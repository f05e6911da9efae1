"""Cut runs anywhere, go on, and compare every bit."""

import numpy as np

from mpm.records.checkpoint import pack, unpack
from mpm.runner import run_point


class Cuts:
    """A keeper that saves at the chosen questions (all counted in `asked`), through the bytes of a checkpoint."""

    def __init__(self, at=(), found=None):
        self.at, self.found, self.asked, self.kept = set(at), found, 0, {}

    def due(self, stop):
        self.asked += 1
        return self.asked in self.at

    def save(self, memory):
        self.kept[self.asked] = pack(memory, {})


def different(one, two):
    """Names of what differs between two Runs in any bit; wall time is not of the result."""
    told = [name for name in ("outcome", "steps") if getattr(one, name) != getattr(two, name)]
    told += [name for name in ("times", "snapshot_times") if not same(getattr(one, name), getattr(two, name))]
    for part in ("series", "finals", "axes", "grid"):
        a, b = getattr(one, part), getattr(two, part)
        told += [f"{part}.{name}" for name in {**a, **b} if name not in a or name not in b or not same(a[name], b[name])]
    if len(one.particles) != len(two.particles):
        return [*told, "particles"]
    for k, (a, b) in enumerate(zip(one.particles, two.particles, strict=True)):
        told += [f"particles.{k}.{name}" for name in {**a, **b} if name not in a or name not in b or not same(a[name], b[name])]
    return told


def same(a, b):
    a, b = np.asarray(a), np.asarray(b)
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def cut(experiment, count, rng):
    """Run once whole, once with `count` cuts, and go on from each: (cuts made, those that differ with the names of what does)."""
    counter = Cuts()
    whole = run_point(experiment, keeper=counter)
    at = sorted(rng.choice(np.arange(1, counter.asked + 1), min(count, counter.asked), replace=False).tolist()) if counter.asked else []
    cuts = Cuts(at)
    wrong = [("saving", names)] if (names := different(whole, run_point(experiment, keeper=cuts))) else []
    for place, data in cuts.kept.items():
        names = different(whole, run_point(experiment, keeper=Cuts(found=unpack(data)[0])))
        wrong += [(f"{place} of {counter.asked}", names)] if names else []
    return len(cuts.kept), wrong
