"""The engine's own decisions, with a store, an executor and points that only note what they are asked: no process is started."""

import math
from collections import Counter
from types import SimpleNamespace

import pytest

from mpm.records.variables import KILLED, MEMORY, OK, TIMEOUT
from mpm.sweep import engine as module
from mpm.sweep.engine import Engine, Options, Running


class Due(list):
    """Points to hand out, as mpm.sweep.queue.Due."""

    def __init__(self, ids):
        super().__init__(ids)
        self.back = self

    @property
    def first(self):
        return self[0]

    def take(self):
        return self.pop(0)


class Resources:
    """Memory and disk of a test's choice."""

    def __init__(self, fits=True, short="", most=math.inf):
        self.given, self.most, self.asked = {}, most, []
        self.fits = lambda need: fits
        self.short = lambda count, experiment: self.asked.append(count) or short
        self.need = lambda experiment: experiment.need
        self.refusal = lambda need: "too much" if need > self.most else ""


def made(monkeypatch, tmp_path, ids="abcd", resources=None, needs=None, **options):
    """(an engine, what it noted)."""
    noted = SimpleNamespace(forgot=[], tasks=[], saved=[], finished=[], cancelled=[])
    monkeypatch.setattr(module, "missing", lambda points, lines, rerun: ids)
    monkeypatch.setattr(module, "Due", lambda every, numbers: Due(numbers))
    monkeypatch.setattr(module, "Resources", lambda *given, **named: resources or Resources())
    monkeypatch.setattr(module, "label", lambda case: "point")
    store = SimpleNamespace(out=tmp_path, forget=noted.forgot.append, own=lambda due: set(), batch_names=lambda: iter("123456789"), save=noted.saved.append)
    cases = {one: SimpleNamespace(experiment=SimpleNamespace(resolved=dict, need=(needs or {}).get(one, 1))) for one in ids}
    reporter = SimpleNamespace(finished=lambda name, line, again: noted.finished.append(again), beat=lambda parts: None)
    found = Engine(store, SimpleNamespace(ids=list(ids), cases=cases), {}, Options(**options), reporter)
    found.executor = SimpleNamespace(free=1, submit=noted.tasks.append, cancel=lambda task, why: noted.cancelled.append(why), kill=lambda task, why: None)
    found.batch_size = SimpleNamespace(batch=lambda left, workers: 3)
    return found, noted


@pytest.mark.parametrize("rerun", [None, "failed", "stale", "all"])
def test_only_a_run_of_all_forgets_what_is_there(monkeypatch, tmp_path, rerun):
    found, noted = made(monkeypatch, tmp_path, rerun=rerun)
    assert [list(due) for due in noted.forgot] == ([list("abcd")] if rerun == "all" else []) and list(found.due) == list("abcd")


def test_a_batch_is_as_long_as_it_may_be(monkeypatch, tmp_path):
    found, noted = made(monkeypatch, tmp_path)
    assert found.hand_out(found.executor) and found.hand_out(found.executor) and not found.due
    assert [[job.run_id for job in task.jobs] for task in noted.tasks] == [list("abc"), ["d"]]
    assert found.resources.asked == [3, 3 + 3]  # points, with those that run
    assert found.attempts == Counter("abcd")


def test_what_is_alone_ends_a_batch(monkeypatch, tmp_path):
    found, noted = made(monkeypatch, tmp_path)
    found.alone = {"c"}
    for _ in range(3):
        found.hand_out(found.executor)
    assert [[job.run_id for job in task.jobs] for task in noted.tasks] == [["a", "b"], ["c"], ["d"]]


@pytest.mark.parametrize(("resources", "stopped"), [(Resources(fits=False), ""), (Resources(short="full"), "broken")])
def test_a_point_waits_for_room(monkeypatch, tmp_path, resources, stopped):
    """For memory it waits; a full disk stops the sweep where nothing runs that could end."""
    found, noted = made(monkeypatch, tmp_path, resources=resources)
    assert not found.hand_out(found.executor) and list(found.due) == list("abcd") and not noted.tasks and found.stopped == stopped


def test_a_full_disk_waits_for_what_runs_and_stops_once(monkeypatch, tmp_path):
    found, _ = made(monkeypatch, tmp_path, resources=Resources(short="full"))
    found.running["x"] = Running(SimpleNamespace(jobs=(1, 2)), 0.0)
    assert not found.on_disk(3, None) and found.stopped == "" and found.resources.asked == [5]
    found.stopped = "interrupted"
    found.stop_for_the_disk("full")
    assert found.stopped == "interrupted" and found.broken.startswith("full; finished points are kept")


@pytest.mark.parametrize(
    ("scheduler", "shared", "kept"), [(None, False, 7.0), ("local", False, 7.0), ("tcp://far", False, 0.0), ("tcp://far", True, 7.0), (None, True, 7.0)]
)
def test_checkpoints_are_where_a_folder_lasts(monkeypatch, tmp_path, scheduler, shared, kept):
    found, noted = made(monkeypatch, tmp_path, scheduler=scheduler, shared=shared, checkpoint=7.0)
    found.hand_out(found.executor)
    assert noted.tasks[0].checkpoint == kept


@pytest.mark.parametrize(
    ("needs", "stopped", "can", "left"),
    [
        ({}, "", True, "abcd"),
        ({"a": 9, "b": 9}, "", True, "cd"),
        (dict.fromkeys("abcd", 9), "", False, ""),
        ({}, "interrupted", False, "abcd"),
        ({"a": 9}, "interrupted", False, "abcd"),
    ],
)
def test_workers_are_started_for_what_can_run(monkeypatch, tmp_path, needs, stopped, can, left):
    found, noted = made(monkeypatch, tmp_path, resources=Resources(most=5), needs=needs)
    found.stopped = stopped
    assert found.any_can_run() is can and list(found.due) == list(left) and len(noted.saved) == 4 - len(left)
    assert all(record.outcome == MEMORY for record in noted.saved)


@pytest.mark.parametrize(
    ("status", "outcome", "retries", "again"),
    [
        (KILLED, "", None, True),
        (KILLED, MEMORY, None, False),
        (KILLED, "", 0, False),
        (TIMEOUT, "", None, False),
        (TIMEOUT, "", 1, True),
        (OK, "completed", 1, False),
    ],
)
def test_what_is_tried_again(monkeypatch, tmp_path, status, outcome, retries, again):
    found, noted = made(monkeypatch, tmp_path, retries=retries)
    found.attempts["a"] = 1
    found.due.take()
    found.finish({"run_id": "a", "status": status, "outcome": outcome})
    assert noted.finished == [again] and ("a" in found.due) == again and ("a" in found.alone) == again


@pytest.mark.parametrize(("spent", "budget", "stopped"), [(5.0, 6.0, ""), (7.0, 6.0, "budget"), (7.0, None, "")])
def test_the_time_budget(monkeypatch, tmp_path, spent, budget, stopped):
    found, _ = made(monkeypatch, tmp_path, time_budget=budget)
    monkeypatch.setattr(module.time, "monotonic", lambda: found.began + spent)
    found.look_at_the_clock()
    assert found.stopped == stopped
