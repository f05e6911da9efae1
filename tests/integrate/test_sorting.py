"""Sorted particles: the same physics, the same names. (Cuts: tests/faults/test_restart.py.)"""

import numpy as np
import pytest

from mpm.integrate import sorting as module
from mpm.integrate.sorting import first_nodes, mixed, parts, permute, sorting
from mpm.sources.given import Given
from mpm.state import PER_PARTICLE, Source

FLOW = {"ellipse": {"M": 0.05, "p0": 1.0, "eta": 0.2}}
LOOKS = {
    "every": 0.5, "snapshots": {"every": 0.5, "particles": ["position", "velocity", "temperature", "J"]}, "probes": {"p": [0.65, 0.7]},
    "observables": ["time_to.p.395_K"],
}  # fmt: skip


def scene(core, **sections):
    """A warm block that flies, stretches, cools and hits a wall."""
    air = [{"of": "body", "convection": {"beta": 1.0, "outside": 300}}]
    body = core.config(2)["bodies"]["body"] | {"velocity": [0.6, 0.3]}
    changes = {"method.particles": 3, "time.end": 1.0, "materials.solid.expansion.modulus.gamma": 0.01}
    return core.experiment(2, changes | sections.pop("changes", {}), **{"surfaces": air, "bodies": {"body": body}, "output": LOOKS} | sections)


def shuffled(scene):
    """The particles of every body in random order."""
    for body in scene.bodies:
        permute(body, np.random.default_rng(0).permutation(len(body.particles.m)))


@pytest.fixture
def small(monkeypatch):
    """Sort as soon as there is a particle out of place."""
    monkeypatch.setattr(module, "LEAST", 1)
    monkeypatch.setattr(module, "MIXED", 0.0)
    monkeypatch.setattr(module, "FAR", 0)
    monkeypatch.setattr(module, "EVERY", 2)


def test_sorting_is_stable_and_complete():
    values = np.random.default_rng(0).integers(-5, 40, 1000)
    assert np.array_equal(sorting(values), np.argsort(values, kind="stable"))


def test_a_lattice_is_in_order_and_a_shuffle_is_not(core):
    from mpm.scene.build import build

    made = build(core.experiment(2, {"method.particles": 4, "grid.cell": 0.05}))
    x, far = made.bodies[0].particles.x, module.FAR * made.space.n1
    assert mixed(first_nodes(made.space, x), far) < 0.01 < 0.2 < mixed(first_nodes(made.space, np.random.default_rng(0).permutation(x)), far)


def test_every_array_of_particles_is_named(core):
    """What has a row a particle and is not in PER_PARTICLE would stay behind; scratch may."""
    from mpm.scene.build import build

    solid = core.config(2)["materials"]["solid"]
    latched = solid | {"expansion": {"latched": {"c": 0.05, "reference": 300, "set": 450}}, "heating": {"dissipation": {}}, "flow": FLOW}
    load = [{"of": "body", "side": "right", "traction": {"nominal": [0.1, 0.0], "ramp": 0.1}}]
    pressed = [{"of": "body", "side": "right", "traction": {"pressure": 0.1}}]
    seen = set()
    sets = {"ellipse": FLOW["ellipse"] | {"M": {"set": {"raw": 0.05, "baked": 0.1, "rate": 0.1}}}}
    given = [{"of": "body", "heat": {"formula": "1 + x"}, "force": [{"formula": "y"}, 0.0]}]
    materials = ({"solid": latched}, {"solid": solid | {"flow": sets}})
    poured = {"body": core.config(2)["bodies"]["body"] | {"inflow": {"velocity": [0.5, 0.0]}}}
    for sections in ({"loads": load}, {"loads": pressed}, *({"materials": one} for one in materials), {"sources": given}, {"bodies": poured}):
        body = build(core.experiment(2, {"method.particles": 3}, **sections)).bodies[0]
        N = len(body.particles.m)
        found = {(type(part), name) for part in parts(body) for name, a in zip(part._fields, part, strict=True) if isinstance(a, np.ndarray) and len(a) == N}
        found -= {(Given, "theta")}
        assert found == {(kind, name) for kind, name in found if name in PER_PARTICLE.get(kind, ())}
        seen |= found
    assert seen == {(kind, name) for kind, names in PER_PARTICLE.items() for name in names if kind is not Source}


@pytest.mark.wide
def test_sorted_particles_do_what_unsorted_ones_do(core, small, monkeypatch):
    made, run = core.play(scene(core), shuffled)
    taken = made.order
    monkeypatch.setattr(module, "LEAST", 10**9)
    _, plain = core.play(scene(core), shuffled)
    assert taken.original == [None] and run.steps == plain.steps > 10
    for name, values in plain.series.items():
        assert np.allclose(run.series[name], values, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(values).max())), name
    for one, other in zip(run.particles, plain.particles, strict=True):
        for name in one:
            assert np.allclose(one[name], other[name], rtol=1e-9, atol=1e-10), name
    assert any(not np.array_equal(run.series[name], plain.series[name]) for name in plain.series)  # they were sorted


def test_only_owners_of_surface_carry_their_deformation(core, small):
    """A block that flies and turns without force, its particles sorted as they go: F of every piece is that of its own particle's motion."""
    rate = np.array([[0.2, 0.5], [-0.3, 0.1]])

    def stretching(scene):
        shuffled(scene)
        p = scene.bodies[0].particles
        p.v[:], p.C[:] = (p.x - 0.7) @ rate.T, rate

    changes = {"time.end": 0.5, "time.step": 0.01, "lam": 1e-9, "mu": 1e-9, "method.gradient": "mls"}
    made, run = core.play(scene(core, changes=changes), stretching)
    body = made.bodies[0]
    surface, owners = body.surface, np.unique(body.surface.owner)
    assert run.outcome.ok and len(surface.F) == len(owners) < 0.7 * len(body.particles.m)
    assert np.array_equal(np.sort(surface.row), np.concatenate([np.full(len(surface.row) - len(owners), -1), np.arange(len(owners))]))
    F, J = surface.F[surface.row[owners]], body.particles.J[owners]
    assert np.allclose(np.linalg.det(F), J, rtol=1e-12) and np.ptp(J) > 1e-3  # J is carried by every particle itself


def spoil(p):
    p.C[7] = np.nan


def throw(p):
    p.x[7], p.v[7] = 1.9, 60.0


@pytest.mark.parametrize("how", [pytest.param(spoil, id="before a step"), pytest.param(throw, id="in a step", marks=pytest.mark.wide)])
def test_a_failure_names_the_particle_by_its_own_number(core, small, how):
    def prepare(scene):
        shuffled(scene)
        how(scene.bodies[0].particles)

    _, run = core.play(scene(core, changes={"time.step": 0.1}), prepare)
    assert not run.outcome.ok and "particle 7," in run.outcome.message
