"""What a sweep came to."""

from dataclasses import dataclass, field
from typing import Any

from mpm.sweep.summaries import Summaries


@dataclass
class Result:
    """What a sweep came to."""

    out: Any
    lines: Summaries
    counts: dict[str, int]
    ran: int
    stopped: str
    exit_code: int
    seconds: float
    collected: bool = False
    hurried: bool = False  # told to leave at once
    warned: dict[str, int] = field(default_factory=dict)  # as tally.warned gives it
    compiling: float = 0.0  # seconds that workers spent on compiling
