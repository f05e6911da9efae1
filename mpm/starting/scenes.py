"""Scenes by name, and what a user gets of one: texts by file name, all of which stand in one folder."""

import re
from dataclasses import dataclass
from pathlib import Path

from mpm.starting.places import folder

ROOMS = ("scenes", "verification")  # what `mpm new` knows, in this order
EDITOR = "# yaml-language-server: $schema="
HINT = "# For help in an editor: mpm schema > schema.json, and the line  # yaml-language-server: $schema=schema.json  in place of this one.\n"


@dataclass(frozen=True)
class Scene:
    """A shipped config: its file, title and the comments that it opens with."""

    file: Path
    title: str
    purpose: str
    trust: str  # what is fitted and what is predicted
    cost: str
    source: str

    @property
    def name(self) -> str:
        """The name of its file, without the suffix."""
        return self.file.stem


def read(file: Path) -> Scene:
    """A config's title and opening comments."""
    text = file.read_text(encoding="utf-8")
    title = re.search(r'^title: "?(.*?)"?$', text, re.MULTILINE)
    said = [re.search(rf"^# {word} +(.*(?:\n#   .*)*)", text, re.MULTILINE) for word in ("Purpose", "Trust", "Cost", "Source")]
    whole = [" ".join(part.strip("# ") for part in found[1].split("\n")) if found else "" for found in said]
    return Scene(file, title[1] if title else file.stem, *whole)


def scenes(room: str = "scenes") -> dict[str, Scene]:
    """The scenes of a room (`scenes` or `verification`) by name."""
    return {file.stem: read(file) for file in sorted((folder("configs") / room).glob("*.yaml"))}


def find(name: str) -> Scene | None:
    """A scene by its name, or None."""
    return next((found[name] for room in ROOMS if name in (found := scenes(room))), None)


def names() -> list[str]:
    """Every name that `find` knows."""
    return [name for room in ROOMS for name in scenes(room)]


def copy(scene: Scene) -> dict[str, str]:
    """The scene and all files that it reads (base configs, measured curves) as texts by name, with paths that hold where they lie in one folder."""
    texts: dict[str, str] = {}
    gather(scene.file, texts)
    return texts


def gather(file: Path, texts: dict[str, str]) -> None:
    """A file and what it names, below `texts`."""
    if file.name in texts:
        return
    text = file.read_text(encoding="utf-8")
    texts[file.name] = text
    if file.suffix != ".yaml":
        return
    for base in re.findall(r"^extends: (\S+)$", text, re.MULTILINE):
        gather((file.parent / base).resolve(), texts)
    for curve in re.findall(r"\bfile: ([^\s,}]+)", text):
        gather((file.parent / curve).resolve(), texts)
        text = text.replace(curve, Path(curve).name)
    text = re.sub(r"configs/(?:data|scenes|verification)/(?=[\w.-]+\.(?:csv|yaml))", "", text)
    text = re.sub(r"^(extends: ).*/", r"\1", text, flags=re.MULTILINE)
    texts[file.name] = re.sub(rf"^{re.escape(EDITOR)}.*\n", HINT, text)


def command(text: str) -> str:
    """The command that a config is made for."""
    for section, name in (("fit", "fit"), ("chart", "chart"), ("stability", "stability"), ("sweep", "sweep")):
        if re.search(rf"^{section}:(?! null)", text, re.MULTILINE):
            return name
    return "run"
