"""What is being compiled, how much of it is left, and what this process has spent on it.

    expect(experiment)            this process runs it first: how many kernels that may take is told beside each
    seconds()                     wall time that this process has spent on compiling kernels
    say(listener)                 context: `listener(text, expected, took)` hears of a kernel as it begins, after each function, and when it is ready (text "")
    remember(experiment)          its kernels are in the cache of this machine now
    expected(experiment)          about how long they take to compile; 0 where they are in the cache

Configs compile the same kernels where they differ in numbers only, so one is known by its keys and words. How many functions a kernel has, and how long they
took, is kept beside the cache; before that an estimate stands for it.
"""

import contextlib
import hashlib
import json
import os
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from mpm.cache import kernels
from mpm.fingerprint import contained, hash_of

NAMES = {
    "advance": "the mechanical step", "advance_lanes": "the mechanical step", "heat_step": "the heat step", "heat_chebyshev": "the heat step",
    "heat_implicit": "the heat step", "advance_touching": "the step of bodies that touch", "advance_total": "the step of the total frame",
    "nodal": "sums over nodes",
}  # fmt: skip
USUAL = (25, 0.5)  # functions, and seconds, of a kernel never met
MET = {  # of the large ones, on an idle core of the machine of docs/speed.md; `advance_touching` after `advance`
    "advance": (150, 11.0), "heat_chebyshev": (40, 3.5), "heat_step": (35, 3.0), "heat_implicit": (60, 4.0), "advance_touching": (105, 13.5),
}  # fmt: skip
KERNELS = {"at rest": 8, "moving": 12}  # that a scene takes, where this machine has met none of its sort
LINKING = 0.3  # of a kernel's time, after its last function: linking, optimising, machine code
MOVING, RESTING = 2.5, 3.0  # seconds of the small kernels of bodies that move, and of those of all that rests
UNLIKE = ("title", "output", "time", "sweep", "smoke", "chart", "stability")  # parts of a config that compile nothing


class Spent:
    """What this process compiles now, and what it has spent so far."""

    def __init__(self) -> None:
        self.total, self.began, self.functions = 0.0, 0.0, 0
        self.kernels, self.about = 0, 0  # compiled for this scene, and how many one of this sort took
        self.begun = self.remembered = False
        self.heard: list[Callable[[str, float, float], None]] = []

    def hear(self, compiled: Callable, function: Callable | None) -> None:
        """From mpm.linking: a kernel begins (`function` is itself), one of its functions is lowered, it is ready (None)."""
        now, kernel = time.perf_counter(), compiled.__name__
        if function is compiled:
            self.began, self.functions = now, 0
            self.kernels += 1
        elif function is None:
            took = now - self.began
            self.total += took
            if 2 * self.functions >= met().get(kernel, (0, 0.0))[0]:  # else its process had most of its functions from the kernel before
                keep(kernel, self.functions, took)
            for listener in self.heard:
                listener("", 0.0, took)
            return
        else:
            self.functions += 1
        about, seconds = met().get(kernel, MET.get(kernel, USUAL))
        about = max(about, self.functions)
        left = max(seconds - (now - self.began), LINKING * seconds)
        functions, kernels = f"function {self.functions} of about {about}", f"kernel {self.kernels} of about {max(self.kernels, self.about)}"
        name = NAMES.get(kernel, f"the kernel {kernel}")
        text = f"compiling {name}: {left:.0f} s left, {functions}, {kernels}, once on this machine"  # a narrow terminal cuts its end
        for listener in self.heard:
            listener(text, seconds, 0.0)

    def wait(self, kernel: str, process: subprocess.Popen) -> None:
        """Until a process beside this one has compiled a kernel, which counts as compiling here."""
        began = time.perf_counter()
        for listener in self.heard:
            listener(f"compiling {NAMES[kernel]} in a process beside this one, once on this machine", met().get(kernel, MET[kernel])[1], 0.0)
        process.wait()
        took = time.perf_counter() - began
        self.total += took
        for listener in self.heard:
            listener("", 0.0, took)


spent = Spent()


def seconds() -> float:
    """Wall time that this process has spent on compiling kernels."""
    return spent.total


@contextlib.contextmanager
def say(listener: Callable[[str, float, float], None]) -> Iterator[None]:
    """Tell `listener` of what is compiled while this lasts: a sentence, the seconds that the kernel is expected to take, and when it is ready those it took."""
    spent.heard.append(listener)
    try:
        yield
    finally:
        spent.heard.remove(listener)


def met() -> dict[str, tuple[int, float]]:
    """Functions and seconds of the kernels that this machine has compiled, by name."""
    try:
        found = json.loads((kernels() / "kernels.json").read_text())
        return {str(name): (int(functions), float(took)) for name, (functions, took) in found.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def keep(kernel: str, functions: int, took: float) -> None:
    """Note what a kernel took. Two processes may lose each other's note; none may read half of one."""
    with contextlib.suppress(OSError):
        write(kernels() / "kernels.json", json.dumps(met() | {kernel: (functions, round(took, 3))}))


def write(path: Path, text: str) -> None:
    with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False) as file:
        file.write(text)
    os.replace(file.name, path)


def kind(config: Any) -> Any:
    """A config without its numbers: what tells which kernels it needs."""
    if isinstance(config, dict):
        return {key: kind(value) for key, value in config.items()}
    if isinstance(config, list | tuple):
        kinds = [kind(value) for value in config]
        return "numbers" if all(one == "number" for one in kinds) else kinds
    return "number" if isinstance(config, int | float) and not isinstance(config, bool) else config


def place(config: dict) -> Path:
    """The file that stands for: this config's kernels are in the cache."""
    source = hash_of(sorted(contained("simulation") | contained("rigid") | contained("point")))
    words = {key: value if key == "grid" else kind(value) for key, value in config.items() if key not in UNLIKE}
    words["grid"] = words.get("grid", {}).get("dimension")
    made = hashlib.sha256(json.dumps([source, words], sort_keys=True, default=str).encode()).hexdigest()[:16]
    return kernels() / "known" / made


def sort(experiment: Any) -> str:
    """Scenes that call as many kernels."""
    heat = any(material.heat is not None for material in experiment.materials.values())
    return f"{'moving' if experiment.moving else 'at rest'}, {experiment.grid.dimension}, {experiment.method.mechanics}{', heat' if heat else ''}"


def expect(experiment: Any) -> None:
    """How many kernels this process may have to compile: as many as such a scene took on this machine."""
    spent.about, _ = met().get(f"scene {sort(experiment)}", (KERNELS["moving" if experiment.moving else "at rest"], 0.0))


def begun() -> bool:
    """Whether this was asked before: the first run of a process is the one that may have to compile. Kernels count from here on: others were not its."""
    before, spent.begun, spent.kernels = spent.begun, True, 0
    return before


def remember(experiment: Any, again: bool) -> None:
    """The kernels of this experiment are in the cache. Noted once a process, and `again` where it had to compile some."""
    if again or not spent.remembered:
        spent.remembered = True
        if (name := f"scene {sort(experiment)}") and spent.kernels > met().get(name, (0, 0.0))[0]:
            keep(name, spent.kernels, 0.0)
        with contextlib.suppress(OSError):
            path = place(experiment.resolved())
            path.parent.mkdir(exist_ok=True)
            path.touch()
    spent.kernels = 0  # those of the next scene of this process are its own


def expected(experiment: Any) -> float:
    """About how many seconds this machine takes to compile what an experiment needs; 0 where its kernels are in the cache."""
    if place(experiment.resolved()).exists():
        return 0.0
    if not experiment.moving:
        return RESTING
    here = met()
    step, heat, touching = (here.get(name, MET[name])[1] for name in ("advance", "heat_chebyshev", "advance_touching"))
    warm = any(material.heat is not None for material in experiment.materials.values())
    return MOVING + step + heat * warm + touching * meets(experiment)


def meets(experiment: Any) -> bool:
    """Whether a config names what its bodies may touch. That they reach a wall that it does not name is not foreseen."""
    return len(experiment.bodies) > 1 or bool(experiment.tools) or any(wall.acts == "contact" for wall in experiment.walls.values())
