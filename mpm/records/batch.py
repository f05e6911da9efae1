"""Many small records in one sealed HDF5 file: what a worker writes for a batch of tiny points, with one sync for all.

Points of one sweep mostly share their times and names, so records that do lie in one array; the seal's line carries every point's summary.

line    points: [the line of each record]
file    0/, 1/ ...: records that share times and names: time (T), series (k, n, T), finals (k, f), at (k): places in `points`
        rest: JSON text of [[facts, config] of each record], compressed; attribute `names` on each group: JSON with the names of series and finals
"""

import io
import json
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.netcdf import seal, unseal
from mpm.records.point import PACKED, Record


def fits(record: Record) -> bool:
    """Whether a record may join a batch: fields are large, and stay in a file of their own."""
    return not record.grid and not record.particles and not len(record.snapshot_times) and record.frames is None


def pack_batch(records: list[Record]) -> bytes:
    """The bytes of a batch's file."""
    import h5py

    groups: dict[tuple, list[int]] = {}
    for place, record in enumerate(records):
        key = (record.times.tobytes(), tuple(record.series), tuple(record.finals))
        groups.setdefault(key, []).append(place)
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", libver="latest") as file:
        for index, ((_, series, finals), members) in enumerate(groups.items()):
            group = file.create_group(str(index))
            group.attrs["names"] = json.dumps({"series": series, "finals": finals})
            put(group, "at", np.array(members))
            put(group, "time", records[members[0]].times)
            put(group, "series", np.array([list(records[place].series.values()) for place in members]))
            put(group, "finals", np.array([list(records[place].finals.values()) for place in members]))
        rest = zlib.compress(json.dumps([[record.facts, record.config] for record in records]).encode(), 4)
        file.create_dataset("rest", data=np.frombuffer(rest, dtype=np.uint8), fletcher32=True, chunks=(len(rest),))
    return seal(buffer.getvalue(), {"points": [record.line for record in records]})


def put(group: Any, name: str, values: np.ndarray) -> None:
    """An array, compressed and checksummed unless it is empty."""
    group.create_dataset(name, data=values, **({"chunks": values.shape, **PACKED} if values.size else {}))


def read_batch(path: Path | str) -> list[Record]:
    """All records of a batch, checked against the seal."""
    body, line = unseal(Path(path).read_bytes(), path)
    return list(parse_batch(body, line))


def parse_batch(body: bytes, line: dict) -> Iterable[Record]:
    """The records in a body and its line, in the order of the line."""
    import h5py

    with h5py.File(io.BytesIO(body)) as file:
        rest = json.loads(zlib.decompress(file["rest"][()].tobytes()))
        records = [Record(**summary, facts=facts, config=config) for summary, (facts, config) in zip(line["points"], rest, strict=True)]
        for name, group in file.items():
            if name == "rest":
                continue
            names = json.loads(group.attrs["names"])
            times, series, finals = group["time"][()], group["series"][()], group["finals"][()].tolist()
            for k, place in enumerate(group["at"][()].tolist()):
                record = records[place]
                record.times = times
                record.series = dict(zip(names["series"], series[k], strict=True))
                record.finals = dict(zip(names["finals"], finals[k], strict=True))
    return records
