"""Guards of a run of moving bodies (docs/physics.md 15), beside those that sit in the step itself (integrate/particle_update.py, integrate/explicit.py).

opening   every block of steps looks at what it reads: every field finite, every particle on the grid (integrate/state_check.py); `whole` says what was wrong
block     before it, temperatures: above absolute zero and, where nothing heats, within their data by more than the transfer is known to overshoot (SLOPES,
          NOISE) with `method.bounds: free`, and at all without; a warning from NOTICEABLE on: FLIP's noise beside a cold surface reaches 0.29, APIC's
          slopes 0.05
frame     every output time: `whole`; no energy that nothing gives (GROWTH of the largest so far, NOISY with affine FLIP); bodies in the pieces that they began
          with (integrate/fragments.py); in the total frame no body beyond a wall on which it did not lie. Where `method.frame: auto` chose that frame,
          none within AWAY of such a wall, and none strained by more than MODERATE
explain   after a failure: which field of which particle was first, and what to do: the step against the limits that held
Cost      0.7 % of a run of 10 000 particles in 2-D whose heat steps cut blocks to 13 steps, with a frame every hundred (pytest -m slow tests/test_guards.py):
          the opening 12 us a block, temperatures 20 us, an output time 210 us
Fails when: a scene heats itself (then only absolute zero bounds temperatures); it has thermal stress, loads or sources (then energy may grow, and is not
judged); a crack does not reach through the body (then it is in one piece)
"""

import math
from dataclasses import replace

import numpy as np

from mpm.boundary import extents
from mpm.diagnostics import strains
from mpm.integrate.fragments import STRETCH, torn
from mpm.integrate.nozzle import Nozzle
from mpm.integrate.state_check import span, unsound
from mpm.integrate.surroundings import Surroundings
from mpm.integrate.traction import GROWS, ROUGH
from mpm.materials import Hencky
from mpm.outcome import COMPLETED, ENERGY_GROWTH, FRACTURED, MAX_PRINCIPLE, OUTGROWN, Outcome, outcome
from mpm.sources import acting
from mpm.state import PAD, Isothermal, Load, NoExchange, NoExpansion, NoHeating, NoSource, Radiation, Thermal
from mpm.transfer import Flip
from mpm.warned import warning

SLOPES, NOISE, NOTICEABLE, ROUNDING = 0.15, 0.5, 0.005, 1e-6  # of the range of the data; SLOPES: APIC and PIC, NOISE: increments kept
MODERATE, AWAY, FLUSH = math.log(2.0), 1.0, 1e-9  # Hencky strain, elastic and plastic together; cells; of the domain
GROWTH, NOISY = 0.05, 0.5  # of the largest energy so far; NOISY: affine FLIP keeps noise in velocities, and adds its slopes to it
GROWN = 0.05  # of a traction by present area
ROUNDED = 1e4  # round-offs: a strain below this is none, and its energy neither


def grown(load) -> float:
    """What the change of area and direction adds to tractions by present area, of their size."""
    area = load.area
    return float(np.abs(load.force - area.still).sum() / np.abs(area.press + area.pull).sum())


class Guards:
    """What one run may not do."""

    def __init__(self, scene):
        over = ROUNDING if scene.repair else SLOPES if scene.blend == 1.0 and not scene.sharp else NOISE
        self.data = [Data(body, around, over) for body, around in zip(scene.wholes, scene.surroundings, strict=True)]
        self.judged = (
            all(isinstance(body.source, NoSource) and isinstance(body.expansion, NoExpansion) and isinstance(body.elastic, Hencky) for body in scene.bodies)
            and not any(len(reference.load) for reference in scene.references)
            and (scene.meeting is None or scene.meeting.drive is None)
            and scene.course is None
        )
        self.growth = NOISY if isinstance(scene.scheme, Flip) and scene.scheme.affine else GROWTH
        self.least = sum(rounded(body) for body in scene.bodies) if self.judged else 0.0
        self.begun = math.nan
        self.most = 0.0
        self.pieces: list[list[int]] | None = None  # of each body at the start (integrate/fragments.py)
        self.warned: list[str] = []
        self.heats = scene.inflow is not None or any(one.heats for one in self.data)  # whether temperatures change between heat steps too
        self.looked = -1  # heat steps of the run when temperatures were found good

    def memory(self) -> dict:
        """What was seen so far (mpm.memory)."""
        return {name: value for name, value in vars(self).items() if name != "data"} | {"data": [vars(one) for one in self.data]}

    def recall(self, found: dict) -> None:
        """As it was when `memory` was kept."""
        for one, seen in zip(self.data, found.pop("data"), strict=True):
            vars(one).update(seen)
        vars(self).update(found)

    def follow(self, scene) -> "Guards":
        """Those of another scene of the same particles, with what was seen so far."""
        after = Guards(scene)
        after.begun, after.most, after.warned = self.begun, self.most, self.warned
        for one, seen in zip(after.data, self.data, strict=True):
            vars(one).update({name: value for name, value in vars(seen).items() if name not in ("allowed", "lasting")})
        return after

    def share(self, scene) -> None:
        """Bodies that pass heat to each other have one range of data: what one of them meets by now, another may feel."""
        if scene.meeting is None or not scene.meeting.warms:
            return
        for body, data in zip(scene.bodies, self.data, strict=True):
            if isinstance(body.thermal, Thermal) and not data.heats:
                data.meet(body)
        for b, c in np.argwhere(scene.meeting.passing):
            one, other = self.data[b], self.data[c]
            one.low, one.high = min(one.low, other.low), max(one.high, other.high)
            one.heats, one.cools, one.warms = one.heats or other.heats, one.cools or other.cools, one.warms or other.warms

    def block(self, scene, clock) -> Outcome:
        """Before a block of steps: temperatures. All else is looked at as the block opens (integrate/state_check.py)."""
        if clock.heat_steps == self.looked and not self.heats:
            return outcome(COMPLETED)
        self.share(scene)
        if all(data.judge(body) is None for body, data in zip(scene.bodies, self.data, strict=True) if isinstance(body.thermal, Thermal)):
            self.looked = clock.heat_steps
            return outcome(COMPLETED)
        return self.whole(scene, clock)

    def whole(self, scene, clock) -> Outcome:
        """Before a record, and where something is wrong."""
        self.share(scene)
        for b, (name, body, data) in enumerate(zip(scene.names, scene.bodies, self.data, strict=True)):
            wrong = unsound(scene.space, body) or (data.judge(body) if isinstance(body.thermal, Thermal) else None)
            if wrong is not None:
                code, particle, said = wrong
                return outcome(code, scene.order.name(b, particle), clock.time * scene.scale, clock.steps, f"({said}, {name})")
        return outcome(COMPLETED)

    def frame(self, scene, clock, series) -> Outcome:
        """At an output time, with the series up to it."""
        for name, data in zip(scene.names, self.data, strict=True):
            if data.over > NOTICEABLE:
                self.warn(name, "temperature", f"temperatures leave the bounds of their data by up to {100 * data.over:.0f} % of the range")
        self.tractions(scene)
        now = {name: series[name][-1] for name in ("energy_kinetic", "energy_elastic", "energy_total")}
        self.most = max(self.most, now["energy_kinetic"] + now["energy_elastic"])
        if math.isnan(self.begun):
            self.begun = now["energy_total"]
        gained = now["energy_total"] - self.begun
        gained -= 2 * scene.meeting.parted if scene.meeting is not None else 0.0  # velocities of now may hold one push more than is counted
        if self.judged and gained > self.growth * self.most and gained > 1e-12 * abs(self.begun) + self.least:
            said = f"(more than at the start by {100 * gained / self.most:.0f} % of the largest)"
            return outcome(ENERGY_GROWTH, time=clock.time * scene.scale, step=clock.steps, detail=said)
        if scene.references:
            said = outgrown(scene, series)
            return outcome(OUTGROWN, time=clock.time * scene.scale, step=clock.steps, detail=f"({said})") if said else outcome(COMPLETED)
        return self.gaps(scene, clock)

    def tractions(self, scene) -> None:
        """Tractions that particles do not bear by the quadrature of their stress (mpm.scene.faded)."""
        for name, body in zip(scene.names, scene.bodies, strict=True):
            loads = [one for one in acting(body.source) if isinstance(one, Load)]
            if any(one.left == ROUGH for one in loads):
                self.warn(name, "traction", "a face that is loaded is neither flat nor all of a round one, and stress beneath it is off by as much as the load")
            elif (more := max((grown(one) for one in loads if one.left == GROWS), default=0.0)) > GROWN:
                self.warn(name, "traction", f"the load on a face grew or turned by {100 * more:.0f} % of itself, and stress beneath it is off by as much")

    def gaps(self, scene, clock) -> Outcome:
        """A body in more pieces than it began with: spacing over h. Over 2 h no force is left."""
        begun, h = self.pieces is None, scene.space.h
        found = [list(torn(body.particles.x, h, STRETCH if begun else 1.0)) for body in scene.bodies]
        self.pieces = found if begun else self.pieces
        for name, (one, two), (was, wide) in zip(scene.names, found, self.pieces, strict=True):
            if scene.tears and two > wide:
                return outcome(FRACTURED, time=clock.time * scene.scale, step=clock.steps, detail=f"of {name}")
            if one > was:
                self.warn(name, "torn", f"particles are more than a cell apart from t = {clock.time * scene.scale:.4g} s on, and beyond two they pull no more")
        return outcome(COMPLETED)

    def warn(self, name: str, kind: str, said: str) -> None:
        """Say a thing once a body; of a thing that grows, the latest."""
        begins = f"{kind}: {name}: "
        if kind == "torn" and any(text.startswith(begins) for text in self.warned):
            return
        self.warned = [text for text in self.warned if not text.startswith(begins)] + [warning(kind, f"{name}: {said}")]


def rounded(body) -> float:
    """Elastic energy of a body at a strain of ROUNDED round-offs [J]: a scene at rest has no other."""
    strain = ROUNDED * float(np.finfo(body.particles.V0.dtype).eps)
    return 0.5 * (body.elastic.lam + 2.0 * body.elastic.mu) * strain**2 * float(np.sum(body.particles.V0, dtype=float))


def outgrown(scene, series) -> str:
    """What the total frame does not know, where a body has come to it; empty where all is well."""
    h, names = scene.space.h, [name.removeprefix("position_min_") for name in series if name.startswith("position_min_")]
    for name, count in zip(names, extents(scene.space), strict=False):
        size = (count - 1 - 2 * PAD) * h
        room = h * (AWAY if scene.moderate < math.inf else -FLUSH)
        for end in range(2):
            gaps = [size - x if end else x for x in series[f"position_{'max' if end else 'min'}_{name}"]]
            if gaps[0] > FLUSH * size and gaps[-1] < min(room, 0.5 * gaps[0]):
                return f"it comes to the {'upper' if end else 'lower'} side of the domain along {name}, on which it did not lie"
    if scene.moderate == math.inf:
        return ""
    flowed = [np.abs(strains(scene.space, reference.plastic)).max() for reference in scene.references if len(reference.plastic)]
    strain = series["strain_max"][-1] + max(flowed, default=0.0)
    return f"it is strained by {strain:.2g}, more than {scene.moderate:.2g}" if strain > scene.moderate else ""


class Data:
    """Bounds of one body's temperatures: what it was, and what it meets; open where something heats it."""

    def __init__(self, body, around, allowed):
        self.low, self.high, self.over, self.allowed = -math.inf, math.inf, 0.0, allowed
        self.lasting = isinstance(around, Surroundings) and around.steady  # what it meets is written once
        self.seen = self.heats = False
        if isinstance(body.thermal, Isothermal):
            return
        theta = body.thermal.theta
        self.heats = not (all(isinstance(one, NoSource | Load | Nozzle) for one in acting(body.source)) and isinstance(body.heating, NoHeating))
        self.cools = self.warms = False  # by a flux, which knows no bound that way
        self.low, self.high = float(np.min(theta)), float(np.max(theta))

    def meet(self, body) -> None:
        """Widen by what surrounds the body now."""
        surface = body.surface
        if isinstance(surface, NoExchange) or (self.lasting and self.seen):
            return
        self.cools, self.warms = self.cools or bool(surface.flux.min(initial=0.0) < 0), self.warms or bool(surface.flux.max(initial=0.0) > 0)
        acting = surface.beta > 0
        self.seen = bool(acting.any())
        for seen in (surface.outside[acting], (surface.outside + surface.drift)[acting]):
            if len(seen):
                self.low, self.high = min(self.low, float(np.min(seen))), max(self.high, float(np.max(seen)))
        if isinstance(surface.radiation, Radiation) and np.any(surface.radiation.emissivity > 0):
            sky = surface.radiation.sky[surface.radiation.emissivity > 0] - body.thermal.zero
            drift = surface.radiation.drift[surface.radiation.emissivity > 0]
            self.low, self.high = min(self.low, float(np.min(sky)), float(np.min(sky + drift))), max(self.high, float(np.max(sky)), float(np.max(sky + drift)))

    def judge(self, body) -> tuple[int, int, str] | None:
        """(code, particle, what is wrong with its temperature), or nothing."""
        thermal = body.thermal
        least, most = span(thermal.theta)
        if not least > -thermal.zero:
            return MAX_PRINCIPLE, int(np.argmin(thermal.theta)), f"{thermal.zero + least:.4g} K, below absolute zero"
        if self.heats:
            return None
        self.meet(body)
        scale = 1e-6 * max(abs(thermal.zero), 1.0)
        above, below = 0.0 if self.warms else most - self.high, 0.0 if self.cools else self.low - least
        wide = max(self.high, most if self.warms else -math.inf) - min(self.low, least if self.cools else math.inf)
        self.over = max(self.over, (max(above, below) - scale) / max(wide, scale))
        over = self.allowed * wide + scale
        bounds = f"beyond {thermal.zero + self.low:.5g} to {thermal.zero + self.high:.5g} K"
        if above > over:
            return MAX_PRINCIPLE, int(np.argmax(thermal.theta)), f"{thermal.zero + most:.5g} K, {bounds}"
        if below > over:
            return MAX_PRINCIPLE, int(np.argmin(thermal.theta)), f"{thermal.zero + least:.5g} K, {bounds}"
        return None


def explain(found: Outcome, scene, clock) -> Outcome:
    """The outcome with advice from the step that was taken: which limit it passed, by how much, and what to change."""
    if found.ok or found.kind in ("budget", "heat_solver", "outgrown"):
        return found
    taken = {"heat": clock.heated, "mechanical": clock.stepped}
    wanted = ("heat",) if found.kind == "max_principle" else ("mechanical", "heat") if found.kind == "non_finite" else ("mechanical",)
    known = [(dt / limit, dt, limit, name, kind) for kind in wanted if (now := taken[kind]) is not None for dt, limit, name in [now] if limit > 0]
    if not known:
        return found
    ratio, dt, limit, name, kind = max(known)
    if ratio <= 1.0 + 1e-9:
        return replace(found, advice=f"the step was {ratio:.2g} of the {name} limit, so it is not the step alone; {found.advice}")
    swollen = f" at J = {clock.swell:.2g}" if abs(clock.swell - 1.0) > 0.05 else ""
    step = "heat step" if kind == "heat" else "step"
    said = f"the {step} of {dt:.3g} s is {ratio:.2g} times the {name} limit{swollen}: {cure(scene, kind, limit)}"
    return replace(found, advice=f"{found.advice}; but {said}" if found.kind == "left_grid" else said)


def cure(scene, kind: str, limit: float) -> str:
    """What to change where a step is over a limit."""
    if kind == "mechanical" and scene.step is not None:
        return f"lower `time.step` below {limit:.3g} s, or let it be `auto`"
    if scene.safety > 1:
        return "lower `time.safety` to 1" + (", or leave `method.heat` at auto" if kind == "heat" else "")
    return f"lower `{'method.heat_step' if kind == 'heat' else 'time.safety'}`"
