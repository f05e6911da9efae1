"""Options that commands share: their types, and the words of their help."""

import re
import shlex
from pathlib import Path
from typing import Annotated, Any

import typer
from mpm_cli.talk import warn

BYTES = {"": 1.0} | {f"{letter}{i}": (1024.0 if i else 1000.0) ** (power + 1) for power, letter in enumerate("kMGT") for i in ("", "i")}
UNITS = {"s": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0, "d": 86400.0}


def seconds(text: str) -> float:
    """`90`, `90s`, `1.5min`, `2h` in seconds."""
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*(s|min|m|h|d)?\s*", text)
    if match is None or float(match[1]) == 0:
        raise typer.BadParameter(f"{text!r} is not a duration; say 90, 90s, 5min or 2h")
    return float(match[1]) * UNITS[match[2] or "s"]


def amount(text: str) -> float:
    """`4GB`, `500 MB`, `2GiB`, `4e9` in bytes."""
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?(?:e\d+)?)\s*([kMGT]?i?)B?\s*", text)
    if match is None or float(match[1]) == 0 or match[2] not in BYTES:
        raise typer.BadParameter(f"{text!r} is not an amount of memory; say 4GB, 500MB or 2GiB")
    return float(match[1]) * BYTES[match[2]]


def workers(text: str) -> int:
    """`auto` (one a core) or a number of worker processes."""
    from mpm.records.provenance import cores

    if text == "auto":
        return cores()
    if not re.fullmatch(r"[1-9]\d{0,3}", text):
        raise typer.BadParameter(f"{text!r} is not a number of workers; say auto, 1, 2, ...")
    return int(text)


def share(text: str) -> float:
    """`1%` or `0.01` as a number between 0 and 1."""
    match = re.fullmatch(r"\s*(\d+\.?\d*(?:e-?\d+)?|\.\d+)\s*(%?)\s*", text)
    value = float(match[1]) / (100 if match[2] else 1) if match else 0.0
    if not 0 < value <= 1:
        raise typer.BadParameter(f"{text!r} is not a tolerance; say 1% or 0.01")
    return value


def folder(text: str) -> Path:
    """A file or folder. Nothing at all would be the current folder."""
    if not text.strip():
        raise typer.BadParameter("it is empty; name a folder or a file")
    return Path(text)


Config = Annotated[Path, typer.Argument(metavar="CONFIG", help="YAML file that describes the experiment.", show_default=False)]
Folder = Annotated[Path, typer.Argument(metavar="OUT", parser=folder, help="Folder of a sweep or of a run.", show_default=False)]
POINT = "Point by its values, as kappa=0.35,beta=13; beta=all takes one for each value.  [default: the point that stands for the sweep]"
Points = Annotated[list[str] | None, typer.Argument(metavar="[POINT...]", help=POINT, show_default=False)]
TO = "Folder for results.  [default: results/<config name>]"
Out = Annotated[Path | None, typer.Option("-o", "--out", metavar="DIR", parser=folder, help=TO, show_default=False)]
Jobs = Annotated[int, typer.Option("-j", "--jobs", metavar="N|auto", parser=workers, help="Number of worker processes; auto starts one for each core.")]
Set = Annotated[
    list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Set one parameter of the config; repeat the option to set more.", show_default=False)
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout; messages go to stderr.")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="Print only errors and failures.")]
MaxRuns = Annotated[int, typer.Option("--max-runs", metavar="N", min=1, help="Largest number of points that a sweep may have.")]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tol", metavar="TOL", parser=share, show_default=False, help="Largest acceptable error, e.g. 1%. Runs coarse pilots and chooses a model and method."
    ),
]
Strict = Annotated[bool, typer.Option("--strict", help="End with exit code 3 if any point has warnings.")]
Smoke = Annotated[bool, typer.Option("--smoke", help="Make the run coarse and short: apply the config's smoke section.")]
Threads = Annotated[
    int, typer.Option("--threads", metavar="N", min=1, help="Number of threads for one large run. The result does not depend on it, bit for bit.")
]


def limit(help_: str) -> Any:
    """An option that holds a duration."""
    return typer.Option(metavar="T", parser=seconds, show_default=False, help=help_)


KEEP = "Time between two checkpoints of a running point; a killed point continues from its last one.  [default: 1min]"
Checkpoints = Annotated[float | None, limit(KEEP)]


def again(context: typer.Context) -> str:
    """The command that goes on from what this one left: the same, but for an order to begin again."""
    return re.sub(r" --rerun[= ]all(?= |$)", "", shlex.join(["mpm", *(context.obj or ())]))


def overrides(pairs: list[str] | None) -> dict[str, Any]:
    """`path=value` pairs as a mapping; `mpm.config.load` reads the text."""
    found: dict[str, Any] = {}
    for pair in pairs or []:
        path, sign, text = pair.partition("=")
        if not sign or not path.strip():
            raise typer.BadParameter(f"--set {pair!r}: say PATH=VALUE, as --set time.end=60 or --set 'beta=13 W/m**2/K'")
        found[path.strip()] = text.strip()
    return found


def load(config: Path, pairs: list[str] | None, smoke: bool = False) -> Any:
    """The experiment that a command is about."""
    from mpm.config import load as read
    from mpm.config.cautions import cautions

    experiment = read(config, overrides(pairs), smoke=smoke)
    for text in cautions(experiment):
        warn(f"warning: {text}")
    return experiment
