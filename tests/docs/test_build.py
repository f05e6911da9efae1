"""The docs build offline, with warnings as errors, and hold every page; what would be a warning fails the build."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "docs/sphinx/build.py"


def test_the_contents_name_every_page(tmp_path):
    """Each page that is gathered stands in the contents once, and the contents name no other."""
    build = runpy.run_path(str(BUILD))
    build["gather"](tmp_path)
    pages = {path.stem for path in tmp_path.glob("*.md")} - {"index"}
    named = re.findall(
        r"^(\w+)$", "\n".join(re.findall(r"```\{toctree\}\n(.*?)```", (tmp_path / "index.md").read_text(encoding="utf-8"), re.DOTALL)), re.MULTILINE
    )
    assert sorted(named) == sorted(pages) and {path.stem for path in (ROOT / "docs").glob("*.md")} <= pages


def test_links_to_the_repository_become_plain_paths():
    outward = runpy.run_path(str(BUILD))["outward"]
    assert outward("[a](docs/speed.md) [b](../configs/x.yaml) ![c](docs/loaf.png)", "") == "[a](speed.md) b (`configs/x.yaml`) ![c](loaf.png)"
    assert outward("[d](../CONTRIBUTING.md) [e](https://x.org) [f](#here)", "docs") == "[d](contributing.md) [e](https://x.org) [f](#here)"


@pytest.mark.slow
def test_it_builds_and_a_bad_link_stops_it(tmp_path):
    pytest.importorskip("sphinx")
    done = subprocess.run([sys.executable, BUILD, tmp_path / "html"], capture_output=True, text=True, timeout=180, check=False)
    assert done.returncode == 0, done.stderr
    assert "materials.&lt;name&gt;.heat.fourier" in (tmp_path / "html/reference_config.html").read_text(encoding="utf-8")
    assert not re.search(r'(?:src|href)="https?://(?!jobqueue)[^"]*\.(?:js|css|woff2?)"', (tmp_path / "html/index.html").read_text(encoding="utf-8"))
    page = tmp_path / "pages"
    page.mkdir()
    (page / "index.md").write_text("# A\n\n[no](nowhere.md)\n", encoding="utf-8")
    sphinx = [sys.executable, "-m", "sphinx", "-W", "-q", "-c", BUILD.parent, page, tmp_path / "bad"]
    assert subprocess.run(sphinx, capture_output=True, timeout=120, check=False).returncode != 0
