import numpy as np
import pytest

from mpm import fingerprint
from mpm.outcome import INVERTED, Outcome, Run, outcome
from mpm.records import point
from mpm.records.netcdf import write_whole
from mpm.records.provenance import CANNOT_CHANGE_A_NUMBER, git_revision, source_hash, versions


def run(kind=None):
    return Run(
        outcome=kind or Outcome("completed"),
        times=np.arange(4.0),
        series={"temperature_centre": np.arange(4.0), "heat_ledger": np.zeros(4)},
        finals={"time_to_centre_95_degC": 2.5, "temperature_mean": 300.0},
        axes={"x": np.arange(3.0)},
        snapshot_times=np.array([0.0, 3.0]),
        grid={"temperature": np.ones((2, 3), dtype=np.float32)},
        particles=[{"position": np.ones((2, 2)), "body": np.zeros(2, int)}, {"position": np.zeros((1, 2)), "body": np.ones(1, int)}],
        steps=7,
        wall_time=0.5,
        facts={"binds": "heat"},
    )


def test_round_trip(tmp_path):
    record = point.from_run("ab12", run(), attempts=2, source="s", config={"title": "é" * 60000})
    write_whole(tmp_path / "p.nc", point.pack(record))
    back = point.read(tmp_path / "p.nc")
    assert back.line == record.line and back.status == 0 and back.attempts == 2 and back.steps == 7
    assert back.finals == record.finals and back.facts == {"binds": "heat"} and back.config == record.config
    for name in ("series", "grid", "axes", "particles"):
        assert list(getattr(back, name)) == sorted(getattr(record, name)) or name == "series"
        for key, values in getattr(record, name).items():
            np.testing.assert_array_equal(getattr(back, name)[key], values)
    assert back.row_size.tolist() == [2, 1] and back.particles["position"].shape == (3, 2)
    light = point.read(tmp_path / "p.nc", fields=False)
    assert not light.grid and not light.particles and light.series


@pytest.mark.parametrize("kind, status, error", [
    (outcome(INVERTED, particle=812, time=0.0134, step=2680), 4, "diverged: det F <= 0 at particle 812, t = 0.0134 s, step 2680"),
    (Outcome("budget", "stopped at t = 3 s"), 2, "timeout: stopped at t = 3 s"),
    (Outcome("energy_growth"), 4, "diverged: energy growth"),
])  # fmt: skip
def test_not_ok_keeps_series_and_has_no_finals(kind, status, error):
    record = point.from_run("ab12", run(kind))
    assert record.status == status and record.error == error and record.outcome == kind.kind
    assert list(record.finals) == ["time_to_centre_95_degC", "temperature_mean"] and np.isnan(list(record.finals.values())).all()
    assert record.series["temperature_centre"][3] == 3


def test_bare_record(tmp_path):
    write_whole(tmp_path / "p.nc", point.pack(point.Record("ab12", 3, "killed: by signal 9")))
    back = point.read(tmp_path / "p.nc")
    assert back.status == 3 and back.error == "killed: by signal 9" and not back.series and len(back.times) == 0


def test_unknown_name_is_refused():
    bad = run()
    bad.finals["colour"] = 1.0
    with pytest.raises(KeyError, match="colour"):
        point.from_run("ab12", bad)


def test_provenance_names_what_made_the_result():
    assert source_hash() == fingerprint.source_hash(CANNOT_CHANGE_A_NUMBER) != fingerprint.source_hash()
    assert versions()["numpy"] == np.__version__
    assert isinstance(git_revision(), str)
