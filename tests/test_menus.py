"""Each kind of exchange, programme and load, in each solver: it acts as its exact case says, or the config is refused with a place; never left out.

The exact case of exchange is a slab so thin and conducting that it has one temperature: C dT/dt is what passes both of its sides.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import mpm
from mpm.boundary import KINDS
from mpm.config import ConfigError, boundary, laws, loads
from mpm.config.programmes import Sine, TimeTable
from mpm.heat.exchange import STEFAN_BOLTZMANN
from mpm.scene import law, menus, scaling
from mpm.scene.exchange import PROGRAMMES, acts_of
from mpm.scene.refusal import SceneError

pytestmark = pytest.mark.plain

WARM, COLD, AREA, CAPACITY, END = 400.0, 300.0, 2.0, 2.0 * 1.5 * 0.75, 0.5
RAMP = {"table": {"time": [0, END], "value": [WARM, COLD]}}
SWING = {"sine": {"mean": 350.0, "amplitude": 50.0, "period": 1.0}}
EXCHANGES = {
    "convection": ({"beta": 0.5, "outside": COLD}, lambda T, t: 0.5 * (COLD - T)),
    "flux": ({"q": -20.0}, lambda T, t: -20.0),
    "fixed": ({"temperature": COLD}, lambda T, t: 500.0 * (COLD - T)),
    "radiation": ({"emissivity": 0.02, "surroundings": COLD}, lambda T, t: 0.02 * STEFAN_BOLTZMANN * (COLD**4 - T**4)),
}
PROGRAMME = {
    "table": ({"beta": 0.5, "outside": RAMP}, lambda T, t: 0.5 * (WARM + (COLD - WARM) * t / END - T)),
    "sine": ({"beta": 0.5, "outside": SWING}, lambda T, t: 0.5 * (350.0 + 50.0 * np.sin(2 * np.pi * t) - T)),
}
SOLVERS = ("moving", "scaled", pytest.param("total", marks=pytest.mark.slow), "rigid", "auto", "point")


def data(core, solver):
    """The slab in a solver's config, without exchange or loads."""
    found = core.config(1, surfaces=[], time={"end": END}, output={"every": END / 5})
    solid = found["materials"]["solid"]
    solid["heat"]["fourier"]["kappa"] = 20.0
    if solver == "scaled":
        found["time"]["scale"] = 2.0
    elif solver == "total":
        found["method"] = {"frame": "total"}
        del solid["expansion"], solid["heating"]
    elif solver in ("rigid", "auto", "point"):
        found["materials"]["solid"] = {"density": 2.0, "heat": solid["heat"]}
    if solver == "auto":  # which drops directions in space where the answer bears it
        found["model"] = {"auto": {"tolerance": 1e-3}}
    if solver == "point":
        found["grid"] = {"dimension": 0}
        found["bodies"]["body"]["shape"] = {"point": {"surface_to_volume": AREA / 0.75}}
    return found


def ends_at(core, solver, surface):
    """Mean temperature at the end, or the place at which the config is refused."""
    try:
        experiment = mpm.load(data(core, solver) | {"surfaces": [{"of": "body"} | surface]})
    except ConfigError as refusal:
        return refusal.problems[0].path
    run = mpm.run_point(experiment)
    assert run.outcome.ok
    return run.finals["temperature_mean"]


def exact(power):
    return solve_ivp(lambda t, T: AREA * power(T[0], t) / CAPACITY, (0, END), [WARM], rtol=1e-10, atol=1e-8).y[0, -1]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", EXCHANGES)
def test_exchange(core, kind, solver):
    entry, power = EXCHANGES[kind]
    found = ends_at(core, solver, {kind: entry})
    if solver == "point" and kind in ("flux", "radiation"):
        assert found == f"surfaces.0.{kind}"
    else:
        assert found == pytest.approx(exact(power), abs=0.5) and found < WARM - 5


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", PROGRAMME)
def test_programme(core, kind, solver):
    entry, power = PROGRAMME[kind]
    found = ends_at(core, solver, {"convection": entry})
    if solver == "point":
        assert found == "surfaces.0.convection.outside"
    else:
        assert found == pytest.approx(exact(power), abs=0.5) and found < WARM - 2


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", loads.LOADS)
def test_load(core, kind, solver):
    """A free body takes up T A t of momentum (over S^2 where the clock is S times faster: inertia stays); a drag lets it keep exp(-rate t)."""
    entry, speed = {"traction": ({"side": "right", "traction": {"nominal": [0.2]}}, 0.0), "drag": ({"drag": {"rate": 2.0}}, 0.01)}[kind]
    found = data(core, solver) | {"loads": [{"of": "body"} | entry]}
    found["bodies"]["body"] |= {"velocity": [speed]} if solver not in ("rigid", "auto", "point") else {}
    if solver in ("rigid", "auto", "point"):
        with pytest.raises(ConfigError) as refused:
            mpm.load(found)
        assert any(problem.path.startswith("loads.0") for problem in refused.value.problems)
        return
    run = mpm.run_point(mpm.load(found))
    momentum = 0.2 * END / (4.0 if solver == "scaled" else 1.0) if kind == "traction" else 2.0 * 0.75 * speed * np.exp(-2.0 * END)
    assert run.outcome.ok and run.finals["momentum_x"] == pytest.approx(momentum, rel=0.02)


def test_tables_hold_the_whole_menu():
    assert set(menus.EXCHANGE) == set(boundary.EXCHANGES) == set(EXCHANGES)
    assert set(menus.LOAD) == set(loads.LOADS)
    assert {wall.acts for wall in boundary.WALLS} == set(KINDS)
    assert set(PROGRAMMES) == set(scaling.MOMENTS) == {TimeTable.kind, Sine.kind} == set(PROGRAMME)
    kinds = {one.kind: one for one in vars(laws).values() if isinstance(one, type) and issubclass(one, laws.Kind) and hasattr(one, "kind")}
    assert set(law.LAW) == set(kinds)
    assert {kind for kind, one in kinds.items() if not hasattr(one, "values")} == {"porosity", "set"}  # of p0 alone, which no clock changes; of other laws
    for kind in laws.LAWS:  # every number of a law is a temperature, or scales with the parameter
        scaled = {*kind.values, *getattr(kind, "areas", ())}
        assert {name for name, field in kind.model_fields.items() if field.annotation in (float, tuple[float, ...]) and not field.metadata} <= scaled


def test_a_kind_of_the_menu_alone_is_refused_by_name(core, monkeypatch):
    """Whoever adds one and forgets a solver hears of it there."""
    monkeypatch.setattr(boundary, "EXCHANGES", (*boundary.EXCHANGES, "mist"))
    monkeypatch.setattr(loads, "LOADS", (*loads.LOADS, "wind"))
    entry = SimpleNamespace(**dict.fromkeys(EXCHANGES), mist=1.0, wind=1.0, traction=None, drag=None)
    for look in (lambda: menus.acting(entry), lambda: acts_of(entry, np.arange(3)), lambda: menus.pulling([entry]), lambda: menus.wall_kind("glue")):
        with pytest.raises(SceneError, match=r"mist|wind|glue"):
            look()
    with pytest.raises(SceneError, match="law 'hail' is not known here; what is: constant"):
        law.law(type("Hail", (), {"kind": "hail"})())
