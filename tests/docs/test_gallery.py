"""The gallery, as it is built, names every shipped scene; no picture lies there that it does not show."""

import re
import runpy
from pathlib import Path

from mpm.plots import KINDS
from mpm.starting.scenes import scenes

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "gallery.md").read_text(encoding="utf-8")


def test_every_scene_and_kind_of_figure_is_shown():
    built = runpy.run_path(str(DOCS / "sphinx/build.py"))["gallery"](PAGE)
    assert {name for name in scenes() if not re.search(rf"^\| .*`{name}`.*\|$", built, re.MULTILINE)} == set()
    assert {kind for kind in KINDS if not re.search(rf"mpm plot OUT {kind}\b|{kind}", PAGE)} == set()
    assert {path.name for path in (DOCS / "gallery").iterdir()} == set(re.findall(r"gallery/(\w+\.(?:png|gif))", PAGE))


def test_thumbnails_are_small():
    assert sum(path.stat().st_size for path in (DOCS / "gallery").iterdir()) < 1_500_000
