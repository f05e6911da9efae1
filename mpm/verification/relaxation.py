"""Stress relaxation of a viscoplastic point at held strain, from a state outside the ellipse (docs/physics.md 5.3; 7, problem 7).

dp/dt = -K M^2/eta <f> df/dp,  dq/dt = -3 mu M^2/eta <f> df/dq,  f = sqrt(p^2/p0^2 + q^2)/M - 1 (radial) or |p|/(p0 sqrt(M^2 - q^2)) - 1 (clipped),
integrated to 1e-12 by a Runge-Kutta method of order 8.
Order   1 in the step: the return map is one implicit Euler step
"""

import numpy as np

from mpm.verification.path import AXES, constant, point

ORDER = 0.95


def exact(experiment):
    """t -> {Kirchhoff p, q}: strain at the start, every direction held, no heat, constant M, p0 and eta > 0."""
    from mpm.scene.law import elastic_law

    body, material = point(experiment)
    if material.flow is None or material.expansion is not None:
        raise ValueError("relaxation needs elastic and flow, and no expansion")
    if any(getattr(part, axis) is not None for s in experiment.loading for part in (s.strain_rate, s.stretch_rate, s.stress) for axis in AXES):
        raise ValueError("relaxation needs every direction held: a loading of one empty stage")
    elastic = elastic_law(material.elastic)
    K, mu = elastic.lam + 2 * elastic.mu / 3, elastic.mu
    M, p0, eta = (constant(getattr(material.flow, name), name) for name in ("M", "p0", "eta"))
    e = np.array([getattr(body.shape.strain, axis) for axis in AXES])
    p, q = -K * e.sum(), np.sqrt(6) * mu * np.linalg.norm(e - e.mean())
    if eta == 0 or (material.flow.map == "clipped" and q >= M):
        raise ValueError("relaxation needs eta > 0, and with the clipped map q < M at the start")

    def rates(_, state):
        p, q = state
        if material.flow.map == "radial":
            s = np.sqrt(p**2 / p0**2 + q**2) / M
            over, by_p, by_q = max(s - 1, 0.0), p / (p0**2 * M**2 * s), q / (M**2 * s)
        else:
            room = np.sqrt(M**2 - q**2)
            over, by_p, by_q = max(abs(p) / (p0 * room) - 1, 0.0), np.sign(p) / (p0 * room), abs(p) * q / (p0 * room**3)
        return [-K * M**2 / eta * over * by_p, -3 * mu * M**2 / eta * over * by_q]

    def solution(times: np.ndarray) -> dict[str, np.ndarray]:
        from scipy.integrate import solve_ivp

        found = solve_ivp(rates, (0.0, experiment.time.end), [p, q], method="DOP853", t_eval=times, rtol=1e-12, atol=1e-14 * M)
        return {"kirchhoff_p": found.y[0], "kirchhoff_q": found.y[1]}

    return solution
