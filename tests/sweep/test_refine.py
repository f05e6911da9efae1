"""Refined axes: a contour with far fewer points than the grid that finds it as well, edges of what fails, and the shell's way."""

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from contourpy import contour_generator
from scipy.interpolate import CubicSpline, LinearNDInterpolator, RectBivariateSpline, RegularGridInterpolator
from scipy.spatial import cKDTree

from mpm.sweep.refine import Mesh, choose


def centre(kappa, u):
    """As a loaf's centre after a bake: rises with kappa and ln beta, and levels off."""
    return 24 + 76 * (1 - np.exp(-3.2 * kappa ** 0.6 * np.exp(u) / (np.exp(u) + 18 * kappa + 4)))  # fmt: skip


SPAN = ((0.2, 0.6), (np.log(5), np.log(50)))
LEVEL = 80.0


def refined(asked, answer, first=5):
    mesh = Mesh(asked, ["kappa", "beta"], [False, True], [np.linspace(*span, first).tolist() for span in SPAN])
    wanted, pending = mesh.begin(), []
    while wanted:
        mesh.known |= {place: answer(*place) for place in wanted}
        for cell in pending:
            mesh.split(cell)
        wanted, pending = choose(mesh)
    return mesh


def line(predict):
    """The line on which a function of places (in units of the ranges) crosses LEVEL, as points."""
    fine = np.linspace(0, 1, 601)
    values = predict(np.stack(np.meshgrid(fine, fine, indexing="ij"), axis=-1).reshape(-1, 2)).reshape(601, 601)
    (lines,) = contour_generator(fine, fine, values.T).multi_lines([LEVEL])
    return np.vstack(lines)


def off(found, true):
    """Largest distance of two lines, in ranges."""
    return max(cKDTree(true).query(found)[0].max(), cKDTree(found).query(true)[0].max())


def smallest_grid(answer, true, within):
    """How many points the smallest grid has on which linear interpolation finds the line."""
    for n in range(3, 60):
        axis = np.linspace(0, 1, n)
        values = answer(np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)).reshape(n, n)
        if off(line(RegularGridInterpolator((axis, axis), values)), true) <= within:
            return n * n
    return None


def scaled(places):
    return (np.asarray(places) - [low for low, _ in SPAN]) / [high - low for low, high in SPAN]


def straight(mesh):
    """Linear interpolation between the points that were taken."""
    return LinearNDInterpolator(scaled([*mesh.known]), np.array([*mesh.known.values()]))


def test_a_line_takes_a_quarter_of_the_points_of_the_grid_that_finds_it_as_well():
    """To 0.2 % of the ranges; this line is so straight that a grid of 7 x 7 finds it to 1 %."""
    answer = lambda u: centre(*(u * [high - low for low, high in SPAN] + [low for low, _ in SPAN]).T)  # noqa: E731
    true = line(answer)
    mesh = refined(SimpleNamespace(level=LEVEL, until=0.002, points=400), centre, first=3)
    assert off(line(straight(mesh)), true) <= 0.002
    assert len(mesh.known) <= 0.25 * smallest_grid(answer, true, 0.002)


@pytest.mark.slow
def test_the_loafs_line_of_95_degrees():
    """Over kappa and beta: where the centre is at 95 degC after 13 minutes, within 1 % of the ranges, on the scene itself; no grid of up to four times as many
    points finds it as well by the same interpolation. The line itself is found by bisection at 41 conductivities."""
    answer = lambda u: loaf(np.asarray(u) * [high - low for low, high in SPAN] + [low for low, _ in SPAN])  # noqa: E731
    kappa, low, high = np.linspace(0, 1, 41), np.zeros(41), np.ones(41)
    for _ in range(10):
        middle = (low + high) / 2
        over = answer(np.stack([kappa, middle], axis=1)) > LEVEL
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    fine = np.linspace(0, 1, 601)
    true = np.stack([fine, CubicSpline(kappa, (low + high) / 2)(fine)], axis=1)
    mesh = refined(SimpleNamespace(level=LEVEL, until=0.01, points=400), lambda *place: float(loaf([place])[0]), first=4)
    print(f"{len(mesh.known)} points, off by {off(line(straight(mesh)), true):.4f}")
    assert off(line(straight(mesh)), true) <= 0.01
    for n in range(4, math.isqrt(4 * len(mesh.known) - 1) + 1):
        axis = np.linspace(0, 1, n)
        values = answer(np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)).reshape(n, n)
        found = off(line(RegularGridInterpolator((axis, axis), values)), true)
        print(
            f"grid of {n} x {n}, off by {found:.4f}; by cubic splines {off(line(lambda u, v=values, a=axis: RectBivariateSpline(a, a, v).ev(*u.T)), true):.4f}"
        )
        assert found > 0.01


def loaf(places):
    """Its centre after 13 minutes, by kappa and ln beta; LEVEL at 95 degC."""
    import mpm
    from mpm.sweep.cases import plan

    points = [{"kappa": float(kappa), "beta": float(np.exp(u))} for kappa, u in places]
    config = {"grid.cell": "2 mm", "output.every": 60, "output.snapshots": None, "time.end": 780, "sweep": {"points": points}}
    cases = plan(mpm.load(Path(__file__).parents[2] / "configs" / "scenes" / "loaf.yaml", config)).cases
    return np.array([mpm.run_point(case.experiment).series["temperature_centre"][-1] for case in cases]) - 273.15 - 95 + LEVEL


def test_where_ok_meets_failed_points_come_close():
    mesh = refined(SimpleNamespace(level=None, until=0.02, points=2000), lambda kappa, u: float("nan") if kappa + 0.1 * u > 0.7 else 1.0)
    edge = [cell for cell in mesh.cells if 0 < sum(np.isnan(mesh.known[corner]) for corner in cell.corners()) < 4]
    assert edge and all(mesh.small(cell) for cell in edge)
    assert len(mesh.known) < 0.25 * 51**2


def test_points_are_never_more_than_asked():
    mesh = refined(SimpleNamespace(level=None, until=1e-4, points=77), centre)
    assert len(mesh.known) <= 77


def test_one_axis_keeps_its_name_and_its_values_rise(tmp_path):
    from mpm.config import load
    from mpm.sweep.api import execute, tree_of
    from mpm.sweep.engine import Options

    config = {
        "grid": {"dimension": 0}, "bodies": {"b": {"shape": {"point": {"surface_to_volume": 20}}, "temperature": 300, "material": "m"}},
        "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1, "alpha": 1000}}}},
        "surfaces": [{"of": "b", "convection": {"beta": 10, "outside": 400}}], "time": {"end": 1000},
        "output": {"every": 100, "observables": ["temperature.mean"]},
        "sweep": {"axes": {"beta": [1, 10, 100]}, "refine": {"of": "temperature.mean", "until": 0.02, "points": 12}},
    }  # fmt: skip
    result = execute(load(config), tmp_path, Options(jobs=0))
    root = tree_of(result.out / "sweep.nc").to_dataset()
    assert root["status"].dims == ("beta",) and 3 < root.sizes["beta"] <= 12 and np.all(np.diff(root.beta) > 0)
    assert execute(load(config), tmp_path, Options(jobs=0)).ran == 0
