import pytest

from mpm.records import variables as v


def test_every_row_is_complete_and_named_once():
    assert len(v.VARIABLES) == len(v.TABLE)
    for name, variable in v.VARIABLES.items():
        assert variable.name == name and "." not in name
        assert variable.units and variable.long_name
        assert variable.dims in ("point", "series", "grid", "particles")


@pytest.mark.parametrize("name", v.OBSERVABLES)
def test_observable_has_a_dataset_name(name):
    assert v.describe(v.dataset_name(name)).dims == "series"
    assert v.observable_exists(name)


@pytest.mark.parametrize(
    "name, probe, kelvin",
    [("time_to.centre.95_degC", "centre", 368.15), ("time_to.far_corner.300.5_K", "far_corner", 300.5), ("time_to.p1.-18_degC", "p1", 255.15)],
)
def test_threshold(name, probe, kelvin):
    for text in (name, v.dataset_name(name)):
        found = v.threshold(text)
        assert found.probe == probe and found.kelvin == pytest.approx(kelvin, abs=1e-12)
        assert v.observable_exists(text)
    assert v.describe(v.dataset_name(name)).units == "s"


def test_probe_and_unknown():
    assert v.describe("temperature_far_corner") == v.Variable("temperature_far_corner", "θ", "K", "series", "temperature at far corner")
    assert v.describe("velocity_tip").units == "m/s"
    for name in ("tempreature.mean", "time_to.centre.95", "time_to.centre.x_degC"):
        assert not v.observable_exists(name)
    with pytest.raises(KeyError):
        v.describe("colour")


def test_a_probe_may_be_called_as_the_end_of_a_sum_over_a_body():
    found = v.describe("mass_total_ball", 2, ("total_ball",))
    assert (found.units, found.long_name) == ("kg/m", "total mass, of ball, per metre of depth")
    assert v.describe("temperature_max_ball", 2, ("max_ball",)).long_name == "temperature at max ball"


def test_direction_fits_dimension():
    assert v.fits("momentum.z", 3) and not v.fits("momentum.z", 2)
    assert v.fits("position.max_r", "axisymmetric") and not v.fits("position.max_x", "axisymmetric")
    assert v.fits("temperature.max", 0) and v.fits("temperature.mean", 1) and not v.fits("extent.x", 0)


def test_status_names_match_numbers():
    assert [v.STATUS[i] for i in (v.OK, v.FAILED, v.TIMEOUT, v.KILLED, v.DIVERGED, v.SKIPPED, v.PENDING)] == list(v.STATUS)


@pytest.mark.parametrize(
    ("name", "bodies", "said"),
    [
        ("heat_patty_cheese", (), "heat taken in by patty from cheese since the start"),
        ("heat_beef_patty_cheese", (), "heat taken in by the first body of beef patty cheese from the second since the start"),
        ("heat_beef_patty_cheese", ("beef_patty", "cheese"), "heat taken in by beef patty from cheese since the start"),
        ("force_struck_striking_x", ("striking", "struck"), "force on struck by striking, mean since the record before, along x"),
        ("force_hot_plate_z", ("striking", "struck"), "force on bodies by hot plate, mean since the record before, along z"),
        ("area_beef_patty_cheese", ("beef_patty", "cheese"), "area of beef patty in touch with cheese, mean since the record before"),
    ],
)
def test_who_meets_whom_is_said_by_name(name, bodies, said):
    assert v.describe(name, 3, (), bodies).long_name == said
