"""What mechanics needs of a dataset: tensors, displacements, numbers of particles, probes of displacement and stress; one snapshot as a table."""

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError

FIELDS = ["position", "displacement", "reference_position", "id", "stress", "strain", "pressure", "stress_mises", "velocity_gradient", "J"]


def pulled(frame, **changes):
    """A block on two mirrors, pulled upwards: uniform stress, P_yy = 0.1."""
    return mpm.load({
        "grid": {"dimension": 2, "size": [0.8, 1.5], "cell": 0.1},
        "bodies": {"bar": {"shape": {"box": {"lower": [0, 0], "upper": [0.53, 1.03]}}, "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.3}}}}, "walls": {"left": "slip", "bottom": "slip"},
        "loads": [{"of": "bar", "side": "top", "traction": {"nominal": [0.0, 0.1], "ramp": 5}}, {"of": "bar", "drag": {"rate": 2}}],
        "time": {"end": 60}, "method": {"frame": frame},
        "output": {"every": 20, "probes": {"end": [0.3, 1.03]}, "observables": ["displacement.end_y", "displacement.end_x", "stress.end_yy"],
                   "snapshots": {"every": 30, "particles": FIELDS}},
    }, changes)  # fmt: skip


@pytest.mark.parametrize("frame", ["total", pytest.param("updated", marks=pytest.mark.slow)])
def test_fields_probes_and_one_snapshot(frame):
    tree = mpm.run(pulled(frame))
    last, first = mpm.particles(tree), mpm.particles(tree, snapshot=0.0)
    assert int(tree.status) == 0 and last.attrs["time"] == 60 and list(last.component.values) == ["xx", "yy", "zz", "xy"]
    assert last.displacement.values == pytest.approx(last.position.values - last.reference_position.values, abs=1e-14)
    assert np.array_equal(first.particle, last.particle) and np.abs(first.displacement).max() < 1e-14
    with pytest.raises(KeyError, match="a time, from 0 to 60 s, not -1"):
        mpm.particles(tree, snapshot=-1)
    sigma = last.stress
    assert -sigma.sel(component=["xx", "yy", "zz"]).mean("component").values == pytest.approx(last.pressure.values, rel=1e-9, abs=1e-12)
    stretch = np.exp(last.strain.sel(component="yy").values)
    exact, tight = 0.1 * stretch / last.J.values, 1e-8 if frame == "total" else 0.5
    assert sigma.sel(component="yy").values == pytest.approx(exact, rel=tight)
    series = tree["series"].to_dataset()
    top = 1.03 * (stretch.mean() - 1.0)
    assert float(series.displacement_end_y[-1]) == pytest.approx(top, rel=1e-8 if frame == "total" else 2e-2)
    assert float(series.stress_end_yy[-1]) == pytest.approx(exact.mean(), rel=1e-8 if frame == "total" else 0.5)
    assert series.displacement_end_x.attrs["units"] == "m" and series.stress_end_yy.attrs["units"] == "Pa"


@pytest.mark.parametrize(("name", "said"), [
    ("displacement.tip_y", "there is no probe 'tip'"), ("displacement.end_z", "no such component in dimension 2"), ("stress.end_yz", "no such component"),
])  # fmt: skip
def test_what_a_probe_cannot_tell(name, said):
    with pytest.raises(ConfigError, match=said):
        pulled("total", **{"output.observables": [name, "displacement.end_x"]})


def test_a_probe_of_a_cold_body_wants_an_observable():
    with pytest.raises(ConfigError, match="unless an observable asks it for more"):
        pulled("total", **{"output.observables": []})


def test_gradient_of_velocity_wants_slopes():
    with pytest.raises(ConfigError, match="carry no gradient of velocity"):
        pulled("updated", **{"method.transfer": {"flip": {}}})
