"""Answers at rest and thermal stress: exact solutions against independent ones; in the total frame to the orders that they declare."""

import numpy as np
import pytest

from mpm.verification import cantilever, exact_solution, hertz, pressed_cylinder, spinning_disc, thermal_cylinder

TOTAL = {"method.frame": "total"}


def apart(motion, X, displacement, stress):
    """Relative differences between a solution at rest and another, at points of equal volume."""
    found = motion.measure(X, np.ones(len(X)), {"displacement": displacement, "stress": stress}, 0.0)
    return {name: value / np.sqrt(np.mean(np.sum(values**2, axis=1))) for name, values in (("displacement", displacement), ("stress", stress))
            for value in [found[f"error_{name}_l2"]]}  # fmt: skip


def test_cylinder_solves_its_equations_on_a_fine_line(shipped):
    """Finite differences of (lam + 2 mu) (u' + u/r)' = gamma d', sigma_r = 0 inside and outside, with 4000 points."""
    from scipy.sparse import diags, lil_matrix
    from scipy.sparse.linalg import spsolve

    experiment = shipped("thermal_cylinder")
    (a, _), (b, _) = experiment.bodies["pipe"].shape.lower, experiment.bodies["pipe"].shape.upper
    lam, mu = 0.3 / (1.3 * 0.4), 1 / 2.6
    gamma = (3 * lam + 2 * mu) * 1e-9
    r = np.linspace(a, b, 4001)
    h, d = r[1] - r[0], 20 + 80 * np.log(b / r) / np.log(b / a)
    middle = slice(1, -1)
    A = lil_matrix(diags([1 / h**2 - 0.5 / (h * np.append(r[1:], 1.0)), -2 / h**2 - 1 / r**2, 1 / h**2 + 0.5 / (h * r)], [-1, 0, 1], shape=(4001, 4001)))
    right = gamma / (lam + 2 * mu) * np.gradient(d, h)
    for row, step in ((0, 1), (-1, -1)):  # one-sided, of order 2
        A[row, :] = 0
        for k, weight in enumerate((-1.5, 2.0, -0.5)):
            A[row, row + k * step] = (lam + 2 * mu) * weight * step / h + (lam / r[row] if k == 0 else 0)
        right[row] = gamma * d[row]
    u = spsolve(A.tocsc(), right)
    slope = np.gradient(u, h, edge_order=2)
    dilation = slope + u / r
    tau = np.stack([2 * mu * e + lam * dilation - gamma * d for e in (slope, 0 * r, u / r, 0 * r)], axis=1)
    tau[:, 3] = 0
    X = np.stack([r, 0 * r], axis=1)
    error = apart(exact_solution(experiment), X[middle], np.stack([u, 0 * u], axis=1)[middle], tau[middle])
    assert error["displacement"] < 1e-6 and error["stress"] < 1e-5


def test_cantilever_is_that_of_a_beam_and_of_other_elements():
    """Deflection 3/2 (1 - nu^2) w L^4/(E H^2) of bending, w L^2/(2 mu 5/6) of shear; stress M y/I half way."""
    E, nu, L, H, w = 1e6, 0.3, 1.0, 0.05, 1.0
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    mesh, u = cantilever.rest(L, H, lam, mu, (0.0, -w))
    bending, shear = 1.5 * (1 - nu**2) * w * L**4 / (E * H**2), w * L**2 / (2 * mu * 5 / 6)
    assert -u[2 * mesh.nx * mesh.columns + mesh.ny, 1] == pytest.approx(bending + shear, rel=5e-3)
    x = np.stack([np.full(9, 0.5), np.linspace(0.1, 0.9, 9) * H], axis=1)
    tau = cantilever.kirchhoff(mesh, u, x, lam, mu)
    assert tau[:, 0] == pytest.approx(w * H * 0.5**2 / 2 * (x[:, 1] - H / 2) / (H**3 / 12), abs=2e-3 * np.abs(tau[:, 0]).max())


@pytest.mark.parametrize(("nu", "most"), [(0.3, 1e-5), (0.499, 3e-5)])
def test_elements_of_the_cantilever_are_enough(monkeypatch, nu, most):
    """Those that the problem takes against more of them: a load step alone, as it bends little."""
    lam, mu, found = 1e6 * nu / ((1 + nu) * (1 - 2 * nu)), 1e6 / (2 * (1 + nu)), []
    x = np.stack(np.meshgrid(np.linspace(0.01, 0.99, 50), np.linspace(0.01, 0.19, 10)), -1).reshape(-1, 2)
    monkeypatch.setattr(cantilever, "STEPS", 1)
    for elements in (cantilever.ELEMENTS, 20):
        monkeypatch.setattr(cantilever, "ELEMENTS", elements)
        mesh, u = cantilever.rest.__wrapped__(1.0, 0.2, lam, mu, (0.0, -29.0))
        element, local = mesh.at(x)
        found.append(np.einsum("na,nac->nc", cantilever.shapes(*local.T)[0], u[mesh.nodes[element]]))
    assert 0 < np.linalg.norm(found[0] - found[1]) < most * np.linalg.norm(found[1])


@pytest.mark.slow  # Newton's method, far
def test_far_cantilever_is_that_of_other_elements():
    E, nu = 1e6, 0.3
    mesh, u = cantilever.rest(1.0, 0.1, E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)), (0.0, -4578.75))
    assert -u[2 * mesh.nx * mesh.columns + mesh.ny, 1] == pytest.approx(0.50409, rel=2e-5)  # 0.50374, 0.50389 by full integration of 40 x 4, 60 x 6 even ones


def test_bar_and_shock_hold_what_they_say(shipped):
    """P = T everywhere in the bar; nothing along the slab that is free to expand, and -E a/(1 - nu) (theta - theta_0) across."""
    motion, X = exact_solution(shipped("traction_bar")), np.linspace(0, 1.02, 7)[:, None]
    low, high = 0.0, 1.0
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if (0.7 / (1.3 * 0.4)) * middle * np.exp(-middle) < 0.1 else (low, middle)
    tau = np.tile([0.7 / (1.3 * 0.4) * low, 0.3 / (1.3 * 0.4) * low, 0.3 / (1.3 * 0.4) * low], (7, 1))
    error = apart(motion, X[1:], np.expm1(low) * X[1:], tau[1:])
    assert max(error.values()) < 1e-12
    shock = exact_solution(shipped("thermal_shock"))
    theta, tau = shock.fields["temperature"](X[:6] / 1.1, 0.05), shock.fields["stress"](X[:6] / 1.1, 0.05)
    assert (tau[:, 0] == 0).all() and tau[:, 1] == pytest.approx(-1e-8 / 0.7 * (theta - 400))


def test_pressed_cylinder_is_lames_at_small_strain_and_holds_its_pressure_at_large_ones():
    """sigma_r = -p at the inner face, 0 at the outer one, and one half of it in balance with the other: p r_i = int P_t dR."""
    a, b, lam, mu = 0.52, 1.13, 0.577, 0.385
    R = np.linspace(a, b, 20001)
    small, straight = pressed_cylinder.widened(a, b, lam, mu, 2e-8, 5e-9)(R), pressed_cylinder.lame(a, b, lam, mu, 2e-8, 5e-9)(R)
    assert small == pytest.approx(straight, rel=1e-6)
    B, C = straight[:, 0] @ [1 / a, 1] / 2, (straight[0, 0] / a - straight[1, 0]) * a**2 / 2
    assert 2 * (lam + mu) * B - 2 * mu * C / a**2 == pytest.approx(-2e-8, rel=1e-6) and 2 * (lam + mu) * B - 2 * mu * C / b**2 == pytest.approx(-5e-9, rel=1e-6)
    u, slope = pressed_cylinder.widened(a, b, lam, mu, 0.1, 0.0)(R)
    er, et = np.log1p(slope), np.log1p(u / R)
    radial, hoop = (2 * mu * er + lam * (er + et)) / np.exp(er + et), (2 * mu * et + lam * (er + et)) * np.exp(-et)
    assert radial[0] == pytest.approx(-0.1, rel=1e-7) and abs(radial[-1]) < 1e-8 and u[0] > 0.25 * a
    assert np.sum((hoop[1:] + hoop[:-1]) / 2 * np.diff(R)) == pytest.approx(0.1 * (a + u[0]), rel=1e-6)


def test_spinning_disc_solves_its_equation():
    """u'' = (u' + u/s)' + 8 s in units of its own, by finite differences; at rest and without strain at the start, no stress at the rim at any time."""
    ratio, step = 0.57, 1e-3
    s, u, rise, hoop = spinning_disc.radial(ratio, 0.0)
    assert np.abs(u).max() < 1e-8 and np.abs(rise).max() < 1e-5
    for clock in (0.4, 2.3):
        (_, before, _, _), (_, now, rise, hoop), (_, after, _, _) = (spinning_disc.radial(ratio, clock + k * step) for k in (-1, 0, 1))
        pull = np.gradient(rise + hoop, s, edge_order=2)
        inner = slice(20, -20)  # behind the wave that starts at the rim: 0.4 in, and on its way back
        away = np.abs(np.abs(1 - s[inner]) - clock % 2) > 0.05
        assert ((after - 2 * now + before) / step**2)[inner][away] == pytest.approx((pull + 8 * s)[inner][away], abs=2e-2)
        assert abs(rise[-1] + (1 - ratio) * hoop[-1]) < 1e-12


@pytest.mark.parametrize(("name", "changes", "said"), [
    ("pressed_cylinder", {"loads.0.side": "all"}, "sides inner and outer"),
    ("pressed_cylinder", {"loads.0.traction.pressure": 0.3}, "may not bear"),
    ("spinning_disc", {"bodies.disc.angular_velocity": 0.1}, "small strains"),
    ("cantilever", {"walls.left": "slip"}, "stick"),
    ("traction_bar", {"loads.0.traction.nominal": [0.9]}, "most that Hencky's law bears"),
    ("thermal_shock", {"bodies.slab.temperature": 390}, "reference temperature"),
    ("thermal_cylinder", {"surfaces.0.side": "lateral", "surfaces.1.side": "top"}, "inner and outer"),
    ("hertz", {"tools.plate.friction": 0.1}, "without friction"),
    ("hertz", {"walls.bottom": "slip"}, "a wall `contact`"),
])  # fmt: skip
def test_another_scene_is_refused(shipped, name, changes, said):
    with pytest.raises(ValueError, match=said):
        exact_solution(shipped(name, changes))


def test_a_ball_between_plates_is_that_of_hertz_where_the_contact_is_small():
    """4/3 E/(1 - nu^2) sqrt(R d^3), and first in a/R more by 3/2 of what far loads give the other way: ((1 + nu)/4 + (1 - nu^2)/2) 4/(3 pi (1 - nu^2))."""
    E, nu, R = 1e4, 0.3, 0.02
    for small in (1e-3, 1e-2):
        d = small**2 * R
        more = hertz.force(d, E, nu, R) / (4 / 3 * E / (1 - nu**2) * np.sqrt(R * d**3)) - 1
        assert more / small == pytest.approx(1.5 * ((1 + nu) / 4 + (1 - nu**2) / 2) * 4 / (3 * np.pi * (1 - nu**2)), rel=0.03)


@pytest.mark.slow
def test_a_ball_between_plates(points):
    """The force to 3 %, where its contact is 2.4 cells wide."""
    (run,) = points("hertz", "grid.cell", (0.0625,))
    assert run.finals["error_force"] < 0.03


@pytest.mark.slow
def test_a_disc_that_rolls(points):
    """2/3 g sin to 2 %, its radius 8 cells; gravity sets in within half a second."""
    (run,) = points("rolling", "grid.cell", (0.0625,))
    assert run.finals["momentum_x"] / run.finals["mass_total"] / (run.times[-1] - 0.25) == pytest.approx(0.2, rel=0.02)
    assert run.finals["error_displacement"] < 0.02


@pytest.mark.slow  # compilations of heat in the total frame
def test_orders_in_the_total_frame(core, points):
    cells = (0.1, 0.05, 0.025)
    for name, least in (("cantilever", 1.0), ("thermal_cylinder", thermal_cylinder.ORDER), ("pressed_cylinder", 1.8), ("spinning_disc", 1.5)):
        errors = [run.finals["error_displacement"] for run in points(f"{name}_total", "grid.cell", cells)]
        assert core.order(errors) > least
