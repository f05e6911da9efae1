"""The contact sheet: every shipped config is met, every picture is on the page and on the sheet, what failed is told; a slow one runs it on two configs."""

import subprocess
import sys

import pytest
from PIL import Image

from mpm.benchmarks import contact_sheet
from mpm.benchmarks.contact_sheet import ACROSS, CAPTION, CONFIGS, THUMB, Shown, configs, page, sheet, show


def test_every_shipped_config_is_met_once():
    found = list(configs([]))
    shipped = {path for folder in ("scenes", "verification", "studies") for path in (CONFIGS / folder).rglob("*.yaml")}
    assert set(found) == shipped and len(found) == len(shipped)
    assert {path.parent.name for path in configs(["stability"])} == {"stability"} and [path.stem for path in configs(["slump"])] == ["slump"]


def test_a_sheet_shows_every_picture_and_every_fault(tmp_path):
    shown = []
    for number in range(ACROSS + 1):
        folder = tmp_path / f"scenes_{number}"
        folder.mkdir()
        Image.new("RGB", (1600, 800), (10 * number, 0, 0)).save(folder / "overview.png")
        shown.append(Shown(CONFIGS / "scenes/slab.yaml", folder, ["mpm plot <OUT>"], ["<b>broken</b>"] if number == 1 else []))
    text = page(shown)
    assert text.count("<img") == ACROSS + 1 and "<b>" not in text and "mpm plot &lt;OUT&gt;" in text and "scenes_3/overview.png" in text
    sheet([picture for one in shown for picture in one.pictures], tmp_path / "sheet.png")
    with Image.open(tmp_path / "sheet.png") as image:
        assert image.size == (ACROSS * THUMB, 2 * (THUMB // 2 + CAPTION))
        assert image.getpixel((3 * THUMB + 50, CAPTION + 50)) == (30, 0, 0) and image.getpixel((50, THUMB // 2 + 2 * CAPTION + 50)) == (10 * ACROSS, 0, 0)


def test_a_command_that_fails_or_draws_nothing_is_a_fault(tmp_path, monkeypatch):
    made = Shown(CONFIGS / "scenes/slab.yaml", tmp_path)
    assert not made.mpm("plot", str(tmp_path / "nothing")) and "exit code 2" in made.faults[0]
    monkeypatch.setattr(contact_sheet.Shown, "mpm", lambda *_, **__: True)
    monkeypatch.setattr(contact_sheet, "figures", lambda *_: None)
    assert show(CONFIGS / "scenes/slump.yaml", tmp_path, True).faults == ["no picture"]


@pytest.mark.slow
def test_the_command(tmp_path):
    run = [sys.executable, "-m", "mpm.benchmarks.contact_sheet", str(tmp_path / "out"), "slab", "lumped_cooling", "--smoke"]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    pictures = sorted(str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*/*.png"))
    assert {"scenes_slab/overview.png", "scenes_slab/series.png", "scenes_slab/finals.png", "verification_lumped_cooling/overview.png"} <= set(pictures)
    assert f"{len(pictures)} pictures of 2 configs" in done.stdout and (tmp_path / "out/sheet.png").exists()
