"""The smaller models of an experiment side by side, for `mpm plan`: error by own estimate, by a pilot where a tolerance is named, and what each would save."""

from collections.abc import Callable
from typing import Any

from mpm.costs import estimate
from mpm.reduce.choose import DIRECTIONS, PHYSICS, Stopped, candidates, named, offered
from mpm.reduce.difference import pilot, rough_form
from mpm.reduce.offers import Offer, asked, refused

LEFT = 0.01  # the tolerance that choices inside an offer see where none is named
LONGEST = 30.0  # estimated seconds that a pilot may take


def listing(experiment: Any, tolerance: float | None = None, run: Callable | None = None) -> dict[str, Any]:
    """Every reduction by itself, and with a tolerance the chain that `model: auto` would begin with. `run` runs pilots."""
    if said := refused(experiment, asked(experiment)):
        return {"none": said, "models": [], "auto": None}
    left, seconds = tolerance or LEFT, estimate(experiment)["seconds"]
    rows, base, before = [], experiment, None
    for names in (PHYSICS, [*DIRECTIONS, "lumped"]):
        for name in names:
            offer = offered(name, base, left)
            if isinstance(offer, Offer):
                rows.append(row(before, name, offer, base, seconds, left, run))
        if names is PHYSICS and isinstance(rigid := offered("rigid", experiment, left), Offer):
            base, before = rigid.experiment, rigid
    return {"none": "" if rows else "no smaller model answers what is asked for", "models": rows, "auto": chosen(experiment, tolerance, run)}


def row(before: Offer | None, name: str, offer: Offer, base: Any, seconds: float, left: float, run: Callable | None) -> dict[str, Any]:
    """One smaller model. The pilot is of this step alone (after `rigid +`: against the rigid model)."""
    took = estimate(offer.experiment)["seconds"]
    errors = (offer.error, *([before.error] if before else []))
    whole = f"{before.name} + {offer.name}" if before else offer.name
    found = {"name": whole, "dropped": offer.dropped, "error": None if None in errors else sum(errors), "seconds": took,
             "saving": seconds / took if took > 0 else None, "pilot": None, "pilot_said": ""}  # fmt: skip
    if run is None:
        return found
    rough = rough_form(base)
    if rough is None or estimate(rough)["seconds"] > LONGEST:
        return found | {"pilot_said": "there is no coarser grid" if rough is None else "a pilot would take too long"}
    error, trouble = pilot(base, lambda one: offered(name, one, left), run)
    return found | ({"pilot_said": trouble} if trouble else {"pilot": error})


def chosen(experiment: Any, tolerance: float | None, run: Callable | None) -> dict[str, Any] | None:
    """What `model: auto` would try first at a tolerance."""
    if tolerance is None:
        return None
    passed: list = []
    try:
        chain = next(candidates(experiment, tolerance, run, passed))
    except Stopped:
        chain = []
    last = chain[-1].offer.experiment if chain else experiment
    predicted = sum(one.said.predicted for one in chain)
    return {"tolerance": tolerance, "name": named(chain), "predicted": predicted, "seconds": estimate(last)["seconds"]}


def models_in_words(found: dict[str, Any]) -> list[str]:
    """The same in words, a line each."""
    if found["none"]:
        return [f"smaller   none: {found['none']}"]
    lines = ["smaller models"]
    for one in found["models"]:
        error = "no estimate of its error" if one["error"] is None else "exact by symmetry" if one["error"] == 0 else f"error about {one['error']:.2g}"
        if one["pilot"] is not None:
            error += f" (a pilot: {one['pilot']:.2g})"
        elif one["pilot_said"]:
            error += f" ({one['pilot_said']})"
        lines.append(f"  {one['name']:<22} without {one['dropped']}; {error}; {gain(one['saving'])}, {one['seconds']:.2g} s")
    if found["auto"]:
        auto = found["auto"]
        lines.append(f"  at {auto['tolerance']:.3g}, model: auto would take {auto['name']}: predicted error {auto['predicted']:.2g}, {auto['seconds']:.2g} s")
    return lines


def gain(saving: float | None) -> str:
    """What it saves, by the estimates of cost."""
    return "no cost left" if saving is None else f"{saving:.3g} times as fast" if saving > 1.05 else "no faster"
