"""What docstrings, configs and documents cite is in this repository: files, sections of documents by number or title, and equations of docs/physics.md."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROOMS = ("mpm", "cli", "tests", "configs", "docs")
KINDS = (".py", ".yaml", ".md", ".toml", ".cff")
FILES = sorted(path for path in [*ROOT.glob("*"), *(path for room in ROOMS for path in (ROOT / room).rglob("*"))] if path.suffix in KINDS)
FILES = [path for path in FILES if path not in (Path(__file__), ROOT / "tests/docs/test_build.py")]  # their examples dangle on purpose
WRITERS = {f"mpm/benchmarks/{name}.py": "configs/verification" for name in ("single", "surfaces", "verification")}  # their text goes into that folder
WRITERS["mpm/reference/pages.py"] = "docs"
WRITERS["tests/docs/test_gallery.py"] = "docs"

DOCUMENT = re.compile(r"(?<![\w/.-])((?:\.\./)*(?:[\w-]+/)*[\w-]+\.md)\b")
NUMBERS = re.compile(r"\d+(?:\.\d+)*(?:(?:, | and |; )\d+(?:\.\d+)*)*(?![\w-]|\.\d)")
PLACE = re.compile(rf"(?<![\w/.-])((?:{'|'.join(ROOMS)})/[\w/.-]+\.(?:py|yaml|csv|png|json))\b")
ANY = re.compile(r"[A-Z]{3,}")  # NAME.yaml stands for any
GONE = re.compile(r"\.\./shared|(?<![\w-])failure-modes \d+")  # notes that never were in the repository


def sections(path):
    """(numbers, titles) of a document's headings."""
    headings = re.findall(r"^#+ +(?:(\d+(?:\.\d+)*)\.? +)?(.+?)\s*$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {number for number, _ in headings}, {title for _, title in headings}


def dangling(text, folder):
    """What of the text's references is not there; documents are looked for beside it (`folder`) and from the root."""
    for found in GONE.finditer(text):
        yield found.group()
    for found in PLACE.finditer(text):
        if not ANY.search(found.group(1)) and not (ROOT / found.group(1)).is_file():
            yield found.group(1)
    for found in DOCUMENT.finditer(text):
        named, rest = found.group(1), text[found.end() :]
        target = next((place / named for place in (folder, ROOT) if (place / named).is_file()), None)
        if target is None:
            yield named
            continue
        numbers, titles = sections(target)
        if cited := NUMBERS.match(rest.removeprefix(" ")) if rest.startswith(" ") else None:
            yield from (f"{named} {number}" for number in re.findall(r"\d+(?:\.\d+)*", cited.group()) if number not in numbers)
        elif (cited := re.match(r', "([^"\\\n]+)"', rest)) and cited.group(1) not in titles:
            yield f"{named}{cited.group()}"


def test_what_is_cited_is_here():
    found = {}
    for path in FILES:
        home = WRITERS.get(path.relative_to(ROOT).as_posix())
        found[path.relative_to(ROOT)] = list(dangling(path.read_text(encoding="utf-8"), ROOT / home if home else path.parent))
    assert {path: gone for path, gone in found.items() if gone} == {}


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        ("physics.md 4", ["physics.md"]),  # only from docs/ is it called so
        ("docs/physics.md 5.1; 7, problem 7", []),
        ("docs/physics.md 10, 0-D", []),
        ("docs/physics.md 3, 10 and 99.", ["docs/physics.md 99"]),
        ("docs/physics.md 5.9)", ["docs/physics.md 5.9"]),
        ("docs/physics.md 11 has 4.1e-3", []),
        ("see interface.md section 3", ["interface.md"]),
        ('README.md, "From the shell"', []),
        ('README.md, "No such heading"', ['README.md, "No such heading"']),
        ("../shared/notes", ["../shared"]),
        ("failure-modes 11", ["failure-modes 11"]),
        ("mpm/guards.py and mpm/gone.py, configs/studies/stability/NAME.yaml", ["mpm/gone.py"]),
    ],
)
def test_what_is_not_here_is_found(text, missing):
    assert list(dangling(text, ROOT / "mpm")) == missing


def test_equations_have_numbers_of_their_section():
    """Every equation of docs/physics.md has a number of its own, and every number cited there an equation."""
    text = (ROOT / "docs" / "physics.md").read_text(encoding="utf-8")
    tags = []
    for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        own = re.findall(r"\\tag\{([\d.]+)\}", part)
        assert own == [f"{part.split('.')[0]}.{n + 1}" for n in range(len(own))]
        tags += own
    assert len(tags) > 30
    assert set(re.findall(r"\((\d+\.\d+)\)", text)) <= set(tags)
