"""Names of variables that hold other names (of probes, walls, tools, pairs of bodies): what is met, by its first word, and patterns."""

import re

MET = {  # what a wall, a tool or another body does: <what>.<of>, with a direction behind it for forces and torques. {} is its name, {1} and {2} those of a pair
    "force": ("N", "force on bodies by {}, mean since the record before"),
    "torque": ("N m", "torque on bodies by {}, mean since the record before, about the tool's centre or the origin of coordinates"),
    "area": ("m2", "area in touch with {}, mean since the record before"),
    "heat": ("J", "heat taken in by {1} from {2} since the start"),
    "travel": ("m", "how far {} has moved since the start"),
    "hardness": ("N", "largest force of the first bite of {}"),
    "cohesiveness": ("1", "work of the second bite of {} over that of the first"),
    "springiness": ("1", "way of the second bite of {} over that of the first"),
}
BITES = ("hardness", "cohesiveness", "springiness")  # one number a run
THRESHOLD = re.compile(r"time_to\.(?P<probe>[A-Za-z_]\w*)\.(?P<value>-?\d+(?:\.\d+)?)_(?P<unit>degC|K)")
IN_DATASET = r"time_to_(?P<probe>{})_(?P<value>-?\d+(?:_\d+)?)_(?P<unit>degC|K)"
PROBED = re.compile(r"(?P<field>displacement|stress)[._](?P<probe>[A-Za-z_]\w*)_(?P<part>[xyzr]|[xyzrt]{2})")
OF = "area|heat|hardness|cohesiveness|springiness"
MEETING = re.compile(rf"(?:(?P<turned>force|torque|travel)[._](?P<on>[A-Za-z_]\w*)_(?P<axis>[xyzr])|(?P<what>{OF})[._](?P<of>[A-Za-z_]\w*))")
AT_PROBE = ("temperature", "velocity")  # fields that a probe's name may follow at once
SINGLE = ("temperature", "heat_total", "mass", "volume", "momentum", "position", "extent", "velocity_max", "J")  # families told of one body


def pair(of: str) -> tuple[str, str]:
    """Both bodies of `patty_cheese`, in words; of names that have an underscore of their own it is not known where one ends."""
    one, _, two = of.partition("_")
    return (one, two) if two and "_" not in two else (f"the first body of {of.replace('_', ' ')}", "the second")
