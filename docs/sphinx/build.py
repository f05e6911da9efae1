"""Build the docs as HTML: python docs/sphinx/build.py [OUT]   (default: build/docs).

Pages are gathered in a temporary folder: docs/*.md as they are, README as the front page, CONTRIBUTING and CHANGELOG, and the pages that mpm.reference makes.
Warnings are errors, among them pages that no contents name and links that lead nowhere. Nothing is read from the network.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from mpm_cli.listing import commands

from mpm.reference.pages import pages
from mpm.starting.scenes import command, scenes

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
CONTENTS = {
    "Begin": ["tutorial", "cookbook", "choosing", "trouble", "glossary"],
    "Scenes": ["gallery"],
    "Use": ["config", "fitting", "showing", "python", "cluster"],
    "Reference": ["reference_config", "reference_dataset", "reference_commands", "reference_python"],
    "Trust": ["physics", "frames", "accuracy", "stability", "guards", "reliability", "speed"],
    "Carry on": ["contributing", "changelog"],
}


def outward(text: str, folder: str) -> str:
    """Links to files of the repository that are no pages become plain paths; links to docs/*.md are to pages beside."""
    text = re.sub(r"(!?\[[^\]]*\])\((?:\.\./)?docs/([\w./-]+(?:#[\w-]+)?)\)", r"\1(\2)", text)
    text = re.sub(r"\[([^\]]*)\]\((?:\.\./)?(CONTRIBUTING|CHANGELOG)(?:\.md)?(#[\w-]+)?\)", lambda m: f"[{m[1]}]({m[2].lower()}.md{m[3] or ''})", text)
    return re.sub(
        r"(?<!!)\[([^\]]*)\]\(((?:\.\./)?(?!https?://)[\w./-]+)\)", lambda m: m[0] if stays(m[2], folder) else f"{m[1]} (`{m[2].removeprefix('../')}`)", text
    )


def stays(target: str, folder: str) -> bool:
    """Whether a link is to a page or picture that is gathered."""
    return target.endswith((".md", ".png", ".gif")) and not target.startswith("../") and "/" not in target.removeprefix("gallery/")


def gallery(text: str) -> str:
    """The page of pictures, with a row for every scene that it does not name yet."""
    missing = [one for name, one in scenes().items() if f"`{name}`" not in text]
    rows = [f"| `{one.name}`: {one.title} | `mpm {command(one.file.read_text(encoding='utf-8'))} {one.name}.yaml` | |\n" for one in missing]
    return text.replace("\n## Kinds of figures", "".join(rows) + "\n## Kinds of figures")


def gather(into: Path) -> None:
    """All pages as Sphinx reads them."""
    made = {path.stem: path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")} | pages(commands())
    made |= {name.lower(): (ROOT / f"{name}.md").read_text(encoding="utf-8") for name in ("CONTRIBUTING", "CHANGELOG")}
    made["gallery"] = gallery(made["gallery"])
    for name, text in made.items():
        (into / f"{name}.md").write_text(outward(text, "docs"), encoding="utf-8")
    for path in [*DOCS.glob("*.png"), *DOCS.glob("gallery/*")]:
        target = into / path.relative_to(DOCS)
        target.parent.mkdir(exist_ok=True)
        shutil.copyfile(path, target)
    named = {name for names in CONTENTS.values() for name in names}
    more = {
        "Scenes": sorted(name for name in made if name.startswith("scene_")),
        "Carry on": sorted(name for name in made if name not in named and not name.startswith("scene_")),
    }
    trees = [
        f"```{{toctree}}\n:caption: {title}\n:maxdepth: 1\n:hidden:\n\n" + "\n".join([*names, *more.get(title, ())]) + "\n```\n"
        for title, names in CONTENTS.items()
    ]
    readme = outward((ROOT / "README.md").read_text(encoding="utf-8"), "")
    (into / "index").with_suffix(".md").write_text(readme + "\n" + "\n".join(trees), encoding="utf-8")


def build(out: Path) -> int:
    """The exit code of Sphinx."""
    with tempfile.TemporaryDirectory() as place:
        gather(Path(place))
        return subprocess.run([sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-c", DOCS / "sphinx", place, out], check=False).returncode


if __name__ == "__main__":
    sys.exit(build(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "docs")))
