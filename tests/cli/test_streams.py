"""Whatever becomes of stdout and stderr, the work goes on: commands in processes of their own, with the fake runner."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

FAKES = str(Path(__file__).parents[1] / "fakes")
CODE = f"""
import sys, types
sys.path.insert(0, {FAKES!r})
import mpm
plots = types.ModuleType("mpm.plots")
plots.__path__ = [mpm.__path__[0] + "/plots"]
plots.overview = lambda tree, path: path.write_bytes(b"p")
sys.modules["mpm.plots"] = plots
import fake_plots
from mpm.sweep import apart, engine
apart.apart = lambda code, *words: fake_plots.here(*words)
engine.RUNNER = "fake_runner"
from mpm_cli.main import main
sys.exit(main())
"""


@pytest.fixture
def shell(tmp_path):
    """Run `mpm ARGUMENTS REDIRECTIONS` in bash: exit codes of the pipe, stdout, stderr."""

    def run(line, encoding="utf-8"):
        env = {**os.environ, "PYTHONIOENCODING": encoding, "PYTHON": sys.executable, "CODE": CODE}
        script = f'mpm() {{ "$PYTHON" -c "$CODE" "$@"; }}\n{line}\necho "${{PIPESTATUS[*]}}" >codes'
        done = subprocess.run(["bash", "-c", script], cwd=tmp_path, env=env, capture_output=True, timeout=120, check=False)
        return (tmp_path / "codes").read_text().strip(), done.stdout, done.stderr.decode(errors="replace")

    return run


def test_closed_from_the_start(shell, write, tmp_path):
    config = write([0.2])
    assert shell(f"mpm run {config} -o a >&-")[0] == "0"
    assert shell(f"mpm run {config} -o b >&- 2>&- <&-")[0] == "0"
    assert shell(f"mpm run {tmp_path}/none.yaml -o c 2>&-") == ("2", b"", "")
    assert [(tmp_path / name / "run.nc").read_bytes()[:8] for name in "ab"] == [b"\x89HDF\r\n\x1a\n"] * 2


def test_full_is_told_once_and_by_the_exit_code(shell, write, tmp_path):
    codes, _, err = shell(f"mpm sweep {write([0.2, 0.5])} -j 1 -o a >/dev/full")
    assert codes == "1" and err == "error: stdout: No space left on device; the work goes on, and what it says is lost\n"
    assert (tmp_path / "a" / "sweep.nc").exists()
    assert shell("mpm schema >/dev/full")[::2] == (codes, err)


@pytest.mark.parametrize("encoding", ["utf-8", pytest.param("cp1252", marks=pytest.mark.wide), pytest.param("ascii", marks=pytest.mark.slow)])
def test_a_reader_that_leaves_loses_nothing(shell, write, tmp_path, encoding):
    config = Path(write([0.2, 0.5, 1.0]))
    config.write_text(config.read_text().replace("A slab for", "🍞 for"), encoding="utf-8")
    codes, out, err = shell(f"mpm sweep {config} -j 1 -o a | head -1", encoding)
    assert (codes, out, err) == ("141 0", b"3 points, 0 already there\n", "")
    assert (tmp_path / "a" / "sweep.nc").exists()
    assert shell("mpm status a | (read line)", encoding)[0] in ("141 0", "0 0")  # one line may be gone before the reader is


@pytest.mark.parametrize("encoding", [pytest.param("utf-8", marks=pytest.mark.slow), pytest.param("cp1252", marks=pytest.mark.wide), "ascii"])
def test_letters_that_the_encoding_lacks_are_escaped(shell, write, encoding):
    config = Path(write([0.2]))
    config.write_text(config.read_text().replace("A slab for the", "Größe 🍞"), encoding="utf-8")
    codes, out, err = shell(f"mpm plan {config}", encoding)
    assert (
        codes == "0"
        and err == ""
        and out.splitlines()[0].decode(encoding) == "slab: Größe 🍞 fake runner".encode(encoding, "backslashreplace").decode(encoding)
    )
    codes, out, err = shell(f"mpm plan {config} --json", encoding)
    assert json.loads(out.decode(encoding))["title"] == "Größe 🍞 fake runner"


def test_file_names_that_are_not_utf_8(shell, write, tmp_path):
    """They are named by their bytes, in words, in JSON and in the dataset."""
    place = os.fsencode(tmp_path) + b"/caf\xe9.yaml"
    os.rename(write([0.2, 0.5]), place)
    codes, out, err = shell("mpm sweep caf*.yaml -j 1 --json")
    assert codes == "0" and json.loads(out)["dataset"] == r"results/caf\xe9/sweep.nc" and (tmp_path / "results" / r"caf\xe9" / "sweep.png").exists()
    codes, out, err = shell("mpm sweep caf*.yaml -j 1 -o $'\\xff out' && mpm status $'\\xff out'")
    assert codes == "0" and rb"\xff out/sweep.nc" in out and rb"\xff out: caf\xe9, 2 points: 2 ok" in out
    codes, _, err = shell("echo 'colour: 1' >$'x\\xff\\e[31m.yaml'; mpm plan $'x\\xff\\e[31m.yaml'")
    assert codes == "2" and r"x\xff\x1b[31m.yaml:1:1: colour: unknown key" in err and "\x1b" not in err
    codes, _, err = shell("mpm plan caf*.yaml --set $'title=a\\xff'")
    assert codes == "2" and r"--set title=a\xff: title: this is not UTF-8 text (given \xff)" in err
