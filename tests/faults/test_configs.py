"""R10: whatever stands in a config ends in an experiment or in errors with places: no traceback, under a second and 300 MB, nothing written."""

import json
import os
import re
import resource
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from mpm.config import ConfigError, load
from mpm.sweep.cases import plan

CONFIGS = Path(__file__).parents[2] / "configs"
TEXTS = [path.read_text(encoding="utf-8") for path in sorted(CONFIGS.rglob("*.yaml"))]
JUNK = ["null", "[]", "{}", "-1", "1e308", ".inf", ".nan", "true", "&a ", "*a", "!!python/object:os.system ", "\t", "\x00", "κ", "../../x", "/etc/passwd",
        "[[[[", "? ", ": ", "\u2028", "\ud7ff", "---", "%YAML 9.9", "0x10", "9**9**9 m", "1e400", "9" * 5000,
        "__class__", "{linear: [0, 1, 100000000]}", "extends: ../x"]  # fmt: skip
SECONDS, BYTES = 1.0, 300e6


@st.composite
def texts(draw):
    """A real config, with up to five pieces cut out, doubled, or replaced by junk; or no config at all."""
    if draw(st.integers(0, 9)) == 0:
        return draw(st.text(max_size=300))
    text = draw(st.sampled_from(TEXTS))
    for _ in range(draw(st.integers(1, 5))):
        at = draw(st.integers(0, max(0, len(text) - 1)))
        end = min(len(text), at + draw(st.integers(0, 30)))
        text = text[:at] + draw(st.one_of(st.sampled_from(JUNK), st.just(text[at:end] * 2), st.text(max_size=8))) + text[end:]
    return text


def attempt(file, text):
    """Load and plan; processor seconds."""
    file.write_bytes(text.encode("utf-8", "replace"))
    began = time.process_time()
    try:
        plan(load(file))
    except ConfigError as error:
        assert error.problems and all(one.line > 0 or one.file.startswith("--set") for one in error.problems), text
    return time.process_time() - began


def fuzz(folder, examples):
    """(configs tried, slowest [s], growth of memory [bytes], files written)."""
    file, seen = folder / "config.yaml", [0, 0.0]
    for text in TEXTS:
        attempt(file, text)  # what is imported on demand counts once
    before, was = {*os.listdir(folder)}, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    @settings(max_examples=examples, deadline=None, database=None, derandomize=examples < 1000, suppress_health_check=list(HealthCheck))
    @given(texts())
    def one(text):
        spent = attempt(file, text)
        assert spent < SECONDS, text
        seen[0], seen[1] = seen[0] + 1, max(seen[1], spent)

    one()
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - was) * 1024
    return seen[0], seen[1], grown, {*os.listdir(folder)} - before


def test_configs_at_random(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, _, grown, written = fuzz(tmp_path, 60)
    assert grown < BYTES and not written


@pytest.mark.slow
def test_configs_at_random_at_length(tmp_path, monkeypatch, table):
    monkeypatch.chdir(tmp_path)
    count, slowest, grown, written = fuzz(tmp_path, int(os.environ.get("MPM_FUZZ", "100000")))
    table(f"{count} fuzzed configs (hypothesis)", f"0 tracebacks, slowest {slowest:.2f} s, memory grew by {grown / 1e6:.0f} MB, {len(written)} files written")
    assert grown < BYTES and not written


@pytest.mark.slow
def test_configs_by_coverage_at_length(tmp_path, table):
    """libFuzzer keeps what reaches new code (fuzz.py): pip install 'mpm[fuzz]'."""
    pytest.importorskip("atheris")
    runs = os.environ.get("MPM_FUZZ", "100000")
    command = [sys.executable, str(Path(__file__).parent / "fuzz.py"), str(tmp_path), runs]
    done = subprocess.run(command, capture_output=True, text=True, timeout=6 * 3600, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    found = json.loads(done.stdout.splitlines()[-1])
    said = f"0 tracebacks, slowest {found['slowest']:.2f} s, memory grew by {found['grown'] / 1e6:.0f} MB, {len(found['written'])} files written"
    table(f"{found['configs']} fuzzed configs (atheris, by coverage)", said)
    assert found["slowest"] < SECONDS and found["grown"] < BYTES and not found["written"]


def base(**more):
    text = "grid: {dimension: 1, size: [0.1], cell: 1e-3}\nmaterials: {m: {density: 1000, heat: {fourier: {kappa: 1, alpha: 1000}}}}\ntime: {end: 10}\n"
    text += "bodies: {slab: {shape: {box: {lower: [0], upper: [0.05]}}, material: m, temperature: 300}}\n"
    return text + "".join(f"{name}: {value}\n" for name, value in more.items())


ALIASES = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 12))
HOSTILE = {
    "aliases": ALIASES + base(),
    "depth": base(title="[" * 3000),
    "long number": base(title="9" * 200_000),
    "2 MB": base(title="x" * 2_000_000),
    "product": base(sweep="{axes: {kappa: {linear: [1, 2, 1000000]}, alpha: {linear: [1, 2, 1000000]}, density: {linear: [1, 2, 1000000]}}}"),
    "axis": base(sweep="{axes: {kappa: {linear: [1, 2, 1000000000000]}}}"),
    "sample": base(sweep="{sample: {sobol: {kappa: [1, 2]}, count: 1000000000000}}"),
    "cells": base().replace("1e-3", "1e-18"),
    "outputs": base(output="{every: 1e-12}"),
    "name up": base().replace("slab", "../../up"),
    "name root": base().replace("slab", "/elsewhere"),
    "name nul": base().replace("slab", '"a\\0b"'),
    "extends up": "extends: ../../../../etc/passwd\n" + base(),
    "extends device": "extends: /dev/zero\n" + base(),
    "condition": base(sweep="{axes: {kappa: [1, 2]}, where: \"__import__('os').system('touch owned')\"}"),
    "power": base(sweep="{axes: {kappa: [1, 2]}, where: 'kappa < 9**9**9**9'}"),
    "tag": base(title="!!python/object/apply:os.system ['touch owned']"),
}
STABLE = (
    base(surfaces="[{of: slab, convection: {beta: 1, outside: 300}}]")
    + """
stability:
  across: {beta: {log: [0.01, 100, 9]}}
  along: {method.heat_step: {log: [0.001, 10, 9]}}
"""
)
POINT = """
grid: {dimension: 0}
bodies: {b: {shape: {point: {strain: {xx: 0.1}}}, material: m}}
materials: {m: {density: 1, elastic: {hencky: {E: 1, nu: 0}}}}
loading: [{stress: {xx: 0, yy: 0, zz: 0}}]
time: {end: 1}
"""
CODE = """
import sys, time
from pathlib import Path
from mpm.config import ConfigError, load
from mpm.sweep.cases import plan
for name in ('plain', *sys.argv[1:]):  # the first, for what is imported on demand
    began = time.process_time()
    try:
        plan(load(Path(f'{name}.yaml')))
        said = 'taken'
    except ConfigError as error:
        said = 'refused'
    print(name, said, time.process_time() - began, sep=';')
print(next(line for line in Path('/proc/self/status').read_text().splitlines() if line.startswith('VmHWM')).split()[1])  # ru_maxrss counts the parent's too
"""


def test_hostile_configs(tmp_path, table):
    """Bombs, names that lead out of the folder, code: refused with a reason, all in one process, so that memory is that of the worst."""
    folder = tmp_path / "in"
    folder.mkdir()
    for name, text in {"plain": base(), **HOSTILE}.items():
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    before = sorted(tmp_path.rglob("*"))
    env = {**os.environ, "PYTHONPATH": str(CONFIGS.parent)}
    done = subprocess.run([sys.executable, "-B", "-c", CODE, *HOSTILE], cwd=folder, env=env, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr[-1500:]
    (_, *rows), most = [line.split(";") for line in done.stdout.splitlines()[:-1]], int(done.stdout.splitlines()[-1]) * 1024
    assert [name for name, said, _ in rows if said != "refused"] == []
    slowest = max(float(seconds) for _, _, seconds in rows)
    table(f"{len(rows)} YAML bombs, product bombs, hostile names and code", f"all refused, slowest {slowest:.2f} s, {most / 1e6:.0f} MB in all")
    assert slowest < SECONDS and most < BYTES and sorted(tmp_path.rglob("*")) == before


WRONG = {
    "axis of a map": (STABLE, "{log: [0.001, 10, 9]}", "{log: [0.001, 10]}", "stability.along.method.heat_step.log: expected 3 entries"),
    "name of an axis of a map": (STABLE + "  steps: 100\n", "method.heat_step", "method.heat_stop", "nothing in this file is called 'method.heat_stop'"),
    "material of a point": (POINT, "material: m}", "material: n}", "bodies.b.material: there is no such material (given 'n')"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_the_fuzzer_found(name):
    text, good, bad, said = WRONG[name]
    assert good in text
    with pytest.raises(ConfigError, match=re.escape(said)):
        load(YAML(typ="safe", pure=True).load(text.replace(good, bad)))


def test_out_through_a_link_stays_in_its_folder(tmp_path, marks):
    """A link in the place of a result is replaced, never written through."""
    from scenes import config, go

    target = tmp_path / "target"
    target.write_text("mine")
    out = tmp_path / "out"
    out.mkdir()
    (out / "sweep.nc").symlink_to(target)
    (out / "experiment.json").symlink_to(tmp_path / "nowhere")
    go(config([0.5, 1.0]), out)
    assert target.read_text() == "mine" and not (tmp_path / "nowhere").exists() and not (out / "sweep.nc").is_symlink()
