"""Configs made by libFuzzer (atheris), which keeps what reaches new code: python tests/faults/fuzz.py FOLDER RUNS. Prints what came of it as JSON.

It starts from the shipped configs, with the words of the schema as its dictionary. Any exception but a ConfigError with places ends it with a trace.
"""

import json
import os
import sys
import time
from pathlib import Path

import atheris

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1]))
with atheris.instrument_imports(include=["mpm", "ruamel.yaml"]):
    from mpm.config import ConfigError, load
    from mpm.sweep.cases import plan

CONFIGS = HERE.parents[1] / "configs"
MOST = 6000  # bytes of a config


def words(tree):
    """Every key, and every word that a schema allows."""
    found = set()
    if isinstance(tree, dict):
        for key, value in tree.items():
            found |= {key} | words(value)
    elif isinstance(tree, list):
        for value in tree:
            found |= {value} if isinstance(value, str) else words(value)
    return found


def resident(name):
    """A row of /proc/self/status in bytes."""
    return next(int(row.split()[1]) * 1024 for row in Path("/proc/self/status").read_text().splitlines() if row.startswith(name))


def main(folder, runs):
    corpus = folder / "corpus"
    corpus.mkdir(parents=True)
    for path in CONFIGS.rglob("*.yaml"):
        (corpus / path.stem).write_bytes(path.read_bytes()[:MOST])
    known = sorted(word for word in words(json.loads((CONFIGS / "schema.json").read_text())) if word.isascii() and word.isprintable() and 1 < len(word) < 30)
    escaped = [word.replace("\\", "\\\\").replace('"', '\\"') for word in known]
    (folder / "words").write_text("".join(f'"{word}"\n' for word in escaped))
    file = folder / "config.yaml"
    file.write_bytes((CONFIGS / "smoke.yaml").read_bytes())
    plan(load(file))  # what is imported on demand counts once
    before, was, seen = {*os.listdir(folder)}, resident("VmRSS"), {"configs": 0, "taken": 0, "slowest": 0.0}

    def one(data):
        file.write_bytes(data)
        began = time.process_time()
        try:
            plan(load(file))
            seen["taken"] += 1
        except ConfigError as error:
            assert error.problems and all(found.line > 0 for found in error.problems)
        seen["slowest"] = max(seen["slowest"], time.process_time() - began)
        seen["configs"] += 1
        if seen["configs"] >= runs:  # libFuzzer ends the process without asking
            print(json.dumps(seen | {"grown": resident("VmHWM") - was, "written": sorted({*os.listdir(folder)} - before)}), flush=True)
            os._exit(0)

    atheris.Setup([sys.argv[0], f"-max_len={MOST}", f"-dict={folder / 'words'}", "-rss_limit_mb=0", f"-artifact_prefix={folder}/", "-seed=3", str(corpus)], one)
    atheris.Fuzz()


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    main(Path(sys.argv[1]), int(sys.argv[2]))
