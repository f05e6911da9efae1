"""Slabs and threads: the same bits for any number of threads, the same physics as without slabs, whatever drifts where."""

from contextlib import nullcontext

import numpy as np
import pytest

from mpm.integrate import sorting as module
from mpm.integrate import step_threaded
from mpm.integrate.sorting import cuts
from mpm.integrate.step_threaded import Crew, Slabs, share_out, wave

LOOKS = {"every": 0.5, "snapshots": {"every": 0.5, "particles": ["position", "velocity", "temperature", "J"]}}


def scene(core, dimension=2, several=False, **sections):
    """A warm block, or two that fly at each other, three particles a cell and direction, cooled and thrown at walls."""
    D = core.DIRECTIONS[dimension]
    boxes = {"body": (0.4, 1.9, 0.6), "other": (2.1, 3.5, -0.6)} if several else {"body": (0.4, 3.4, 0.6)}
    bodies = {
        name: {"shape": {"box": {"lower": [low, *[0.8] * (D - 1)], "upper": [high, *[1.6] * (D - 1)]}}, "material": "solid", "temperature": 400,
               "velocity": [v, *[0.1] * (D - 1)]}
        for name, (low, high, v) in boxes.items()
    }  # fmt: skip
    grid = {"dimension": dimension, "size": [4.0, *[2.5] * (D - 1)], "cell": 0.125}
    air = [{"of": "body", "convection": {"beta": 1.0, "outside": 300}}]
    method = {"particles": 3} | sections.pop("method", {})
    return core.experiment(dimension, grid=grid, bodies=bodies, surfaces=air, method=method, output=LOOKS, **{"time": {"end": 1.0}} | sections)


@pytest.fixture
def small(monkeypatch):
    """Slabs as thin as they can be, for any scene."""
    monkeypatch.setattr(module, "SHARED", 1)
    monkeypatch.setattr(module, "FULL", 1)


def played(core, experiment, threads, prepare=None):
    """(scene, run) by that many threads."""

    def ready(scene):
        scene.threads = threads
        if prepare is not None:
            prepare(scene)

    return core.play(experiment, ready)


def bits(run):
    """Every array of a run, as bytes."""
    fields = [field for frame in run.particles for field in frame.values()]
    return [np.asarray(values).tobytes() for values in (*run.series.values(), *fields)]


def test_slabs_are_wide_enough_and_about_equally_full():
    counts = np.random.default_rng(0).integers(0, 50000, 60)
    counts[:7] = counts[50:] = 0
    found = cuts(counts, 4)
    full = np.add.reduceat(counts, found[:-1])
    assert found[0] >= 7 and found[-1] <= 50 and (np.diff(found) >= 4).all() and full.sum() == counts.sum() and len(found) == 11
    assert np.array_equal(cuts(np.array([0, 9, 9, 0]), 4), [1, 3])


@pytest.mark.parametrize("M", [2, 3, 6, 7])
@pytest.mark.parametrize("threads", [1, 2, 4])
def test_an_odd_slab_comes_after_the_two_beside_it(M, threads):
    done = []
    with Crew(threads) as crew:
        crew.work(wave(M), lambda which: done.extend(which.tolist()))
    assert sorted(done) == list(range(M))
    assert all(done.index(s) > done.index(t) for s in range(1, M, 2) for t in (s - 1, s + 1) if t < M)


def test_a_thread_that_fails_ends_the_work():
    def call(which):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), Crew(3) as crew:
        crew.work(wave(6), call)


def test_no_two_slabs_of_a_kind_may_touch_one_node():
    """Whatever they reached before: also where particles of one slab have passed those of others."""
    random = np.random.default_rng(0)
    for _ in range(200):
        reach = np.sort(random.integers(0, 100, (8, 2)), axis=1)
        made = Slabs(0, None, None, np.zeros(8, np.int64), np.zeros(8, np.int64), *[None] * 4)
        share_out(reach, made)
        assert all(made.high[s] <= made.low[t] for s in range(8) for t in range(s + 2, 8))


@pytest.mark.wide
def test_the_same_bits_for_any_number_of_threads(core, small):
    runs = [played(core, scene(core), threads) for threads in (1, 2, 3)]
    assert runs[0][0].order.shared and runs[0][0].order.starts.shape[1] > 5 and runs[0][1].outcome.ok
    assert bits(runs[0][1]) == bits(runs[1][1]) == bits(runs[2][1])


@pytest.mark.wide
def test_slabs_change_nothing_but_the_order_of_sums(core, small, monkeypatch):
    _, cut = played(core, scene(core), 2)
    monkeypatch.setattr(module, "SHARED", 10**9)
    other, whole = played(core, scene(core), 2)
    assert not other.order.shared and cut.steps == whole.steps > 20
    for name, values in whole.series.items():
        assert np.allclose(cut.series[name], values, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(values).max())), name
    for one, two in zip(cut.particles, whole.particles, strict=True):
        for name in one:
            assert np.allclose(one[name], two[name], rtol=1e-9, atol=1e-10), name


@pytest.mark.wide
def test_a_record_changes_no_bit_of_the_run(core, small, monkeypatch):
    """Looking at velocities (contact/insync.py) sorts particles and puts them back."""
    _, looked = played(core, scene(core), 2)
    monkeypatch.setattr("mpm.simulation.in_sync", lambda *_: nullcontext())
    _, blind = played(core, scene(core), 2)
    for name in ("position_mean_x", "position_max_x", "J_min", "energy_elastic", "temperature_min", "heat_exchanged"):
        assert looked.series[name].tobytes() == blind.series[name].tobytes(), name
    assert looked.series["momentum_x"].tobytes() != blind.series["momentum_x"].tobytes()


@pytest.mark.wide
def test_particles_that_drift_past_their_slab_are_scattered_late(core, small, monkeypatch):
    """Cuts at the wrong places: many chunks are late, the answer is that of any other cut."""
    late = []
    advance = step_threaded.advance_slabs

    def watched(scene, *rest):
        scene.order.reach[:] = scene.order.reach[:, :1] + [[-40, -39]]  # says that the slabs were far to the left
        late.append(advance(scene, *rest))
        return late[-1]

    _, plain = played(core, scene(core), 1)
    monkeypatch.setattr("mpm.contact.block.advance_slabs", watched)
    runs = [played(core, scene(core), threads)[1] for threads in (1, 2)]
    assert any(late) and bits(runs[0]) == bits(runs[1]) and bits(runs[0]) != bits(plain)
    for name, values in plain.series.items():
        assert np.allclose(runs[0].series[name], values, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(values).max())), name


def throw(scene):
    p = scene.bodies[-1].particles
    p.x[7, 0], p.v[7] = 3.9, 500.0


@pytest.mark.wide
def test_a_failure_in_a_slab_names_body_and_particle(core, small):
    said = {played(core, scene(core, time={"end": 1.0, "step": 0.01}), threads, throw)[1].outcome.message for threads in (1, 2)}
    assert len(said) == 1 and "particle 7" in said.pop()


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [3, "axisymmetric"])
@pytest.mark.parametrize("method", [{}, {"gradient": "bspline"}, {"transfer": {"flip": {"blend": 0.05}}}, {"transfer": {"xpic": {"order": 2}}}])
def test_the_same_bits_in_every_dimension_and_transfer(core, small, dimension, method):
    experiment = scene(core, dimension, several=True, method=method | ({"particles": 2} if dimension == 3 else {}))
    runs = [played(core, experiment, threads) for threads in (1, 2, 4)]
    assert runs[0][0].order.shared and bits(runs[0][1]) == bits(runs[1][1]) == bits(runs[2][1])
