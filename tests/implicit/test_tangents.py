"""Each flow law's incremental potential: dW/deps_tr is the stress, and the slopes are those of finite differences."""

import numpy as np
import pytest

from mpm.config.materials import ELASTIC
from mpm.materials import (
    FLOW,
    Constant,
    EllipseClipped,
    EllipseRadial,
    Hencky,
    NeoHookean,
    NoFlow,
    energy,
    flow,
    response,
    stress,
    tangent,
    turning,
)  # fmt: skip

E = Hencky(3.0, 5.0)
LAWS = {
    "no_flow": NoFlow(),
    "viscous": EllipseRadial(Constant(0.3), Constant(0.8), Constant(2.0)),
    "nearly rigid plastic": EllipseRadial(Constant(0.2), Constant(30.0), Constant(1e-3)),
    "rate independent": EllipseRadial(Constant(0.25), Constant(0.5), Constant(0.0)),
}
STATES = np.random.default_rng(7).normal(scale=0.15, size=(200, 4))


def measures(e):
    d = e - e.mean()
    return float(e.sum()), float(np.sqrt(d @ d)), d


def answer(law, e, thermal):
    trace, size, d = measures(e)
    return *tangent(law, E, trace, size, thermal, 300.0, 0.7), d, size


def responded(elastic, law, e, thermal):
    """W, and tau and its slopes as the elastic law gives them."""
    trace, size, d = measures(e)
    tau, a = np.empty(3), np.empty((3, 3))
    W, share, good = response(elastic, law, trace, tuple(d), size, thermal, 300.0, 0.7, tau, a)
    assert good and (share == 1.0 or law != NoFlow())
    return W, tau, a


def test_every_flow_law_is_here_or_refused():
    assert {type(law) for law in LAWS.values()} == set(FLOW) - {EllipseClipped}
    with pytest.raises(TypeError, match="EllipseClipped does not know `tangent`"):
        tangent(EllipseClipped(Constant(1.0), Constant(1.0), Constant(1.0)), E, 0.1, 0.1, 0.0, 300.0, 1.0)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
def test_stress_is_that_of_the_return_map_and_the_gradient_of_the_potential(law):
    for *e, thermal in STATES:
        e = np.array(e)
        _, p, share, _, _, _, lost, good, d, _ = answer(law, e, thermal)
        n1, n2, n3, dissipated, ok = flow(law, E, *e, thermal, 300.0, 0.7)
        tau = 2 * E.mu * share * d - p
        assert good and ok
        np.testing.assert_allclose(tau, stress(E, n1, n2, n3, thermal), rtol=0, atol=1e-12)
        assert lost == pytest.approx(dissipated, rel=1e-9, abs=1e-15)
        slope = [(answer(law, e + h, thermal)[0] - answer(law, e - h, thermal)[0]) / 2e-6 for h in 1e-6 * np.eye(3)]
        np.testing.assert_allclose(slope, tau, rtol=0, atol=2e-8)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
def test_slopes_are_those_of_differences(law):
    kinks = 0
    for *e, thermal in STATES:
        e = np.array(e)
        tau, a = responded(E, law, e, thermal)[1:]
        _, p, share, *_, d, _ = answer(law, e, thermal)
        np.testing.assert_allclose(tau, 2 * E.mu * share * d - p, rtol=0, atol=1e-14)
        slope = np.stack([(responded(E, law, e + h, thermal)[1] - responded(E, law, e - h, thermal)[1]) / 2e-6 for h in 1e-6 * np.eye(3)], axis=1)
        yields = {answer(law, e + h, thermal)[6] > 0 for h in 1e-6 * np.vstack([np.eye(3), -np.eye(3)])}
        kinks += len(yields) > 1
        if len(yields) == 1:
            np.testing.assert_allclose(a, slope, rtol=0, atol=4e-6 * np.abs(a).max())
        assert np.linalg.eigvalsh(a).min() > -1e-9
    assert kinks <= 2


ELASTIC_LAWS = {"hencky": Hencky(3.0, 5.0), "neo_hookean": NeoHookean(3.0, 5.0)}


@pytest.mark.parametrize(("kind", "law"), ELASTIC_LAWS.items(), ids=ELASTIC_LAWS)
def test_every_elastic_law_answers_with_its_stress_and_slopes(kind, law):
    """W is its energy, tau its stress, a and the turning of axes those of differences."""
    assert set(ELASTIC_LAWS) == {one.kind for one in ELASTIC}

    for *e, _ in STATES:
        e = np.array(e)
        W, tau, a = responded(law, NoFlow(), e, 0.0)
        assert pytest.approx(energy(law, *e), rel=1e-12, abs=1e-14) == W
        np.testing.assert_allclose(tau, stress(law, *e, 0.0), rtol=0, atol=1e-13)
        slope = np.stack([(responded(law, NoFlow(), e + h, 0.0)[1] - responded(law, NoFlow(), e - h, 0.0)[1]) / 2e-6 for h in 1e-6 * np.eye(3)], axis=1)
        np.testing.assert_allclose(a, slope, rtol=0, atol=4e-6 * np.abs(a).max())
        b = np.expm1(2 * e)
        assert turning(law, 1.0, b[0], b[1]) == pytest.approx((tau[0] - tau[1]) / (b[0] - b[1]), rel=1e-9)
    same = turning(law, 1.0, 0.2, 0.2)
    assert same == pytest.approx(turning(law, 1.0, 0.2, 0.2 + 1e-7), rel=1e-6)
