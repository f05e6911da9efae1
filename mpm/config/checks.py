"""Checks across sections: names exist, vectors have the grid's dimension, physics has what it needs.

Each rule sees one item and yields findings. A rule that meets a value that is MISSING (already reported) is given up alone.
To add a rule: write it, list it in `RULES` with the items it is for.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from mpm.config import rules_chart as charting
from mpm.config import rules_fit as fitting
from mpm.config import rules_forces as forces
from mpm.config import rules_frame as framing
from mpm.config import rules_inflow as pouring
from mpm.config import rules_mechanics as steps
from mpm.config import rules_output as output
from mpm.config import rules_point as point
from mpm.config import rules_scene as scene
from mpm.config import rules_setting as setting
from mpm.config import rules_size as size
from mpm.config import rules_sources as within
from mpm.config import rules_tools as tools
from mpm.config.explain import Finding
from mpm.config.partial import Unknown
from mpm.config.problems import MOST_FINDINGS
from mpm.config.schema_paths import Path, Slot

Rule = Callable[..., Iterable[Finding]]


def check(experiment: Any) -> list[Finding]:
    """Everything that is wrong across sections of an experiment, whole or loose."""
    found: list[Finding] = []
    for rule, items in RULES:
        try:
            listed = list(items(experiment))
        except Unknown:
            continue
        for item in listed:
            if len(found) > MOST_FINDINGS:
                return found
            try:
                found += list(rule(experiment, *item))
            except Unknown:
                continue
            except KeyError:
                if not found:  # else it looked up a name that is not there, which `scene.names` has told
                    raise
    return found


def unread(path: Path, slot: Slot) -> bool:
    """Whether no rule reads the value of a path, so that another number cannot break one: those of materials and surfaces,
    but for E, which must be constant where there is elastic heating. Where only some points have kappa = 0, those fail as they run (scene/exchange.py)."""
    return path[0] in ("materials", "surfaces") and slot.quantity is not None and path[-2:] != ("hencky", "E")


def once(experiment: Any) -> Iterator[tuple]:
    """For a rule of the whole experiment: one call."""
    yield ()


def each(section: str) -> Callable[[Any], Iterator[tuple]]:
    """Items of a mapping or list: (key, item)."""

    def items(experiment: Any) -> Iterator[tuple]:
        content = getattr(experiment, section)
        yield from enumerate(content) if isinstance(content, tuple) else list(content.items())

    return items


RULES: list[tuple[Rule, Callable[[Any], Iterator[tuple]]]] = [
    (fitting.parameters, once),
    (scene.names, once),
    (scene.grid, once),
    (size.count, once),
    (size.steps, once),
    (size.whole, once),
    (scene.body, each("bodies")),
    (scene.body_shape, each("bodies")),
    (scene.body_motion, each("bodies")),
    (pouring.inflow, each("bodies")),
    (pouring.methods, once),
    (scene.material, each("materials")),
    (setting.setting, each("materials")),
    (scene.anything, once),
    (scene.surface, each("surfaces")),
    (scene.surface_conducts, each("surfaces")),
    (scene.surface_side, each("surfaces")),
    (scene.surface_twice, each("surfaces")),
    (scene.surface_names, once),
    (forces.load, each("loads")),
    (within.source, each("sources")),
    (within.formula, each("sources")),
    (within.exact, once),
    (scene.contact, each("contacts")),
    (scene.walls, each("walls")),
    (tools.tool, each("tools")),
    (tools.motion, each("tools")),
    (tools.met, output.observables),
    (scene.mechanics, once),
    (forces.gravity, once),
    (scene.scaling, once),
    (output.clock, once),
    (output.probe, output.probes),
    (output.probe_home, output.probes),
    (output.observable, output.observables),
    (setting.observable, output.observables),
    (output.apart, once),
    (output.overview, once),
    (output.snapshots, once),
    (scene.method, once),
    (output.exact, once),
    (point.grid, once),
    (point.body, each("bodies")),
    (point.exchange, each("surfaces")),
    (point.alone, once),
    (point.loading, once),
    (point.stages, once),
    (point.clock, once),
    (point.output, once),
    (point.heating, each("materials")),
    (charting.chart, once),
    (fitting.fit, once),
    (fitting.refine, once),
    (framing.frame, once),
    (framing.frame_wall, each("walls")),
    (framing.frame_material, each("materials")),
    (steps.mechanics, once),
    (steps.mechanics_material, each("materials")),
]
