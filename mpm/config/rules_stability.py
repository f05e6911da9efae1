"""Rules of `stability:`: its axes and panels are read as a sweep is, and what is wrong is told where it stands."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from mpm.config.explain import Finding
from mpm.config.explain import findings as explained
from mpm.config.names import ROOT, Names
from mpm.config.partial import MISSING, Unknown
from mpm.config.problems import listed
from mpm.config.sweep import Sweep
from mpm.config.vary import Vary


def axes_of(stability: Any) -> Sweep:
    """The coarse grid of a map, as a sweep: across, along, and the panels as points."""
    panels = tuple(dict(panel) for panel in stability.panels.values())
    return Sweep(axes={**stability.across, **stability.along}, points=panels if any(panels) else ())


def findings(experiment: Any) -> Iterator[Finding]:
    """What is wrong with the map of an experiment, whole or loose."""
    stability = experiment.stability
    if stability is None or stability is MISSING:
        return
    try:
        across, along, labels = dict(stability.across), dict(stability.along), list(stability.panels)
        if set(across) & set(along):
            yield Finding(("stability", "along"), "the axes are the same parameter", "two different parameters", on_key=True)
            return
        try:
            sweep = axes_of(stability)
        except ValidationError as error:  # what is missing is told already, where the section itself is checked
            told = explained(error, ROOT.under("sweep"), ("sweep",))
            yield from (replace(found, path=moved(found.path, across, labels)) for found in told if found.given is not MISSING)
            return
        vary = Vary(sweep, Names(experiment))
        vary.read()
        for found in vary.found:
            yield replace(found, path=moved(found.path, across, labels))
        for index, line in enumerate(stability.lines):
            for panel in line.panels:
                if panel not in labels:
                    yield Finding(("stability", "lines", index, "panels"), f"there is no panel {panel!r}", listed(labels) or "no panels")
        if stability.steps is not None and not vary.found and getattr(Names(experiment).resolve(next(iter(along)))[1].quantity, "unit", "") != "s":
            yield Finding(("stability", "steps"), "the vertical axis is no time step, so runs cannot last a number of it", "no `steps`", on_key=True)
    except Unknown:
        return


def moved(path: tuple, across: dict, labels: list[str]) -> tuple:
    """A place in the sweep that stands for the map, as a place in the map."""
    if path[:2] == ("sweep", "axes") and len(path) > 2:
        return ("stability", "across" if path[2] in across else "along", *path[2:])
    if path[:2] == ("sweep", "points"):
        return ("stability", "panels", *((labels[path[2]], *path[3:]) if len(path) > 2 else ()))
    return ("stability",)
