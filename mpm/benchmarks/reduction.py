"""No more model than a scene needs, measured: `python -m mpm.benchmarks.reduction` writes configs/studies/reduction/README.md.

Every config there says `model: auto`. It is run so and as the full model, in turn; the true error is the largest difference between the two in anything
that the config asks for (mpm.reduce.difference), beside the error that was predicted without running the full model. Time counts the whole of `model: auto`:
choosing, pilots, the run. Names of configs after the command measure those alone and print their lines. What is measured is kept in
results/reduction.json until the config or the source changes, so an interrupted study goes on where it stopped.
"""

import json
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from mpm.benchmarks import CONFIGS

FOLDER = CONFIGS / "studies" / "reduction"
STORE = Path("results") / "reduction.json"
REPEATS, ENOUGH = 3, 5.0  # runs of each, unless one takes so many seconds
HEAD = """# No more model than a scene needs

Made by `python -m mpm.benchmarks.reduction` in {seconds:.0f} s of processor, compiling included. Each line is a config of this folder with `model: auto` at
1 %: what was dropped, the error predicted for that before the full model was ever run, the true error against the full model (the largest over everything
that the config asks for: of temperatures as a share of the driving difference, of times relative, of motion relative to how much it changes), and
wall times on one core of a shared machine, least of {repeats} runs in turn ({enough:g} s or longer: of one), compiled before. The time of `model: auto` is all
of it, choosing included.
{summary}

| scene | asked for | model | dropped | predicted | by | true error | full, s | auto, s | times as fast |
|---|---|---|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class ReductionRow:
    """One row of the table."""

    name: str
    asked: tuple[str, ...]
    model: str
    dropped: tuple[str, ...]
    predicted: float
    by: tuple[str, ...]
    error: float
    full: float
    auto: float
    tolerance: float

    @property
    def saving(self) -> float:
        """Time of the full model over that of the smaller one."""
        return self.full / self.auto

    @property
    def held(self) -> bool:
        """Whether the error stays within the tolerance."""
        return self.error <= self.tolerance

    def text(self) -> str:
        """As a row of Markdown."""
        dropped = "; ".join(self.dropped) or "nothing"
        numbers = (f"{self.predicted:.2g}", ", ".join(dict.fromkeys(self.by)) or "-", f"{self.error:.2g}", f"{self.full:.2g}", f"{self.auto:.2g}")
        return f"| {self.name} | {', '.join(self.asked)} | {self.model} | {dropped} | {' | '.join(numbers)} | {self.saving:.3g} |"


def measure(path: Path) -> ReductionRow:
    """Run one config both ways. A full model that does not complete leaves nothing to compare with: its error is infinite."""
    from mpm.config import load
    from mpm.reduce.difference import gap
    from mpm.reduce.offers import asked, driving
    from mpm.runner import run_point, warm

    auto, full = load(path), load(path, {"model": "full"})
    run_point(auto)  # compiles the smaller model, and the pilot's where one is needed
    warm(full)
    seconds: dict[str, list[float]] = {"full": [], "auto": []}
    runs = {}
    for repeat in range(REPEATS):
        for which, experiment in (("full", full), ("auto", auto)):
            if repeat == 0 or seconds[which][0] < ENOUGH:
                began = time.perf_counter()
                runs[which] = run_point(experiment)
                seconds[which].append(time.perf_counter() - began)
    said, apart = runs["auto"].facts["model"], gap(runs["full"], runs["auto"], asked(full), driving(full))
    return ReductionRow(
        path.stem, tuple(apart), said["name"], tuple(one["dropped"] for one in said["dropped"]), said["predicted"], tuple(one["by"] for one in said["dropped"]),
        max(apart.values()), min(seconds["full"]), min(seconds["auto"]), said["tolerance"],
    )  # fmt: skip


def kept(path: Path, store: Path) -> ReductionRow:
    """The line of a config: what was measured of just this config by just this source, else measured now and kept."""
    from mpm.config import load
    from mpm.records.netcdf import write_whole
    from mpm.records.provenance import source_hash

    known = json.loads(store.read_text(encoding="utf-8")) if store.is_file() else {}
    key = f"{load(path).run_id} {source_hash()}"
    if known.get(path.stem, {}).get("key") != key:
        known[path.stem] = {"key": key, "line": asdict(measure(path))}
        store.parent.mkdir(parents=True, exist_ok=True)
        write_whole(store, json.dumps(known, indent=1).encode())
    line = known[path.stem]["line"]
    return ReductionRow(**{name: tuple(value) if isinstance(value, list) else value for name, value in line.items()})


def summary(lines: list[ReductionRow]) -> str:
    """The table in a sentence."""
    held, fast = sum(line.held for line in lines), sum(line.saving >= 10 for line in lines)
    above = sum(line.error <= max(line.predicted, 1e-6) for line in lines)
    said = f"Within the tolerance: {held} of {len(lines)}; ten times as fast or more: {fast}; error below what was predicted: {above}"
    return f"\n{said} (where that is nothing: below 1e-6)."


def main() -> None:
    """Measure the configs named, or all and write the table; a line on standard error for each."""
    wanted = sys.argv[1:]
    lines = []
    for path in sorted(FOLDER.glob("*.yaml")):
        if not wanted or path.stem in wanted:
            lines.append(kept(path, STORE))
            print(lines[-1].text(), file=sys.stderr, flush=True)
    print(summary(lines).strip(), file=sys.stderr)
    if not wanted:
        head = HEAD.format(seconds=time.process_time(), repeats=REPEATS, enough=ENOUGH, summary=summary(lines))
        (FOLDER / "README.md").write_text(head + "\n".join(line.text() for line in lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
