"""What must hold for every material on the menu, whichever it is."""

import itertools
import json
import os
import subprocess
import sys

import numpy as np
import pytest

from mpm import tensors
from mpm.jit import kernel
from mpm.materials import ELASTIC, FLOW, Bump, Constant, EllipseClipped, EllipseRadial, Hencky, Logistic, NoFlow, energy, flow, moduli, stress, table

ELASTICS = [Hencky(1e5, 1.5e5), Hencky(3e4, 0.0), Hencky(1e4, 5e6)]
FLOWS = [
    NoFlow(),
    *(
        kind(M, p0, eta)
        for kind in (EllipseRadial, EllipseClipped)
        for M, p0, eta in [
            (Constant(1e3), Constant(0.8), Constant(50.0)),
            (Constant(1e3), Constant(30.0), Constant(0.0)),
            (table([280.0, 340.0, 400.0], [3e3, 500.0, 1e3], "pchip"), Logistic(0.5, 2.0, 340.0, 5.0), Bump(10.0, 1e4, 345.0, 4.0)),
        ]
    ),
]
every_pair = pytest.mark.parametrize(("elastic", "law"), list(itertools.product(ELASTICS, FLOWS)), ids=lambda x: type(x).__name__)
THETA, DT = 343.0, 1e-4


def trials(n=60):
    rng = np.random.default_rng(8)
    return rng.standard_normal((n, 3)) * 10.0 ** rng.uniform(-4, -0.7, (n, 1)), rng.choice([0.0, 300.0, -2000.0], n)


@kernel
def flow_many(law, elastic, e, thermal, theta, dt, out):
    for k in range(len(e)):
        e1, e2, e3, work, ok = flow(law, elastic, e[k, 0], e[k, 1], e[k, 2], thermal[k], theta, dt)
        t1, t2, t3 = stress(elastic, e1, e2, e3, thermal[k])
        out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4], out[k, 5], out[k, 6], out[k, 7] = e1, e2, e3, work, 1.0 if ok else 0.0, t1, t2, t3


def run(law, elastic, e, thermal):
    out = np.empty((len(e), 8))
    flow_many(law, elastic, e, thermal, THETA, DT, out)
    return out


def test_the_menu_is_covered():
    assert {type(x) for x in ELASTICS} == set(ELASTIC)
    assert {type(x) for x in FLOWS} == set(FLOW)


@every_pair
def test_zero_strain_stays_and_carries_no_stress(elastic, law):
    assert flow(law, elastic, 0.0, 0.0, 0.0, 0.0, THETA, DT) == (0.0, 0.0, 0.0, 0.0, True)
    assert stress(elastic, 0.0, 0.0, 0.0, 0.0) == (0.0, 0.0, 0.0)
    assert energy(elastic, 0.0, 0.0, 0.0) == 0.0


@every_pair
def test_dissipation_is_the_work_lost_and_never_negative(elastic, law):
    e, thermal = trials()
    out = run(law, elastic, e, thermal)
    assert out[:, 4].all()
    assert np.all(out[:, 3] >= 0.0)
    lost = np.einsum("ki,ki->k", out[:, 5:], e - out[:, :3])
    np.testing.assert_allclose(out[:, 3], lost, rtol=1e-9, atol=1e-12 * np.abs(out[:, 5:]).max())
    free = [energy(elastic, *row) for row in e] - thermal * e.sum(axis=1)
    left = [energy(elastic, *row) for row in out[:, :3]] - thermal * out[:, :3].sum(axis=1)
    assert np.all(out[:, 3] <= free - left + 1e-12 * np.abs(free))  # implicit Euler gives away a little more energy than it calls work


@every_pair
def test_the_order_of_the_principal_strains_does_not_matter(elastic, law):
    e, thermal = trials()
    out = run(law, elastic, e, thermal)
    for order in ([1, 2, 0], [1, 0, 2]):
        turned = run(law, elastic, np.ascontiguousarray(e[:, order]), thermal)
        np.testing.assert_allclose(turned[:, :3], out[:, order], rtol=1e-11, atol=1e-15)


@every_pair
def test_objectivity_of_the_whole_step(elastic, law):
    """A rotation before the step rotates strain and stress, and changes nothing else."""
    rng = np.random.default_rng(4)
    packed = ([0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2])

    def step(B):
        values = tensors.eigen3(*B[packed])
        *e, work, ok = flow(law, elastic, *(0.5 * np.log1p(x) for x in values[:3]), 100.0, THETA, DT)
        assert ok
        return np.array(tensors.compose3(*stress(elastic, *e, 100.0), *values[3:9])), np.array(tensors.compose3(*np.expm1(2 * np.array(e)), *values[3:9])), work

    for size in (1e-3, 0.1):
        B = rng.standard_normal((3, 3)) * size
        B = B + B.T
        R = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        for one, other in zip(step(B), step(R @ B @ R.T), strict=True):
            if np.ndim(one):
                one = (R @ one[np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])] @ R.T)[packed]
            np.testing.assert_allclose(one, other, rtol=1e-10, atol=1e-12 * np.abs(one).max())


@every_pair
def test_failure_is_said(elastic, law):
    """A strain that is no number, or a parameter out of its range, gives ok = False where there is a flow."""
    if not isinstance(law, NoFlow):
        assert flow(law, elastic, np.nan, 0.0, 0.0, 0.0, THETA, DT)[4] is False
        for bad in ({"M": Constant(-1.0)}, {"M": Constant(0.0)}, {"p0": Constant(0.0)}, {"eta": Constant(-1.0)}, {"M": Constant(np.nan)}):
            assert flow(law._replace(**bad), elastic, 0.1, 0.0, 0.0, 0.0, THETA, DT) == (0.1, 0.0, 0.0, 0.0, False)


@every_pair
def test_float32_strains(elastic, law):
    e, thermal = trials()
    single = run(law, elastic, e.astype(np.float32), thermal.astype(np.float32))
    double = run(law, elastic, e.astype(np.float32).astype(np.float64), thermal)
    np.testing.assert_allclose(single[:, :3], double[:, :3], rtol=2e-5, atol=2e-6 * np.abs(e).max())
    assert single[:, 4].all()


def test_soft_and_stiff_moduli():
    assert moduli(ELASTICS[2]) == (5e6, 1e4)


PLAIN = """
import importlib.util, json, sys
spec = importlib.util.spec_from_file_location("test_menu", sys.argv[1])
menu = importlib.util.module_from_spec(spec)
spec.loader.exec_module(menu)
assert not hasattr(menu.flow_many, "signatures")
e, thermal = menu.trials()
print(json.dumps([menu.run(law, elastic, e, thermal).tolist() for elastic in menu.ELASTICS for law in menu.FLOWS]))
"""


def test_compiled_equals_plain_python():
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", PLAIN, __file__], env=environment, capture_output=True, text=True, check=True)
    e, thermal = trials()
    for (elastic, law), plain in zip(itertools.product(ELASTICS, FLOWS), json.loads(done.stdout), strict=True):
        np.testing.assert_allclose(run(law, elastic, e, thermal), plain, rtol=1e-11, atol=1e-15)
