"""Summaries in columns: what goes in comes out, whatever it is, and the fingerprint is of the contents alone."""

import sys

import numpy as np
import pytest

from mpm.records.point import LINE, Record
from mpm.sweep.ids import Ids
from mpm.sweep.queue import Due
from mpm.sweep.summaries import Summaries

TIMES = ["2026-11-22T10:07:40.123+00:00", "1970-01-01T00:00:00.000+00:00", "", "yesterday", "2026-11-22T10:07:40+00:00", "1969-12-31T23:59:59.999+00:00"]


def line(number, **more):
    made = Record(f"{number:04x}", 0, steps=3 * number, wall_time=number / 7, source="ab" * 8, started=TIMES[number % 6], finished=TIMES[0]).line
    return made | more


def test_what_goes_in_comes_out():
    kept = [line(k, error=f"killed: {k % 3}", status=k % 5) for k in range(60)]
    lines = Summaries(one["run_id"] for one in kept)
    assert len(lines) == 0 and list(lines) == [] and "0003" not in lines
    for one in reversed(kept):
        lines[one["run_id"]] = one
    assert [lines[one["run_id"]] for one in kept] == kept and list(lines) == [one["run_id"] for one in kept] and len(lines) == 60
    assert all(type(lines["0004"][name]) is type(kept[4][name]) for name in LINE)
    assert [lines.ids[number] for number in lines.by_status(ok=True)] == [one["run_id"] for one in kept if one["status"] == 0]
    del lines["0003"]
    assert "0003" not in lines and len(lines) == 59 and lines.get("0003") is None
    for name in ("0003", "ffff", "κ", "0" * 40):
        with pytest.raises(KeyError):
            lines[name]
    with pytest.raises(KeyError):
        lines["ffff"] = kept[0]


def test_the_fingerprint_is_of_the_contents():
    kept = [line(k, error=f"killed: {k % 3}") for k in range(60)]

    def printed(order, change):
        lines = Summaries(kept[k]["run_id"] for k in range(60))
        lines.code("a text that no point has")
        lines.put_all([kept[k] | {"error": "x"} for k in order[::2]])
        lines.put_all([kept[k] | (change if k == 7 else {}) for k in order])
        return b"".join(lines.content())

    once = printed(list(range(60)), {})
    assert printed(np.random.default_rng(0).permutation(60).tolist(), {}) == once
    for name, value in {"error": "killed: 2", "started": "", "finished": TIMES[1], "steps": 4, "wall_time": 0.1, "attempts": 2, "status": 3}.items():
        assert printed(list(range(60)), {name: value}) != once, name


def test_a_point_takes_few_bytes():
    ids = Ids.of(f"{k:016x}" for k in range(1000))
    lines = Summaries(ids)
    assert lines.rows.nbytes + sys.getsizeof(ids.texts) + ids.order.nbytes < 100 * 1000


def test_ids_are_found():
    ids = Ids.of(["b1", "a2", "c3", "a2"])
    assert list(ids) == ["b1", "a2", "c3"] and [ids.find(name) for name in ("b1", "a2", "c3", "", "a", "zz", "b12")] == [0, 1, 2, -1, -1, -1, -1]
    assert ids.find_all(["c3", "x", "b1"]).tolist() == [2, -1, 0] and Ids.of([]).find_all(["a"]).tolist() == [-1] and Ids.of([]).find("a") == -1


def test_what_is_due_goes_round():
    due = Due(Ids.of("abcdef"), np.array([1, 3, 4]))
    assert due.first == "b" and due.take() == "b" and len(due) == 2
    due.front.appendleft("b")
    due.back.append("a")
    assert list(due) == ["b", "d", "e", "a"] and [due.take() for _ in range(3)] == ["b", "d", "e"] and due.first == "a" and due.take() == "a" and not due
