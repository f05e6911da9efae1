"""Everything that the docs show is run: commands, Python, configs, in one folder a page, in the order of the page.

A block is marked by a comment before it:
    <!-- file: NAME -->    it is a file of that name, which later blocks use; a config is loaded
    <!-- exits: N -->      its command ends with exit code N
    <!-- elsewhere -->     it is for another machine, and only its words of `mpm` are looked at
Blocks of `text` are not run. Commands that compute nothing run by default, all others with -m slow.
"""

import functools
import itertools
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from mpm_cli.main import COMMANDS
from pydantic import create_model

import mpm
from mpm.config.base import Model
from mpm.config.experiment import Experiment
from mpm.config.nodes import Origin, read

ROOT = Path(__file__).parents[2]
PAGES = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "CONTRIBUTING.md"]
RECIPES = ROOT / "docs/recipes.md"  # run by test_recipes in a copy of the tree  # README has a test of its own
BLOCK = re.compile(r"(?:^<!-- (?P<mark>[^>]*) -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)
INDENTED = re.compile(r"^    (mpm .*)$", re.MULTILINE)
LIGHT = {"new", "explain", "docs", "schema", "info"}  # commands that compute nothing
OTHERS = {"elsewhere", "slurm", "showing"}  # the last is run by tests/test_showing.py


@dataclass(frozen=True)
class Block:
    """A block of a page."""

    language: str
    text: str
    mark: str


@functools.cache
def blocks(page):
    """The blocks of a page, in order."""
    text = page.read_text(encoding="utf-8")
    found = [(match.start(), Block(match["language"], match["text"], match["mark"] or "")) for match in BLOCK.finditer(text)]
    inside = [(match.start(), match.end()) for match in BLOCK.finditer(text)]
    found += [
        (match.start(), Block("bash", match[1] + "\n", "")) for match in INDENTED.finditer(text) if not any(low < match.start() < high for low, high in inside)
    ]
    return [block for _, block in sorted(found, key=lambda pair: pair[0])]


def light(block):
    """Whether every line of it is a command that computes nothing."""
    return not block.mark.startswith("shows: ") and all(re.match(rf"mpm ({'|'.join(LIGHT)})\b", line) for line in block.text.splitlines() if line.strip())


@pytest.fixture
def folder(tmp_path):
    """Where a page's blocks run: `configs` and `docs` as in the repository, `mpm` on the path."""
    for name in ("configs", "docs", "tests"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/mpm").write_text(f'#!/bin/sh\nexec {sys.executable} -c "import sys; from mpm_cli.main import main; sys.exit(main())" "$@"\n')
    (tmp_path / "bin/mpm").chmod(0o755)
    (tmp_path / "bin/python").symlink_to(sys.executable)
    return tmp_path


def run(block, folder):
    """Run a block of commands or Python, or write a file."""
    if block.mark.startswith("file: "):
        (folder / block.mark.removeprefix("file: ")).write_text(block.text, encoding="utf-8")
        return
    command = {"bash": ["bash", "-euo", "pipefail", "-c", block.text], "python": [sys.executable, "-c", block.text]}.get(block.language)
    if command is None or block.mark in OTHERS:
        return
    place = os.environ | {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "MPLBACKEND": "agg"}
    done = subprocess.run(command, cwd=folder, env=place, capture_output=True, text=True, timeout=540, check=False)
    wanted = int(block.mark.removeprefix("exits: ")) if block.mark.startswith("exits: ") else 0
    assert done.returncode == wanted, f"{block.text}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"


def test_marks_and_languages_are_known():
    for page in PAGES:
        for block in blocks(page):
            assert block.language in ("bash", "python", "yaml", "text", "diff"), (page.name, block.text[:80])
            assert not block.mark or re.match(r"file: [\w.]+$|exits: \d+$|elsewhere$|showing$|slurm$|shows: ", block.mark), block.mark


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_and_flags_are_those_that_there_are(page):
    """In blocks and in running text: every `mpm word` is a command."""
    known = {command.__name__ for command in COMMANDS}
    text = page.read_text(encoding="utf-8").replace("mpm count", "")  # which a recipe adds
    said = re.findall(r"(?:`|^    |^|&& )mpm ([a-z]\w*)", text, re.MULTILINE)
    assert {word for word in said if word not in known} == set()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_configs_load(page, folder):
    """Whole ones are loaded; of parts, each section is what its model allows."""
    for name in ("loaf", "loaf_fit"):
        subprocess.run([folder / "bin/mpm", "new", name], cwd=folder, check=True, capture_output=True) if "extends: loaf" in page.read_text() else None
    for block in blocks(page):
        if block.mark.startswith("file: "):
            run(block, folder)
    for block in blocks(page):
        if block.language != "yaml":
            continue
        if "grid:" in block.text or "extends:" in block.text:
            (folder / "config.yaml").write_text(block.text, encoding="utf-8")
            if block.mark == "file: broken.yaml":
                with pytest.raises(mpm.ConfigError):
                    mpm.load(folder / "config.yaml")
            else:
                assert mpm.plan(mpm.load(folder / "config.yaml")).cases
            continue
        root, wrong = read(block.text, Origin(page.name))
        assert not wrong
        for key, value in root.plain().items():
            field = Experiment.model_fields[key]
            if not (key == "parameters" or "=" in str(value)):  # formulas are filled in where the whole is read
                create_model("Part", __base__=Model, **{key: (field.annotation, field)}).model_validate({key: value})


@pytest.mark.parametrize(
    "page", [page for page in PAGES if any(block.language == "bash" and light(block) for block in blocks(page))], ids=lambda page: page.stem
)
def test_commands_that_compute_nothing(page, folder):
    for block in blocks(page):
        if block.language == "bash" and light(block) and block.mark not in OTHERS:
            run(block, folder)


@pytest.mark.slow
@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page != RECIPES and any(block.language in ("bash", "python") and not light(block) for block in blocks(page))],
    ids=lambda page: page.stem,
)
def test_every_block_runs_in_order(page, folder):
    """Python that follows Python goes on in the same session, as a reader types it."""
    for language, found in itertools.groupby(blocks(page), key=lambda block: block.language):
        if language == "python":
            run(Block(language, "\n".join(block.text for block in found), ""), folder)
        else:
            for block in found:
                run(block, folder)
