"""From a config to a scene: positions, laws, walls, what is refused."""

import numpy as np
import pytest

from mpm.boundary import CONTACT, SLIP
from mpm.config import ConfigError
from mpm.materials import Hencky
from mpm.scene.build import build, output_times
from mpm.scene.law import elastic_law
from mpm.scene.refusal import SceneError
from mpm.state import PAD, NoExchange, NoExpansion, NoHeating
from mpm.transfer import Apic, Bspline, Flip, Mls


@pytest.mark.parametrize("pair", [{"E": 5.2, "nu": 0.3}, {"lam": 3.0, "mu": 2.0}, {"K": 13 / 3, "mu": 2.0}])
def test_pairs_of_moduli(core, pair):
    law = elastic_law(core.experiment(1, materials={"solid": {"density": 1, "elastic": {"hencky": pair}}}, surfaces=[]).materials["solid"].elastic)
    assert law == (Hencky(2.0, 3.0) if "E" not in pair else pytest.approx(Hencky(2.0, 3.0)))


@pytest.mark.parametrize("expansion", [{"modulus": {"gamma": 0.26}}, {"linear": {"coefficient": 0.02}}, {"source": {"c": 0.26 / 3}}])
def test_stress_temperature_modulus_in_three_ways(core, expansion):
    """gamma = 3 K alpha_L = c lam, with K = 13/3 and lam = 3; the shift is to the reference."""
    kind = next(iter(expansion))
    material = core.config(1)["materials"]["solid"] | {"expansion": {kind: expansion[kind] | {"reference": 350.0}}}
    body = build(core.experiment(1, materials={"solid": material})).bodies[0]
    assert body.expansion.gamma == pytest.approx(0.26) and body.expansion.shift == core.HOT - 350.0
    assert body.heating.gamma == body.expansion.gamma


@pytest.mark.parametrize("offset", [0.0, 0.3, -0.45])
def test_offset_moves_bodies_and_probes_alike(core, offset):
    experiment = core.experiment(2, {"method.offset": [offset, 0.0]}, output={"probes": {"corner": [0.6, 0.6]}})
    scene = build(experiment)
    p, shift = scene.bodies[0].particles, offset * 0.25
    assert np.average(p.x, axis=0, weights=p.V0) == pytest.approx([0.975 + shift, 0.975])
    assert p.V0.sum() == pytest.approx(0.75**2) and scene.watch.probes["corner"] == pytest.approx([0.6 + shift, 0.6])


def test_grid_has_room_outside_the_domain(core):
    scene = build(core.experiment(3))
    assert (scene.space.n0, scene.space.n1, scene.space.n2) == (9 + 2 * PAD,) * 3 and scene.space.h == 0.25


def test_particles_a_cell(core):
    body = {"shape": {"box": {"lower": [0.5, 0.5], "upper": [1.0, 1.25]}}, "material": "solid"}
    for count in (1, 2, 3):
        assert len(build(core.experiment(2, {"method.particles": count}, bodies={"body": body})).bodies[0].particles.m) == 6 * count**2


def test_walls_gravity_and_the_axis(core):
    scene = build(core.experiment("axisymmetric", walls={"bottom": "stick", "outer": "contact"}, gravity=[0, -9.81]))
    assert scene.walls[:2].tolist() == [[SLIP, CONTACT], [CONTACT, CONTACT]] and scene.gravity.tolist() == [[0, -9.81]]


def test_methods(core):
    scene = build(core.experiment(1))
    assert (scene.scheme, scene.gradient, scene.blend, scene.affine) == (Apic(), Mls(), 1.0, 1.0)
    scene = build(core.experiment(1, method={"transfer": {"flip": {"blend": 0.1}}, "temperature": {"flip": {"blend": 0.2}}, "gradient": "bspline"}))
    assert (scene.scheme, scene.gradient, scene.blend, scene.affine) == (Flip(0.1, 0.0), Bspline(), 0.2, 0.0)
    scene = build(core.experiment(1, method={"transfer": {"pic": {}}, "temperature": {"pic": {}}}))
    assert (scene.scheme, scene.blend, scene.affine) == (Flip(1.0, 0.0), 1.0, 0.0)


def test_absent_physics_is_an_object(core):
    body = build(core.experiment(1, drop=("surfaces", "expansion", "heating"))).bodies[0]
    assert (body.surface, body.expansion, body.heating) == (NoExchange(), NoExpansion(), NoHeating())


def test_rotation_about_the_centre_of_mass(core):
    body = {"shape": {"box": {"lower": [0.6] * 3, "upper": [1.35] * 3}}, "material": "solid", "velocity": [0.1, 0, 0], "angular_velocity": [0.5, -0.8, 1.2]}
    p = build(core.experiment(3, bodies={"body": body})).bodies[0].particles
    arm = p.x - 0.975
    assert np.allclose(p.v, np.array([0.1, 0, 0]) + np.cross([0.5, -0.8, 1.2], arm))
    assert np.allclose(np.einsum("pcd,pd->pc", p.C, arm), p.v - np.array([0.1, 0, 0]))


def test_output_times_end_at_the_end(core):
    assert np.allclose(output_times(core.experiment(1, {"time.end": 1.0, "output.every": 0.3})), [0, 0.3, 0.6, 0.9, 1.0])
    assert np.allclose(output_times(core.experiment(1, {"time.end": 0.9, "output.every": 0.3})), [0, 0.3, 0.6, 0.9])


def refused(core, *words, changes=None, dimension=1, **sections):
    with pytest.raises(SceneError) as told:
        build(core.experiment(dimension, changes, **sections))
    assert all(word in str(told.value) for word in words), told.value


def test_refused_with_advice(core):
    refused(core, "method.offset", changes={"method.offset": [0.3, 0.0]}, dimension="axisymmetric")
    rigid = core.config(1)["bodies"] | {"stone": {"shape": {"box": {"lower": [1.5], "upper": [1.75]}}, "material": "stone"}}
    materials = core.config(1)["materials"] | {"stone": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}}
    assert build(core.experiment(1, bodies=rigid, materials=materials)).meeting.held.tolist() == [False, True]


def test_exchange_without_conduction_is_refused(core):
    with pytest.raises(ConfigError, match="'solid' conducts no heat"):
        core.experiment(1, {"kappa": 0.0})


TRIANGLE = {"polygon": {"vertices": [[0.5, 0.5], [1.5, 0.5], [1.0, 1.5]]}}
DIAMOND = {"box": {"lower": [0.5, 0.5], "upper": [1.5, 1.5], "angle": "45 deg"}}
BALL, CYLINDER = {"ball": {"centre": [0.0, 1.0], "radius": 0.5}}, {"cylinder": {"radius": 0.5, "height": 1.0, "base": [0.0, 0.5]}}
PIPE = {"box": {"lower": [0.5, 0.5], "upper": [1.0, 1.5]}}


@pytest.mark.parametrize(
    ("dimension", "form", "side", "there"),
    [(2, TRIANGLE, "top", False), (2, TRIANGLE, "bottom", True), (2, DIAMOND, "top", False), (2, DIAMOND, "left", True),
     ("axisymmetric", CYLINDER, "inner", False), ("axisymmetric", BALL, "inner", False),
     ("axisymmetric", PIPE, "inner", True), ("axisymmetric", CYLINDER, "outer", True)],
)  # fmt: skip
@pytest.mark.parametrize("acts", ["rigid", "moving", "traction"])
def test_what_would_act_on_a_side_that_is_not_there_is_refused(dimension, form, side, there, acts):
    """A flux on the top of a triangle that stands on its base did nothing, and the run was ok."""
    import mpm
    from mpm.runner import refuse

    solid = {"density": 2.0, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.5}}} | ({"elastic": {"hencky": {"E": 1.0, "nu": 0.3}}} if acts != "rigid" else {})
    entry = {"of": "b", "side": side}
    acting = {"loads": [entry | {"traction": {"pressure": 1e-3}}]} if acts == "traction" else {"surfaces": [entry | {"flux": {"q": 1.0}}]}
    experiment = mpm.load({
        "grid": {"dimension": dimension, "size": [2.0, 2.0], "cell": 0.25}, "bodies": {"b": {"shape": form, "temperature": 300, "material": "solid"}},
        "materials": {"solid": solid}, "time": {"end": 1.0}, **acting,
    })  # fmt: skip
    if there:
        return refuse(experiment)
    with pytest.raises(SceneError, match=f"no part of the surface of b is its side '{side}'") as caught:
        refuse(experiment)
    assert caught.value.at == (next(iter(acting)), 0, "side")


def test_a_conductance_through_which_nothing_can_pass_is_refused():
    """A body of kappa = 0 or without heat took in nothing, and the run was ok; without a conductance, or with one of 0, that is what was asked for."""
    import mpm
    from mpm.runner import refuse

    def pair(conductance, kappa=0.0):
        bodies = {name: {"shape": {"box": {"lower": [low], "upper": [low + 1.0]}}, "material": name} for name, low in (("a", 1.0), ("b", 2.0))}
        heat = {"heat": {"fourier": {"kappa": kappa, "alpha": 1.5}}} if kappa is not None else {}
        solid = {"density": 2.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.3}}}
        materials = {"a": solid | heat, "b": solid | {"heat": {"fourier": {"kappa": 1.0, "alpha": 1.5}}}}
        data = {"grid": {"dimension": 1, "size": [4.0], "cell": 0.125}, "bodies": bodies, "materials": materials, "time": {"end": 1.0}}
        return mpm.load(data | {"contacts": [{"between": ["a", "b"], "friction": 0.0} | ({"conductance": conductance} if conductance is not None else {})]})

    for conductance, kappa in ((0.0, 0.0), (None, 0.0), (5.0, 1.0), (0.0, None)):
        refuse(pair(conductance, kappa))
    with pytest.raises(SceneError, match="kappa of a is 0") as caught:
        refuse(pair(5.0))
    assert caught.value.at == ("contacts", 0, "conductance")
    with pytest.raises(ConfigError, match=r"contacts.0.conductance: a has no heat law"):
        pair(5.0, None)
