import json
import os
import subprocess
import sys
from pathlib import Path

import fake_runner as fake
import pytest
import xarray as xr


def fresh(code, folder=None):
    """What a new interpreter prints, and its processor seconds (wall time would measure the machine's other work)."""
    before = os.times()
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=folder).stdout
    after = os.times()
    return said, after.children_user + after.children_system - before.children_user - before.children_system


def test_help_is_quick_and_loads_nothing_heavy():
    heavy = {"numba", "xarray", "scipy", "matplotlib", "pint", "h5netcdf", "numpy", "pydantic"}
    code = f"import sys; from mpm_cli.main import main; main(['--help']); print(sorted({heavy} & set(sys.modules)))"
    said, seconds = fresh(code)
    assert said.endswith("[]\n") and "sweep" in said and seconds < 0.3


def test_sweep_twice(mpm, write, tmp_path):
    config = write([0.2, 0.5])
    code, out, err = mpm("sweep", config, "-j", "1")
    assert code == 0 and err == "" and "[2/2] kappa=" in out and "2 ok; 2 run now" in out
    folder = tmp_path / "results" / "slab"
    assert (folder / "sweep.png").read_bytes() == b"p"
    with xr.open_dataset(folder / "sweep.nc") as data:
        assert data.sizes == {"kappa": 2} and data.kappa.attrs["units"] == "W/m/K" and data.attrs["config"].startswith("title: A slab")
    code, out, _ = mpm("sweep", config)
    assert code == 0 and "2 points, 2 already there\n" in out and "0 run now" in out


def test_the_same_again_is_quick_and_needs_no_numba(mpm, write, tmp_path):
    config = write([0.2, 0.5])
    mpm("sweep", config, "-j", "1")
    code = f"import sys; from mpm_cli.main import main; code = main(['sweep', {config!r}]); print(code, 'numba' in sys.modules, 'xarray' in sys.modules)"
    said, seconds = fresh(code, tmp_path)
    assert said.endswith("0 False False\n") and seconds < 1.0


def test_a_sweep_leaves_numba_to_its_workers(write, tmp_path):
    """Its own process stays small, under 70 MB: kernels and what they need are loaded where points run; the dataset is made and drawn by others."""
    fakes = str(Path(__file__).parents[1] / "fakes")
    code = f"import sys; sys.path.insert(0, {fakes!r}); sys.argv = ['mpm', 'sweep', {write([0.2])!r}, '-j', '1', '-q', '-o', 's']; import mpm_cli.main as cli\n"
    code += "def faked(words, real=cli.command_code):\n    from mpm.sweep import engine; engine.RUNNER = 'fake_runner'; return real(words)\n"
    code += "cli.command_code = faked; code = cli.main()\n"
    code += "peak = next((int(row.split()[1]) for row in open('/proc/self/status') if row.startswith('VmHWM')), 0)\n"
    code += "heavy = {'numba', 'xarray', 'pandas', 'matplotlib', 'h5py', '_hashlib'}; print(code, sorted(heavy & set(sys.modules)), peak)"
    ended, loaded, peak = fresh(code, tmp_path)[0].rsplit(maxsplit=2)
    assert (ended, loaded) == ("0", "[]") and int(peak) * 1024 < 70e6 and (tmp_path / "s/sweep.png").stat().st_size > 1000


def test_json_is_one_document_and_talk_goes_to_stderr(mpm, write):
    code, out, err = mpm("sweep", write([0.2, fake.DIVERGES]), "--json", "-j", "1")
    document = json.loads(out)
    assert code == 3 == document["exit_code"] and document["counts"]["ok"] == 1 and "[2/2]" in err
    assert document["failures"][0]["error"].startswith("diverged: det F <= 0 at particle 812")


def test_quiet_says_only_what_went_wrong(mpm, write):
    assert mpm("sweep", write([0.2]), "-q", "-j", "1", "-o", "a") == (0, "", "")
    code, _, err = mpm("sweep", write([fake.DIVERGES]), "-q", "-j", "1", "-o", "b")
    assert code == 4 and "det F <= 0" in err


@pytest.mark.parametrize("text, said", [
    ("title: [", "broken.yaml:"),
    ("title: a\ntitle: b\n", "broken.yaml:2:1"),
    ("colour: red\n", "broken.yaml:1:1: colour"),
])  # fmt: skip
def test_a_broken_config_is_two_and_writes_nothing(mpm, tmp_path, text, said):
    (tmp_path / "broken.yaml").write_text(text)
    for command in ("sweep", "run", "plan"):
        code, out, err = mpm(command, "broken.yaml")
        assert code == 2 and said in err and "Traceback" not in err and out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["broken.yaml"]


def test_a_missing_config_and_a_sweep_over_the_limit(mpm, write, tmp_path):
    assert mpm("sweep", "nothing.yaml")[0] == 2
    code, _, err = mpm("sweep", write([0.1, 0.2, 0.3]), "--max-runs", "2")
    assert code == 2 and "3 points" in err and not (tmp_path / "results").exists()


def test_usage_errors_are_two(mpm, write):
    config = write([0.2])
    wrong = (["-j", "0"], ["--timeout", "soon"], ["--rerun", "some"], ["--set", "x"], ["--max-runs", "none"])
    for arguments in (["bogus"], ["sweep"], *(["sweep", config, *more] for more in wrong)):
        code, _, err = mpm(*arguments)
        assert code == 2 and "error: " in err and "Traceback" not in err


def test_another_experiment_is_refused(mpm, write):
    mpm("sweep", write([0.2]), "-j", "1")
    code, _, err = mpm("sweep", write([0.2], end=20), "-j", "1")
    assert code == 2 and "time.end: 10.0 -> 20.0" in err
    assert mpm("sweep", write([0.2], end=20), "-j", "1", "--rerun", "stale")[0] == 0


def test_set_fixes_a_swept_parameter_and_smoke_shortens(mpm, write, tmp_path):
    code, _, _ = mpm("sweep", write([0.2, 0.5]), "--set", "kappa=0.7", "--smoke", "-j", "1", "-o", "out")
    assert code == 0
    with xr.open_datatree(tmp_path / "out" / "sweep.nc") as tree:
        assert tree.sizes == {} and tree.temperature_mean.item() == 300.7 and tree["series"].time[-1] == 2 and float(tree.kappa) == 0.7


def test_run_writes_the_four_groups(mpm, write, tmp_path):
    document = mpm.document("run", write([0.2, 0.5]))
    assert document["status"] == "ok" and document["finals"]["temperature_mean"] == 300.2
    with xr.open_datatree(tmp_path / "results" / "slab" / "run.nc") as tree:
        assert [node.name for node in tree.children.values()] == ["series", "grid", "particles"] and tree.sizes == {} and tree.status == 0
    code, out, _ = mpm("run", write([fake.DIVERGES]), "-o", "bad")
    assert code == 4 and "diverged: det F <= 0" in out


def test_a_model_that_raises_in_run_is_no_traceback(mpm, write):
    code, out, err = mpm("run", write([fake.RAISES]))
    assert code == 4 and "ValueError: no such luck" in out and "Traceback" not in out + err


def test_plan_counts_what_is_there_and_writes_nothing(mpm, write, tmp_path):
    config = write([0.2, 0.5, 1.0])
    assert mpm.document("plan", config)["due"] == 3 and not (tmp_path / "results").exists()
    mpm("sweep", write([0.2]), "-j", "1")
    document = mpm.document("sweep", write([0.2, 0.5, 1.0]), "--dry-run", "-j", "2")
    assert (document["points"], document["present"], document["due"], document["seconds"]) == (3, 1, 2, 0.5)
    code, out, _ = mpm("plan", config)
    assert code == 0 and "conduction binds" in out and "left out  mechanics, flow" in out and "kappa" in out


def test_status_groups_reasons(mpm, write):
    mpm("sweep", write([0.2, fake.DIVERGES, fake.RAISES]), "-j", "1", "-q")
    document = mpm.document("status", "results/slab")
    assert {row["reason"]: row["count"] for row in document["failures"]} == {"diverged: inverted": 1, "failed: ValueError: no such luck": 1}
    assert document["owner"] is None and document["stale"] == [] and document["slowest"][0]["point"] == "kappa=0.2"
    code, out, _ = mpm("status", "results/slab")
    assert code == 0 and "1 ok, 1 failed, 1 diverged" in out
    assert mpm("status", "results")[0] == 2


def test_warnings_are_told_and_strict_makes_them_three(mpm, write):
    config = write([0.2, fake.WARNS])
    code, out, _ = mpm("sweep", config, "-j", "1")
    assert code == 0 and "2 ok, 1 of them with warnings: volume 1, temperature 1; 2 run now" in out
    assert mpm("sweep", config, "--strict")[0] == 3 and mpm("sweep", write([0.2]), "--strict", "-o", "clean")[0] == 0
    assert mpm("sweep", write([fake.DIVERGES]), "--strict", "-j", "1", "-o", "bad")[0] == 4
    code, out, _ = mpm("run", write([fake.WARNS]), "-o", "one")
    assert code == 0 and "warning: volume: 48 % of the volume is lost" in out
    assert mpm("run", write([fake.WARNS]), "-o", "one", "--strict")[0] == 3
    assert mpm.document("run", write([fake.WARNS]), "-o", "one")["warnings"] == fake.WARNINGS


def test_collect_and_compare(mpm, write, tmp_path):
    mpm("sweep", write([0.2, 0.5]), "-j", "1", "-o", "a")
    mpm("sweep", write([0.2, 0.5]), "-j", "2", "-o", "b")
    assert mpm("compare", "a", "b") == (0, "same\n", "")
    first = (tmp_path / "a" / "sweep.nc").read_bytes()
    (tmp_path / "a" / "sweep.nc").unlink()
    assert mpm.document("collect", "a")["written"] is True and "up to date" in mpm("collect", "a")[1]
    assert mpm("compare", "a/sweep.nc", "b/sweep.nc")[0] == 0 and len(first) == (tmp_path / "a" / "sweep.nc").stat().st_size
    mpm("sweep", write([0.2, 0.6]), "-j", "1", "-o", "c")
    document = mpm.document("compare", "a", "c")
    assert not document["same"] and any(line.startswith("/kappa: 1 of 2 differ, most at kappa=0.5: 0.5 and 0.6") for line in document["differences"])
    assert mpm("compare", "a", "c", "--rtol", "0.5")[0] == 1  # run ids still differ
    assert mpm("compare", "a", "nowhere")[0] == 2


def test_warmup(mpm, write):
    code, out, _ = mpm("warmup", write([0.2]))
    assert code == 0 and "slab.yaml: 0.0 s" in out
    code, out, _ = mpm("warmup")
    assert code == 0 and "thermo-viscoplastic, plane strain: 0.0 s" in out and len(out.splitlines()) == 5


def test_plot_schema_info(mpm, write, tmp_path):
    assert mpm("plot", ".", "series", "-o", "x.svg") == (0, "x.svg\n", "")
    assert mpm("plot", "out", "series", "finals", "--svg")[1] == "out/series.svg\nout/finals.svg\n"
    assert "properties" in json.loads(mpm("schema")[1])
    info = mpm.document("info")
    assert info["versions"]["python"] and info["cache"]["folder"] and info["machine"]["cores"] >= 1


def test_our_own_fault_is_a_line_and_a_file(mpm, write, monkeypatch):
    monkeypatch.setattr("mpm.sweep.api.execute", lambda *_: 1 / 0)
    code, _, err = mpm("sweep", write([0.2]))
    assert code == 1 and err.startswith("internal error: ZeroDivisionError") and "Traceback" not in err
    place = Path(err.split("where: ")[1].split(";")[0])
    assert "ZeroDivisionError" in place.read_text()
    place.unlink()


def test_a_figure_that_fails_does_not_hide_the_results(mpm, write, monkeypatch):
    monkeypatch.setattr(sys.modules["mpm.plots"], "overview", lambda *_: 1 / 0)
    code, out, err = mpm("sweep", write([0.2]), "-j", "1")
    assert code == 0 and "1 ok" in out and "the figure failed: ZeroDivisionError" in err
    Path(err.split("where: ")[1].split(";")[0]).unlink()


def test_a_sweep_that_left_without_a_dataset_names_none(tmp_path):
    from mpm_cli.sweep import summary, words

    from mpm.sweep.result import Result
    from mpm.sweep.summaries import Summaries

    counts = {"ok": 300, "pending": 1, "failed": 0, "timeout": 0, "killed": 0, "diverged": 0}
    left = Result(tmp_path, Summaries([]), counts, 300, "interrupted", 130, 9.0, hurried=True)
    said = words(left, None, "mpm sweep a.yaml")
    assert "300 ok, 1 pending; 300 run now" in said[0] and f"mpm collect {tmp_path}" in said[1] and said[2].startswith("1 point is left")
    assert summary(left, None)["dataset"] is None and not [line for line in said if line.endswith("sweep.nc")]
