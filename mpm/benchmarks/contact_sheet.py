"""All pictures of all scenes and studies, by the commands that a user types: `python -m mpm.benchmarks.contact_sheet OUT [NAME...] [--smoke]`.

    OUT/NAME/*.png      every figure of configs/scenes, verification and studies: `mpm sweep` or `mpm fit`, `mpm plot` of all kinds, `mpm sensitivity`
                        of samples, `mpm chart --quick`, `mpm stability`
    OUT/sheet.html      all of them beside their commands, to look at one by one
    OUT/sheet.png       the same, small, in one picture

NAME      names of configs or of folders of them (`scenes`, `loaf`, `stability`); all unless given
--smoke   what each config's `smoke:` says: coarse and short; pictures of the same kinds
The same command again computes nothing that is there, unless source or config have changed since. All at full size takes about an hour on two cores; scenes
alone some minutes. Exit code 1 where a command failed or left no picture: what it said is on the page.
"""

import argparse
import html
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from mpm.benchmarks import CONFIGS

FOLDERS = ("scenes", "verification", "studies", "studies/stability", "studies/reduction")
THUMB, ACROSS, CAPTION = 360, 6, 18  # pixels; pictures a row; pixels


@dataclass
class Shown:
    """One config: the commands that were run and what they left."""

    config: Path
    out: Path
    commands: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    @property
    def pictures(self) -> list[Path]:
        """Pictures in the config's folder."""
        return sorted(self.out.glob("*.png"))

    def mpm(self, *words: str, fine: tuple[int, ...] = (0, 3)) -> bool:
        """Run `mpm WORDS`; whether it ended as it should. Points that fail (3) are no fault of a picture."""
        command = [sys.executable, "-c", "import sys; from mpm_cli.main import main; sys.exit(main())", *words]
        done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"NO_COLOR": "1"}, check=False)
        self.commands.append(f"mpm {' '.join(words)}")
        if done.returncode not in fine:
            self.faults.append(f"{self.commands[-1]}: exit code {done.returncode}: {(done.stderr or done.stdout).strip()[-400:]}")
        return done.returncode in fine


def configs(names: list[str]) -> Iterator[Path]:
    """Shipped configs, all or those named."""
    for folder in FOLDERS:
        for path in sorted((CONFIGS / folder).glob("*.yaml")):
            if not names or {path.stem, *Path(folder).parts} & set(names):
                yield path


def show(config: Path, out: Path, smoke: bool) -> Shown:
    """Everything that the commands draw of a config."""
    from mpm.config import load

    experiment, group = load(config), config.parent.name
    made = Shown(config, out / f"{group}_{config.stem}")
    where, short = ("-o", str(made.out)), ("--smoke",) if smoke and experiment.smoke else ()
    name = os.path.relpath(config)
    if group == "studies":
        made.mpm("chart", name, *where, "--quick", "-q")
    elif group == "stability":
        made.mpm("stability", name, *where, *short, "-q")
    elif experiment.fit is not None:
        made.mpm("fit", name, *where, *short, "-q")
    elif made.mpm("sweep", name, *where, *short, "--rerun", "stale", "-q", fine=(0, 3, 4)):
        figures(made, experiment)
    if not made.pictures:
        made.faults.append("no picture")
    return made


def figures(made: Shown, experiment: object) -> None:
    """Figures of a sweep: of a scene all kinds, of a verification its overview."""
    if made.config.parent.name != "scenes":
        made.mpm("plot", str(made.out), "overview")
        return
    from mpm.opened import Results

    with Results(made.out) as found:
        swept = found.view.status.size > 1
    made.mpm("plot", str(made.out), "overview", "series", *(("finals",) if swept else ()))
    if experiment.output.snapshots is not None:
        made.mpm("plot", str(made.out), "snapshot")
    if swept and experiment.sweep.sample:
        made.mpm("sensitivity", str(made.out), "-q")


def page(shown: list[Shown]) -> str:
    """All pictures beside their commands."""
    style = "body{font:15px sans-serif;margin:2em} img{max-width:100%;border:1px solid #ddd} pre{background:#f4f4f4;padding:.6em} .fault{color:#b00020}"
    parts = [f"<!doctype html><meta charset=utf-8><title>Contact sheet</title><style>{style}</style><h1>Contact sheet</h1>"]
    for one in shown:
        parts.append(f"<h2>{html.escape(one.out.name)}</h2><pre>{html.escape(chr(10).join(one.commands))}</pre>")
        parts += [f"<p class=fault>{html.escape(fault)}</p>" for fault in one.faults]
        parts += [f'<p>{picture.stem}<br><img loading=lazy alt="{picture.stem}" src="{one.out.name}/{picture.name}"></p>' for picture in one.pictures]
    return "\n".join(parts)


def sheet(pictures: list[Path], path: Path) -> None:
    """All pictures, small, in one."""
    from PIL import Image, ImageDraw

    small = []
    for picture in pictures:
        image = Image.open(picture).convert("RGB")
        image.thumbnail((THUMB, THUMB))
        small.append((f"{picture.parent.name} {picture.stem}", image))
    rows = [small[k : k + ACROSS] for k in range(0, len(small), ACROSS)]
    heights = [max(image.height for _, image in row) + CAPTION for row in rows]
    whole = Image.new("RGB", (ACROSS * THUMB, sum(heights)), "white")
    pen, top = ImageDraw.Draw(whole), 0
    for row, height in zip(rows, heights, strict=True):
        for column, (caption, image) in enumerate(row):
            pen.text((column * THUMB + 4, top + 2), caption[: math.floor(THUMB / 6.5)], fill="#222222")
            whole.paste(image, (column * THUMB, top + CAPTION))
        top += height
    whole.save(path)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m mpm.benchmarks.contact_sheet", description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for datasets, pictures and the sheet")
    parser.add_argument("names", nargs="*", metavar="NAME", help="configs, or folders of them; all unless given")
    parser.add_argument("--smoke", action="store_true", help="coarse and short, as each config's smoke section says")
    given = parser.parse_intermixed_args()
    wanted = list(configs(given.names))
    if not wanted:
        parser.error(f"no config is called {', '.join(given.names)}; there are {', '.join(path.stem for path in configs([]))}")
    given.out.mkdir(parents=True, exist_ok=True)
    shown = []
    for number, config in enumerate(wanted, 1):
        print(f"[{number}/{len(wanted)}] {os.path.relpath(config)}", flush=True)
        shown.append(show(config, given.out, given.smoke))
        for fault in shown[-1].faults:
            print(f"  {fault}", flush=True)
    (given.out / "sheet.html").write_text(page(shown), encoding="utf-8")
    pictures = [picture for one in shown for picture in one.pictures]
    if pictures:
        sheet(pictures, given.out / "sheet.png")
    print(f"{len(pictures)} pictures of {len(shown)} configs: {given.out / 'sheet.html'}")
    return int(any(one.faults for one in shown))


if __name__ == "__main__":
    sys.exit(main())
