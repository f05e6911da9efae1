"""sensitivity: every observable of a finished sample -> indices with intervals, what failed, sentences, OUT/sensitivity.nc.

Points that are not ok are left out, and told. Where failing depends on a parameter, intervals are those of `failing.bounded`. A time that was not reached is
censored: indices are of min(time, end), which is known for every point that ended; ranks are right as they are.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.netcdf import Array, Group, to_bytes, write_whole
from mpm.records.provenance import git_revision, versions
from mpm.sensitivity import indices
from mpm.sensitivity.failing import SURE, Row, bounded, table
from mpm.sensitivity.projection import chosen, estimate
from mpm.sensitivity.sample import Sample, read
from mpm.sensitivity.surrogate import Surrogate, build
from mpm.sensitivity.surrogate import indices as of_surrogate
from mpm.sweep.lock import Refused


@dataclass
class Effects:
    """Of one observable. Each of `spearman`, `first`, `total`: (value, lower, upper) by parameter. `how` the indices were made."""

    name: str
    known: int
    late: int
    spearman: np.ndarray
    first: np.ndarray | None
    total: np.ndarray | None
    how: str
    surrogate: Surrogate | None = None


@dataclass
class Found:
    """All of it."""

    sample: Sample
    failed: list[Row]
    effects: list[Effects]
    unreached: dict[str, list[Row]]

    @property
    def share(self) -> float:
        """Of the points that are not ok."""
        return float(1 - self.sample.ok.mean())


def analyse(tree: Any, of: tuple[str, ...] = (), surrogate: bool = False, seed: int = 0) -> Found:
    """From a dataset."""
    sample = read(tree)
    if unknown := [name for name in of if name.replace(".", "_") not in sample.outputs]:
        raise Refused(f"--of {unknown[0]}: there is no such observable that varies; here are {', '.join(sample.outputs)}")
    failed = table(sample.parameters, sample.unit, ~sample.ok)
    names, unreached = [name.replace(".", "_") for name in of] or wanted(sample), {}
    effects = []
    for name in names:
        y, ok = sample.outputs[name], sample.ok
        late = ok & ~np.isfinite(y) if name in sample.late else np.zeros(len(y), bool)
        if late.any():
            y = np.where(late, sample.late[name], y)
            unreached[name] = table(sample.parameters[:], sample.unit[ok], late[ok])
        effects.append(effects_of(sample, name, y, int(late.sum()), failed, surrogate, seed))
    return Found(sample, failed, effects, unreached)


def wanted(sample: Sample) -> list[str]:
    """What the config lists, else everything."""
    output = sample.config.get("output") or {}
    listed = [*(name.replace(".", "_") for name in output.get("observables") or ()), *(f"temperature_{probe}" for probe in output.get("probes") or {})]
    return [name for name in dict.fromkeys(listed) if name in sample.outputs] or list(sample.outputs)


def effects_of(sample: Sample, name: str, y: np.ndarray, late: int, failed: list[Row], surrogate: bool, seed: int) -> Effects:
    """The indices of one observable."""
    known, x = np.isfinite(y), sample.unit
    if known.sum() < indices.FEWEST or sample.refined:
        ranks = indices.spearman(x[known], y[known], seed) if known.sum() > 3 else np.full((x.shape[1], 3), np.nan)
        few = f"only {known.sum()} points are known, and indices need {indices.FEWEST}"
        why = "refinement placed the points, which are no sample of the ranges: no indices" if sample.refined else few
        return Effects(name, int(known.sum()), late, ranks, None, None, why)
    ranks = indices.spearman(x[known], y[known], seed)
    biased = bool(failed) and failed[0].p < SURE
    if sample.base and not biased:
        first, total, rows = indices.saltelli(y, sample.base, x.shape[1], seed)
        return Effects(name, int(known.sum()), late, ranks, first, total, f"Saltelli's design, {rows} of {sample.base} rows whole")
    if surrogate and not late:
        made = build(x[known], y[known], seed)
        first, total = of_surrogate(made, x.shape[1], seed=seed)
        return Effects(name, int(known.sum()), late, ranks, first, total, "surrogate", made)
    found = bounded(x, y, known, seed) if biased else estimate(chosen(x[known], y[known]), y[known], seed)
    how = f"polynomials that predict {100 * max(found.explained, 0):.3g} % of the variance" + (", bounds over what the failed points may be" if biased else "")
    how += ", no surrogate: it would smooth the edge of what is never reached" if surrogate else ""
    return Effects(name, int(known.sum()), late, ranks, found.first, found.total, how)


def sentences(found: Found) -> list[str]:
    """The answer in words."""
    sample, said = found.sample, []
    bad = int((~sample.ok).sum())
    if bad:
        said.append(f"{bad} of {len(sample.ok)} points ({100 * found.share:.0f} %) are not ok and are left out")
        said += where(found.failed, "failing")
    for one in found.effects:
        if one.late:
            said.append(f"{one.name}: {one.late} of {one.known} points never reach it; they count as at least {sample.late[one.name]:g} s")
            said += where(found.unreached[one.name], "not reaching it")
        strongest = one.first if one.first is not None else np.abs(one.spearman)
        parts = []
        for k in np.argsort(-strongest[:, 0]):
            value, low, high = (one.first if one.first is not None else one.spearman)[k]
            least = 0 if one.first is not None else -1
            more = f"; total {span(one.total[k], 0)}" if one.total is not None else ""
            seen = low > 0 if one.first is not None else low * high > 0
            parts.append(f"{sample.parameters[k].name} {span((value, low, high), least)}{more}" + ("" if seen else ", no effect of its own shown"))
        what = "shares of the variance" if one.first is not None else "rank correlations"
        said.append(f"{one.name}, {what} ({one.how}):")
        said += [f"  {part}" for part in parts]
        if one.surrogate is not None:
            made = one.surrogate
            trust = ": too little to trust" if made.explained < 0.9 else ""
            said.append(f"  the surrogate of {one.name}, {made.points} points, predicts {100 * made.explained:.3g} % of the variance of points that it was not "
                        f"shown, off by {made.rms:.3g} {sample.units[one.name]} rms{trust}")  # fmt: skip
    return said


def span(index: tuple[float, float, float], least: float) -> str:
    """`0.31 (0.29 to 0.33)`; an end beyond what an index can be is cut."""
    value, low, high = (min(max(float(end), least), 1.0) + 0.0 for end in index)
    return f"{value:.2f} ({low:.2f} to {high:.2f})"


def where(rows: list[Row], what: str) -> list[str]:
    """Which ranges, in words; one line a parameter that matters."""
    if not rows:
        return []
    if rows[0].p >= SURE:
        return [f"  {what} depends on no parameter that this sample shows (p = {rows[0].p:.2g})"]
    text = lambda row: " / ".join(f"{100 * share:.0f} %" for share in row.shares)  # noqa: E731
    span = lambda row: f"below {row.edges[0]:.4g} / to {row.edges[1]:.4g} / above"  # noqa: E731
    return [f"  {what} depends on {row.name}: {text(row)} {span(row)} (p = {row.p:.1g})" for row in rows if row.p < SURE]


def write(found: Found, path: Path) -> Path:
    """OUT/sensitivity.nc: spearman, first, total (observable, parameter, of); failed (parameter, third), failed_p; of what was not reached
    unreached_share (observable, parameter, third), unreached_p; NaN where there is none."""
    sample, names = found.sample, [parameter.name for parameter in found.sample.parameters]
    text = lambda values: np.array(list(values), dtype=object)  # noqa: E731
    nothing = np.full((len(names), 3), np.nan)
    stack = lambda kind: np.array([nothing if getattr(one, kind) is None else getattr(one, kind) for one in found.effects])  # noqa: E731
    effects = found.effects
    by_name = lambda rows: {row.name: row for row in rows}  # noqa: E731
    shares = lambda rows: [rows[n].shares if n in rows else (0.0,) * 3 for n in names]  # noqa: E731
    chances = lambda rows: [rows[n].p if n in rows else 1.0 for n in names]  # noqa: E731
    rows, late = by_name(found.failed), [by_name(found.unreached.get(one.name, ())) for one in effects]
    said = lambda words: {"units": "1", "long_name": words}  # noqa: E731
    about = {"spearman": "rank correlation", "first": "first-order index", "total": "total index"}
    variables = {
        "parameter": Array(("parameter",), text(names)), "observable": Array(("observable",), text(one.name for one in effects)),
        "observable_long_name": Array(("observable",), text(sample.long_names[one.name] for one in effects), {"long_name": "what it is"}),
        "of": Array(("of",), text(["value", "lower", "upper"])), "third": Array(("third",), text(["lower", "middle", "upper"])),
        **{kind: Array(("observable", "parameter", "of"), stack(kind), said(f"{words}, 95 % interval")) for kind, words in about.items()},
        "how": Array(("observable",), text(one.how for one in effects), {"long_name": "how the indices were made"}),
        "known": Array(("observable",), np.array([one.known for one in effects]), said("points that count")),
        "unreached": Array(("observable",), np.array([one.late for one in effects]), said("points that count as at least the end")),
        "unreached_share": Array(("observable", "parameter", "third"), np.array([shares(one) for one in late]), said("share that did not reach it")),
        "unreached_p": Array(("observable", "parameter"), np.array([chances(one) for one in late]), said("p that it does not matter")),
        "failed": Array(("parameter", "third"), np.array(shares(rows)), said("share failed")),
        "failed_p": Array(("parameter",), np.array(chances(rows)), said("p that it does not matter")),
    }  # fmt: skip
    attrs = {"Conventions": "CF-1.11", "title": sample.title, "sentences": sentences(found), "share_failed": found.share, "points": len(sample.ok),
             "versions": versions(), "git_revision": git_revision()}  # fmt: skip
    write_whole(path, to_bytes({"/": Group(variables)}, attrs))
    return path


def opened(source: Any) -> Any:
    """A tree, a dataset, a file or the folder of a sweep."""
    if not isinstance(source, str | Path):
        return source
    import xarray

    path = Path(source) / "sweep.nc" if Path(source).is_dir() else Path(source)
    if not path.exists():
        raise Refused(f"{path} is not there; give the folder that `mpm sweep` wrote")
    return xarray.load_dataset(path, engine="h5netcdf")


def sensitivity(source: Any, of: tuple[str, ...] = (), surrogate: bool = False) -> Any:
    """`mpm.sensitivity(tree_or_out)`: an xarray.Dataset of indices, with `sentences` among its attributes."""
    import io

    import xarray

    found = analyse(opened(source), tuple(of), surrogate)
    buffer = io.BytesIO()
    path = Path(source) / "sensitivity.nc" if isinstance(source, str | Path) and Path(source).is_dir() else None
    if path is not None:
        return xarray.load_dataset(write(found, path), engine="h5netcdf")
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        buffer.write(write(found, Path(folder) / "sensitivity.nc").read_bytes())
    return xarray.load_dataset(buffer, engine="h5netcdf")
