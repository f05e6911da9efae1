"""How mpm compiles: `kernel` (njit with the house's flags) and `role` (a function chosen by the type of its first argument).

Numba's on-disk cache does not notice that a callee in another file changed, so a kernel's cache is in a folder named after the versions that matter and a
hash of every source file that the kernel can contain (mpm.fingerprint). It is private (mpm.cache). All that is compiled comes through here and mpm.linking.
"""

import contextlib
import functools
import hashlib
import io
from pathlib import Path

import numba
from numba import config, njit
from numba.core.caching import IndexDataCacheFile
from numba.extending import overload

from mpm import cache, linking
from mpm.fingerprint import fingerprint

# No "nnan" and no "ninf": guards must still see a NaN. (`fastmath=True` would remove isnan and isfinite.)
FLAGS = {"fastmath": {"contract", "arcp", "nsz", "afn"}, "error_model": "numpy", "nogil": True}


# For functions that run inside another's loop: LLVM puts them in place, and no array's reference count is touched (an atomic operation each, and a
# tuple of arrays has as many as it has fields). So they cannot make arrays, and must not return any.
INLINE = {"forceinline": True, "_nrt": False}
ARRAYS = {"forceinline": False, "_nrt": True}  # for functions that make arrays and are called from INLINE ones, which else hand down that there are none
INNER = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}  # only compiled code calls it: a wrapper for a tuple of arrays is most of the compiling

CACHE = cache.kernels()

if not linking.install():
    cache.say(f"numba {numba.__version__} was not tried with mpm ({linking.tried()} were): compiling takes two to three times as long")


class Sealed(IndexDataCacheFile):
    """Numba's cache files, each with its SHA-256 behind it, each entry with its key: what was cut, or another process wrote over, is compiled anew.

    A cache that cannot be written (a full disk) costs the next process a compilation, not this one its run.
    """

    @contextlib.contextmanager
    def _open_for_write(self, filepath):
        buffer = io.BytesIO()
        yield buffer
        data = buffer.getvalue()
        with contextlib.suppress(OSError), super()._open_for_write(filepath) as file:
            file.write(data + hashlib.sha256(data).digest())  # readers of pickles stop before it

    def _load_index(self):
        return super()._load_index() if whole(self._index_path) else {}

    def _load_data(self, name):
        return super()._load_data(name) if whole(self._data_path(name)) else None

    def save(self, key, data):
        super().save(key, (key, data))

    def load(self, key):
        found = super().load(key)
        return found[1] if found is not None and found[0] == key else None


def whole(path: str) -> bool:
    """Whether a file ends in the hash of what stands before."""
    try:
        data = Path(path).read_bytes()
    except OSError:
        return False
    return hashlib.sha256(data[:-32]).digest() == data[-32:]


def kernel(function=None, *, inline=False, arrays=False):
    """Compile with the house's flags and cache on disk. `inline=True` for functions that a kernel calls per particle, chunk or step: see INLINE, ARRAYS."""
    if function is None:
        return functools.partial(kernel, inline=inline, arrays=arrays)
    config.CACHE_DIR = str(CACHE / fingerprint(function.__module__))
    made = njit(cache=True, **FLAGS, **(INLINE if inline else ARRAYS if arrays else {}))(function)
    if hasattr(getattr(made, "_cache", None), "_cache_file"):  # there is none under NUMBA_DISABLE_JIT
        made._cache._cache_file.__class__ = Sealed
    return made


def role(stub=None, *, inline=False, arrays=False):
    """A function chosen by the type of its first argument, in Python and in compiled code alike.

    `stub` gives name, argument names and docstring. A law registers itself with `@stub.register(Kind)`, `Kind` a
    NamedTuple class, on a function with the same argument names and no annotations (Numba compares the signatures).
    Kinds are types, values are run-time arguments: a sweep over values shares one compiled kernel. `inline` and `arrays` as in `kernel`.
    """
    if stub is None:
        return functools.partial(role, inline=inline, arrays=arrays)
    laws = functools.singledispatch(stub)

    @functools.wraps(stub)
    def pick(*args):
        return laws.registry.get(getattr(args[0], "instance_class", None))

    enter = laws.register

    def register(kind, function=None):
        """Every law is called `_`: Numba needs names that tell the laws of one file apart, also between processes that share a cache."""
        if function is None:
            return lambda found: register(kind, found)
        if hasattr(function, "__qualname__") and function.__name__ == "_":
            function.__qualname__ = f"{stub.__name__}_{kind.__name__}"
        return enter(kind, function)

    laws.register = register
    overload(laws, jit_options=FLAGS | INNER | (INLINE if inline else ARRAYS if arrays else {}))(pick)
    return laws
