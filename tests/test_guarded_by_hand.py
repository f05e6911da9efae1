"""Bounds of the guards, by hand: what is just within passes, what is just beyond does not. No scene runs."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import mpm
from mpm import guards
from mpm.boundary import extents
from mpm.guards import NOTICEABLE, ROUNDED, ROUNDING, Data, Guards, outgrown, rounded
from mpm.scene.build import build
from mpm.simulation import Clock
from mpm.state import PAD, NoExchange, Radiation


@pytest.fixture
def scene(core):
    return build(core.experiment(1, drop=("surfaces", "expansion", "heating")))


@pytest.mark.parametrize(("over", "told"), [(0.004, False), (0.006, True)])
def test_what_is_noticeable_is_warned_of(scene, over, told):
    held = Guards(scene)
    held.data[0].over = over
    assert held.frame(scene, Clock(scene), {"energy_kinetic": [0.0], "energy_elastic": [0.0], "energy_total": [0.0]}).ok
    assert any(text.startswith("temperature: body: ") for text in held.warned) == told


@pytest.mark.parametrize(("beyond", "fine"), [(0.5, True), (1.5, False), (-0.5, True), (-1.5, False)])
def test_a_repaired_body_may_leave_its_data_by_round_off(scene, beyond, fine):
    """A millionth of the range, above and below."""
    theta = scene.bodies[0].thermal.theta
    theta[:] = np.linspace(0.0, 1e9, len(theta))
    data = Guards(scene).data[0]
    assert not data.heats and (data.low, data.high) == (0.0, 1e9)
    theta[0] = 1e9 * (1 + ROUNDING * beyond) if beyond > 0 else 1e9 * ROUNDING * beyond
    body = scene.bodies[0]._replace(thermal=scene.bodies[0].thermal._replace(zero=1e4))
    assert (data.judge(body) is None) == fine and ROUNDING == 1e-6


@pytest.mark.parametrize(("beyond", "fine"), [(0.5, True), (2.0, False)])
def test_a_body_of_one_temperature_has_the_round_off_of_its_zero(scene, beyond, fine):
    """Without a range there is a millionth of 400 K."""
    theta = scene.bodies[0].thermal.theta
    theta[:] = 0.0
    data = Data(scene.bodies[0], None, 0.0)
    theta[0] = beyond * 1e-6 * scene.bodies[0].thermal.zero
    assert (data.judge(scene.bodies[0]) is None) == fine


def test_what_heats_itself_has_no_bounds(core, scene):
    assert Data(build(core.experiment(1, drop=("surfaces",))).bodies[0], None, 0.0).heats and not Data(scene.bodies[0], None, 0.0).heats


def test_the_sky_is_one_of_the_data(scene):
    body, sky = scene.bodies[0], Radiation(np.array([0.8, 0.0]), np.array([500.0, 900.0]), np.array([20.0, 0.0]))
    none = np.zeros(2)
    surface = SimpleNamespace(beta=none, outside=none, drift=none, flux=none, radiation=sky)
    data, zero = Data(body, None, 0.0), body.thermal.zero
    data.meet(body._replace(surface=surface))
    assert data.high == pytest.approx(520.0 - zero) and data.low == float(body.thermal.theta.min()) and isinstance(body.surface, NoExchange)


def test_energy_is_judged_where_nothing_gives_any(scene, core):
    assert Guards(scene).judged and not Guards(build(core.experiment(1, drop=("surfaces",)))).judged
    scene.references = (SimpleNamespace(load=np.ones(3)),)
    assert not Guards(scene).judged


def test_the_energy_of_a_strain_that_is_round_off(scene):
    body, strain = scene.bodies[0], ROUNDED * np.finfo(float).eps
    assert rounded(body) == pytest.approx(0.5 * (body.elastic.lam + 2 * body.elastic.mu) * strain**2 * float(body.particles.V0.sum()), rel=1e-12, abs=0.0)


def test_what_is_wrong_with_the_state_is_told_before_temperatures(scene):
    held, clock = Guards(scene), Clock(scene)
    assert held.whole(scene, clock).ok
    scene.bodies[0].particles.J[0] = -0.2
    assert held.whole(scene, clock).kind == "inverted"


@pytest.mark.parametrize(
    ("moderate", "gaps", "told"),
    [
        (math.inf, (1.5, 1e-12), False),  # cells: comes to the side and no further
        (math.inf, (1.5, -1e-6), True),
        (0.7, (3.0, 1.1), False),  # where the frame was chosen, a cell is kept
        (0.7, (3.0, 0.9), True),
        (0.7, (1.5, 0.9), False),  # what begins nearer, half of its gap
        (0.7, (1.5, 0.7), True),
        (0.7, (0.0, 0.0), False),  # lies on it
    ],
)
@pytest.mark.parametrize("end", ["min", "max"])
def test_a_side_on_which_a_body_did_not_lie(scene, moderate, gaps, told, end):
    h, size = scene.space.h, (extents(scene.space)[0] - 1 - 2 * PAD) * scene.space.h
    assert size == pytest.approx(2.0)
    at = {"min": [0.5 * size] * 2, "max": [0.5 * size] * 2} | {end: [gap * h if end == "min" else size - gap * h for gap in gaps]}
    series = {f"position_{name}_x": where for name, where in at.items()} | {"strain_max": [0.0]}
    one = SimpleNamespace(space=scene.space, moderate=moderate, references=())
    assert bool(outgrown(one, series)) == told and guards.AWAY == 1.0


@pytest.mark.parametrize("q", [1.0, -1.0])
def test_a_flux_bounds_temperatures_on_its_other_side(core, q):
    """What takes in heat may become as hot as it likes, but no colder than it was; its range is what it reached."""
    body = build(core.experiment(1, surfaces=[{"of": "body", "flux": {"q": q}}])).bodies[0]
    body.thermal.theta[:] = 0.0
    data = Data(body, None, NOTICEABLE)
    data.heats = False
    body.surface.flux[:] = q
    for beyond, fine in ((100.0, True), (-0.1, True), (-2.0, False)):
        body.thermal.theta[:2] = q * 100.0, q * beyond
        assert (data.judge(body) is None) == fine
    assert data.over == pytest.approx(0.02, rel=1e-3)


@pytest.mark.parametrize("first", ["cold", "warm"])
def test_a_body_may_feel_what_its_neighbour_has_just_met(first):
    """The neighbour met air of 250 K in the heat step that is over. Whichever is judged first: it was the order in the config that decided."""
    heat = {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.0}}, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}}}
    places = {"cold": (0.5, 1.0), "warm": (0.0, 0.5)}
    names = sorted(places, key=lambda name: name != first)
    found = build(mpm.load({
        "grid": {"dimension": 1, "size": [1.0], "cell": 0.125}, "materials": {"m": heat}, "time": {"end": 1.0}, "output": {"every": 1.0},
        "bodies": {name: {"shape": {"box": {"lower": [low], "upper": [high]}}, "temperature": 300.0, "material": "m"}
                   for name in names for low, high in [places[name]]},
        "surfaces": [{"of": "cold", "side": "right", "convection": {"beta": 1.0, "outside": 250.0}}],
    }))  # fmt: skip
    held, b = Guards(found), names.index("warm")
    found.bodies[b].thermal.theta[0] -= 1.0
    assert found.meeting.warms and held.whole(found, Clock(found)).ok
