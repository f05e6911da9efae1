"""The pictures of docs/gallery: python docs/sphinx/gallery.py SHEET [NAME...]

SHEET is what `python -m mpm.benchmarks.contact_sheet SHEET scenes` left. The picture of a scene is that of its fit, else its overview; of the other kinds of
figures one each; all are made 560 dots wide with 64 colours. Movies are short and small. report.png is a screenshot of `mpm report`, made by hand.
"""

import sys
from pathlib import Path

from PIL import Image

import mpm
from mpm.starting.scenes import scenes

GALLERY = Path(__file__).parents[1] / "gallery"
WIDTH, COLOURS = 560, 64
KINDS = {"finals": "loaf/finals.png", "series": "steak_flip/series.png", "snapshot": "loaf/snapshot.png", "sensitivity": "slump/sensitivity.png"}
MOVIES = {"loaf_movie": ("loaf", ["beta=5", "beta=50"], 4), "slump_movie": ("slump", [], 4)}  # scene, points, one snapshot of so many


def thumbnail(drawn: Path, name: str) -> None:
    """A small picture."""
    with Image.open(drawn) as picture:
        small = picture.convert("RGB").resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.Resampling.LANCZOS)
    small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(GALLERY / f"{name}.png", optimize=True)


def main(sheet: Path, names: list[str]) -> None:
    """Make those that are named, or all."""
    GALLERY.mkdir(exist_ok=True)
    folders = {name: sheet / f"scenes_{name}" for name in scenes()}
    pictures = {name: next((folder / file for file in ("fit.png", "overview.png") if (folder / file).exists()), None) for name, folder in folders.items()}
    del pictures["loaf"]  # docs/loaf.png, which the README shows
    pictures |= {name: sheet / f"scenes_{file}" for name, file in KINDS.items()}
    for name, picture in pictures.items():
        if picture is not None and name in (names or pictures):
            thumbnail(picture, name)
    for name, (scene, points, every) in MOVIES.items():
        if name in (names or MOVIES):
            mpm.movie(folders[scene], points, GALLERY / f"{name}.gif", every=every, size=(600, 360))
    for path in sorted(GALLERY.glob("*")):
        print(path.stat().st_size, path.name)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
