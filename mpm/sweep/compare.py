"""Compare: whether two datasets hold the same results. Times of day, wall times, attempts and the config's text do not count; what it resolves to does."""

import contextlib
import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from mpm.sweep.store import Refused, differences
from mpm.text import visible

NOT_RESULTS = ("wall_time", "attempts")
NOT_ATTRIBUTES = ("config", "started", "finished", "facts", "machine", "threads", "versions", "git_revision", "source_hash", "_NCProperties")
MOST_TOLD = 12  # paths of the config
PLURAL = {"point": "points", "sample": "points of a sample"}


def dataset_of(place: Path) -> Path:
    """A dataset's file, given it or its folder."""
    if place.is_dir():
        for name in ("sweep.nc", "run.nc"):
            if (place / name).exists():
                return place / name
        raise Refused(f"{place} holds neither sweep.nc nor run.nc")
    if not place.exists():
        raise Refused(f"{place} does not exist")
    return place


def opened(place: Path, xarray: Any) -> Any:
    """A dataset's tree, lazily."""
    path = dataset_of(place)
    try:
        return xarray.open_datatree(path, engine="h5netcdf")
    except (OSError, ValueError, KeyError) as error:
        raise Refused(f"{path} is not a whole NetCDF-4 file: {str(error).splitlines()[0] if str(error) else type(error).__name__}") from None


def compare(one: Path, two: Path, rtol: float = 0.0, atol: float = 0.0) -> list[str]:
    """Differences in words, none if the two are the same within |a - b| <= atol + rtol |b| (NaN equals NaN)."""
    import xarray

    told: list[str] = []
    with contextlib.ExitStack() as stack:
        a, b = (stack.enter_context(opened(place, xarray)) for place in (one, two))
        if words := unlike(a, b):
            return words
        paths = {node.path: None for tree in (a, b) for node in tree.subtree}
        for path in paths:
            here, there = (tree[path] if path in {node.path for node in tree.subtree} else None for tree in (a, b))
            if here is None or there is None:
                told.append(f"{path}: only in the {'second' if here is None else 'first'}")
                continue
            told += group(path, here.to_dataset(inherit=False), there.to_dataset(inherit=False), rtol, atol)
        keys = {key: None for tree in (a, b) for key in tree.attrs if key not in NOT_ATTRIBUTES}
        for key in keys:
            told += attribute(key, a.attrs.get(key), b.attrs.get(key))
    return told


def unlike(a: Any, b: Any) -> list[str]:
    """Two datasets that are not of one experiment, in three lines; nothing where a comparison value by value makes sense."""
    sizes = [dict(tree["status"].sizes) if "status" in tree else {} for tree in (a, b)]
    names = [str(tree.attrs.get("name", "")) for tree in (a, b)]
    if names[0] == names[1] or list(sizes[0]) == list(sizes[1]):
        return []
    about = (f"{' x '.join(f'{size} {PLURAL.get(dim, dim)}' for dim, size in one.items()) or 'one point'}" for one in sizes)
    first, second = (f"{visible(name)}, {said}" for name, said in zip(names, about, strict=True))
    return ["these are results of different experiments, and nothing in them is compared", f"first   {first}", f"second  {second}"]


def attribute(key: str, x: Any, y: Any) -> list[str]:
    """How an attribute differs; of the config each path that does."""
    if equal(x, y):
        return []
    if key == "config_resolved":
        with contextlib.suppress(TypeError, ValueError):
            told = differences(json.loads(x), json.loads(y), set())
            more = [f"config: {len(told) - MOST_TOLD} more paths"] if len(told) > MOST_TOLD else []
            return [f"config: {line}" for line in told[:MOST_TOLD]] + more
    return [f"attribute {key}: {both(x, y)}"]


def group(path: str, a: Any, b: Any, rtol: float, atol: float) -> list[str]:
    """Differences within one group."""
    other = {dim: (a.sizes[dim], b.sizes[dim]) for dim in a.sizes if dim in b.sizes and a.sizes[dim] != b.sizes[dim]}
    told, skipped = [f"{path}: {dim} has {one} and {two} values" for dim, (one, two) in other.items()], 0
    for name in {str(name): None for data in (a, b) for name in data.variables if str(name) not in NOT_RESULTS}:
        place = f"{path.rstrip('/')}/{name}"
        if name not in a.variables or name not in b.variables:
            told.append(f"{place}: only in the {'second' if name not in a.variables else 'first'}")
            continue
        x, y = a.variables[name], b.variables[name]
        if x.dims == y.dims and set(x.dims) & set(other):
            skipped += 1
        elif x.dims != y.dims or x.shape != y.shape:
            told.append(f"{place}: {dict(x.sizes)} and {dict(y.sizes)}")
        elif name == "run_id" and (foreign := int(np.sum(np.asarray(x.values != y.values)))):
            told.append(f"{place}: {foreign} of {x.size} points are of another config or version of the physics")
        elif text := values(x.values, y.values, rtol, atol, functools.partial(named, a, x.dims)):
            told.append(f"{place}: {text}")
    return [*told, *([f"{path}: {skipped} variables along {', '.join(map(str, other))} were not compared"] if skipped else [])]


def named(data: Any, dims: tuple, at: tuple) -> str:
    """A place in a variable by the values there: `kappa=0.35 time=12`; by its number along a dimension without values."""
    told = []
    for dim, index in zip(map(str, dims), at, strict=True):
        value = data.coords[dim].values[index] if dim in data.coords else int(index)
        told.append(f"{dim}={value:.6g}" if isinstance(value, float) else f"{dim}={visible(str(value))}")
    return " ".join(told)


def values(x: np.ndarray, y: np.ndarray, rtol: float, atol: float, named: Callable[[tuple], str]) -> str:
    """How two arrays of one shape differ; empty if they do not. `named` says a place in words."""
    if x.dtype.kind not in "fiub" or y.dtype.kind not in "fiub":
        different = np.asarray(x != y)
        if not different.any():
            return ""
        at = tuple(np.argwhere(different)[0])
        where = f"at {named(at)}: " if x.ndim else ""
        return f"{different.sum()} of {x.size} differ, first {where}{both(x[at], y[at])}"
    same = np.isclose(x.astype(float), y.astype(float), rtol=rtol, atol=atol, equal_nan=True)
    if same.all():
        return ""
    gap = np.where(same, 0.0, np.abs(np.nan_to_num(x.astype(float)) - np.nan_to_num(y.astype(float))))
    at = np.unravel_index(np.argmax(np.where(same, -1.0, gap)), x.shape)
    where = f"most at {named(at)}" if x.ndim else "by value"
    return f"{(~same).sum()} of {x.size} differ, {where}: {x[at].item()!r} and {y[at].item()!r}"


def equal(x: Any, y: Any) -> bool:
    """Whether two attributes are the same."""
    return json.dumps(x, default=str) == json.dumps(y, default=str)


def both(x: Any, y: Any) -> str:
    """Two values, short: long texts from where they begin to differ."""
    texts = [visible(str(value)) for value in (x, y)]
    same = next((place for place, (a, b) in enumerate(zip(*texts, strict=False)) if a != b), min(map(len, texts)))
    start = max(0, same - 20) if max(map(len, texts)) >= 60 else 0
    cut = [("..." if start else "") + text[start : start + 57] + ("..." if len(text) > start + 57 else "") for text in texts]
    return " and ".join(cut)
