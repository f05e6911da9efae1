"""How tools move as they are told: a path of the centre, a steady turning, a force for a while, and when they are there.

A tool that a force moves stands before its motion begins, and where it is once that ends. Where nothing is near it flies as the steps of contact would let it
(tools.py), at the end of a block.
"""

from dataclasses import dataclass, field

import numpy as np

from mpm.contact.tools import Tools


@dataclass(frozen=True)
class Told:
    """One tool. Between the times of `path` it moves in straight lines, and stands before the first and after the last."""

    name: str
    times: np.ndarray  # (K,) [s]
    path: np.ndarray  # (K, D) of its centre [m]
    spin: np.ndarray  # (D, D) W [1/s]
    turning: tuple[float, float]  # from, until [s]
    there: tuple[float, float]
    light: float = 0.0  # 1/M of one that a force moves, else 0 [1/kg]


@dataclass
class Drive:
    """The tools of a scene and what they are told."""

    told: tuple[Told, ...]
    tools: Tools
    begun: bool = field(default=False, init=False)

    def lay(self, start: float, dt: float, steps: int, behind: float = 0.0) -> None:
        """Write path, turns and presence of a block of steps; `behind`: how far velocities lie back (mpm.contact.insync)."""
        when = start + dt * np.arange(steps + 1)
        for t, one in enumerate(self.told):
            for a in range(one.path.shape[1]):
                self.tools.path[: steps + 1, t, a] = np.interp(when, one.times, one.path[:, a])
            self.tools.turns[: steps + 1, t] = turned(one.spin, np.clip(when, *one.turning) - one.turning[0])
            middle = when[:-1] + 0.5 * dt
            self.tools.present[:steps, t] = (middle >= one.there[0]) & (middle < one.there[1])
            now = one.turning[0] <= when[0] + 0.5 * dt < one.turning[1]
            self.tools.spin[t] = one.spin if now else 0.0
            self.release(t, start + 0.5 * dt, behind)

    def release(self, t: int, when: float, behind: float) -> bool:
        """Whether a force moves tool t then: free, or else at rest. Of the first force after that, the share `behind` does not act."""
        one, was = self.told[t], self.tools.light[t]
        free = one.light > 0.0 and max(one.turning[0], one.there[0]) <= when < min(one.turning[1], one.there[1])
        self.tools.light[t] = one.light if free else 0.0
        if not (free and was):
            self.tools.v[t] = -behind * self.tools.light[t] * self.tools.force[t]
        return free

    def drift(self, start: float, dt: float, kick: float, steps: int) -> None:
        """Free tools after a block of steps in which nothing was near; the first force acts for `kick`."""
        for t in range(len(self.told)) if steps > 0 else ():
            if self.release(t, start + 0.5 * dt, kick - 0.5 * dt):
                pull = self.tools.light[t] * self.tools.force[t]
                self.tools.shift[t] += dt * (steps * self.tools.v[t] + (steps * kick + 0.5 * dt * steps * (steps - 1)) * pull)
                self.tools.v[t] += (kick + (steps - 1) * dt) * pull

    def pace(self, start: float, span: float, pushed: float) -> float:
        """The fastest that any place on a tool may go from `start` on for `span`, forces acting for `pushed` [m/s]."""
        return max(self.fastest(t, start, span, pushed) for t in range(len(self.told)))

    def fastest(self, t: int, start: float, span: float, pushed: float = 0.0) -> float:
        """Of tool t."""
        one, rate = self.told[t], float(np.linalg.norm(self.tools.v[t])) + pushed * float(np.linalg.norm(self.tools.force[t])) * self.told[t].light
        if len(one.times) > 1:
            speeds = np.linalg.norm(np.diff(one.path, axis=0), axis=1) / np.diff(one.times)
            rate = max([rate, *speeds[(one.times[1:] > start) & (one.times[:-1] < start + span)]])
        return rate + float(np.linalg.norm(one.spin)) * self.tools.bound[t]

    def displacement(self, t: int, now: float) -> np.ndarray:
        """How far tool t has moved since the start (D,) [m]."""
        one = self.told[t]
        return np.array([np.interp(now, one.times, x) - x[0] for x in one.path.T]) + self.tools.shift[t]

    def gap(self, t: int, start: float, low, high) -> float:
        """Between a box and a ball about tool t, as it stands; infinite where it is gone for good [m]."""
        one, tools = self.told[t], self.tools
        if start >= one.there[1]:
            return np.inf
        centre = np.array([np.interp(start, one.times, x) for x in one.path.T]) + tools.shift[t]
        return float(np.linalg.norm(np.maximum(0.0, np.maximum(low - centre, centre - high)))) - float(tools.bound[t])


def turned(spin: np.ndarray, time) -> np.ndarray:
    """exp(W t) (..., D, D) for times (...,)."""
    D, rate = len(spin), float(np.linalg.norm(spin)) / np.sqrt(2.0)
    way, angle = spin / max(rate, 1e-300), rate * np.asarray(time, float)[..., None, None]
    return np.eye(D) + np.sin(angle) * way + (1.0 - np.cos(angle)) * (way @ way)
