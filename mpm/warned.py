"""What a careful user wants to know of a run that ended well. Warnings are values, as outcomes are (mpm.outcome): a run ends with a list, possibly empty.

A warning is one text, `kind: what was seen; what to do`. Its kind is a key of KINDS, by which warnings are flagged, counted and drawn.
To add a kind: a line here, and where it is seen (mpm.review from what a run recorded, mpm.guards while it runs) a call of `warning`.
"""

from collections.abc import Iterable

KINDS = {
    "volume": "a law of flow that keeps its volume has a large `p0`; a body that is squeezed wants a larger bulk modulus",
    "temperature": "`method.temperature: apic`, or leave `method.bounds` at auto; where no body has `elastic`, `method.rigid: bounded`",
    "heat": "shorter heat steps, smaller cells, or `method.temperature: apic`",
    "energy": "smaller cells, `method.transfer` affine_flip or flip, which take less from motion than apic, or explicit steps where they are implicit",
    "inertia": "lower `time.scale`",
    "torn": "more `method.particles`, or larger cells",
    "thin": "smaller cells",
    "probe": "put the probe where material stays",
    "edge": "enlarge `grid.size`, or say under `walls` what stands there",
    "step": "a `time.step` of which `output.every`, snapshots and heat steps are whole numbers",
    "depth": "smaller cells, a longer run, or leave the exchange out where hardly anything is conducted",
    "near": "let them meet for heat to pass, or take cells smaller than the gap",
    "late": "a longer `time.end`, or an earlier `from`",
    "ring": "shorter heat steps (`method.heat_step`), a larger `time.scale`, or `method.mechanics: implicit`",
    "traction": "`method.frame: total`, which bears tractions on any surface at any strain; force and moment of the load as a whole are right",
    "narrow": "smaller cells, or trust its force alone: over the way it is off by a tenth or so, and pressure and area mean nothing",
    "bend": "`method.frame: total`; where that is refused, `method.gradient: bspline` and `method.particles: 4`",
    "pieces": "smaller cells, or weld the two: beyond three times they may enter each other between the pieces of their surfaces",
    "overlap": "let nothing come or grow within another; until they are apart, the force between them and the energy that it gives mean nothing",
}


def warning(kind: str, said: str, advice: str = "") -> str:
    """The text of a warning; the table's advice unless told."""
    return f"{kind}: {said}; {advice or KINDS[kind]}"


def kinds(warnings: Iterable[str]) -> tuple[str, ...]:
    """The kinds of these warnings, in the order of the table."""
    there = {text.partition(":")[0] for text in warnings}
    return tuple(kind for kind in KINDS if kind in there)


def flags(warnings: Iterable[str]) -> int:
    """The kinds as bits: 1 for the first of the table, 2 for the second, 4, 8, ..."""
    order = list(KINDS)
    return sum(1 << order.index(kind) for kind in kinds(warnings))


def counted(found: dict[str, int]) -> str:
    """How many points have each kind, the commonest first: `volume 7, temperature 4`."""
    return ", ".join(f"{kind} {count}" for kind, count in sorted(found.items(), key=lambda item: -item[1]) if count)
