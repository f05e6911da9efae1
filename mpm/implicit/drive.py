"""Heat and mechanics step by step, at steps of their own choosing (docs/physics.md 17).

A step   heat over dt (as the run gives it), laws at the new temperature, Newton's method, particles: of order 1. It is made once over dt and from the same
         start twice over dt/2; what is kept is twice the second less the first (mpm.implicit.extrapolate): of order 2, heat and motion together.
Error    the larger of rms |x_2 - x_1|/L and WARMER rms |Theta_2 - Theta_1|/(highest less lowest temperature so far). The next step is
         dt clip(0.9 sqrt(REACH tolerance/error), 0.3, 2); a step whose error is too large is made again once, shorter, never twice in a row: after a remap old
         stresses are slightly out of balance with the new weights, and the move that mends this does not shrink with dt. The first step is exempt:
         a body that is put on its wall must sag.
Kinetic  energy of motion over what it was at the start and what gravity, loads, tools and expansion have worked so far. Where a material without viscosity
         flows and it stays above SWIFT for PATIENCE steps, the body falls down under more than it bears: inertia carries it, and backward Euler damps
         that. The run ends (no_equilibrium). What damping takes from a body that was thrown or fell is warned of (mpm.review, `energy`).
Failure  everything as before the step, a quarter of dt; below LEAST of the first step the run ends, as the step did. A step fails too where particles leave the
         grid, or move by more than SIGHT cells and past where no wall and no tool was near: what was not looked for would not stop them.
"""

import copy
import math
from dataclasses import dataclass

import numpy as np

from mpm.boundary import directions
from mpm.diagnostics import kinetic
from mpm.implicit.contact import NEAR, STIFFNESS, keep_books, may_touch
from mpm.implicit.deliver import deliver, drag_rate, pull_nodes
from mpm.implicit.extrapolate import everything, extrapolate
from mpm.implicit.following import following, following_skin, laid_skin
from mpm.implicit.free import free_tools, move_on
from mpm.implicit.lasting import begin_step, end_step, lasting_nodes
from mpm.implicit.newton import MOST_MOVE, Problem, solve
from mpm.implicit.nodes import Nodes, new_nodes
from mpm.implicit.nozzle import carry, told_work
from mpm.integrate.state_check import unsound
from mpm.integrate.strain import CODE, DISSIPATED, PARTICLE, SPEED, STEP
from mpm.integrate.timestep import limits, stiffest
from mpm.materials import Constant, EllipseRadial
from mpm.outcome import BUDGET, COMPLETED, INVERTED, NO_EQUILIBRIUM, Outcome, outcome
from mpm.state import NoSource

CUT, SHRINK, GROW, SAFE = 0.25, 0.3, 2.0, 0.9
TOLD = {"rejected": "steps_rejected", "failed": "steps_failed", "iterations": "newton_iterations", "shifts": "newton_shifts", "deepest": "wall_depth",
        "kinetic_over_work": "kinetic_over_work"}  # fmt: skip
SWIFT, PATIENCE = 0.05, 20
REACH = 3.0  # the error of the first-order step may be this much of the tolerance: what is kept is closer
LEAST = 1e-4  # of the first step that was tried
STRIDE = 0.5  # cells that a tool may move in a step
SIGHT = NEAR - 0.5  # cells that a particle may move in a step where walls or tools may be near
REJECT = 2.0  # of what is aimed at: an error from which a step is made again
CURED = ("no_equilibrium", "inverted", "overstretched", "heat_solver", "left_grid")  # what a shorter step may cure


@dataclass
class Implicit:
    """How a scene steps implicitly. `size` is the body's largest extent [m]."""

    tolerance: float
    size: float
    first: float  # step to begin with [s]
    walls: np.ndarray  # (3, 2) kinds
    lasting: Nodes | None = None  # of the reference shape, in the total frame
    skin: tuple | None = None  # what follows its surface (mpm.implicit.following.laid_skin)

    def begin(self, energy: float) -> dict:
        """What a run with this energy of motion counts, and its next step: steps made again for their error (rejected) or cut (failed), sums, extrema."""
        return {"next": self.first, "last": 0.0, "again": 0, "work": energy, "moved": energy, "swift": 0} | dict.fromkeys(TOLD, 0)

    def finals(self, told: dict) -> dict[str, float]:
        """What the dataset says of a run's steps."""
        return {name: float(told.get(key, 0)) for key, name in TOLD.items()}

    def advance(self, *given) -> Outcome:
        """See `advance`."""
        return advance(*given)


def advance(scene, clock, guards, work, until: float, warm, recorder, look) -> Outcome:
    """Steps up to `until`. warm(scene, clock, work, begun, dt, limits) is the run's heat step; look() -> bool asks whether to stop."""
    clock.told = clock.told or scene.implicit.begin(sum(kinetic(scene.space, body.particles) for body in scene.bodies))
    while until - clock.time > 1e-12 * until:
        goal = until
        if scene.inflow is not None:
            scene.inflow.enter(scene, clock.time)
            goal = scene.inflow.before(clock.time, until)
        if not (sound := guards.block(scene, clock)).ok:
            return sound
        told, left = clock.told, goal - clock.time
        count = max(1, math.ceil(left / told["next"] * (1 - 1e-9)), math.ceil(left * fastest(scene, clock, left) / (STRIDE * scene.space.h)))
        dt, before = left / count, keep(scene, clock)
        error, found = pair(scene, clock, work, dt, warm)
        told = clock.told
        if not found.ok or too_far(scene, told, error):
            told = put_back(scene, clock, before)
            if not found.ok and (dt * CUT < LEAST * scene.implicit.first or found.kind not in CURED or told["swift"] >= PATIENCE):
                return found
            told["failed" if not found.ok else "rejected"] += 1
            told["again"], told["next"] = int(found.ok), dt * (factor(scene.implicit, error) if found.ok else CUT)
            continue
        told["next"] = scene.step or dt * (factor(scene.implicit, error) if told["last"] > 0 else 1.0)
        told["last"], told["again"] = dt, 0
        clock.shortest, clock.longest = min(before[1]["shortest"], dt), max(before[1]["longest"], dt)  # not those of its halves
        binding = "time.step" if scene.step else "error of the step"
        clock.bound[binding] = clock.bound.get(binding, 0) + 1
        clock.steps += 1
        clock.time = goal if count == 1 else before[1]["time"] + dt
        recorder.watch(scene, clock.time)
        if look():
            return outcome(BUDGET, time=clock.time * scene.scale, step=clock.steps)
    scene.facts |= {"mechanics": "implicit", **{name: clock.told[name] for name in (*TOLD, "moved")}}
    return guards.whole(scene, clock)


def fastest(scene, clock, span: float) -> float:
    """The fastest that a tool may go for `span` from now on [m/s]; how far a force moves one is for the step to find (mpm.implicit.free)."""
    return scene.meeting.stride(clock.time, span, 0.0) if scene.meeting is not None else 0.0


def pair(scene, clock, work, dt: float, warm) -> tuple[float, Outcome]:
    """One step of dt, two of half of it from the same start, and twice the second less the first: (error, outcome). See the module's docstring."""
    start = keep(scene, clock)
    if not (found := one_step(scene, clock, work, dt, warm)).ok:
        return math.inf, found
    once, spent = keep(scene, clock), vars(clock)["time"]
    put_back(scene, clock, start)
    for part in range(2):
        clock.time = spent + 0.5 * dt * part
        if not (found := one_step(scene, clock, work, 0.5 * dt, warm)).ok:
            return math.inf, found
    error = extrapolate(scene, clock, work, once, start)
    return error, whole(scene, clock) if math.isfinite(error) else outcome(INVERTED, time=clock.time * scene.scale, step=clock.steps)


def first_pair(scene, clock, work, warm) -> None:
    """The pair of steps that a run begins with, whatever comes of it: it needs the kernels that all need."""
    clock.told = scene.implicit.begin(0.0)
    if scene.inflow is not None:
        scene.inflow.enter(scene, 0.0)
    pair(scene, clock, work, scene.implicit.first, warm)


def whole(scene, clock) -> Outcome:
    """Whether the next step can begin: every particle is on the grid, and finite."""
    if scene.references or (wrong := unsound(scene.space, scene.bodies[0])) is None:
        return outcome(COMPLETED)
    return outcome(wrong[0], wrong[1], clock.time * scene.scale, clock.steps, f"({wrong[2]})")


def one_step(scene, clock, work, dt: float, warm) -> Outcome:
    """Heat, then mechanics; the other way round where heat passes by touch, as motion says who touches."""
    if scene.course is not None:
        scene.course.lay(scene, clock.time, dt, 1, 0.0)
    if scene.inflow is not None:
        scene.inflow.lay(clock.time, dt)
    later = scene.meeting is not None and scene.meeting.warms
    now = limits(scene.space, directions(scene.space), scene.bodies, clock.reports)
    found = outcome(COMPLETED) if later else warm(scene, clock, work, clock.time, dt, now)
    if found.ok:
        found = mechanical_step(scene, clock, dt)
    return warm(scene, clock, work, clock.time, dt, now) if found.ok and later else found


def factor(how: Implicit, error: float) -> float:
    """By how much the step after one with this error may be longer."""
    return min(GROW, max(SHRINK, SAFE * math.sqrt(REACH * how.tolerance / error))) if error > 0 else GROW


def too_far(scene, told: dict, error: float) -> bool:
    """Whether a step is to be made again for its error."""
    free = scene.step is not None or told["again"] or told["last"] == 0
    return not free and error > REJECT * REACH * scene.implicit.tolerance


def keep(scene, clock) -> tuple:
    """All that a step may change."""
    met = copy.deepcopy(scene.meeting.memory()) if scene.meeting is not None else None
    return {path: array.copy() for path, array in everything(scene).items()}, copy.deepcopy(vars(clock)), met


def put_back(scene, clock, before: tuple) -> dict:
    """The state before a step; what Newton's method was asked stays counted."""
    found, past, met = before
    counts = {name: clock.told[name] for name in ("iterations", "shifts")}
    for path, array in everything(scene).items():
        array[...] = found[path]
    clock.recall(past)
    clock.told |= counts
    if met is not None:
        scene.meeting.recall(met)
    return clock.told


def mechanical_step(scene, clock, dt: float) -> Outcome:
    """One step of dt; particles move only where it is ok."""
    how, told, body = scene.implicit, clock.told, scene.bodies[0]
    lam, mu = stiffest(body)
    if scene.references:
        reference = scene.references[0]
        if how.lasting is None:
            how.lasting = lasting_nodes(scene.space, body, reference)
            how.skin = laid_skin(scene.space, reference, how.lasting)
        nodes, pull, drag = begin_step(scene.space, reference, how.lasting, scene.gravity[-1], dt)
        follows = following_skin(scene.space, reference, how.skin, dt)
        most = math.inf  # there is no cell to leave, and nothing to meet
    else:
        nodes = new_nodes(scene.space, scene.gradient, body, how.walls, scene.gravity[-1], mu)
        pull, drag, most = np.zeros(nodes.v.shape), drag_rate(body.source, dt), MOST_MOVE * scene.space.h
        follows = following(scene.space, body, nodes, dt)
    if not isinstance(body.source, NoSource):
        pull_nodes(body, nodes, pull, dt)
    nodes.push[:] += pull
    clear, unforeseen = scene.meeting.distance(clock.time) if scene.meeting is not None and not scene.references else (math.inf, None)
    if unforeseen is not None:
        return outcome(unforeseen[0], time=clock.time * scene.scale, step=clock.steps)
    pushed = may_touch(scene, clock, dt, STIFFNESS * (lam + 2 * mu) / scene.space.h)
    free = free_tools(scene, dt)
    problem = Problem(scene.space, body, nodes, pushed, free, dt, drag, most, follows)
    answer = solve(problem, dt * nodes.v)
    told["iterations"], told["shifts"] = told["iterations"] + answer.iterations, told["shifts"] + answer.shifts
    if answer.u is None or not move_on(scene, free, dt):
        return outcome(NO_EQUILIBRIUM, time=clock.time * scene.scale, step=clock.steps)
    followed = problem.followed(answer.u)
    work = float(np.sum(pull * answer.u) - drag / dt * np.sum(nodes.m[:, None] * answer.u**2)) + told_work(problem, answer.u) + followed
    clock.reset()
    report = clock.reports[0]
    told["work"] += abs(keep_books(scene, nodes, pushed, answer.u, answer.depth, dt))
    deliver(scene.space, body, nodes, answer.u, dt, work, report)
    if report[CODE] != 0:
        report[STEP] = 0
        return outcome(int(report[CODE]), int(report[PARTICLE]), clock.time * scene.scale, clock.steps)
    if dt * math.sqrt(report[SPEED]) > max(clear, SIGHT * scene.space.h):
        return outcome(NO_EQUILIBRIUM, time=clock.time * scene.scale, step=clock.steps, detail="(past what it may touch)")
    if scene.references:
        end_step(scene.space, body, reference, nodes, answer.u, dt)
    carry(body, dt)
    clock.gather(dt)
    if scene.course is not None:
        clock.worked += scene.course.work(scene)
    told["work"] += abs(float(np.sum(nodes.push * answer.u)) + followed)
    moving, given = 0.5 * float(np.sum(nodes.m[:, None] * (answer.u / dt) ** 2)), told["work"] + abs(clock.swelled)
    told["moved"], told["kinetic_over_work"] = max(told["moved"], moving), moving / given if given > 0 else 0.0
    told["swift"] = told["swift"] + 1 if moving > SWIFT * given and report[DISSIPATED] > 0 and rate_independent(body.flow) else 0
    if told["swift"] > PATIENCE:
        said = f"(inertia carries it: energy of motion is {100 * moving / given:.0f} % of the work of gravity and loads)"
        return outcome(NO_EQUILIBRIUM, time=clock.time * scene.scale, step=clock.steps, detail=said)
    told["deepest"] = max(told["deepest"], float(answer.depth.max(initial=0.0)))
    return whole(scene, clock)


def rate_independent(flow) -> bool:
    """Whether a material flows at once, whatever the rate."""
    return isinstance(flow, EllipseRadial) and isinstance(flow.eta, Constant) and flow.eta.constant == 0
