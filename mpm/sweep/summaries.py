"""The summaries of a sweep's points (records.point.LINE) by run id, in columns: 58 bytes a point, where dicts would take a thousand."""

import json
from collections.abc import Collection, Iterable, Iterator, MutableMapping
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from mpm.records.point import LINE
from mpm.sweep.ids import Ids

NAMES = tuple(name for name in LINE if name != "run_id")
TEXTS = ("error", "outcome", "advice", "warned", "source")  # many points have the same
TIMES = ("started", "finished")
KINDS = {"status": "i1", "attempts": "i4", "steps": "i8", "wall_time": "f8"} | dict.fromkeys(TEXTS, "i4") | dict.fromkeys(TIMES, "i8")
START, MILLISECOND = datetime(1970, 1, 1, tzinfo=UTC), timedelta(milliseconds=1)


class Summaries(MutableMapping):
    """Takes and gives dicts; points that are not of `ids` are refused. `rows` are the columns, and `rows["there"]` says which points have a summary."""

    def __init__(self, ids: Iterable[str]) -> None:
        self.ids = Ids.of(ids)
        self.rows = np.zeros(len(self.ids), [("there", "?"), *((name, KINDS[name]) for name in NAMES)])
        self.texts: list[str] = []
        self.codes: dict[str, int] = {}
        self.count = 0

    def code(self, text: str) -> int:
        """The number that stands for a text."""
        if text not in self.codes:
            self.codes[text] = len(self.texts)
            self.texts.append(text)
        return self.codes[text]

    def moment(self, text: str) -> int:
        """A time as milliseconds; any other text as a negative number."""
        try:
            count = (datetime.fromisoformat(text) - START) // MILLISECOND
        except (ValueError, TypeError):
            return -1 - self.code(text)
        return count if count >= 0 and timestamp(count) == text else -1 - self.code(text)

    def __setitem__(self, run_id: str, line: dict[str, Any]) -> None:
        number = self.ids.find(run_id)
        if number < 0:
            raise KeyError(run_id)
        self.put(number, line)

    def put(self, number: int, line: dict[str, Any]) -> None:
        """Keep the summary of a point by its number."""
        kept = line | {name: self.code(line.get(name, "")) for name in TEXTS} | {name: self.moment(line[name]) for name in TIMES}
        self.count += not self.rows["there"][number]
        self.rows[number] = (True, *(kept[name] for name in NAMES))

    def put_all(self, lines: list[dict[str, Any]], without: Collection[str] = ()) -> None:
        """Keep summaries of the points that are of `ids`, less those in `without`."""
        for number, line in zip(self.ids.find_all([line["run_id"] for line in lines]).tolist(), lines, strict=True):
            if number >= 0 and line["run_id"] not in without:
                self.put(number, line)

    def __getitem__(self, run_id: str) -> dict[str, Any]:
        return {"run_id": run_id, **dict(zip(NAMES, self.values_of(self.number(run_id)), strict=True))}

    def number(self, run_id: str) -> int:
        """The number of a point that has a summary."""
        number = self.ids.find(run_id)
        if number < 0 or not self.rows["there"][number]:
            raise KeyError(run_id)
        return number

    def values_of(self, number: int) -> tuple:
        """A summary's values in the order of NAMES, by the point's number."""
        found = dict(zip(NAMES, self.rows[number].item()[1:], strict=True))
        for name in TEXTS:
            found[name] = self.texts[found[name]]
        for name in TIMES:
            found[name] = timestamp(found[name]) if found[name] >= 0 else self.texts[-1 - found[name]]
        return tuple(found.values())

    def __delitem__(self, run_id: str) -> None:
        self.rows["there"][self.number(run_id)] = False
        self.count -= 1

    def __iter__(self) -> Iterator[str]:
        return (self.ids[number] for number in np.flatnonzero(self.rows["there"]))

    def __len__(self) -> int:
        return self.count

    def __contains__(self, run_id: object) -> bool:
        return isinstance(run_id, str) and (number := self.ids.find(run_id)) >= 0 and bool(self.rows["there"][number])

    def content(self) -> Iterator[bytes]:
        """All of it as bytes, whatever the order in which it came."""
        at = self.ids.order[self.rows["there"][self.ids.order]]
        yield self.ids.texts[at].tobytes()
        for name in NAMES:
            column = self.rows[name][at]
            if name in TIMES:
                yield np.maximum(column, -1).tobytes()
                column = -1 - column[column < 0]
            if name in TEXTS or name in TIMES:
                used, place = np.unique(column, return_inverse=True)
                words = [self.texts[code] for code in used]
                ranks = np.empty(len(words), np.int64)
                ranks[sorted(range(len(words)), key=words.__getitem__)] = np.arange(len(words))
                yield json.dumps(sorted(words)).encode()
                column = ranks[place]
            yield column.tobytes()

    def by_status(self, ok: bool) -> np.ndarray:
        """Numbers of the points that are ok, or of those that are not."""
        return np.flatnonzero(self.rows["there"] & ((self.rows["status"] == 0) == ok))


def timestamp(milliseconds: int) -> str:
    """As records.provenance.now says it."""
    return (START + milliseconds * MILLISECOND).isoformat(timespec="milliseconds")
