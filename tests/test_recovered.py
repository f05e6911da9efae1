"""Stress recovered from patches: linear stress as it is, on particles and nodes, and of order 2 where the particles' own is of order 1."""

from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.fields import cauchy, grid_fields, recovered
from mpm.scene.build import build

SHOCK = Path(__file__).parents[1] / "configs" / "verification" / "thermal_shock.yaml"


def body(dimension):
    """A box that ends anywhere in its cells; axisymmetric ones are rings."""
    D = {1: 1, 2: 2, "axisymmetric": 2}[dimension]
    return mpm.load({
        "grid": {"dimension": dimension, "size": [2.0, 1.0][:D], "cell": 0.125}, "time": {"end": 1}, "output": {"snapshots": {"every": 1, "grid": ["stress"]}},
        "bodies": {"b": {"shape": {"box": {"lower": [0.33, 0.2][:D], "upper": [1.41, 0.77][:D]}}, "material": "m"}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}}}},
    })  # fmt: skip


@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric"])
def test_linear_stress_comes_out_as_it_is(dimension):
    scene = build(body(dimension))
    p, (one,) = scene.bodies[0].particles, scene.bodies
    e = 0.01 + 0.02 * p.x @ np.array([1.0, -0.7])[: p.x.shape[1]]
    p.B[:, :3] = np.expm1(2 * e)[:, None]
    sigma = cauchy(one)
    assert np.ptp(sigma[:, 0]) > 0.1
    np.testing.assert_allclose(recovered(scene.space, one), sigma, atol=1e-12)
    found = grid_fields(scene)
    names = {1: "xx yy zz", 2: "xx yy zz xy", "axisymmetric": "rr zz tt rz"}[dimension].split()
    assert list(found) == [f"stress_{name}" for name in names]
    inside = found[f"stress_{names[0]}"]
    size = inside.shape[::-1]
    x = np.stack(np.meshgrid(*(0.125 * np.arange(count) for count in size), indexing="ij"), -1) @ np.array([1.0, -0.7])[: len(size)]
    known = np.isfinite(inside)
    assert known.sum() > 5
    np.testing.assert_allclose(inside[known], ((3 * 3 + 2 * 2) * (0.01 + 0.02 * x)).T[known], rtol=1e-5, atol=1e-6)


@pytest.mark.slow  # 3 runs
def test_thermal_stress_of_particles_is_of_order_2_once_recovered():
    """Thermal shock in the updated frame: largest error of the stress across over its peak."""
    own, patches = [], []
    for cell in (0.125, 0.0625, 0.03125):
        fields = ["position", "reference_position", "stress", "stress_recovered"]
        experiment = mpm.load(SHOCK, {"grid.cell": cell, "output.snapshots": {"every": 0.1, "particles": fields}, "sweep": None})
        from mpm.verification import exact_solution

        run = mpm.run_point(experiment)
        last = run.particles[-1]
        wanted = exact_solution(experiment).fields["stress"](last["reference_position"], 0.1)
        for errors, name in ((own, "stress"), (patches, "stress_recovered")):
            errors.append(np.abs(last[name] - wanted)[:, 1].max() / np.abs(wanted).max())
    print(own, patches)
    assert np.polyfit(np.log([4, 2, 1]), np.log(patches), 1)[0] > 1.5 and patches[-1] < 0.3 * own[-1]
