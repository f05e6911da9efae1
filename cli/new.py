"""mpm new: a config to begin from."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Json, folder
from mpm_cli.talk import document, say

MENU = "Name of a shipped scene, or bare. Without a name: list the scenes."
INTO = "Folder to write to.  [default: the current folder]"
PARTS = "Physics of a bare config: some of heat, elastic, flow, expansion, with commas between.  [default: heat]"
Scene = Annotated[str | None, typer.Argument(metavar="SCENE", help=MENU, show_default=False)]
Into = Annotated[Path | None, typer.Option("-o", "--out", metavar="DIR", parser=folder, help=INTO, show_default=False)]
Dimension = Annotated[str | None, typer.Option(metavar="D", help="Dimension of a bare config: 0, 1, 2, axisymmetric or 3.  [default: 1]", show_default=False)]
Physics = Annotated[str | None, typer.Option(metavar="P,...", help=PARTS, show_default=False)]
Force = Annotated[bool, typer.Option("--force", help="Overwrite files that are there.")]


def new(scene: Scene = None, dimension: Dimension = None, physics: Physics = None, out: Into = None, force: Force = False, as_json: Json = False) -> None:
    """Write a config to begin from, with the files that it reads.

    SCENE is one of the shipped scenes; `bare` is the least config of a dimension and of some physics. Nothing that is there is overwritten without --force.
    """
    from mpm.starting.scenes import command

    if scene is None and dimension is None and physics is None:
        menu(as_json)
        return
    texts = made(scene, dimension, physics)
    target = out or Path()
    write(target, texts, force)
    first = next(iter(texts))
    following = f"mpm {command(texts[first])} {target / first}"
    if as_json:
        document({"files": [target / name for name in texts], "next": following})
        return
    say(f"wrote {', '.join(str(target / name) for name in texts)}\nnext: {following}    (mpm plan {target / first} says before what it costs)")


def menu(as_json: bool) -> None:
    """The scenes, a line each."""
    from mpm.starting.scenes import ROOMS, scenes

    found = {room: scenes(room) for room in ROOMS}
    if as_json:
        document({room: {name: {"title": one.title, "purpose": one.purpose, "cost": one.cost} for name, one in some.items()} for room, some in found.items()})
        return
    lines = [f"  {name:<22} {one.title}" for name, one in found["scenes"].items()]
    say("\n".join(["Scenes (mpm new SCENE writes one here, with its data):", *lines, "  bare                   your own: --dimension and --physics say which"]))
    say("Problems with exact solutions: " + ", ".join(found["verification"]))


def made(scene: str | None, dimension: str | None, physics: str | None) -> dict[str, str]:
    """The texts of a scene or of a bare config."""
    from mpm.starting.bare import DIMENSIONS, PHYSICS, bare
    from mpm.starting.scenes import copy, find, names

    if scene in (None, "bare"):
        wanted = [word.strip() for word in (physics or "heat").split(",")]
        if unknown := [word for word in wanted if word not in PHYSICS]:
            raise typer.BadParameter(f"--physics: {unknown[0]!r} is none of {', '.join(PHYSICS)}")
        if (dimension or "1") not in DIMENSIONS:
            raise typer.BadParameter(f"--dimension: {dimension!r} is none of {', '.join(DIMENSIONS)}")
        return {"bare.yaml": bare(dimension or "1", wanted)}
    if dimension or physics:
        raise typer.BadParameter(f"--dimension and --physics are of a bare config; {scene} is what it is")
    found = find(scene.removesuffix(".yaml"))
    if found is None:
        from mpm.config.problems import near

        meant = near(scene, names())
        raise typer.BadParameter(f"there is no scene {scene!r}{f'; did you mean {meant}?' if meant else ''}; mpm new lists all")
    return copy(found)


def write(target: Path, texts: dict[str, str], force: bool) -> None:
    """All files, or none where one is there that says something else."""
    if not force:
        for name, text in texts.items():
            there = target / name
            if there.exists() and (not there.is_file() or there.read_bytes() != text.encode()):
                raise typer.BadParameter(f"{there} is there already; nothing was written. --force overwrites it, -o DIR writes elsewhere")
    target.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (target / name).write_text(text, encoding="utf-8", newline="\n")
