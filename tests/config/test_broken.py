"""Every broken config gives exactly the problems that its last lines expect: file, line, column, path, message, what is allowed, suggestion.

# expect [file:]line:column path | message | allowed (a beginning, if it ends in ...) | suggestion
"""

import re
from pathlib import Path

import pytest

from mpm.config import ConfigError, load
from mpm.sweep.cases import plan

ROOT = Path(__file__).parent.parent / "configs_broken"
FILES = sorted(ROOT.glob("*.yaml"))
EXPECT = re.compile(
    r"# expect (?:(?P<file>[\w/]+\.yaml):)?(?P<line>\d+):(?P<column>\d+) (?P<path>.*?) \| (?P<message>.*?) \|(?P<allowed>.*?)\|(?P<suggestion>.*)"
)


def expected(file: Path) -> list[tuple]:
    found = [EXPECT.fullmatch(line) for line in file.read_text(encoding="utf-8").splitlines() if line.startswith("# expect")]
    assert found and all(found), f"{file.name} does not say what it expects"
    names = ("path", "message", "allowed", "suggestion")
    return [(str(ROOT / (one["file"] or file.name)), int(one["line"]), int(one["column"]), *(one[name].strip() for name in names)) for one in found]


def test_there_are_many():
    assert len(FILES) >= 25


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_problems(file):
    with pytest.raises(ConfigError) as caught:
        plan(load(file))
    wanted, problems = expected(file), caught.value.problems
    assert [(str(Path(one.file)), one.line, one.column, one.path, one.message, one.suggestion) for one in problems] == [(*item[:5], item[6]) for item in wanted]
    for one, item in zip(problems, wanted, strict=True):
        begin = item[5].removesuffix("...")
        assert one.allowed == item[5] or (begin != item[5] and one.allowed.startswith(begin))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_caret_points_at_the_column(file):
    with pytest.raises(ConfigError) as caught:
        plan(load(file))
    for one in caught.value.problems:
        head, shown, caret = str(one).split("\n")
        assert head.startswith(f"{one.file}:{one.line}:{one.column}: ")
        text = Path(one.file).read_text(encoding="utf-8").splitlines()[one.line - 1]
        assert shown.strip() == text.strip() or text.startswith(shown.strip()[:40], 0) or shown.strip() in text
        assert caret.endswith("^") and len(caret) - 5 == min(one.column - 1, 89)


@pytest.mark.parametrize("file", sorted((ROOT / "base").glob("[bs]*.yaml")), ids=lambda file: file.stem)
def test_bases_are_right(file):
    assert load(file).grid.cell > 0


def test_file_problems(tmp_path):
    large = tmp_path / "large.yaml"
    large.write_text("# " + "x" * (1 << 20))
    latin = tmp_path / "latin.yaml"
    latin.write_bytes(b"title: Br\xf6tchen\n")
    (tmp_path / "slab.yaml").write_text("title: x")
    for source, message in ((large, "larger than 1 MiB"), (latin, "not UTF-8"), (tmp_path / "slap.yaml", "No such file"), (tmp_path, "Is a directory")):
        with pytest.raises(ConfigError, match=message) as caught:
            load(source)
        assert len(caught.value.problems) == 1
    with pytest.raises(ConfigError, match=r"did you mean 'slab.yaml'\?"):
        load(tmp_path / "slap.yaml")
    with pytest.raises(ConfigError, match=r"latin.yaml:1:10: this is not UTF-8 text \(given byte 0xf6\)"):
        load(latin)
