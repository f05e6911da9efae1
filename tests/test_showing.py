"""The commands of docs/showing.md, as a stranger types them, in shortened runs: they give the report, the movie and the ParaView file of slump and loaf."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.slow
def test_the_commands_of_the_page(tmp_path):
    page = (ROOT / "docs/showing.md").read_text(encoding="utf-8")
    commands = re.search(r"<!-- showing -->\n```bash\n(.*?)```", page, re.DOTALL)[1].strip().splitlines()
    assert len(commands) == 5
    script = f'mpm() {{ "{sys.executable}" -c "import sys; from mpm_cli.main import main; sys.exit(main())" "$@"; }}\n'
    for command in commands:
        short = re.sub(r"(mpm (?:run|sweep) \S+)", r"\1 --smoke", command).replace("configs/", f"{ROOT}/configs/")
        done = subprocess.run(["bash", "-c", script + short], cwd=tmp_path, env=os.environ, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 0, (command, done.stdout, done.stderr)
    for name in ("slump", "loaf"):
        made = [tmp_path / "results" / file for file in (f"{name}/report.html", f"{name}/movie.webp", f"{name}/paraview.vtkhdf")]
        assert all(path.stat().st_size > 1000 for path in made), made
        assert "data:image/webp" in made[0].read_text(encoding="utf-8")
    assert (tmp_path / "results/loaf/ovens.webp").stat().st_size > 1000
