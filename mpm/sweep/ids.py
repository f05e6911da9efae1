"""Ids: the run ids of a sweep by number and the other way, 24 bytes a point; as texts in a dict they would take two hundred."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np


def raw(run_ids: Iterable[str]) -> np.ndarray:
    """Run ids as an array of bytes."""
    return np.array([run_id.encode("ascii") for run_id in run_ids], dtype=np.bytes_)


class Ids(Sequence):
    """Distinct run ids in the order given; the other way is a bisection."""

    def __init__(self, texts: np.ndarray):
        self.texts = texts
        self.order = np.argsort(texts, kind="stable")

    @classmethod
    def of(cls, run_ids: Iterable[str]) -> "Ids":
        """From texts."""
        return run_ids if isinstance(run_ids, cls) else cls(raw(dict.fromkeys(run_ids)))

    def find(self, run_id: str) -> int:
        """The number of a run id; -1 where it is not one of these."""
        key = np.bytes_(run_id.encode("ascii", "replace"))
        if not len(self.texts) or len(key) > self.texts.dtype.itemsize:
            return -1
        at = int(np.searchsorted(self.texts, key, sorter=self.order))
        number = int(self.order[at]) if at < len(self.order) else -1
        return number if number >= 0 and self.texts[number] == key else -1

    def find_all(self, run_ids: Sequence[str]) -> np.ndarray:
        """The numbers of many, -1 for those that are none of these."""
        if not len(self.texts) or not run_ids:
            return np.full(len(run_ids), -1)
        keys = raw(run_ids)
        at = np.minimum(np.searchsorted(self.texts, keys, sorter=self.order), len(self.order) - 1)
        return np.where(self.texts[self.order[at]] == keys, self.order[at], -1)

    def __contains__(self, run_id: object) -> bool:
        return isinstance(run_id, str) and self.find(run_id) >= 0

    def __getitem__(self, number: Any) -> str:
        return self.texts[number].decode("ascii")

    def __len__(self) -> int:
        return len(self.texts)

    def __iter__(self) -> Iterator[str]:
        return (text.decode("ascii") for text in self.texts)
