"""A point's result on disk: one small sealed HDF5 file.

Written compactly (all series in one array: about 1 ms a point; a NetCDF file with a variable for each takes 20), because a sweep writes
thousands and `collect` turns them into the labelled dataset. The seal's line carries what `status` needs.

line    run_id, status, error, outcome, advice, warned, steps, wall_time, attempts, source, started, finished
file    time (T), series (n, T), finals (k), snapshot (S), grid/<field> (S, [z,] [y,] x), axes/<x>, particles/<field> (obs, ...), particles/row_size (S)
        or attribute `frames`: bytes of the file <run id>.frames beside it, which has grid and particles
        attribute `names`: JSON with the names of series and finals; `facts` and `config`: JSON
"""

import functools
import io
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.frames import Entries
from mpm.records.netcdf import DamagedFile, seal, unseal
from mpm.records.variables import DIVERGED, OK, STATUS, TIMEOUT, describe
from mpm.warned import kinds

PACKED = {"compression": "gzip", "compression_opts": 4, "shuffle": True, "fletcher32": True}
LINE = "run_id status error outcome advice warned steps wall_time attempts source started finished".split()


@dataclass
class Record:
    """What is known of a point. `status` as in variables.STATUS; a point that is not ok keeps its series so far; its finals are NaN."""

    run_id: str
    status: int
    error: str = ""
    outcome: str = ""
    advice: str = ""
    warned: str = ""  # kinds of `warnings`
    steps: int = 0
    wall_time: float = 0.0
    attempts: int = 1
    source: str = ""
    started: str = ""
    finished: str = ""
    times: np.ndarray = field(default_factory=lambda: np.zeros(0))
    series: dict[str, np.ndarray] = field(default_factory=dict)
    finals: dict[str, float] = field(default_factory=dict)
    axes: dict[str, np.ndarray] = field(default_factory=dict)
    snapshot_times: np.ndarray = field(default_factory=lambda: np.zeros(0))
    grid: dict[str, np.ndarray] = field(default_factory=dict)
    particles: dict[str, np.ndarray] = field(default_factory=dict)
    row_size: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    frames: Any = None  # in the place of grid and particles where they lie in a file beside the point's (records.frames)
    facts: dict = field(default_factory=dict)
    config: dict = field(default_factory=dict)

    @property
    def line(self) -> dict:
        """The summary that the seal carries."""
        return {name: getattr(self, name) for name in LINE}

    @property
    def warnings(self) -> list[str]:
        """What a careful user wants to know of the run (mpm.warned)."""
        return self.facts.get("warnings", [])


@functools.lru_cache(maxsize=4096)
def known(name: str) -> None:
    """KeyError for a name that the table does not know: it would have neither units nor a long name. Every point of a sweep asks for the same ones."""
    describe(name)


def from_run(run_id: str, run: Any, **calls: Any) -> Record:
    """The record of a Run (mpm.outcome.Run). Any outcome but `completed` keeps its series, and its finals become NaN."""
    outcome = run.outcome
    status = OK if outcome.ok else TIMEOUT if outcome.kind == "budget" else DIVERGED
    error = "" if status == OK else f"{STATUS[status]}: {outcome.message or outcome.kind.replace('_', ' ')}"
    for name in (*run.series, *run.finals):
        known(name)
    if wrong := [name for name, values in run.series.items() if len(values) != len(run.times)]:
        raise ValueError(f"series that are not one value a time, as when two have one name: {', '.join(wrong)}")
    sizes = [len(next(iter(rows.values()), ())) for rows in run.particles]
    fields = run.particles[0] if run.particles else {}
    return Record(
        run_id=run_id,
        status=status,
        error=error,
        outcome=outcome.kind,
        advice=outcome.advice if status != OK else "",
        warned=" ".join(kinds(run.facts.get("warnings", ()))),
        steps=int(run.steps),
        wall_time=float(run.wall_time),
        times=np.asarray(run.times, dtype=float),
        series={name: np.asarray(values, dtype=float) for name, values in run.series.items()},
        finals={name: float(value) if status == OK else np.nan for name, value in run.finals.items() if name not in ("steps", "wall_time")},
        axes=dict(run.axes),
        snapshot_times=np.asarray(run.snapshot_times, dtype=float),
        grid=dict(run.grid),
        particles={name: np.concatenate([np.asarray(rows[name]) for rows in run.particles]) for name in fields},
        row_size=np.asarray(sizes, dtype=np.int64),
        frames=run.frames,
        facts=dict(run.facts),
        **calls,
    )


def pack(record: Record) -> bytes:
    """The bytes of a point file."""
    import h5py

    buffer = io.BytesIO()
    with h5py.File(buffer, "w", libver="latest") as file:

        def put(name: str, values: Any) -> None:
            values = np.asarray(values)
            packed = {"chunks": values.shape, **PACKED} if values.size and values.nbytes < 2**20 else PACKED if values.size else {}
            file.create_dataset(name, data=values, **packed)

        if len(record.times):
            put("time", record.times)
        if record.series:
            put("series", np.stack(list(record.series.values())))
        if record.finals:
            put("finals", np.array(list(record.finals.values())))
        if len(record.snapshot_times):
            put("snapshot", record.snapshot_times)
        for name, values in record.grid.items():
            put(f"grid/{name}", np.asarray(values, dtype=np.float32))
        for name, values in record.axes.items():
            put(f"axes/{name}", values)
        for name, values in record.particles.items():
            put(f"particles/{name}", values)
        if record.particles:
            put("particles/row_size", record.row_size)
        if record.frames is not None:
            file.attrs["frames"] = record.frames.ends[-1]
        file.attrs["names"] = json.dumps({"series": list(record.series), "finals": list(record.finals)})
        file.attrs["facts"] = json.dumps(record.facts)
        file.attrs["config"] = json.dumps(record.config)
    return seal(buffer.getvalue(), record.line)


def read(path: Path | str, fields: bool = True) -> Record:
    """A point file, checked against its seal; `fields=False` leaves grid and particles on disk."""
    body, line = unseal(Path(path).read_bytes(), path)
    record = parse(body, line, fields)
    if record.frames is not None and fields:
        record.frames = beside(Path(path), record.frames)
    return record


def beside(path: Path, size: int) -> Entries:
    """The frames of a point's file; DamagedFile where they are not as long as they were."""
    file = path.with_suffix(".frames")
    try:
        if file.stat().st_size == size:
            return Entries(file)
    except FileNotFoundError:
        pass  # told with the same words
    raise DamagedFile(f"{file}: missing, or not as long as it was written")


def parse(body: bytes, line: dict, fields: bool = True) -> Record:
    """The record in a body and its line."""
    import h5py

    with h5py.File(io.BytesIO(body)) as file:
        names = json.loads(file.attrs["names"])
        record = Record(**line, facts=json.loads(file.attrs["facts"]), config=json.loads(file.attrs["config"]))
        if "time" in file:
            record.times = file["time"][()]
        if names["series"]:
            record.series = dict(zip(names["series"], file["series"][()], strict=True))
        if names["finals"]:
            record.finals = dict(zip(names["finals"], file["finals"][()].tolist(), strict=True))
        if "snapshot" in file:
            record.snapshot_times = file["snapshot"][()]
        record.frames = int(file.attrs["frames"]) if "frames" in file.attrs else None
        if fields:
            record.axes = {name: values[()] for name, values in file["axes"].items()} if "axes" in file else {}
            record.grid = {name: values[()] for name, values in file["grid"].items()} if "grid" in file else {}
            if "particles" in file:
                record.particles = {name: values[()] for name, values in file["particles"].items()}
                record.row_size = record.particles.pop("row_size")
    return record
