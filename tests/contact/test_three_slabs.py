"""Three slabs of different materials that move and touch: the heat that passes between each pair, against volumes on a line."""

import numpy as np
import pytest
from scipy.linalg import expm

KAPPA = {"a": 1.0, "b": 3.0, "c": 0.5}  # capacity is as large
START = {"a": 400.0, "b": 350.0, "c": 300.0}
THICK, END, M = 1 / 3, 0.05, 150


def passed(resistance):
    """Heat from a to b and from b to c until END, by M volumes a slab, exact in time [J]."""
    kappa, T = np.repeat(list(KAPPA.values()), M), np.repeat(list(START.values()), M)
    heavy, half, i = kappa * THICK / M, 0.5 * THICK / M / kappa, np.arange(3 * M - 1)
    rate = 1 / (half[1:] + half[:-1] + np.where((i + 1) % M == 0, resistance, 0.0))
    A = np.zeros((3 * M, 3 * M))
    for here, there in ((i, i + 1), (i + 1, i)):
        A[here, here] -= rate
        A[here, there] += rate
    gained = (heavy * (expm(A * END / heavy[:, None]) @ T - T)).reshape(3, M).sum(axis=1)
    return -gained[0], gained[2]


def slabs(n, conductance, offset):
    """Of n cells a metre, `offset` cells beside the grid's lines."""
    h = 1 / n
    box = lambda k: {"box": {"lower": [(2 + offset) * h + k * THICK], "upper": [(2 + offset) * h + (k + 1) * THICK]}}  # noqa: E731
    return {
        "grid": {"dimension": 1, "size": [1 + 8 * h], "cell": h},
        "bodies": {name: {"shape": box(k), "material": name, "temperature": T} for k, (name, T) in enumerate(START.items())},
        "materials": {
            name: {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}, "heat": {"fourier": {"kappa": k, "alpha": k}}} for name, k in KAPPA.items()
        },
        "contacts": [{"between": list(pair), "conductance": conductance} for pair in ("ab", "bc")],
        "time": {"end": END}, "output": {"every": END / 5},
    }  # fmt: skip


@pytest.mark.parametrize(("conductance", "offset"), [(5.0, 0.3), (np.inf, 0.0)])
@pytest.mark.parametrize("n", [6, 12, pytest.param(24, marks=pytest.mark.slow)])
def test_heat_between_three_slabs(plain, n, conductance, offset):
    """Each pair's heat to 5, 1 and 0.25 % at two, four and eight cells a slab: order 2, so a slab of two cells is 4 % off by its cell alone."""
    (run,) = plain([slabs(n, conductance, offset)])
    s, close = run["series"], {6: 0.05, 12: 0.01, 24: 0.0025}[n]
    assert run["kind"] == "completed" and (-s["heat_a_b"][-1], -s["heat_b_c"][-1]) == pytest.approx(passed(1 / conductance), rel=close)
    assert np.abs(s["heat_ledger"]).max() < 1e-12 * 600
