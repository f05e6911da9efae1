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


Config = Annotated[Path, typer.Argument(metavar="CONFIG", help="YAML file of the experiment.", show_default=False)]
Folder = Annotated[Path, typer.Argument(metavar="OUT", parser=folder, help="Folder of a sweep.", show_default=False)]
TO = "Folder for results.  [default: results/<config name>]"
Out = Annotated[Path | None, typer.Option("-o", "--out", metavar="DIR", parser=folder, help=TO, show_default=False)]
Jobs = Annotated[int, typer.Option("-j", "--jobs", metavar="N|auto", parser=workers, help="Worker processes; auto is one a core.")]
Set = Annotated[list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Set a parameter; repeat for more.", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="One JSON document on stdout, talk on stderr.")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="Say only what went wrong.")]
MaxRuns = Annotated[int, typer.Option("--max-runs", metavar="N", min=1, help="Refuse sweeps of more points.")]
Tolerance = Annotated[
    float | None,
    typer.Option("--tol", metavar="TOL", parser=share, show_default=False, help="An error that would do, such as 1%: pilots are run, and a model is chosen."),
]
Strict = Annotated[bool, typer.Option("--strict", help="Warnings are exit code 3.")]
Smoke = Annotated[bool, typer.Option("--smoke", help="Coarse and short: apply the config's smoke section.")]
Threads = Annotated[int, typer.Option("--threads", metavar="N", min=1, help="Threads of one large run; the result is the same, bit for bit, for any number.")]


def limit(help_: str) -> Any:
    """An option that holds a duration."""
    return typer.Option(metavar="T", parser=seconds, show_default=False, help=help_)


KEEP = "How often a running point saves a checkpoint, from which a killed one goes on.  [default: 1min]"
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

    experiment = read(config, overrides(pairs), smoke=smoke)
    for text in experiment.cautions:
        warn(f"warning: {text}")
    return experiment
