"""Rules of what sets (mpm.config.laws.Set): it has heat, and one rate."""

from collections.abc import Iterator
from typing import Any

from mpm.config.explain import Finding
from mpm.config.laws import sets


def setting(experiment: Any, name: str, item: Any) -> Iterator[Finding]:
    """Of one material."""
    found, where = sets(item), ("materials", name)
    rates = {place: one.rate for place, one in found.items() if one.rate is not None}
    for place in found:
        if item.heat is None:
            yield Finding((*where, *place, "set"), "what sets follows temperature, and the material has no heat", f"materials.{name}.heat", on_key=True)
        if not rates:
            allowed = "rate: {arrhenius: {k0: ..., activation: ...}}, or a number [1/s]"
            yield Finding((*where, *place, "set"), "no rate of setting is given", allowed, on_key=True)
    for place, rate in rates.items():
        first = next(iter(rates))
        if rate != rates[first]:
            said = f"a material has one degree of setting, and {'.'.join(first)} gives it another rate"
            yield Finding((*where, *place, "set", "rate"), said, "the same rate, or none here", on_key=True)


def observable(experiment: Any, index: int, name: str, *_: bool) -> Iterator[Finding]:
    """Something sets where its degree is asked for."""
    if name.startswith("setting.") and not any(sets(material) for material in experiment.materials.values()):
        allowed = "M: {set: {raw: ..., baked: ..., rate: ...}} in a material of a body"
        yield Finding(("output", "observables", index), "no material sets", allowed, given=name)
