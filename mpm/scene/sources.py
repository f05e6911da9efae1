"""Sources of a config to what runs take: a formula a body for heat by mass and one a direction for force, written for compiled code (mpm.sources.formula)."""

import ast
import math

import numpy as np

from mpm.config.sources import KINDS, PLACES, ByFormula
from mpm.heat.programmes import Parts, Sine, turns
from mpm.heat.programmes import spell as within
from mpm.materials.laws import Table
from mpm.scene.exchange import programme
from mpm.scene.refusal import SceneError
from mpm.sources import Both, Code, Force, Given, Jumping, NoForce, NoWarming, Warming, values
from mpm.sources import formula as stack
from mpm.state import NoSource, Thermal

POINTS = 9  # a direction, at which a formula is tried
BINARY = {ast.Add: stack.ADD, ast.Sub: stack.SUBTRACT, ast.Mult: stack.MULTIPLY, ast.Div: stack.DIVIDE, ast.Pow: stack.POWER}


class Writer:
    """Operations, one after another."""

    def __init__(self, places: tuple[str, ...] = ()):
        self.places, self.steps, self.tables, self.top, self.depth = places, [], np.zeros((0, 5)), 0, 1

    def put(self, what: int, number: float = 0.0, rows: tuple[int, int] = (0, 0), up: int = 0) -> "Writer":
        self.steps.append((what, float(number), rows))
        self.top += up
        self.depth = max(self.depth, self.top)
        return self

    def number(self, value: float) -> "Writer":
        return self.put(stack.NUMBER, value, up=1)

    def combine(self, what: int) -> "Writer":
        return self.put(what, up=-1)

    def after(self, when: float) -> "Writer":
        return self.put(stack.TIME, up=1).put(stack.AFTER, when)

    def code(self) -> Code:
        does, number, rows = zip(*self.steps, strict=True)
        return Code(np.array(does, np.int64), np.array(number), np.array(rows, np.int64), self.tables, self.depth, stack.TEMPERATURE in does)

    def tree(self, node: ast.AST) -> "Writer":
        """A formula that mpm.config.condition has read and found good."""
        if isinstance(node, ast.Constant):
            return self.number(float(node.value))
        if isinstance(node, ast.Name):
            if node.id == "pi":
                return self.number(math.pi)
            if node.id in self.places:
                return self.put(stack.PLACE, self.places.index(node.id), up=1)
            return self.put({"t": stack.TIME, "T": stack.TEMPERATURE}[node.id], up=1)
        if isinstance(node, ast.UnaryOp):
            self.tree(node.operand)
            return self.put(stack.NEGATE) if isinstance(node.op, ast.USub) else self
        if isinstance(node, ast.BinOp):
            return self.tree(node.left).tree(node.right).combine(BINARY[type(node.op)])
        name, given = node.func.id, node.args
        self.tree(given[0])
        if name in ("min", "max"):
            for one in given[1:]:
                self.tree(one).combine(stack.LEAST if name == "min" else stack.MOST)
            return self
        if name == "log" and len(given) == 2:  # to a base
            self.put(stack.FIRST + stack.UNARY.index("log")).tree(given[1])
            return self.put(stack.FIRST + stack.UNARY.index("log")).combine(stack.DIVIDE)
        return self.put(stack.FIRST + stack.UNARY.index(name))

    def programme(self, one) -> "Writer":
        """A run-time programme (mpm.heat.programmes)."""
        if isinstance(one, Table):
            first = len(self.tables)
            rows = np.zeros((len(one.theta), 5))
            rows[:, 0], rows[:-1, 1:] = one.theta, one.c
            self.tables = np.concatenate([self.tables, rows])
            return self.put(stack.TIME, up=1).put(stack.TABLE, rows=(first, len(self.tables)))
        if isinstance(one, Sine):
            self.number(one.mean).number(one.amplitude).put(stack.TIME, up=1).number(2 * math.pi / one.period).combine(stack.MULTIPLY)
            self.number(one.phase).combine(stack.ADD).put(stack.FIRST + stack.UNARY.index("sin"))
            return self.combine(stack.MULTIPLY).combine(stack.ADD)
        if isinstance(one, Parts):
            self.programme(one.parts[0])
            for when, before, after in zip(one.jumps, one.parts[:-1], one.parts[1:], strict=True):
                self.programme(after).programme(before).combine(stack.SUBTRACT).after(when).combine(stack.MULTIPLY).combine(stack.ADD)
            return self
        return self.number(float(one))

    def between(self, begin: float, end: float | None) -> "Writer":
        """What was written last, from `begin` to `end`."""
        if begin > 0:
            self.after(begin).combine(stack.MULTIPLY)
        if end is not None:
            self.number(1.0).after(end).combine(stack.SUBTRACT).combine(stack.MULTIPLY)
        return self


def total(experiment, parts) -> Code | None:
    """The sum of (what, factor, from, until); None of nothing."""
    writer = Writer(PLACES[experiment.grid.dimension])
    for number, (one, factor, begin, until) in enumerate(parts):
        if isinstance(one, ByFormula):
            writer.tree(ast.parse(one.text.strip(), mode="eval").body).between(begin, until)
        else:
            writer.programme(within(programme(one), begin, until))
        if factor != 1.0:
            writer.number(factor).combine(stack.MULTIPLY)
        if number:
            writer.combine(stack.ADD)
    return writer.code() if parts else None


def heats(experiment, name: str) -> list:
    """[(what, its factor to W/m3 of the undeformed body, from, until)] of one body."""
    density = experiment.materials[experiment.bodies[name].material].density
    entries = [entry for entry in experiment.sources if entry.of == name]
    kinds = (("heat", 1.0), ("heat_by_mass", density))
    return [(getattr(entry, kind), factor, getattr(entry, "from"), entry.until)
            for entry in entries for kind, factor in kinds if getattr(entry, kind) is not None]  # fmt: skip


def moments(experiment, of: str = "", kinds: tuple[str, ...] = KINDS) -> tuple[float, ...]:
    """Times at which a source jumps [s]; of one body, and of some kinds, where told."""
    found = set()
    for entry in (entry for entry in experiment.sources if of in ("", entry.of)):
        for one in (part for kind in kinds if (what := getattr(entry, kind)) is not None for part in (what if kind == "force" else (what,))):
            whole = 0.0 if one is None or isinstance(one, ByFormula) else programme(one)
            found |= {*turns(within(whole, getattr(entry, "from"), entry.until)), getattr(entry, "from"), entry.until or 0.0} if one is not None else set()
    return tuple(sorted(found - {0.0}))


def sourced(experiment, name: str, load, particles, thermal):
    """The source of a moving body: what acts already (`load`: Load or NoSource), and what the config gives."""
    entries = [entry for entry in experiment.sources if entry.of == name]
    if not entries:
        return load
    density = experiment.materials[experiment.bodies[name].material].density
    heat = total(experiment, [(one, factor / density, *when) for one, factor, *when in heats(experiment, name)])
    forced = [entry for entry in entries if entry.force is not None]
    ways = range(experiment.grid.directions if forced else 0)
    codes = tuple(total(experiment, [(entry.force[c], 1.0, getattr(entry, "from"), entry.until) for entry in forced]) for c in ways)
    X = particles.x.astype(float) - np.array(experiment.method.offset) * experiment.grid.cell
    theta = thermal.zero + thermal.theta.astype(float) if isinstance(thermal, Thermal) else np.full(len(X), thermal.temperature)
    for code in (*codes, *((heat,) if heat is not None else ())):
        sound(experiment, name, code, X, theta)
    jumps = any(moments(experiment, name, ("force",)))
    push = NoForce() if not codes else Jumping(codes, np.zeros(1)) if jumps else Force(codes)
    warmth = Warming(heat) if heat is not None else NoWarming()
    depth = max(code.depth for code in (*codes, *((heat,) if heat is not None else ())))
    given = Given(X, np.zeros(len(X)), np.zeros(X.shape), np.zeros(len(X)), np.zeros((depth, len(X))), theta.copy(), push, warmth)
    return given if isinstance(load, NoSource) else Both(load, given)


def resting(experiment, name: str, outline) -> tuple:
    """Heat from within a body that does not move, as mpm.rigid.system.RigidBody has it."""
    found = []
    for one, factor, begin, until in heats(experiment, name):
        if isinstance(one, ByFormula):
            code = total(experiment, [(one, factor, 0.0, None)])
            sound(experiment, name, code, points(outline), np.zeros(POINTS**3))
            found.append((code, 1.0, begin, math.inf if until is None else until))
        else:
            found.append((within(programme(one), begin, until), factor, 0.0, math.inf))
    return tuple(found)


def points(outline) -> np.ndarray:
    """Some points of a shape."""
    axes = [np.linspace(low, high, POINTS) for low, high in zip(*outline.bounds(), strict=True)]
    every = np.stack([one.ravel() for one in np.meshgrid(*axes, indexing="ij")], axis=-1)
    return every[outline.distance(every) <= 0]


def sound(experiment, name: str, code: Code, X, theta) -> None:
    """SceneError for a formula that has no value in the body at the start, in the middle or at the end."""
    for t in (0.0, 0.5 * experiment.time.end, experiment.time.end):
        if not np.isfinite(values(code, X, t, theta)).all():
            index = next(k for k, entry in enumerate(experiment.sources) if entry.of == name)
            raise SceneError(("sources", index), f"a source of {name} has no finite value somewhere in the body at t = {t:g} s: look at its formula")
