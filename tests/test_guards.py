"""Guards of a run: planted blow-ups are found at once and named, what is sound is left alone, advice is from the step that was taken, and it costs little."""

import time
from pathlib import Path

import numpy as np
import pytest

import mpm
import mpm.simulation as simulation
from mpm.guards import GROWTH, NOISE, ROUNDING, SLOPES, Data, Guards
from mpm.scene.build import build
from mpm.simulation import Clock

DT = 0.01
FIELDS = {"temperature": "theta", "gradient of temperature": "c", "J": "J", "strain": "B", "affine velocity": "C", "velocity": "v", "position": "x"}
PLANTS = ("not finite", "inverted strain", "inverted volume", "negative temperature", "thrown out", "off the grid")
KINDS = dict(zip(PLANTS, ("non_finite", "inverted", "inverted", "max_principle", "left_grid", "left_grid"), strict=True))


def scene_of(core):
    """Forty particles that swing and cool; the physics of the other tests, so that nothing new is compiled."""
    bodies = {"body": {"shape": {"box": {"lower": [1.0], "upper": [6.0]}}, "temperature": core.HOT, "material": "solid"}}
    grid = {"dimension": 1, "size": [7.0], "cell": 0.25}
    output = {"every": 0.2, "snapshots": {"every": 0.2, "particles": ["temperature", "J"]}}
    return core.experiment(1, {"time.step": DT, "time.end": 2.0}, bodies=bodies, grid=grid, output=output)


def plant(scene, kind, rng):
    """Spoil one particle: (particle, name of the field)."""
    body, name = scene.bodies[0], ""
    i = int(rng.integers(len(body.particles.m)))
    if kind == "not finite":
        name = str(rng.choice(list(FIELDS)))
        holder = body.thermal if FIELDS[name] in ("theta", "c") else body.particles
        array = getattr(holder, FIELDS[name])
        array.reshape(len(array), -1)[i] = rng.choice([np.nan, np.inf])
    elif kind == "inverted strain":
        body.particles.B[i, 0] = -1.5
    elif kind == "inverted volume":
        body.particles.J[i] = -0.2
    elif kind == "negative temperature":
        body.thermal.theta[i] = -body.thermal.zero - rng.uniform(1.0, 1e3)
    elif kind == "thrown out":
        body.particles.v[i, 0] = rng.choice([-1.0, 1.0]) * 1e5
    else:
        body.particles.x[i, 0] = rng.choice([-1.0, 1.0]) * 1e3
    return i, name


def stir(scene):
    p = scene.bodies[0].particles
    p.v[:, 0] = 0.2 * np.sin(p.x[:, 0])


def test_planted_blow_ups_are_found_at_once(core, monkeypatch):
    """500 of them: a random particle, a random step. Found within 50 steps, with the reason and the particle; what was recorded before stays, and is sound."""
    experiment, rng, whole = scene_of(core), np.random.default_rng(5), None
    for number in range(500):
        kind = PLANTS[number % len(PLANTS)]
        monkeypatch.setattr(simulation, "BLOCK", int(rng.integers(1, 33)))
        scene, when, done = build(experiment), rng.uniform(0.05, 1.7), []
        stir(scene)

        def beat(_, now, scene=scene, when=when, done=done, kind=kind):
            if now >= when and not done:
                done.append((round(now / DT), *plant(scene, kind, rng)))
            return False

        run = simulation.simulate(scene, beat)
        step, particle, field = done[0]
        assert run.outcome.kind == KINDS[kind], (kind, run.outcome)
        assert 0 <= run.steps - step <= 50, (kind, run.steps, step)
        if kind != "thrown out":  # the grid carries its neighbours with it
            assert f"particle {particle}," in run.outcome.message, (kind, particle, run.outcome)
        assert field in run.outcome.message and run.outcome.advice
        kept = int(np.ceil(step * DT / 0.2 - 1e-9))  # at an output time itself the plant comes before the record
        kept += kind == "thrown out" and len(run.times) > kept  # a speed that is finite is recorded; where it leads is seen at the next step
        assert len(run.times) == kept == len(run.particles), (kind, step, run.times)
        assert all(np.isfinite(values).all() for values in run.series.values())
        assert all(np.isfinite(fields[name]).all() for fields in run.particles for name in fields)
        if whole is None:
            whole = core.play(experiment, stir)[1]
        assert np.array_equal(run.series["temperature_mean"], whole.series["temperature_mean"][:kept])


def test_advice_names_the_step_and_its_limit(core):
    far = core.play(core.experiment(1, {"time.step": 0.6, "time.end": 60.0, "output.every": 6.0}), stir)[1]
    assert not far.outcome.ok and "times the elastic wave limit" in far.outcome.advice and "`time.step` below" in far.outcome.advice
    bold = core.play(core.experiment(1, {"time.safety": 6.0, "time.end": 60.0, "output.every": 6.0}), stir)[1]
    assert not bold.outcome.ok and "lower `time.safety` to 1" in bold.outcome.advice


def heat_alone(core, changes, bodies=None):
    """A body at rest that cools in explicit heat steps; nothing heats it."""
    air = [{"of": "body", "convection": {"beta": 0.5, "outside": core.COLD}}]
    base = {"method.heat": "explicit", "time.end": 400.0, "output.every": 40.0, "time.step": 1e3}
    given = {} if bodies is None else {"bodies": bodies, "grid": {"dimension": 1, "size": [7.0], "cell": 0.25}}
    return core.play(core.experiment(1, base | changes, drop=("expansion", "heating"), surfaces=air, **given))[1]


def test_a_heat_step_past_its_limit_leaves_the_bounds_of_its_data(core):
    """The limit of the automatic step holds; at three times it temperatures leave what they were and what they met, and the advice says by how much."""
    assert heat_alone(core, {}).outcome.ok
    run = heat_alone(core, {"method.heat_step": 1.25, "time.safety": 1e6})
    assert run.outcome.kind == "max_principle" and "beyond 300 to 400 K" in run.outcome.message
    assert "times the heat limit" in run.outcome.advice and "`time.safety`" in run.outcome.advice


def test_energy_from_nowhere_ends_a_run(core):
    """A push from outside at half time: more than there ever was. The same swing without it is left alone."""
    quiet, pushed = {"time.step": 0.02, "time.end": 10.0, "kappa": 0.0}, []

    def play(factor):
        bodies, pushed[:] = [], []

        def begin(scene):
            stir(scene)
            bodies.append(scene.bodies[0])

        def beat(fraction, _):
            if fraction > 0.5 and not pushed:
                pushed.append(fraction)
                velocity = bodies[0].particles.v
                velocity *= factor
            return False

        box = {"box": {"lower": [3.6], "upper": [4.35]}}  # so far from all walls that it meets none
        centred = {"body": {"shape": box, "temperature": core.HOT, "material": "solid"}}
        grid = {"dimension": 1, "size": [8.0], "cell": 0.25}
        return core.play(core.experiment(1, quiet, drop=("surfaces", "expansion", "heating"), bodies=centred, grid=grid), begin, beat)[1]

    assert play(1.0).outcome.ok
    for factor in (10.0, 2.0):
        run = play(factor)
        assert run.outcome.kind == "energy_growth" and "(more than at the start by" in run.outcome.message
        assert 5.0 <= run.times[-1] < 6.0


@pytest.mark.parametrize("transfer", ["apic", "flip"])
@pytest.mark.plain
def test_a_swing_gains_nothing(monkeypatch, transfer):
    """A bar of 8 cells at the automatic step, seen every tenth of a second: velocities and positions of one time. Half a step apart they seem to gain 2.5 %."""
    gains, frame = [], Guards.frame

    def watched(self, scene, clock, series):
        found = frame(self, scene, clock, series)
        gains.append((series["energy_total"][-1] - self.begun) / self.most)
        return found

    monkeypatch.setattr(Guards, "frame", watched)
    bar = Path(__file__).parents[1] / "configs" / "verification" / "hencky_bar.yaml"
    assert mpm.run_point(mpm.load(bar, {"grid.cell": 0.125, "method.transfer": transfer})).outcome.ok
    assert max(gains) < 0.002


def test_temperatures_may_overshoot_by_what_their_transfer_does(core):
    allowed = {}
    for kind in ("apic", "pic", "flip", "affine_flip"):
        allowed[kind] = Guards(build(core.experiment(1, {"method.temperature": kind, "method.bounds": "free"}))).data[0].allowed
    assert allowed == {"apic": SLOPES, "pic": SLOPES, "flip": NOISE, "affine_flip": NOISE}
    assert Guards(build(core.experiment(1))).data[0].allowed == ROUNDING


@pytest.mark.slow
def test_sub_steps_on_hat_functions_are_not_automatic(core):
    """A particle that has just crossed a grid line: explicit sub-steps on hat functions leave the bounds of the data; `auto` does not take them."""
    bodies = {"body": {"shape": {"box": {"lower": [0.5], "upper": [4.53]}}, "temperature": core.HOT, "material": "solid"}}
    changes = {"grid.basis": "linear", "method.heat_step": 8.0, "time.end": 200.0}
    ended = {heat: heat_alone(core, changes | {"method.heat": heat}, bodies).outcome.kind for heat in ("explicit", "auto")}
    assert ended == {"explicit": "max_principle", "auto": "completed"}


def test_particles_that_come_apart_warn_or_end_the_run(core):
    """A bar pulled to three times its length with two particles a cell."""
    pull = {"time.end": 12.0, "output.every": 0.5, "kappa": 0.0}
    bodies = {"body": {"shape": {"box": {"lower": [4.0], "upper": [6.0]}}, "temperature": core.HOT, "material": "solid"}}
    grid = {"dimension": 1, "size": [20.0], "cell": 0.25}

    def part(scene):
        p = scene.bodies[0].particles
        p.v[:, 0] = np.where(p.x[:, 0] > 5.0, 2.0, -0.2)

    def play(fracture):
        changes = pull | {"method.fracture": fracture}
        return core.play(core.experiment(1, changes, drop=("surfaces", "expansion", "heating"), bodies=bodies, grid=grid), part)[1]

    warned, ended = play("warn"), play("fail")
    assert any("more than a cell apart" in text for text in warned.facts["warnings"])
    assert ended.outcome.kind == "fractured" and "body" in ended.outcome.message and "method.particles" in ended.outcome.advice
    assert ended.times[-1] < warned.times[-1]


@pytest.mark.slow
def test_guards_cost_less_than_a_hundredth(core, monkeypatch):
    """Time in guards over time in the run: ten thousand particles in two dimensions, heat steps of 13 steps, a frame every hundred."""
    from numba import njit

    from mpm.integrate.state_check import sound
    from mpm.transfer import CHUNK

    bodies = {"body": {"shape": {"box": {"lower": [1.0, 1.0], "upper": [13.5, 13.5]}}, "temperature": core.HOT, "material": "solid"}}
    grid = {"dimension": 2, "size": [15.0, 15.0], "cell": 0.25}
    experiment = core.experiment(2, {"time.step": 0.02, "time.end": 8.0, "output.every": 2.0}, bodies=bodies, grid=grid)
    core.play(core.experiment(2))
    spent, blocks = [0.0], [0]

    @njit
    def look(space, body, size, again):
        found = 0
        for first in range(0, body.particles.x.shape[0], size):
            for _ in range(again):
                found += sound(space, body, first, min(size, body.particles.x.shape[0] - first))
        return found

    def opening(scene):
        """Seconds that a block's opening takes longer for its looks: what they look at is read anyway, so a second and a third look are timed."""
        body, rounds = scene.bodies[0], {1: [], 3: []}
        chunks = look(scene.space, body, CHUNK, 1)
        assert chunks == -(-len(body.particles.m) // CHUNK)
        for _ in range(20):
            for again, seconds in rounds.items():
                began = time.perf_counter()
                assert look(scene.space, body, CHUNK, again) == again * chunks
                seconds.append(time.perf_counter() - began)
        return float(np.median(rounds[3]) - np.median(rounds[1])) / 2

    def counted(*arguments):
        blocks[0] += 1
        return advance_block(*arguments)

    def timed(inner):
        def outer(*arguments):
            began = time.perf_counter()
            try:
                return inner(*arguments)
            finally:
                spent[0] += time.perf_counter() - began

        return outer

    for name in ("block", "whole", "frame"):
        monkeypatch.setattr(Guards, name, timed(getattr(Guards, name)))
    advance_block = simulation.advance_block
    monkeypatch.setattr(simulation, "advance_block", counted)
    shares = []
    for _ in range(5):
        spent[0], blocks[0] = 0.0, 0
        scene, run = core.play(experiment, lambda scene: scene.bodies[0].particles.v.__setitem__(slice(None), 0.1))
        assert run.steps <= 13 * blocks[0]
        parts = {"in Python": spent[0], "opening": blocks[0] * opening(scene), "run": run.wall_time}
        shares.append((parts["in Python"] + parts["opening"]) / parts["run"])
        print(f"share of guards {shares[-1]:.4f}, {blocks[0]} blocks,", {name: f"{1e3 * value:.3f} ms" for name, value in parts.items()})
    assert min(shares) < 0.01, shares


@pytest.mark.parametrize("allowed", [SLOPES, NOISE])
def test_temperatures_are_judged_at_just_the_share_that_is_allowed(core, allowed):
    body = build(core.experiment(1, drop=("surfaces",))).bodies[0]
    body.thermal.theta[:] = np.linspace(0.0, 100.0, len(body.thermal.theta))
    data = Data(body, None, allowed)
    data.heats = False
    for share, fine in ((allowed - 0.01, True), (allowed + 0.01, False)):
        for beyond in (100.0 * (1 + share), -100.0 * share):
            theta = body.thermal.theta.copy()
            body.thermal.theta[3] = beyond
            assert (data.judge(body) is None) == fine
            body.thermal.theta[:] = theta


def test_the_round_off_of_bodies_at_rest_is_no_energy(core):
    """Two bodies that touch and do not move have 1e-29 of what a strain of 1 holds."""
    scene = build(core.experiment(1, drop=("surfaces", "expansion", "heating")))
    held = 0.5 * (scene.bodies[0].elastic.lam + 2 * scene.bodies[0].elastic.mu) * float(np.sum(scene.bodies[0].particles.V0))
    for strain, kind in ((1e-13, "completed"), (1e-11, "energy_growth")):
        guards, clock = Guards(scene), Clock(scene)
        series = {"energy_kinetic": [0.0], "energy_elastic": [0.0], "energy_total": [0.0]}
        assert guards.judged and guards.frame(scene, clock, series).ok
        for name in ("energy_kinetic", "energy_total"):
            series[name].append(held * strain**2)
        series["energy_elastic"].append(0.0)
        assert guards.frame(scene, clock, series).kind == kind


def test_energy_is_judged_at_just_the_share_that_is_allowed(core):
    scene = build(core.experiment(1, drop=("surfaces",)))
    for gained, kind in ((GROWTH - 0.01, "completed"), (GROWTH + 0.01, "energy_growth")):
        guards, clock = Guards(scene), Clock(scene)
        guards.judged, series = True, {"energy_kinetic": [1.0], "energy_elastic": [0.0], "energy_total": [1.0]}
        assert guards.frame(scene, clock, series).ok
        series["energy_total"].append(1.0 + gained)
        series["energy_kinetic"].append(1.0), series["energy_elastic"].append(0.0)
        assert guards.frame(scene, clock, series).kind == kind
