"""A fit in processes of its own: interrupted, killed, over Dask; the same command goes on, with the same answer, and no point is run twice."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from mpm.records.netcdf import summary

pytestmark = pytest.mark.slow  # each starts processes

MPM = [sys.executable, "-c", "from mpm_cli.main import main; raise SystemExit(main())", "fit"]
SCENE = """\
grid: {dimension: 1, size: [0.05], cell: 0.0005}
bodies: {slab: {shape: {box: {lower: [0.005], upper: [0.045]}}, temperature: 298.15, material: dough}}
materials: {dough: {density: 500, heat: {fourier: {kappa: 0.3, alpha: 2800}}}}
surfaces: [{of: slab, convection: {beta: 15, outside: 473.15}}]
time: {end: 1200}
output:
  every: 60
  probes: {centre: [0.025], face: [0.044]}
  measured:
    centre: {samples: [[300, 308.1], [600, 330.7], [900, 351.4], [1200, 369.3]], sigma: 0.5 K}
    face: {samples: [[300, 360.5], [600, 378.1], [900, 391.8], [1200, 403.6]], sigma: 0.5 K}
fit: {parameters: {kappa: {log: [0.1, 1]}, beta: {log: [5, 60]}}, starts: 8}
"""


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "slab.yaml").write_text(SCENE)
    return tmp_path / "slab.yaml"


def whole(*arguments):
    """(exit code, JSON document)."""
    done = subprocess.run([*MPM, *map(str, arguments), "--json"], capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout, done.stderr
    return done.returncode, json.loads(done.stdout)


def points(out):
    """Ids of the points on disk, those in batches too; none is there twice."""
    ids = [path.stem for path in out.glob("points/*/*.nc")]
    ids += [line["run_id"] for path in out.glob("batches/*/[0-9]*.nc") if (found := summary(path)) for line in found["points"]]
    assert len(ids) == len(set(ids))
    return len(ids)


def files(out):
    return sum(1 for _ in out.glob("points/*/*.nc")) + sum(1 for _ in out.glob("batches/*/[0-9]*.nc"))


def stopped(out, more, kind, *arguments):
    """Start a fit, and send a signal to it (to its group, as a terminal does) once it has so many more files; (exit code, stderr)."""
    before = files(out)
    process = subprocess.Popen([*MPM, *map(str, arguments), "-o", str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    end = time.monotonic() + 120
    while files(out) < before + more and process.poll() is None and time.monotonic() < end:
        time.sleep(0.002)
    os.killpg(process.pid, kind)
    _, told = process.communicate(timeout=120)
    return process.returncode, told


@pytest.mark.parametrize(("kind", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "SIGTERM"])
def test_a_stopped_fit_says_how_to_go_on_and_goes_on(scene, tmp_path, kind, code):
    out = tmp_path / "out"
    left, told = stopped(out, 5, kind, scene, "-j", "1")
    assert left == code and "to go on: mpm fit" in told and not (out / "fit.nc").exists()
    there = points(out)
    assert there >= 5
    code, found = whole(scene, "-o", out, "-j", "1")
    assert code == 0 and found["ran"] == found["points"] - there > 0
    _, straight = whole(scene, "-o", tmp_path / "straight", "-j", "1")
    assert found["parameters"] == straight["parameters"] and found["points"] == straight["points"] == points(out)


def test_killed_at_ten_moments_it_gives_the_same_and_runs_no_point_twice(scene, tmp_path):
    out, seen = tmp_path / "out", []
    for _ in range(10):
        stopped(out, 4, signal.SIGKILL, scene, "-j", "1")
        seen.append(points(out))
    assert seen == sorted(seen) and len(set(seen)) == 10
    code, found = whole(scene, "-o", out, "-j", "1")
    _, straight = whole(scene, "-o", tmp_path / "straight", "-j", "1")
    assert code == 0 and found["ran"] == found["points"] - seen[-1]
    assert found["parameters"] == straight["parameters"] and found["points"] == straight["points"] == points(out)


def test_over_dask_it_is_the_same(scene, tmp_path):
    pytest.importorskip("distributed")
    code, found = whole(scene, "-o", tmp_path / "dask", "-j", "2", "--scheduler", "local")
    _, straight = whole(scene, "-o", tmp_path / "own", "-j", "2")
    assert code == 0 and found["parameters"] == straight["parameters"] and found["ran"] == straight["ran"] == found["points"]
    assert whole(scene, "-o", tmp_path / "dask", "-j", "2", "--scheduler", "local")[1]["ran"] == 0


def test_what_ran_before_is_run_again_when_asked(scene, tmp_path):
    _, first = whole(scene, "-o", tmp_path / "out", "-j", "1")
    code, again = whole(scene, "-o", tmp_path / "out", "-j", "1", "--rerun", "all")
    assert code == 0 and again["ran"] == first["ran"] and again["parameters"] == first["parameters"]
    _, other = whole(scene, "-o", tmp_path / "out", "-j", "1", "--set", "time.end=1300", "--rerun", "stale")
    assert other["ran"] > 0
