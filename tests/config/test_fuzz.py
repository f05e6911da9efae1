"""Whatever stands in a config, load and plan end in an experiment or in a ConfigError with places; never in a traceback, never in a hang."""

import json
import random
import re
import time

import pytest

from mpm.config import ConfigError, load
from mpm.sweep.cases import plan

JUNK = [
    "null",
    "[]",
    "{}",
    "-1",
    "1e308",
    ".inf",
    "true",
    "'x'",
    "[1, 2, 3]",
    "{a: 1}",
    "1 m",
    "5 degC",
    "auto",
    "apic",
    "{apic: {}}",
    "'",
    "\n",
    "- ",
    "&a ",
    "*a",
    "!t ",
    "\t",
    "κ",
    "\x00",
    "|",
    "? ",
    ": ",
    "{",
    "}",
    "[",
    "]",
    "0x10",
    "1e400",
    "99999999999999999999999",
    "__class__",
    "9**9**9 m",
    "\u2028",
    "[[[[",
    "{linear: [0, 1, 3]}",
    "{constant: 3}",
    "{bump: }",
    "kappa",
    "0",
]
TOKEN = re.compile(r"[\w.\-]+|\[[^\[\]\n]*\]|\{[^{}\n]*\}")
SWEEP = {
    "axes": {"kappa": [0.2, 0.3], "beta": {"log": [1, 10, 3]}},
    "zip": [{"density": [300, 310], "outside": [400, 410]}],
    "points": [{"cell": "1 mm"}, {"cell": "2 mm"}],
    "where": "kappa > 0.1",
}


def mutated(text: str, chance: random.Random) -> str:
    for _ in range(chance.randint(1, 4)):
        places = list(TOKEN.finditer(text))
        if chance.random() < 0.4 or not places:
            at = chance.randrange(len(text))
            text = text[:at] + chance.choice(JUNK) + text[at + chance.randint(0, 3) :]
        else:
            place = chance.choice(places)
            text = text[: place.start()] + chance.choice(JUNK) + text[place.end() :]
    return text


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.wide) for seed in range(1, 5))])
def test_mutated_configs(seed, tmp_path, loaf, block):
    chance = random.Random(seed)
    texts = [
        json.dumps({**scene, "sweep": SWEEP, "smoke": {"kappa": 0.1, "time.end": 1}}, indent=1) for scene in (loaf, {**block, "surfaces": loaf["surfaces"]})
    ]
    file = tmp_path / "config.yaml"
    for _ in range(60):
        file.write_text(mutated(chance.choice(texts), chance), encoding="utf-8")
        start = time.process_time()
        try:
            plan(load(file, {"kappa": "0.3"} if chance.random() < 0.3 else None))
        except ConfigError as error:
            assert error.problems
            for one in error.problems:
                assert (one.line > 0 and one.column > 0) or one.file.startswith("--set"), one
        assert time.process_time() - start < 3


@pytest.mark.parametrize("seed", range(3))
def test_mutated_dicts(seed, loaf):
    chance = random.Random(seed)
    values = [
        None,
        [],
        {},
        -1,
        0,
        "",
        "x",
        True,
        [1],
        {"a": 1},
        float("nan"),
        float("inf"),
        10**400,
        "1 m",
        object(),
        {1: 2},
        [[]],
        "auto",
        ("apic",),
        {"bump": None},
    ]

    def change(data):
        if isinstance(data, dict) and data and chance.random() < 0.85:
            key = chance.choice(list(data))
            return {**data, key: change(data[key])}
        if isinstance(data, list) and data and chance.random() < 0.85:
            return [change(data[0]), *data[1:]]
        return chance.choice(values)

    for _ in range(100):
        try:
            section = chance.choice([*loaf, "sweep"])
            plan(load({**loaf, "sweep": SWEEP, section: change({**loaf, "sweep": SWEEP}[section])}))
        except ConfigError as error:
            assert error.problems and str(error)
