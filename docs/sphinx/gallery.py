"""The thumbnails of docs/gallery: python docs/sphinx/gallery.py RESULTS [SCENE...]

RESULTS/<scene> holds what `mpm sweep` or `mpm run` made of configs/scenes/<scene>.yaml. Its overview is drawn, made 560 dots wide, and written with 48 colours.
"""

import sys
from pathlib import Path

from PIL import Image

from mpm.plots import figures

GALLERY = Path(__file__).parents[1] / "gallery"
WIDTH, COLOURS = 560, 48


def thumbnail(results: Path, scene: str) -> int:
    """Bytes of a scene's thumbnail."""
    drawn = figures(results / scene, [], results / scene / "thumbnail.png", False)[0]
    with Image.open(drawn) as picture:
        small = picture.convert("RGB").resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.Resampling.LANCZOS)
    GALLERY.mkdir(exist_ok=True)
    small.quantize(COLOURS).save(GALLERY / f"{scene}.png", optimize=True)
    return (GALLERY / f"{scene}.png").stat().st_size


if __name__ == "__main__":
    for name in sys.argv[2:] or sorted(path.name for path in Path(sys.argv[1]).iterdir() if path.is_dir()):
        print(name, thumbnail(Path(sys.argv[1]), name))
