"""The notebooks run from their first cell to their last, in plain Python: no server is needed, and none of their cells uses one."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))
each = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def code(path):
    """The cells of code, one after another."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


@each
def test_it_is_a_notebook_without_outputs(path):
    found = json.loads(path.read_text(encoding="utf-8"))
    assert found["nbformat"] == 4 and found["cells"][0]["cell_type"] == "markdown"
    assert all(not cell["outputs"] and cell["execution_count"] is None for cell in found["cells"] if cell["cell_type"] == "code")
    for text in code(path):
        compile(text, path.name, "exec")


@pytest.mark.slow
@each
def test_it_runs(path, tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/mpm").write_text(f'#!/bin/sh\nexec {sys.executable} -c "import sys; from mpm_cli.main import main; sys.exit(main())" "$@"\n')
    (tmp_path / "bin/mpm").chmod(0o755)
    (tmp_path / "cells.py").write_text("if __name__ == '__main__':\n" + "\n".join("    " + line for text in code(path) for line in text.splitlines()))
    place = os.environ | {"PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "MPLBACKEND": "agg"}
    done = subprocess.run([sys.executable, "cells.py"], cwd=tmp_path, env=place, capture_output=True, text=True, timeout=500, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-3000:]
