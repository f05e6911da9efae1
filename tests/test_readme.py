"""What the README shows is so: its config runs, its message is the one that is given, its Python runs on what its first command leaves."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def test_the_config_loads_and_its_points_are_those_it_says(tmp_path):
    from mpm.config import load
    from mpm.sweep.cases import plan

    (text,) = blocks("yaml")
    (tmp_path / "steak.yaml").write_text(text)
    points = plan(load(tmp_path / "steak.yaml"))
    assert len(points.cases) == 15


def test_the_message_is_the_one_that_is_given(tmp_path):
    from mpm.config import ConfigError, load

    shown = next(block for block in blocks("") if "kapa" in block)
    text = (ROOT / "configs/scenes/loaf.yaml").read_text(encoding="utf-8").splitlines()
    line = next(k for k, one in enumerate(text) if re.match(r"\s+kappa: ", one))
    text[line] = text[line].replace("kappa:", "kapa:")
    (tmp_path / "loaf.yaml").write_text("\n".join(text))
    with pytest.raises(ConfigError) as told:
        load(tmp_path / "loaf.yaml")
    said = next(one for one in str(told.value).splitlines() if "kapa" in one)
    place = r"loaf\.yaml:\d+:\d+: "
    assert re.split(place, said)[1] == re.split(place, shown.splitlines()[0])[1]


@pytest.mark.slow
def test_the_python_runs_on_what_the_first_command_leaves(tmp_path):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    sweep = [sys.executable, "-c", "from mpm_cli.main import main; main()", "sweep", "configs/scenes/loaf.yaml"]
    subprocess.run(sweep, cwd=tmp_path, check=True, capture_output=True, timeout=600)
    for block in blocks("python"):
        done = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 0, done.stderr
