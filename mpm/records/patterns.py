"""Names of variables that hold other names (of probes, walls, tools, pairs of bodies): what is met, by its first word, and patterns."""

import re
from collections.abc import Iterable
from itertools import permutations

MET = {  # what a wall, a tool or another body does: <what>.<of>, with a direction behind it for forces and torques; {} and {} are those of `meets`
    "force": ("N", "force on {} by {}, mean since the record before"),
    "torque": ("N m", "torque on {} by {}, mean since the record before, about the tool's centre or the origin of coordinates"),
    "area": ("m2", "area of {} in touch with {}, mean since the record before"),
    "heat": ("J", "heat taken in by {} from {} since the start"),
    "travel": ("m", "how far {1} has moved since the start"),
    "hardness": ("N", "largest force of the first bite of {1}"),
    "cohesiveness": ("1", "work of the second bite of {1} over that of the first"),
    "springiness": ("1", "way of the second bite of {1} over that of the first"),
}
BITES = ("hardness", "cohesiveness", "springiness")  # one number a run
THRESHOLD = re.compile(r"time_to\.(?P<probe>[A-Za-z_]\w*)\.(?P<value>-?\d+(?:\.\d+)?)_(?P<unit>degC|K)")
IN_DATASET = r"time_to_(?P<probe>{})_(?P<value>-?\d+(?:_\d+)?)_(?P<unit>degC|K)"
PROBED = re.compile(r"(?P<field>displacement|stress)[._](?P<probe>[A-Za-z_]\w*)_(?P<part>[xyzr]|[xyzrt]{2})")
OF = "area|heat|hardness|cohesiveness|springiness"
MEETING = re.compile(rf"(?:(?P<turned>force|torque|travel)[._](?P<on>[A-Za-z_]\w*)_(?P<axis>[xyzr])|(?P<what>{OF})[._](?P<of>[A-Za-z_]\w*))")
AT_PROBE = ("temperature", "velocity")  # fields that a probe's name may follow at once
SINGLE = ("temperature", "heat_total", "mass", "volume", "momentum", "position", "extent", "velocity_max", "J")  # families told of one body


def meets(what: str, of: str, bodies: Iterable[str] = ()) -> tuple[str, str]:
    """Who is acted on and by whom, in words: `patty` and `cheese` of the pair patty_cheese, `bodies` and `press` of a tool. Where a name of the scene's
    bodies ends, and whether the heat of `hot_pan` is that of a pair, is known from `bodies` alone."""
    guess = of.partition("_") if what == "heat" and not bodies else ("", "", "")
    one, _, two = next(((one, "_", two) for one, two in permutations(bodies, 2) if of == f"{one}_{two}"), guess)
    if two and (bodies or "_" not in two):
        return one.replace("_", " "), two.replace("_", " ")
    named = of.replace("_", " ")
    return (f"the first body of {named}", "the second") if what == "heat" and two else ("bodies", named)
