"""Simulate a scene of moving bodies: particles, a grid, explicit steps.

Every output interval is cut into equal heat steps, every heat step into equal mechanical steps, those into blocks that one compiled call
advances. Blocks are cut by counts, never by the clock, so a run gives the same bits on any machine load.
"""

import math
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpm.contact import narrow, overlap, stretched
from mpm.contact.block import advance_block, clear, work_arrays
from mpm.contact.insync import in_sync
from mpm.guards import Guards, explain, outgrown
from mpm.integrate import enthalpy_steps  # noqa: F401 - registers the laws of specific heat that follow temperature
from mpm.integrate.sorting import Order
from mpm.integrate.strain import CODE, DISSIPATED, HEATED, PARTICLE, RATE, REPORT, SOURCED, SPEED, STEP, SWELL, SWELLED, WORKED
from mpm.integrate.surroundings import jumps
from mpm.memory import arrays, fill
from mpm.observe import Recorder, merged, stops
from mpm.outcome import BUDGET, COMPLETED, NON_FINITE, STEP_UNDERFLOW, UNSOUND, Outcome, Run, outcome
from mpm.state import as_heated, as_moved
from mpm.total.drive import advance_references, present_limits, present_steps, show_all
from mpm.warming import warm_bodies

BLOCK, BLOCK_WORK = 32, 1_000_000  # steps, and particle-steps, between looks at guards, limits and signals
GATHERED = {"local": HEATED, "dissipated": DISSIPATED, "worked": WORKED, "swelled": SWELLED, "exchanged": SOURCED}  # sums over steps
UNDERFLOW = 256.0  # the stable step may shrink this much before the run gives up


@dataclass(frozen=True)
class HeatMethod:
    """`kind` auto, explicit, stabilised or implicit (of `order`); auto is stabilised, and implicit where a heat step would need more than MANY stages."""

    kind: str = "auto"
    order: int = 1
    tolerance: float = 1e-9


@dataclass
class Scene:
    """Moving bodies, ready to run. Arrays are the run's own: simulating changes them."""

    space: Any
    gradient: Any
    scheme: Any
    names: tuple[str, ...]
    bodies: tuple
    walls: np.ndarray  # (3, 2) kinds of mpm.boundary
    gravity: np.ndarray  # (1, D), or a row a step where it changes over time [m/s2]
    blend: float  # of the temperature transfer (integrate/heat_step.py)
    affine: float
    times: np.ndarray  # output times, the first 0 [s]
    step: float | None  # None: automatic
    safety: float
    heat_step: float | None
    surroundings: tuple = ()  # by body: mpm.integrate.surroundings.Surroundings or None; seams: mpm.integrate.fracture_surface.Seams or None
    hot: tuple[str, ...] = ()  # names of the walls and tools that have heat
    seams: tuple = ()
    outlines: tuple = ()  # mpm.follow.Carried: points of its surface; without them no extents are recorded
    heat: HeatMethod = HeatMethod()
    scale: float = 1.0  # physical seconds a second of the run (mpm.scene.scaling)
    turns: tuple = ()  # times at which a source, or what course has, jumps [s]
    watch: Any = None  # what to record: mpm.observe.Watch
    meeting: Any = None  # mpm.contact.meeting.Meeting, or None
    course: Any = None  # mpm.contact.course.Course: what of it changes over time, or None
    facts: dict = field(default_factory=dict)
    sharp: int = 0  # XPIC order of the temperature transfer; 0: none
    repair: bool = False  # whether temperatures are kept between their bounds (integrate/bounds.py)
    inflow: Any = None  # mpm.inflow.Inflow: bodies that come in, or None
    tears: bool = False  # whether a gap of two cells ends the run (mpm.guards)
    threads: int = 1  # that share the work of a large scene
    moderate: float = math.inf  # the largest strain in the total frame, beyond which a run ends as outgrown (mpm.guards)
    over: Any = None  # (scene, time) -> the same in the updated frame or None, where a run that is outgrown goes over to it (mpm.scene.over)
    references: tuple = ()  # mpm.total.Reference by body, in the total frame; none in the updated one
    implicit: Any = None  # mpm.implicit.drive.Implicit, or None: explicit mechanics
    order: Order = field(init=False)  # of the particles, while it runs
    for_motion: tuple = field(init=False)  # the bodies as the mechanical step reads them, and as the heat step does
    for_heat: tuple = field(init=False)

    def __post_init__(self):
        self.surroundings = self.surroundings or (None,) * len(self.bodies)
        self.order = Order(self.space, self.bodies)
        self.order.due = not self.references  # those have their order for good
        self.for_motion, self.for_heat = as_moved(self.bodies), tuple(map(as_heated, self.bodies))
        if self.inflow is not None:
            self.inflow.begin(self)

    @property
    def wholes(self) -> tuple:
        """The bodies with all that will ever come in."""
        return self.bodies if self.inflow is None else self.inflow.wholes(self)


class Clock:
    """Counts, limits and accumulated sources of one run."""

    def __init__(self, scene: Scene):
        self.time, self.steps, self.heat_steps, self.implicit, self.iterations = 0.0, 0, 0, 0, 0  # implicit: heat steps, and their solver's iterations
        self.bound, self.told = {}, {}  # steps by what bound them; what implicit mechanics counts
        self.exchanged = self.local = self.dissipated = self.repaired = self.unrepaired = self.worked = self.swelled = self.softened = 0.0
        self.given = np.zeros(len(scene.hot))  # heat that each hot wall and tool has given to bodies [J]
        self.swell, self.spent, self.first_step, self.shortest, self.longest = 1.0, 0.0, None, math.inf, 0.0  # largest J; time before a cut; steps [s]
        self.lag, self.touching = 0.0, False  # how far velocities lie behind positions [s] (contact/insync.py); whether the last block looked for contacts
        self.seen = np.tile([math.inf, -math.inf], (len(scene.bodies), 1))  # lowest and highest temperature of body and surroundings so far
        self.stepped = self.heated = None  # (step, its limit [s], the limit's name) of the last mechanical step and of the last heat sub-step
        self.output, self.start, self.part, self.parts = 1, 0.0, 0, 0  # next output or snapshot, start of its interval, heat step, heat steps (0: none yet)
        self.reports = np.zeros((len(scene.bodies), REPORT))
        self.look(scene)

    def look(self, scene: Scene) -> None:
        """Speeds, rates and changes of volume that the first step is to know of."""
        self.reset()
        for report, body in zip(self.reports, scene.bodies, strict=True):
            report[SPEED] = float(np.max(np.sum(body.particles.v.astype(float) ** 2, axis=1)))
            report[RATE] = float(np.max(np.abs(body.particles.C)))
            report[SWELL] = float(np.max(body.particles.J))

    def recall(self, found: dict) -> None:
        """As it was when `vars(self)` was kept."""
        self.reports[...] = found["reports"]
        vars(self).update({name: value for name, value in found.items() if name != "reports"})

    def reset(self) -> None:
        self.reports[:] = 0.0
        self.reports[:, PARTICLE] = -1

    def gather(self, dt: float) -> None:
        """After a block of steps of dt: rates from increments, and the sums of its steps."""
        self.shortest, self.longest = min(self.shortest, dt), max(self.longest, dt)
        self.reports[:, RATE] /= dt
        reports = self.reports.tolist()
        for name, place in GATHERED.items():
            setattr(self, name, getattr(self, name) + sum(report[place] for report in reports))


def simulate(scene: Scene, beat=None, keeper=None) -> Run:
    """Run the scene to its end or its failure.

    `beat(fraction, time) -> bool` is asked between blocks; true stops the run. keeper: mpm.memory; the run goes on where it was cut, with the same bits.
    """
    began = time.perf_counter()
    clock, recorder, guards = Clock(scene), Recorder(scene, getattr(keeper, "frames", None)), Guards(scene)
    work = None if scene.references else work_arrays(scene)
    result, before = outcome(COMPLETED), keeper.found if keeper is not None else None
    if before is not None:
        if "over" in before["clock"]["told"]:
            scene, guards, work = go_on(scene.over(scene, 0.0), clock, recorder, guards)
        clock.recall(before["clock"])
        recorder.recall(before["recorder"])
        guards.recall(before["guards"])
        if scene.inflow is not None:
            scene.inflow.recall(scene, before["inflow"])
        scene.order.recall(before["order"])
        fill(scene.bodies, before["bodies"])
        fill(scene.references, before["references"])
        if scene.meeting is not None:
            scene.meeting.recall(before["meeting"])
    else:
        recorder.frames.clear()
        recorder.record(scene, clock)
        result = guards.frame(scene, clock, recorder.series)

    def look() -> bool:
        stop = beat is not None and beat(clock.time / float(scene.times[-1]), clock.time * scene.scale)
        if keeper is not None and keeper.due(stop):
            parts = {"recorder": recorder.memory(), "guards": guards.memory(), "order": scene.order.memory()}
            parts |= {"bodies": arrays(scene.bodies), "references": arrays(scene.references)}
            parts |= {name: one.memory() for name in ("meeting", "inflow") if (one := getattr(scene, name)) is not None}
            keeper.save({"clock": vars(clock) | {"spent": clock.spent + time.perf_counter() - began}, **parts})
        return stop

    for end, told in stops(scene.times, merged(scene.watch.snapshots, jumps(scene.surroundings, scene.times[-1], scene.turns)))[clock.output :]:
        result = interval(scene, clock, recorder, guards, work, end, look)
        if not result.ok:
            break
        show_all(scene)
        with in_sync(scene, clock, work):
            (recorder.record if told else recorder.frame)(scene, clock)
            result = guards.frame(scene, clock, recorder.series) if told else result
        if result.kind == "outgrown" and scene.over is not None and (after := scene.over(scene, clock.time)) is not None:
            clock.told["over"] = f"total until t = {clock.time * scene.scale:.4g} s: {outgrown(scene, recorder.series)}"
            scene, guards, work = go_on(after, clock, recorder, guards)
            result = outcome(COMPLETED)
        if not result.ok:
            recorder.drop()
            break
        clock.output += 1
    show_all(scene)
    run = recorder.run(scene, clock, explain(result, scene, clock), clock.spent + time.perf_counter() - began)
    looks = () if scene.meeting is None else (overlap, stretched) if scene.implicit is not None else (overlap, stretched, narrow)
    warned = [*guards.warned, *(said for look in looks for said in look.warned(scene.meeting))]
    run.facts |= {"warnings": warned} if warned else {}
    run.facts |= {"parted": scene.meeting.parted} if scene.meeting is not None and scene.meeting.parted else {}
    run.facts |= {"over": clock.told["over"]} if "over" in clock.told else {}
    return run


def go_on(scene: Scene, clock: Clock, recorder, guards: Guards) -> tuple:
    """(scene, guards, work) of a run that goes on in another frame, its counts and records as they are."""
    clock.look(scene)
    clock.first_step = clock.stepped = clock.heated = None
    recorder.scene = scene
    return scene, guards.follow(scene), work_arrays(scene)


def interval(scene: Scene, clock: Clock, recorder, guards: Guards, work, end: float, look) -> Outcome:
    """Advance to the output time `end`; from within the interval where the run was cut there."""
    if scene.course is not None:
        scene.course.set(clock.time, 0.0)
    if scene.implicit is not None:
        return scene.implicit.advance(scene, clock, guards, work, end, warm_bodies, recorder, look)
    cut = clock.parts > 0
    if not cut:
        scene.order.refresh()
        now = present_limits(scene, clock)
        clock.start, clock.part, pace = clock.time, 0, scene.heat_step or now.pace
        clock.parts = max(1, math.ceil((end - clock.start) / pace * (1 - 1e-9))) if np.isfinite(pace) else 1
    while clock.part < clock.parts:
        until = clock.start + (end - clock.start) * (clock.part + 1) / clock.parts
        begun = clock.start + (end - clock.start) * clock.part / clock.parts
        if scene.inflow is not None:
            scene.inflow.enter(scene, begun)
        later = scene.meeting is not None and scene.meeting.warms  # heat that passes by touch follows the motion that says who touched
        if not (cut or later):
            result = warm_bodies(scene, clock, work, begun, until - begun, now)
            if not result.ok:
                return result
            recorder.watch(scene, until)
        cut = False
        result = march(scene, clock, guards, work, until, look)
        now = present_limits(scene, clock)
        if result.ok and later:
            result = warm_bodies(scene, clock, work, begun, until - begun, now)
            recorder.watch(scene, until)
        if not result.ok:
            return result
        clock.part += 1
    clock.parts = 0
    return guards.whole(scene, clock)


def march(scene: Scene, clock: Clock, guards: Guards, work, until: float, look) -> Outcome:
    """Mechanical steps up to `until`, in blocks."""
    while until - clock.time > 1e-12 * until:
        goal = until
        if scene.inflow is not None:
            scene.inflow.enter(scene, clock.time)
            goal = scene.inflow.before(clock.time, until)
        if not (sound := guards.block(scene, clock)).ok:
            return sound
        now = present_steps(scene, clock)
        least = min(now, key=now.get)
        step = scene.step or now[least] * scene.safety
        clock.first_step = clock.first_step or step
        if step < clock.first_step / UNDERFLOW:
            return outcome(STEP_UNDERFLOW, time=clock.time * scene.scale, step=clock.steps, detail=f"({least})")
        left = goal - clock.time
        count = max(1, math.ceil(left / step * (1 - 1e-9)))
        dt, block = left / count, clear(scene, clock, left / count, min(scene.order.block(BLOCK, BLOCK_WORK), count))
        cut = count == 1 and left < step * (1 - 1e-9)
        binding = "heat pace or output" if cut else "time.step" if scene.step else least
        clock.bound[binding] = clock.bound.get(binding, 0) + block
        clock.stepped = dt, now[least], least
        clock.swell = max(clock.reports[:, SWELL].tolist())
        if (taken := (advance_references if scene.references else advance_block)(scene, clock, work, dt, block)) is not None and not taken.ok:
            return taken
        clock.gather(dt)
        if (failed := next((b for b, code in enumerate(clock.reports[:, CODE].tolist()) if code != 0), None)) is not None:
            report = clock.reports[failed]
            if report[CODE] == UNSOUND and not (found := guards.whole(scene, clock)).ok:  # before any step
                return found
            clock.steps += int(report[STEP])
            clock.time += dt * int(report[STEP])
            detail = f"of {scene.names[failed]}" if len(scene.names) > 1 else ""
            return outcome(max(NON_FINITE, int(report[CODE])), scene.order.name(failed, int(report[PARTICLE])), clock.time * scene.scale, clock.steps, detail)
        clock.steps += block
        clock.time = goal if block == count else clock.time + dt * block
        if look():
            return outcome(BUDGET, time=clock.time * scene.scale, step=clock.steps)
    return outcome(COMPLETED)
