"""Which smaller models a tolerance allows, and `model: auto`: the smallest of them, checked after its run.

A reduction is taken where its own estimate, or else a pilot, leaves the sum of all that is dropped below the tolerance. Candidates run from the
smallest; what can only be seen in its run (a time to reach a temperature, a stress) is looked at then, and a candidate in doubt gives way to the next
larger one, the full model last. All of it follows from the point's own values, so a sweep reduces point by point and reproduces bit by bit.
"""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

from mpm.outcome import Outcome
from mpm.reduce.difference import pilot, shifts, widest
from mpm.reduce.dimension import axisymmetric, fewer
from mpm.reduce.lumped import lumped
from mpm.reduce.offers import Offer, asked, driving, refused
from mpm.reduce.physics import no_flow, no_heat, one_way, rigid
from mpm.scene.refusal import SceneError

PHYSICS = {"rigid": rigid, "no flow": no_flow, "no heat": no_heat, "one way": one_way}
DIRECTIONS = {"axisymmetric": axisymmetric, "fewer directions": fewer}
MENU = PHYSICS | DIRECTIONS | {"lumped": lumped}
HOPELESS = 30.0  # an estimate so many times the tolerance is not worth a pilot
LATE = "time: "
PILOT = 0.3  # of the full model's time: what a pilot may cost


@dataclass(frozen=True)
class Said:
    """A reduction and what became of it: predicted error and by what (`symmetry`, `estimate`, `pilot`), or why it is not taken."""

    name: str
    dropped: str
    predicted: float | None
    by: str
    why: str = ""


@dataclass(frozen=True)
class Taken:
    """A reduction that is taken; `key` is its name in the menu."""

    offer: Offer
    said: Said
    key: str = ""


def offered(name: str, experiment: Any, left: float) -> Offer | str:
    """What one reduction of the menu makes of an experiment; a smaller config that is wrong (a probe outside it, say) is no offer."""
    from mpm.config import ConfigError

    try:
        return MENU[name](experiment, left)
    except ConfigError as error:
        return f"the smaller config is wrong: {str(error).splitlines()[0]}"


def judged(experiment: Any, name: str, left: float, run: Callable | None) -> Taken | Said:
    """One reduction of an experiment against what is left of the tolerance; `run` runs pilots, None forbids them."""
    offer = offered(name, experiment, left)
    if isinstance(offer, str):
        return Said(name, "", None, "", offer)
    error, by = offer.error, "symmetry" if offer.error == 0 else "estimate"
    if error is not None and error <= left:
        return Taken(offer, Said(offer.name, offer.dropped, error, by), name)
    why = "no estimate" if error is None else f"estimated error {error:.2g}"
    if run is None or left <= 0 or (error is not None and error > HOPELESS * left):
        return Said(offer.name, offer.dropped, error, by, why)
    if not worthwhile(experiment):
        return Said(offer.name, offer.dropped, error, by, f"{why}, and a pilot would cost as much as the run")
    piloted, trouble = pilot(experiment, lambda rough: offered(name, rough, left), run)
    if piloted <= left:
        return Taken(offer, Said(offer.name, offer.dropped, piloted, "pilot"), name)
    return Said(offer.name, offer.dropped, piloted, "pilot", trouble or f"{why}; a pilot differs by {piloted:.2g}")


def worthwhile(experiment: Any) -> bool:
    """Whether a pilot is much cheaper than the run."""
    from mpm.costs import estimate
    from mpm.reduce.difference import rough_form

    rough = rough_form(experiment)
    try:
        return rough is not None and estimate(rough)["seconds"] < PILOT * estimate(experiment)["seconds"]
    except SceneError:
        return False  # one of them cannot be run


def greedy(experiment: Any, names: Any, left: float, run: Callable | None, passed: list[Said]) -> list[Taken]:
    """Reductions taken one after the other, each of what the one before left; those that are not collect in `passed`."""
    taken: list[Taken] = []
    for name in names:
        found = judged(taken[-1].offer.experiment if taken else experiment, name, left, run)
        if isinstance(found, Taken):
            taken.append(found)
            left -= found.said.predicted
        else:
            passed.append(found)
    return taken


def candidates(experiment: Any, tolerance: float, run: Callable | None, passed: list[Said]) -> Iterator[list[Taken]]:
    """Chains of reductions from the smallest model to the full one (an empty chain); what is not taken, and why, collects in `passed`."""
    if said := refused(experiment, asked(experiment)):
        passed.append(Said("any", "", None, "", said))
        yield []
        return
    physics = greedy(experiment, PHYSICS, tolerance, run, passed)
    base = physics[-1].offer.experiment if physics else experiment
    left = tolerance - sum(one.said.predicted for one in physics)
    for names in (["lumped"], DIRECTIONS):
        more = greedy(base, names, left, run, passed)
        yield from ([*physics, *more[:k]] for k in range(len(more), 0, -1))
    yield from (physics[:k] for k in range(len(physics), -1, -1))


def smallest(experiment: Any, run: Callable) -> Any:
    """The Run of an experiment whose config says `model: auto`. `run(experiment)` runs an ordinary one."""
    began, tolerance = time.perf_counter(), experiment.model.tolerance
    stop = []

    def attempt(one: Any) -> Any:
        done = run(one)
        if done.outcome.kind == "budget":
            stop.append(done)
            raise Stopped
        return done

    doubts: list[Said] = []
    passed: list[Said] = []
    try:
        for chain in candidates(experiment, tolerance, attempt, passed):
            done, predicted, why = tried(experiment, chain, tolerance, attempt)
            if why.startswith(LATE):
                predicted, trouble = whole(experiment, chain, attempt)
                chain = [replace(one, said=replace(one.said, by="pilot")) for one in chain]
                why = "" if predicted <= tolerance else f"{why}, {trouble or f'and a pilot differs by {predicted:.2g}'}"
            if not why:
                break
            doubts.append(Said(" + ".join(one.offer.name for one in chain), "", predicted, "run", why))
    except Stopped:
        done, chain, predicted = stop[0], [], 0.0
        done.series, done.finals, done.times = {}, {}, done.times[:0]
    facts = {"tolerance": tolerance, "predicted": predicted, "dropped": [asdict(one.said) for one in chain],
             "kept": [asdict(one) for one in (*doubts, *passed)]}  # fmt: skip
    if chain:
        facts["config"] = chain[-1].offer.experiment.key()
    done.facts["model"] = {"name": named(chain), **facts}
    done.finals["model_error"] = predicted
    done.wall_time = time.perf_counter() - began
    return done


def likely(experiment: Any) -> Any:
    """The model that is tried first, as far as estimates alone tell: what to compile ahead."""
    chain = next(candidates(experiment, experiment.model.tolerance, None, []))
    return chain[-1].offer.experiment if chain else experiment.model_copy(update={"model": None})


class Stopped(Exception):
    """The clock or the user ended a run on the way."""


def tried(experiment: Any, chain: list[Taken], tolerance: float, run: Callable) -> tuple[Any, float, str]:
    """(Run in the full model's names, predicted error, why it cannot stand) of one candidate."""
    predicted = sum(one.said.predicted for one in chain)
    if not chain:
        return run(experiment), predicted, ""
    try:
        done = run(chain[-1].offer.experiment)
    except SceneError as error:  # a valid config that no method runs: the larger model may
        return None, predicted, str(error)
    if not done.outcome.ok:
        return done, predicted, f"it ended early: {said_of(done.outcome)}"
    for one in reversed(chain):
        if why := one.offer.doubt(done):
            return done, predicted, why
        done = one.offer.back(done)
    lost = [name for name in asked(experiment).names if not name.startswith("time_to_") and name not in done.series]
    if lost:
        return done, predicted, f"it does not give {', '.join(lost)}"
    name, shift = widest(shifts(done, experiment, predicted, driving(experiment)))
    if shift > tolerance:
        return done, predicted, f"{LATE}{name} could be off by {shift:.2g}" if math.isfinite(shift) else f"{LATE}{name} may or may not be reached"
    return done, max(predicted, shift), ""


def whole(experiment: Any, chain: list[Taken], run: Callable) -> tuple[float, str]:
    """A pilot of a whole chain: (what it differs by, why there is none)."""
    if not worthwhile(experiment):
        return math.inf, "and a pilot would cost as much as the run"

    def follow(rough: Any) -> Offer | str:
        offers: list[Offer] = []
        for one in chain:
            found = offered(one.key, offers[-1].experiment if offers else rough, 1.0)
            if isinstance(found, str):
                return found
            offers.append(found)
        return Chained(offers[-1].name, "", offers[-1].experiment, None, offers=tuple(offers))

    return pilot(experiment, follow, run)


@dataclass(frozen=True)
class Chained(Offer):
    """Several reductions as one."""

    offers: tuple[Offer, ...] = ()

    def back(self, run: Any) -> Any:
        """Through all of them."""
        for one in reversed(self.offers):
            run = one.back(run)
        return run


def said_of(result: Outcome) -> str:
    """An outcome in a word."""
    return result.message or result.kind


def named(chain: list[Taken]) -> str:
    """A chain in words."""
    return " + ".join(one.offer.name for one in chain) or "full"
