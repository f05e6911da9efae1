"""Lines: the summaries of a sweep's points (records.point.LINE) by run id, as tuples: some 400 bytes a point, where dicts would take a thousand."""

import sys
from collections.abc import Iterator, MutableMapping
from typing import Any

from mpm.records.point import LINE

NAMES = tuple(name for name in LINE if name != "run_id")
SHARED = tuple(name in {"error", "outcome", "advice", "source"} for name in NAMES)  # texts that many points have


class Lines(MutableMapping):
    """Takes and gives dicts."""

    def __init__(self) -> None:
        self.rows: dict[str, tuple] = {}

    def __setitem__(self, run_id: str, line: dict[str, Any]) -> None:
        pairs = zip(NAMES, SHARED, strict=True)
        self.rows[run_id] = tuple(sys.intern(line[name]) if shared else line[name] for name, shared in pairs)

    def __getitem__(self, run_id: str) -> dict[str, Any]:
        return {"run_id": run_id, **dict(zip(NAMES, self.rows[run_id], strict=True))}

    def values_of(self, run_id: str) -> tuple:
        """The summary as it is kept."""
        return self.rows[run_id]

    def __delitem__(self, run_id: str) -> None:
        del self.rows[run_id]

    def __iter__(self) -> Iterator[str]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __contains__(self, run_id: object) -> bool:
        return run_id in self.rows
