"""What of a scene changes over time beside its heat: gravity, friction, what walls hold, which pairs rub and conduct, loads that begin and end.

settings   numbers in arrays of the scene, as they are in the middle of a block of steps. They jump only where blocks end
gravity    a row a step, as it is when the impulse of the step acts: at the step's start (docs/physics.md 4)
jumps      the first impulse of a block acts from half a step before the block on (mpm.contact.insync). That share of it, `past`, is what held before a jump,
           and the rest is what holds after it, so momentum is exact
Error      order 2 in the step where gravity changes smoothly: v is exact under one that is linear in time, x lacks g' t dt^2/6. Friction that changes smoothly
           is that of a block's middle, order 2 in the block (at most 32 steps)
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpm.heat.programmes import at, before, bounds, during, turns


@dataclass
class Course:
    """Programmes (mpm.heat.programmes) of what changes."""

    settings: tuple[tuple[np.ndarray, tuple, Any], ...] = ()  # (array, index, programme)
    gravity: tuple = ()  # a programme a direction [m/s2]; nothing where it stays
    pasts: tuple[np.ndarray, ...] = ()  # `past` of loads and forces that jump
    times: tuple[float, ...] = ()  # at which those do [s]
    block: tuple = field(default=(), init=False)  # motion as a block began, gravity at its steps' ends, dt

    @property
    def turns(self) -> tuple[float, ...]:
        """Times at which something jumps [s]."""
        found = {when for *_, one in self.settings for when in turns(one)} | {when for one in self.gravity for when in turns(one)}
        return tuple(sorted(found | {*self.times}))

    @property
    def heaviest(self) -> float:
        """No gravity of the run is larger [m/s2]."""
        return float(np.linalg.norm([max(map(abs, bounds(one))) for one in self.gravity]))

    def set(self, start: float, span: float, holds=during) -> None:
        """Settings in the middle of `span` from `start` on. holds: during, or before: as they are up to `start`."""
        for array, index, one in self.settings:
            array[index] = at(holds(one, start), start + 0.5 * span)

    def lay(self, scene, start: float, dt: float, steps: int, past: float) -> None:
        """All for a block of steps; `past` of its first impulse acts before it. 1: all of it, and nothing is as after `start`."""
        self.set(start, dt * steps, before if past == 1.0 else during)
        for array in self.pasts:
            array[0] = past
        if self.gravity:
            rows = np.array([[at(during(one, start), start + k * dt) for one in self.gravity] for k in range(steps + 1)])
            first = past * np.array([at(before(one, start), start) for one in self.gravity]) + (1.0 - past) * rows[0]
            self.block, scene.gravity = (motion(scene), rows, dt), np.concatenate([first[None], rows[1:]])

    def work(self, scene) -> float:
        """Of gravity in the block that is over [J]: sum over steps of its mean at both ends times momentum and dt. 0 where gravity stays: that is a potential;
        0 of a block of no steps, which compiles only.

        Momentum in the middle of each step is what gravity made of that at the beginning, and what other forces gave is spread evenly; its sum is how far
        masses went. Without this what lies still while gravity grows would seem to rise.
        """
        if not self.gravity or len(self.block[1]) == 1:
            return 0.0
        (p, mass, place), rows, dt = self.block
        momentum, _, there = motion(scene)
        half = 0.5 * mass * dt if scene.references else 0.0  # velocities of the total frame are those of the ends of steps
        fallen = p - half * rows[0] + mass * dt * np.cumsum(rows[:-1], axis=0)
        rest = momentum - half * rows[-1] - fallen[-1]
        moves = fallen + np.arange(1, len(rows))[:, None] / (len(rows) - 1) * rest
        moves += (there - place) / (dt * len(moves)) - moves.mean(axis=0)
        return float(0.5 * dt * np.sum((rows[1:] + rows[:-1]) * moves))


def strongest(scene) -> np.ndarray:
    """Gravity of the largest size that it ever has, direction by direction (D,) [m/s2]."""
    if scene.course is None or not scene.course.gravity:
        return scene.gravity[0]
    return np.array([max(bounds(one), key=abs) for one in scene.course.gravity])


def motion(scene) -> tuple[np.ndarray, float, np.ndarray]:
    """(D,) momentum [kg m/s], the mass that moves [kg], and its mass times place (D,) [kg m]."""
    D, held = scene.gravity.shape[1], scene.meeting.held if scene.meeting is not None and scene.meeting.stands else [False] * len(scene.bodies)
    if scene.references:
        parts = [(one.m[one.active].astype(float), one.v[one.active, :D], one.u[one.active, :D]) for one in scene.references]
    else:
        free = (body.particles for body, still in zip(scene.bodies, held, strict=True) if not still)
        parts = [(some.m.astype(float), some.v, some.x) for some in free]
    return sum(m @ v.astype(float) for m, v, _ in parts), float(sum(m.sum() for m, *_ in parts)), sum(m @ x.astype(float) for m, _, x in parts)
