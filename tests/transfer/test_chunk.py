"""Scratch of a chunk: every array its own, and at the start of a cache line. (`reach` and `begins` are whole numbers.)"""

import numpy as np
import pytest

from mpm.lanes import aligned
from mpm.transfer import new_chunk


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("D", [1, 2, 3])
@pytest.mark.parametrize("own", [(False, False), (True, False), (True, True)])
def test_arrays_of_a_chunk(D, real, own):
    for make in (new_chunk, getattr(new_chunk, "py_func", new_chunk)):
        chunk = make(D, np.zeros(1, real), *own)
        shared = {"L": "C" if not own[0] else "", "u": "v" if not own[1] else "", "change": "v" if not own[1] else "", "U": "C" if not own[1] else ""}
        arrays = {name: array for name, array in chunk._asdict().items() if name not in ("reach", "begins") and not shared.get(name)}
        assert all(array.ctypes.data % 64 == 0 and array.dtype == real and not array.any() for array in arrays.values())
        for number, array in enumerate(arrays.values(), 1):
            array[...] = number
        assert all((array == number).all() for number, array in enumerate(arrays.values(), 1))  # nothing overlaps
        assert all(np.shares_memory(getattr(chunk, name), getattr(chunk, other)) for name, other in shared.items() if other)


def test_aligned():
    for shape in ((3,), (2, 5, 4), (0, 4)):
        found = aligned(shape, np.float32)
        assert found.shape == shape and not found.any() and (found.size == 0 or found.ctypes.data % 64 == 0)
