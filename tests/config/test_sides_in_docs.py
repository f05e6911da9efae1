"""The table of sides in docs/config.md is that of the models."""

import re
from pathlib import Path

from mpm.config.boundary import SURFACE_SIDES, WALL_SIDES

PAGE = (Path(__file__).parents[2] / "docs/config.md").read_text(encoding="utf-8")


def test_the_table_of_sides():
    rows = re.findall(r"^\| (0|1|2|axisymmetric|3) \| ([\w, ]+) \| ([\w, ]+) \|$", PAGE, re.MULTILINE)
    assert len(rows) == 5
    for name, of_bodies, of_walls in rows:
        dimension = int(name) if name.isdigit() else name
        assert tuple(of_bodies.split(", ")) == SURFACE_SIDES[dimension]
        assert of_walls == (", ".join(WALL_SIDES[dimension]) or "none")
