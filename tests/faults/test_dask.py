"""A Dask cluster whose worker is killed, and whose scheduler is restarted: what was in flight runs again, and nothing else."""

import threading

import fake_runner as fake
import pytest
from dask_cluster import After, Dask, kill
from scenes import config, go

from mpm.sweep.compare import compare

TINY = [round(0.01 * k, 2) for k in range(1, 61)]
LONG = [fake.BRIEF + k for k in range(8)]  # a second each


@pytest.fixture
def dask(tmp_path):
    (tmp_path / "dask").mkdir()
    made = Dask(tmp_path / "dask")
    yield made
    made.close()


@pytest.mark.wide
def test_a_killed_worker_costs_what_it_ran(tmp_path, marks, dask):
    dask.scheduler()
    workers = [dask.worker(), dask.worker()]
    data = config([*TINY, *LONG])
    go(data, tmp_path / "own", jobs=2)
    before, told, done = len(marks()), After(62, lambda: None), set()
    real = told.finished

    def finished(label, line, again):
        real(label, line, again)
        if workers[0].poll() is None:
            done.add(float(label.removeprefix("kappa=")))
        ran = {int(row[-1]) for row in marks()[before:] if row[0] == "run"}
        if told.count <= 0 and len(ran) == 2 and workers[0].poll() is None:  # once both have run something: then both are busy, to the last points
            kill(workers[0])

    told.finished = finished
    result = go(data, tmp_path / "dask", jobs=2, reporter=told, scheduler=dask.address)
    assert len([note for note in told.notes if note.startswith("worker tcp://127.0.0.1:") and " is gone" in note]) == 1
    ran = [float(row[1]) for row in marks()[before:] if row[0] == "run"]
    twice = {kappa for kappa in ran if ran.count(kappa) > 1}
    assert result.exit_code == 0 and len(done) >= 62 and not twice & done  # the batch that the killed worker held, and nothing that was told as done
    assert compare(tmp_path / "dask", tmp_path / "own") == []


@pytest.mark.slow
@pytest.mark.parametrize("shared", [False, True])
def test_a_killed_worker_and_a_restarted_scheduler_cost_what_was_in_flight(tmp_path, marks, dask, table, shared):
    scheduler = dask.scheduler()
    workers = [dask.worker(), dask.worker()]
    points = config([*TINY, *LONG])
    go(points, tmp_path / "own", jobs=2)
    before = len(marks())
    told = After(62, lambda: kill(workers[0]))
    real, timer = told.finished, threading.Timer(2.5, lambda: (dask.scheduler(), dask.worker()))

    def finished(label, line, again):
        real(label, line, again)
        if told.count == -3:
            kill(scheduler)
            kill(workers[1])
            timer.start()

    told.finished = finished
    result = go(points, tmp_path / "dask", jobs=2, reporter=told, scheduler=dask.address, shared=shared)
    timer.join()
    ran = len([row for row in marks()[before:] if row[0] == "run"])
    assert result.exit_code == 0 and result.counts["ok"] == 68
    assert any("does not answer" in note for note in told.notes)
    differ = compare(tmp_path / "dask", tmp_path / "own")
    said = f"{result.counts['ok']} of 68 points ok, {ran - 68} ran twice, dataset {'differs' if differ else 'the same'}"
    table(f"Dask, two workers on loopback, {'shared folder' if shared else 'over the wire'}: one killed, the scheduler restarted", said)
    assert ran <= 68 + 4 and not differ
