"""The package list of pyproject.toml is written by hand: every folder with an __init__.py must be on it."""

import tomllib
from pathlib import Path

from mpm.starting.scenes import ROOMS

ROOT = Path(__file__).parent.parent


def test_every_room_is_packaged():
    listed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    rooms = {".".join(path.parent.relative_to(ROOT).parts) for path in (ROOT / "mpm").rglob("__init__.py")}
    configs = {"mpm_configs", *(f"mpm_configs.{room}" for room in (*ROOMS, "data"))}
    assert listed == rooms | configs | {"mpm_cli", "mpm_docs"}
