"""Hostile text through every sink: refused with words that can be shown, or kept as it was written, and shown without a control character."""

import io
import json
import random
import sys
import unicodedata
import xml.dom.minidom

import numpy as np
import pytest

from mpm.config import ConfigError, load
from mpm.records.netcdf import Array, Group, seal, to_bytes, unseal
from mpm.sweep.api import execute, tree_of
from mpm.sweep.engine import Options
from mpm.sweep.manifest import read_manifest
from mpm.text import joined, storable, visible

REFUSED = ["\x00", "a\x00b", "\ud83c", "\udf5e\ud83c"]
KEPT = ["", "a\nb", "\x1b[31mred\x1b[0m", "\x9b2J", "\ud83c\udf5e", "👩\u200d🍳", "\u202egnp.exe", "\ufffe", "$\\frac$", "[red]x[/red]", "x" * 100_000]
NASTY = [*REFUSED, *KEPT, " ", "a\r\nb", "\x1b]0;title\x07", "🍞", "\u2028", "\ufeff", "\U0010ffff", "$", "$x^2$", "</text><script>", "-->", "&amp;<",
         "%s {0} {title}", ":bread:", "\\", "\\x1b", '"', "'; rm -rf /", "../../x", "=1+1", "null", "é" * 70_000, "\t", "\x85", "\x7f", "日本語"]  # fmt: skip
DRAWN = ["a\nb", "\x1b[31mred", "🍞", "\ufffe", "$\\frac$", "</text><script>", "--> &", "é" * 70_000, "日本語\u202e"]
SLAB = {
    "grid": {"dimension": 1, "size": [0.1], "cell": 1e-3},
    "bodies": {"slab": {"shape": {"box": {"lower": [0], "upper": [0.05]}}, "material": "m", "temperature": 300}},
    "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
    "time": {"end": 10},
    "output": {"every": 1, "probes": {"centre": [0.01]}},
    "sweep": {"axes": {"kappa": [1.0, 2.0]}},
}


def texts(count=150):
    """The list above, and as many strings of its letters and of any others."""
    chance = random.Random(2026)
    letters = sorted({letter for text in NASTY for letter in text}) + [chr(code) for code in range(160)]

    def letter():
        return chance.choice(letters) if chance.random() < 0.7 else chr(chance.randrange(0x110000))

    drawn = ("".join(letter() for _ in range(chance.randint(1, 12))) for _ in range(count))
    return [*NASTY, *drawn]


def whole(text):
    """The text with the letters that pairs of surrogates stand for, as any reader of JSON gives it."""
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")


def harmless(text, keep="\n\t"):
    """Whether no letter of it does anything to a terminal."""
    return all(letter in keep or unicodedata.category(letter) not in ("Cc", "Cs", "Zl", "Zp", "Cn") for letter in text)


def loaded(text):
    """An experiment of this title; None where it is refused, in words that can be shown."""
    try:
        return load({**SLAB, "title": text})
    except ConfigError as error:
        assert harmless(str(error)) and "which no file can hold" in str(error), ascii(text)
        with pytest.raises(ValueError, match=r"NUL|surrogate"):
            joined(text)
        return None


@pytest.fixture
def streams(monkeypatch):
    """stdout and stderr of bytes in an encoding, as a command has them; what was written."""
    from mpm_cli.streams import Stream

    def set_up(encoding):
        raw = io.BytesIO()
        for name in ("stdout", "stderr"):
            monkeypatch.setattr(sys, name, Stream(io.TextIOWrapper(raw, encoding=encoding, write_through=True), name))
        return lambda: raw.getvalue().decode(encoding)

    return set_up


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "ascii"])
def test_terminals_pipes_and_json(streams, encoding):
    from mpm_cli.progress import Bar, Plain
    from mpm_cli.talk import document, say, warn

    for text in texts():
        written = streams(encoding)
        say(text)
        warn(text)
        Plain(sys.stdout).note(text)
        bar = Bar(sys.stdout)
        bar.say(text)
        assert harmless(written()), ascii(text)
        written = streams(encoding)
        document({"title": text})
        assert json.loads(written()) == {"title": whole(text)}


def test_configs_datasets_and_their_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert all(loaded(text) is None for text in REFUSED) and sum(loaded(text) is None for text in texts()) < 60
    for place, text in enumerate(KEPT):
        experiment = loaded(text)
        result = execute(experiment, tmp_path / f"{place}", Options(jobs=0, runner="fake_runner"))
        assert result.exit_code == 0 and read_manifest(tmp_path / f"{place}" / "experiment.json")["title"] == experiment.title == joined(text)
        root = tree_of(tmp_path / f"{place}" / "sweep.nc")
        assert root.attrs["title"] == (experiment.title or "experiment") and json.loads(root.attrs["config_resolved"])["title"] == experiment.title


def test_what_programs_say_is_kept_whatever_it_is():
    """Errors quote files and values: where a dataset cannot hold a letter, its escape stands there."""
    words = texts()
    data = to_bytes({"/": Group({"error": Array(("point",), np.array(words, dtype=object), {"long_name": words[6]})})}, {"text": words[1], "many": words})
    root = tree_of(data)
    assert root["error"].values.tolist() == [storable(text) for text in words]
    for text in words:
        body, line = unseal(seal(b"body", {"error": whole(text)}))
        assert (body, line) == (b"body", {"error": whole(text)})


def test_figures(tmp_path):
    import warnings

    from mpm.plots import overview
    from mpm.plots.style import figure, save, styled

    for place, text in enumerate(DRAWN):
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a letter that the font lacks is a box, without a word of Python's
            with styled():
                fig = figure(text, 2.0)
                ax = fig.subplots()
                ax.plot([1, 2], [1, 2], label=text[:40])
                ax.set_xticks([1, 2], [visible(text[:10]), "2"])
                ax.legend()
            save(fig, tmp_path / f"{place}.svg")
            save(fig, tmp_path / f"{place}.png")
        assert xml.dom.minidom.parse(str(tmp_path / f"{place}.svg")).documentElement.tagName == "svg"
        assert (tmp_path / f"{place}.png").read_bytes()[:4] == b"\x89PNG"
    experiment = loaded("$\\frac$ \x1b 🍞")
    execute(experiment, tmp_path / "out", Options(jobs=0, runner="fake_runner"))
    overview(tree_of(tmp_path / "out" / "sweep.nc"), tmp_path / "overview.svg")
    assert "script" not in xml.dom.minidom.parse(str(tmp_path / "overview.svg")).toxml()


@pytest.fixture(autouse=True)
def fakes(monkeypatch):
    """The runner that computes nothing."""
    from pathlib import Path

    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "fakes"))
