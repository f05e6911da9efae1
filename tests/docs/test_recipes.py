"""The recipes are true: each is done in a copy of the tree, as the page shows it, and its command then says what the page says.

In plain Python, without the compiler: what is asked is whether the steps suffice.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/recipes.md").read_text(encoding="utf-8")
SECTIONS = {title: text for title, text in re.findall(r"^## ([^\n]+)\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE) if "```diff" in text}
BLOCK = re.compile(r"(?:^<!-- (?P<mark>[^\n]*) -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)
MPM = "import sys; from mpm_cli.main import main; sys.exit(main(sys.argv[1:]))"


@pytest.fixture
def tree(tmp_path):
    """A copy of the tree, and a command `mpm` that runs it."""
    for room in ("mpm", "cli", "configs", "docs"):
        shutil.copytree(ROOT / room, tmp_path / room, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "mpm_cli").symlink_to("cli")
    (tmp_path / "mpm.sh").write_text(f'#!/bin/sh\nexec {sys.executable} -c "{MPM}" "$@"\n')
    (tmp_path / "bin").mkdir()
    (tmp_path / "mpm.sh").chmod(0o755)
    (tmp_path / "bin/mpm").symlink_to("../mpm.sh")
    (tmp_path / "bin/python").write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    (tmp_path / "bin/python").chmod(0o755)
    return tmp_path


def test_there_are_recipes():
    assert len(SECTIONS) >= 8


@pytest.mark.slow
@pytest.mark.parametrize("title", SECTIONS)
def test_a_recipe_does_what_it_says(title, tree):
    place = os.environ | {"PYTHONPATH": str(tree), "PATH": f"{tree / 'bin'}:{os.environ['PATH']}", "NUMBA_DISABLE_JIT": "1", "COLUMNS": "120"}
    for found in BLOCK.finditer(SECTIONS[title]):
        mark, language, text = found["mark"] or "", found["language"], found["text"]
        if language == "diff":
            done = subprocess.run(["git", "apply", "-"], input=text, cwd=tree, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
        elif mark.startswith("file: "):
            (tree / mark.removeprefix("file: ")).write_text(text, encoding="utf-8")
        elif language == "bash":
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=tree, env=place, capture_output=True, text=True, timeout=300, check=False)
            assert done.returncode == 0, done.stderr
            assert mark.removeprefix("shows: ") in done.stdout, done.stdout
