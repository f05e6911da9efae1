"""How far two runs lie apart in what a config asks for, and pilots: a coarse run of the full model against one of the smaller.

Temperatures   the largest difference over time, as a share of the scene's driving difference
Times to reach relative to the time itself; reached in one run alone is infinitely far apart
All else       the largest difference over time, relative to how much the quantity changes in the full run (mpm.reduce.change)
"""

import math
from typing import Any

import numpy as np

from mpm.reduce.change import size
from mpm.reduce.offers import Asked, Offer, asked, bare, crossing, driving

COARSER = (2, 3, 4)  # a pilot's cell over the config's
CAUTION = 1.5  # a pilot's difference is multiplied by it


def gap(full: Any, small: Any, want: Asked, span: float) -> dict[str, float]:
    """Difference of two Runs by asked name; infinite where one run did not complete or a quantity is missing."""
    names = want.names or tuple(name for name in full.series if not name.startswith("heat_ledger"))
    if not (full.outcome.ok and small.outcome.ok):
        return dict.fromkeys(names, math.inf)
    return {name: apart(full, small, name, span) for name in names if name != "heat_ledger"}


def apart(full: Any, small: Any, name: str, span: float) -> float:
    """Difference in one quantity."""
    if name.startswith("time_to_"):
        a, b = full.finals.get(name, math.nan), small.finals.get(name, math.nan)
        return 0.0 if math.isnan(a) and math.isnan(b) else abs(a - b) / a if a > 0 and not math.isnan(b) else math.inf
    if name not in full.series:
        return 0.0
    a, b = full.series[name], small.series.get(name)
    if b is None or len(b) != len(a):
        return math.inf
    return float(np.max(np.abs(a - b))) / size(name, full.series, float(a[-1]), span)


def shifts(run: Any, experiment: Any, error: float, span: float) -> dict[str, float]:
    """What an error of temperatures (a share of `span`) does to the times at which probes reach a level: relative, from the run's own curves."""
    from mpm.records.variables import dataset_name, threshold

    found = {}
    for name in experiment.output.observables:
        if (at := threshold(name)) is not None:
            curve = run.series[f"temperature_{at.probe}"]
            times = [crossing(curve, run.times, at.kelvin + sign * error * span) for sign in (-1, 0, 1)]
            found[dataset_name(name)] = spread(times)
    return found


def spread(times: list[float]) -> float:
    """Largest relative distance of the outer times from the middle one; 0 where none is reached, infinite where some are."""
    reached = [t for t in times if not math.isnan(t)]
    if not reached:
        return 0.0
    return max(abs(t - times[1]) for t in reached) / times[1] if len(reached) == 3 and times[1] > 0 else math.inf


def pilot(experiment: Any, reduce: Any, run: Any) -> tuple[float, str]:
    """(CAUTION times the largest difference, "") between the coarse experiment and what `reduce` makes of it; (infinity, why) where it cannot be had."""
    from mpm.scene.refusal import SceneError

    rough = rough_form(experiment)
    if rough is None:
        return math.inf, "no pilot: there is no coarser grid"
    try:
        offer = reduce(rough)
        if not isinstance(offer, Offer):
            return math.inf, offer
        full, small = run(rough), offer.back(run(offer.experiment))
    except SceneError as error:
        return math.inf, f"no pilot: {str(error).splitlines()[0]}"
    if not (full.outcome.ok and small.outcome.ok):
        return math.inf, f"the pilot ended early: {full.outcome.kind if not full.outcome.ok else small.outcome.kind}"
    name, most = widest(gap(full, small, asked(rough), driving(rough)))
    return CAUTION * most, "" if math.isfinite(most) else f"in a pilot only one of them gives {name}"


def rough_form(experiment: Any) -> Any:
    """The experiment on a coarser grid; None where there is none."""
    from mpm.config import ConfigError, load

    data = bare(experiment)
    data["grid"]["cell"] = coarse(experiment)
    try:
        return load(data) if data["grid"]["cell"] > experiment.grid.cell else None
    except ConfigError:
        return None  # a feature that a coarse cell cannot hold


def widest(found: dict[str, float]) -> tuple[str, float]:
    """The entry with the largest value."""
    name = max(found, key=found.get, default="")
    return name, found.get(name, 0.0)


def coarse(experiment: Any) -> float:
    """Two, three or four cells as one, of which every side of the domain has a whole number; the config's own where there is no such cell."""
    common = math.gcd(*(round(size / experiment.grid.cell) for size in experiment.grid.size))
    return experiment.grid.cell * min((k for k in COARSER if common % k == 0), default=1)
