"""The return map on arrays, for notebooks and calibration: the same functions that the particle loop calls."""

import numpy as np

from mpm.jit import kernel
from mpm.materials.clipped import strain_clipped
from mpm.materials.radial import strain_radial

FORMS = ("radial", "clipped")


@kernel
def map_all(e, lam, mu, M, p0, eta, dt, thermal, clipped, out):
    """Maps every row of e (n, 3) into out; the index of the first row that fails, or -1."""
    for k in range(e.shape[0]):
        if clipped:
            e1, e2, e3, _, ok = strain_clipped(e[k, 0], e[k, 1], e[k, 2], lam[k], mu[k], M[k], p0[k], eta[k], dt[k], thermal[k])
        else:
            e1, e2, e3, _, ok = strain_radial(e[k, 0], e[k, 1], e[k, 2], lam[k], mu[k], M[k], p0[k], eta[k], dt[k], thermal[k])
        if not ok:
            return k
        out[k, 0], out[k, 1], out[k, 2] = e1, e2, e3
    return -1


def admitted(name, x):
    """What a parameter may be, in words, and where it is."""
    if name in ("mu", "M", "p0"):
        return f"a finite {name} > 0", np.isfinite(x) & (x > 0)
    if name == "dt":
        return "a finite dt >= 0", np.isfinite(x) & (x >= 0)
    if name == "eta":
        return "eta >= 0, inf included", x >= 0
    return "a finite number", np.isfinite(x)


def return_map(eps_trial, *, mu, lam, M, p0, eta, dt, form="radial", thermal_stress=0.0):
    """Elastic principal Hencky strains at the end of a step, from the trial ones: one implicit Euler step of viscoplastic flow on an ellipse.

    Minimises over p and q >= 0, outside p^2/p0^2 + q^2 = M^2,

        (p - p_tr)^2/(2 K) + (q - q_tr)^2/(6 mu) + dt M^2/(2 eta) <f>^2,    f = sqrt(p^2/p0^2 + q^2)/M - 1    radial
                                                                           f = |p|/(p0 sqrt(M^2 - q^2)) - 1  clipped

    with p = -tr tau/3, q = sqrt(3/2) |dev tau|, tau_i = 2 mu eps_i + lam tr eps - thermal_stress, K = lam + 2 mu/3. Inside, eps_trial itself.

    eps_trial       (..., 3) trial strains [-]
    mu, lam         Lame constants [Pa], mu > 0, 3 lam + 2 mu > 0
    M               von Mises yield stress at p = 0 [Pa], > 0
    p0              hydrostatic yield pressure over M [-], > 0
    eta             viscosity [Pa s], >= 0, inf allowed (radial: elastic; clipped: q <= M only)
    dt              step [s], >= 0
    form            "radial": viscosity in pressure and shear; "clipped": q <= M at any rate
    thermal_stress  gamma (Theta - Theta_0) [Pa]

    Parameters may be arrays that broadcast against eps_trial without its last axis. Returns float64, broadcast shape + (3,).
    Source       docs/physics.md 5.1 and 5.2. Relaxation times at held strain: eta p0^2/K in pressure, eta/(3 mu) in shear (radial).
    Good values  p0 within 1e-3..1e3, K dt/eta within 1e-12..1e12.
    Fails when   an argument is out of range (ValueError says what is allowed) or the iteration ends without a root (ArithmeticError; none known).
    """
    if form not in FORMS:
        raise ValueError(f"form = {form!r}: allowed are 'radial' and 'clipped'")
    eps = np.asarray(eps_trial, dtype=np.float64)
    if eps.ndim == 0 or eps.shape[-1] != 3:
        raise ValueError(f"eps_trial has shape {eps.shape}: the last axis must hold the 3 principal strains")
    named = {"lam": lam, "mu": mu, "M": M, "p0": p0, "eta": eta, "dt": dt, "thermal_stress": thermal_stress}
    values = {name: np.asarray(x, dtype=np.float64) for name, x in named.items()}
    for name, x in values.items():
        allowed, good = admitted(name, x)
        if not np.all(good):
            raise ValueError(f"{name} = {np.atleast_1d(x)[~np.atleast_1d(good)][0]}: allowed is {allowed}")
    if not np.all(np.isfinite(eps)):
        raise ValueError("eps_trial: allowed are finite strains")
    if not np.all(3 * values["lam"] + 2 * values["mu"] > 0):
        raise ValueError("lam: allowed is 3 lam + 2 mu > 0 (a positive bulk modulus)")
    try:
        shape = np.broadcast_shapes(eps.shape[:-1], *(x.shape for x in values.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {x.shape}" for name, x in values.items() if x.ndim)
        raise ValueError(f"shapes do not broadcast: eps_trial without its last axis {eps.shape[:-1]}, {shapes}") from None
    rows = np.ascontiguousarray(np.broadcast_to(eps, (*shape, 3))).reshape(-1, 3)
    columns = [np.broadcast_to(x, shape).ravel() for x in values.values()]
    out = np.empty_like(rows)
    failed = map_all(rows, *columns, form == "clipped", out)
    if failed >= 0:
        raise ArithmeticError(f"no convergence for eps_trial = {rows[failed]}, " + ", ".join(f"{n} = {c[failed]}" for n, c in zip(named, columns, strict=True)))
    return out.reshape((*shape, 3))
