"""Explicit vectors for kernels: a few numbers of one type that a processor adds and multiplies at once.

LLVM makes vectors of simple loops by itself, but not of the nodes of a stencil, which particles share, and not of long loops over many arrays. Here
they are written down. A `Lanes` value is an LLVM vector `<n x T>`, so the same source becomes SSE, AVX2, AVX-512 or NEON, whatever the machine has.

    load4(array, at), load8(array, at)     four or eight numbers from a C-contiguous array, `at` counts its numbers
    store(array, at, a)                    the same, back
    aligned(shape, dtype)                  zeros at the start of a cache line; in Python only
    peek(array, at), poke(array, at, x)    one number: unlike array[i, k] never a negative index, which costs a comparison each where LLVM cannot see the sign
    fetch_ahead(array, at)                 the cache line of a number begins to come from memory, and nobody waits for it
    splat4(x), splat8(x)                   x in every lane
    four(a, b, c, d)                       lanes from numbers
    transposed(a, b, c, d)                 four fours, rows and columns exchanged; of eights, their first halves and their second halves
    join(a, b), low(a), high(a)            two fours make an eight, and back
    load_row(array, at)                    twelve numbers: three nodes, a row of a stencil; only for what is done lane by lane, store and thirds
    three(a, b, c), thirds(row)            three fours make a row, and back
    fma(a, b, c)                           a b + c by `llvm.fmuladd`: one instruction where there is one, two where not (`llvm.fma` would call a library)
    a + b, a - b, a * b, a / b, -a         lane by lane, also with a number, which takes the type of the lanes
    absolute(a), sqrt(a), minimum(a, b), maximum(a, b), floor(a)
    below(a, b)                            1 where a < b, else 0, in lanes; 0 where either is NaN
    choose(c, a, b)                        a where c is 1, b where it is 0, whatever stands in the other
    like(a, x)                             the number x, as what a is: lanes or a number; lanes as they are
    precision(a)                           epsilon of the type of a, as what a is
    most(a), least(a)                      over the lanes of one value
    item(a, k), put(a, k, x)               lane k; lanes with x there

    logarithm, log1p, expm1, exponential(x)  to two ulp, without a library (functions.py has their ranges)
    erf(x)                                 the same, to two ulp of one (erf.py)

absolute, sqrt, minimum, maximum, below, choose, like precision and these four take numbers too, so that one source (mpm.tensors) serves lanes and numbers.
In plain Python (NUMBA_DISABLE_JIT) lanes are small numpy arrays and every function does the same.
To add    a Python function, its type, its LLVM instruction: see `operation` in kinds.py.

Further files
    access       lanes from arrays and numbers, and back
    arithmetic   arithmetic of lanes, lane by lane, also with numbers
    order        order and choice over lanes and numbers
"""

from mpm.lanes.access import (
    aligned,
    fetch_ahead,
    four,
    high,
    item,
    join,
    load4,
    load8,
    load_row,
    low,
    peek,
    poke,
    put,
    splat4,
    splat8,
    store,
    thirds,
    three,
    transposed,
)  # fmt: skip
from mpm.lanes.arithmetic import absolute, floor, fma, like, sqrt
from mpm.lanes.erf import erf
from mpm.lanes.functions import expm1, exponential, log1p, logarithm
from mpm.lanes.order import below, choose, least, maximum, minimum, most, precision

EIGHT = 8  # particles that pass at once

__all__ = [
    "EIGHT", "absolute", "aligned", "below", "choose", "erf", "expm1", "exponential", "fetch_ahead", "floor", "fma", "four", "high", "item", "join", "least",
    "like", "load4", "load8", "load_row", "log1p", "logarithm", "low", "maximum", "minimum", "most", "peek", "poke", "precision", "put", "splat4", "splat8",
    "sqrt", "store", "thirds", "three", "transposed",
]  # fmt: skip
