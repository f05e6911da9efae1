"""Tractions by present area within an implicit step: their slopes against differences, a free body that a pressure squeezes, rest that knows no steps."""

from types import SimpleNamespace

import numpy as np
import pytest

import mpm
from mpm.implicit.following import follow, new_following, stiffen, twist
from mpm.implicit.matrix import Band
from mpm.runner import run_point

E, NU = 2e4, 0.2  # Pa, -
LAM, MU = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
FREE = {2: {"box": {"lower": [0.07, 0.06], "upper": [0.17, 0.16]}}, "axisymmetric": {"cylinder": {"radius": 0.1, "height": 0.1, "base": [0, 0.06]}},
        3: {"box": {"lower": [0.07, 0.06, 0.05], "upper": [0.17, 0.16, 0.15]}}}  # fmt: skip


def pressed(dimension, frame, pressure, side="all", **more):
    made = {
        "grid": {"dimension": dimension, "size": [0.25] * (3 if dimension == 3 else 2), "cell": 0.05},
        "bodies": {"body": {"shape": FREE[dimension], "material": "dough"}},
        "materials": {"dough": {"density": 600, "elastic": {"hencky": {"E": E, "nu": NU}}}},
        "loads": [{"of": "body", "side": side, "traction": {"pressure": pressure}}],
        "method": {"mechanics": "implicit", "frame": frame}, "time": {"end": 100, "step": 100}, "output": {"every": 100},
    }  # fmt: skip
    return run_point(mpm.load(made | more))


@pytest.mark.plain
@pytest.mark.parametrize("D", [1, 2, 3])
def test_slopes_of_what_follows(D):
    """Minus the slopes are the matrix and the twist together, the one symmetric, the other skew; on points with every kind of load, hoops and mirrors."""
    rng, Q, M, A = np.random.default_rng(7), 3, 4, 6
    node, flip = np.stack([rng.permutation(A)[:M] for _ in range(Q)]), rng.integers(0, 2**D, (Q, M)).astype(np.int8)
    normal = rng.normal(size=(Q, D))
    F = np.eye(D) + 0.1 * rng.normal(size=(Q, D, D))
    acts = [rng.normal(size=size) for size in ((Q, D), (Q, D, D), (Q, D), (Q, D, D))]
    one = new_following(node, flip, rng.uniform(size=(Q, M)), rng.normal(size=(Q, M, D)), F, np.array([1.1, 0.9, 1.0]), np.array([0.3, 0.0, 0.2]),
                        *acts, normal / np.linalg.norm(normal, axis=1)[:, None], np.array([0.4, 0.0, -0.7]))  # fmt: skip
    eq, u = np.arange(A * D).reshape(A, D), 0.02 * rng.normal(size=(A, D))

    def forces(x):
        out = np.zeros((A, D))
        assert follow(one, x, out)
        return out

    step, way, other = 1e-6, rng.normal(size=(A, D)), rng.normal(size=(A, D))
    right = -(forces(u + step * way) - forces(u - step * way)) / (2 * step)
    forces(u)
    band, turned, back = Band(np.zeros((A * D, A * D))), np.zeros((A, D)), np.zeros((A, D))
    stiffen(one, SimpleNamespace(eq=eq), band)
    low = np.array([[band.values[j, i - j] if i >= j else 0.0 for j in range(A * D)] for i in range(A * D)])
    twist(one, way, turned)
    twist(one, other, back)
    found = ((low + np.tril(low, -1).T) @ way.ravel()).reshape(A, D) + turned
    np.testing.assert_allclose(found, right, rtol=0, atol=1e-8 * np.abs(right).max())
    assert np.sum(other * turned) == pytest.approx(-np.sum(way * back)) and (D == 1 or np.abs(turned).max() > 0.1)


@pytest.mark.parametrize("frame", ["updated", "total"])
@pytest.mark.parametrize("dimension", [pytest.param(each, marks=pytest.mark.slow if each == 3 else pytest.mark.wide) for each in FREE])
def test_a_floating_body_that_a_pressure_squeezes(dimension, frame):
    """By a tenth in every direction and by a tenth the other way, at once and in one step: K_n e = -p J everywhere, and it stays where it is."""
    n = 2 if dimension == 2 else 3
    for e in (-0.1, 0.1):
        run = pressed(dimension, frame, -(2 * MU + n * LAM) * e * np.exp(-n * e))
        assert run.outcome.ok and run.facts["failed"] == 0
        assert [run.finals["J_min"], run.finals["J_max"]] == pytest.approx([np.exp(n * e)] * 2, rel=1e-6)
        along = {2: "xy", "axisymmetric": "z", 3: "xyz"}[dimension]
        middle = {"x": 0.12, "y": 0.11, "z": 0.11 if dimension == "axisymmetric" else 0.1}
        assert [run.finals[f"position_mean_{c}"] for c in along] == pytest.approx([middle[c] for c in along], abs=1e-12)
        if dimension == 2:  # nor does it turn
            assert [run.finals["position_max_x"], run.finals["position_min_y"]] == pytest.approx([0.12 + 0.05 * np.exp(e), 0.11 - 0.05 * np.exp(e)], abs=1e-6)


@pytest.mark.wide
def test_rest_under_a_pressure_knows_no_steps():
    """A block on a floor that sticks, its top pressed by 0.17 E, free beside it: in one step or four, and Newton's method closes in at once."""
    on_floor = {"bodies": {"body": {"shape": {"box": {"lower": [0.05, 0], "upper": [0.15, 0.1]}}, "material": "dough"}}, "walls": {"bottom": "stick"}}
    runs = [pressed(2, "total", 3400.0, "top", **on_floor, time={"end": 100, "step": step}) for step in (100, 25)]
    for name in ("position_max_x", "position_mean_y", "J_min"):
        assert runs[0].finals[name] == pytest.approx(runs[1].finals[name], rel=1e-6)
    assert all(run.outcome.ok and run.facts["failed"] == 0 for run in runs) and runs[0].facts["iterations"] <= 15
