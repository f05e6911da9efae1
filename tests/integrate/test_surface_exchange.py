"""Robin exchange of bodies that cross the grid, against exact series: second order, wherever the body lies (docs/physics.md 11)."""

import numpy as np
import pytest

from mpm.verification import exact_solution

END = 0.2  # Fourier number


def error(core, experiment, speed):
    """Root-mean-square error of the temperature, in units of its fall, of a body that has moved by speed * END along x."""
    scene, run = core.play(experiment)
    assert run.outcome.ok
    body = scene.bodies[0]
    x = body.particles.x.copy()
    x[:, 0] -= speed * END
    wrong = (core.HOT + body.thermal.theta - exact_solution(experiment)(x, END)) / (core.HOT - core.COLD)
    return np.sqrt(np.average(wrong**2, weights=body.particles.V0 * body.particles.J))


def sections(core, shape, biot, speed, D, transfer="apic"):
    return {
        "bodies": {"body": {"shape": shape, "temperature": core.HOT, "material": "solid", "velocity": [speed] + [0.0] * (D - 1)}},
        "materials": {
            "solid": {
                "density": 1.0,
                "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}},
                "heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}},
                "expansion": {"modulus": {"gamma": 0.0, "reference": core.HOT}},
                "heating": {"elastic": {}},
            }
        },
        "surfaces": [{"of": "body", "convection": {"beta": biot, "outside": core.COLD}}],
        "time": {"end": END},
        "output": {"every": END},
        "method": core.methods(transfer),
    }


def slab(core, biot, n, offset, speed=1.0, pace=None):
    """Half-thickness 1, n cells to it, thrown across the grid; `offset` in cells, heat steps of pace h^2 (automatic unless given)."""
    h = 1 / n
    lower = 0.5 + offset * h
    config = sections(core, {"box": {"lower": [lower], "upper": [lower + 2]}}, biot, speed, 1)
    if pace is not None:
        config["method"] = config["method"] | {"heat_step": pace * h * h}
    return core.experiment(grid={"dimension": 1, "size": [3.5], "cell": h}, exact={"robin_slab": {}}, **config)


def disc(core, biot, n, speed=1.0):
    """Radius 1, n cells to it."""
    h = 1 / n
    config = sections(core, {"ball": {"centre": [1.5 + 0.3 * h, 1.5 - 0.1 * h], "radius": 1.0}}, biot, speed, 2)
    return core.experiment(2, grid={"dimension": 2, "size": [3.5, 3.0], "cell": h}, exact={"robin_cylinder": {}}, **config)


# Heat steps of PACE h^2. Of Euler's steps at 0.15 and Bi = 0.1 the error of the step and APIC's damping, both of order 2 and of opposite sign, nearly cancel
# (5e-6 at n = 32) and what is left shows order 1.6; at a quarter of the step damping is alone: 1.8e-4, 5.2e-5, 1.4e-5, 3.7e-6 at n = 8, 16, 32, 64.
PACES = [pytest.param(0.1, 0.0375, marks=pytest.mark.wide), (1.0, 0.15), (10.0, 0.15)]


@pytest.mark.parametrize(("biot", "pace"), PACES)
def test_slab_at_the_worst_of_four_offsets(core, biot, pace):
    worst = [max(error(core, slab(core, biot, n, offset, pace=pace), 1.0) for offset in (0, 0.15, 0.3, 0.45)) for n in (8, 16, 32)]
    assert core.order(worst) > 1.8 and worst[-1] < 1e-3


@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_slab_at_a_fixed_temperature(core, offset):
    """beta = inf in a moving body: implicit heat, the same order."""
    errors = [error(core, slab(core, ".inf", n, offset), 1.0) for n in (8, 16)]
    assert core.order(errors) > 1.7 and errors[-1] < 2e-3


@pytest.mark.slow
@pytest.mark.parametrize(("biot", "pace"), PACES)
def test_slab_refined(core, biot, pace):
    worst = [max(error(core, slab(core, biot, n, offset, pace=pace), 1.0) for offset in (0, 0.15, 0.3, 0.45)) for n in (8, 16, 32, 64)]
    assert core.order(worst) > 1.8 and worst[-1] < 2e-4


def test_disc_across_the_grid(core):
    errors = [error(core, disc(core, 10.0, n), 1.0) for n in (6, 12)]
    assert core.order(errors) > 1.8 and errors[-1] < 1.2e-3


@pytest.mark.slow
@pytest.mark.parametrize("biot", [1.0, 10.0])
def test_disc_across_the_grid_refined(core, biot):
    errors = [error(core, disc(core, biot, n), 1.0) for n in (6, 12, 24)]
    assert core.order(errors) > 1.8 and errors[-1] < 3e-4
