"""Numbers for people: results with what they mean and the units that one reads, those that the config asked for first."""

from typing import Any

FAMILIES = {
    "temperature and heat": ("temperature", "time_to", "heat", "area", "misfit"),
    "shape and place": ("position", "extent", "radius", "volume", "mass", "J_", "displacement", "tip"),
    "motion": ("velocity", "momentum"),
    "stress and strain": ("stress", "strain", "pressure", "kirchhoff"),
    "energy and work": ("energy", "dissipation", "work"),
    "errors": ("error",),
}
OTHER = "more"


def lines(record: Any, experiment: Any, everything: bool = False) -> list[str]:
    """A line a number. Without `everything` those that the config lists, and its probes'; where it lists nothing all that are not zero."""
    from mpm.records.variables import dataset_name

    asked = [dataset_name(name) for name in experiment.output.observables]
    asked += [f"{what}_{probe}" for probe in experiment.output.probes for what in ("temperature", "misfit")]
    first = [name for name in dict.fromkeys(asked) if name in record.finals]
    rest = [name for name in record.finals if name not in first]
    left = [] if everything else rest if first else [name for name in rest if record.finals[name] == 0]
    groups = {"asked for": first} if first else {}
    for name in (name for name in rest if name not in left):
        family = next((title for title, starts in FAMILIES.items() if name.startswith(starts)), OTHER)
        groups.setdefault(family, []).append(name)
    told = [(title, [row(name, record.finals[name], experiment) for name in names]) for title, names in groups.items()]
    every = [one for _, rows in told for one in rows]
    widths = [max((len(one[column]) for one in every), default=0) for column in (0, 1)]
    made = []
    for title, rows in told:
        made.append(f"{title}:")
        made += [f"  {label:<{widths[0]}}  {value:<{widths[1]}}  {name}" for label, value, name in rows]
    if left:
        made.append(f"  ({len(left)} {'more' if first else 'more, all 0,'} with --all)")
    return made


def row(name: str, value: float, experiment: Any) -> tuple[str, str, str]:
    """(meaning, value with its unit, name in the dataset)."""
    from mpm.plots import words
    from mpm.records.variables import describe

    found = describe(name, experiment.grid.dimension, experiment.output.probes, experiment.bodies)
    return words.title_case(words.short(found.long_name)), value_in_words(value, found.units, words.is_temperature(name)), name


def value_in_words(value: float, units: str, temperature: bool) -> str:
    """`31.30 °C (304.45 K)`, `8.139 mm`, `11.5 min (688 s)`, `not reached`."""
    from mpm.plots import words

    if value != value:  # NaN
        return "not reached" if units == "s" else "none"
    scale = words.scale(value, units, temperature)
    shown = f"{words.number(float(scale(value)), 4)} {scale.units}".strip()
    if scale.units in ("°C", "min", "h"):
        shown += f" ({words.number(value, 5)} {units})"
    return shown
