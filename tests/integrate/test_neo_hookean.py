"""The law without principal axes against its own form in principal stretches, and the chunk that carries it. In plain Python."""

import numpy as np
import pytest

import mpm
from mpm.integrate import stress_neo_hookean  # noqa: F401 - registers the law
from mpm.integrate.strain import JACOBIAN, REPORT, STRAIN
from mpm.integrate.stress_hencky import ACROSS, stress_plane, stress_volume
from mpm.materials import NeoHookean, energy, moduli, stress
from mpm.state import Body, Isothermal, NoExchange, NoExpansion, NoHeating, Particles
from mpm.transfer import new_chunk

LAW, N = NeoHookean(3.0, 5.0), 13


def stretched(D):
    """A body and its chunk with random elastic strains, and those strains as tensors (N, 3, 3)."""
    rng = np.random.default_rng(D)
    F = np.eye(3) + 0.3 * rng.uniform(-1, 1, (N, 3, 3))
    if D == 2:
        F[:, 2, :2] = F[:, :2, 2] = 0.0
    b, chunk = F @ F.transpose(0, 2, 1), new_chunk(D, np.zeros(1), False, False)
    places = {2: [(0, 0), (1, 1), (2, 2), (0, 1)], 3: [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]}[D]
    for row, (i, j) in enumerate(places):
        chunk.e[row, :N] = b[:, i, j] - (i == j)
    chunk.e[JACOBIAN, :N] = np.linalg.det(F)
    particles = Particles(np.zeros((N, D)), np.zeros((N, D)), np.zeros((N, D, D)), np.zeros((N, len(places))), np.ones(N), np.ones(N), np.ones(N))
    return Body(particles, Isothermal(300.0), NoExchange(), LAW, None, NoExpansion(), NoHeating()), chunk, b


@pytest.mark.parametrize("D, react", [(2, stress_plane), (3, stress_volume)])
def test_stress_of_a_chunk_is_that_of_its_principal_stretches(D, react):
    body, chunk, b = stretched(D)
    report = np.zeros(REPORT)
    react(LAW, body, chunk, 0, N, 0.1, report)
    values, axes = np.linalg.eigh(b)
    principal = np.array([stress(LAW, *(0.5 * np.log(row)), 0.0) for row in values])
    expected = np.einsum("pik,pk,pjk->pij", axes, principal, axes)
    assert np.allclose(chunk.S[:, :, :N].transpose(2, 0, 1), expected[:, :D, :D], atol=1e-13)
    if D == 2:
        assert np.allclose(chunk.e[ACROSS, :N], expected[:, 2, 2], atol=1e-13)
    assert np.array_equal(body.particles.B, chunk.e[: body.particles.B.shape[1], :N].T)
    J = np.sqrt(values.prod(axis=1))
    stiffest = (LAW.lam * J * (2 * J - 1) + 2 * LAW.mu * values[:, -1]).max() / (LAW.lam + 2 * LAW.mu)
    assert stiffest <= 1 - report[STRAIN] < 1.5 * stiffest  # what the step limit divides by: never below the wave modulus


def test_the_step_limit_knows_a_bar_that_thins_as_it_stretches():
    """b = (4, 1/2, 1/2): its trace grows less than its largest entry."""
    body, chunk, _ = stretched(3)
    chunk.e[:6, :N], chunk.e[JACOBIAN, :N] = 0.0, 1.0
    chunk.e[:3, 4] = 3.0, -0.5, -0.5
    report = np.zeros(REPORT)
    stress_volume(LAW, body, chunk, 0, N, 0.1, report)
    assert 1 - report[STRAIN] == pytest.approx((LAW.lam + 2 * LAW.mu * 4) / (LAW.lam + 2 * LAW.mu))


@pytest.mark.plain
def test_a_bar_that_hardly_swings_is_hencky_s(core):
    """From the config to the record: at strains of 1e-5 the two laws store the same energy, to the strain."""

    def push(scene):
        particles = scene.bodies[0].particles
        particles.v[:] = 1e-5 * np.sin(np.pi * particles.x)

    stored = {}
    for law in ("hencky", "neo_hookean"):
        config = core.config(1, surfaces=[], time={"end": 0.5, "step": 0.005}, output={"every": 0.05, "observables": ["energy.elastic"]})
        config["materials"]["solid"] = {"density": 2.0, "elastic": {law: {"lam": 3.0, "mu": 2.0}}}
        _, run = core.play(mpm.load(config), push)
        assert run.outcome.ok, run.outcome
        stored[law] = run.series["energy_elastic"]
    assert np.all(stored["hencky"][1:] > 0) and np.allclose(stored["neo_hookean"], stored["hencky"], rtol=1e-3, atol=0)


def test_what_it_is_not_is_refused(core):
    config = core.config(1)
    config["materials"]["solid"]["elastic"] = {"neo_hookean": {"E": {"table": {"temperature": [280, 400], "value": [1, 2]}}, "nu": 0.3}}
    with pytest.raises(mpm.ConfigError) as caught:
        mpm.load(config)
    assert "one E at all temperatures" in str(caught.value) and "it has no expansion" in str(caught.value)


def test_stress_is_the_slope_of_energy_and_hookean_when_small():
    e, step = np.array([0.2, -0.1, 0.05]), 1e-6
    for k in range(3):
        d = step * np.eye(3)[k]
        assert (energy(LAW, *(e + d)) - energy(LAW, *(e - d))) / (2 * step) == pytest.approx(stress(LAW, *e, 0.0)[k], rel=1e-8)
    small = 1e-7 * e
    lam, mu = moduli(LAW)
    assert np.allclose(stress(LAW, *small, 0.0), 2 * mu * small + lam * small.sum(), rtol=1e-6, atol=0)
