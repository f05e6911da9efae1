"""What a command leaves out."""

import contextlib
import sys
from collections.abc import Iterator
from importlib.util import find_spec

OWN = ("_md5", "_sha1", "_sha3", "_blake2", *(("_sha2",) if sys.version_info >= (3, 12) else ("_sha256", "_sha512")))  # Python's own hashes


def openssl() -> tuple[str, ...]:
    """OpenSSL's hashes, 3.6 MB that a sweep's process can do without: it hashes little. Nothing where Python was built without its own."""
    return ("_hashlib",) if all(map(find_spec, OWN)) else ()


@contextlib.contextmanager
def unseen(*modules: str) -> Iterator[None]:
    """Meanwhile modules that nobody has imported count as not installed.

    For packages that others import to take their arrays, of which there are none here: dask costs 1 s and 9 MB or more. What is imported meanwhile does without
    for good, so this is for a command's own process.
    """
    hidden = [module for module in modules if sys.modules.setdefault(module, None) is None]  # type: ignore[arg-type]  # what Python itself takes for: not there
    try:
        yield
    finally:
        for module in hidden:
            if sys.modules.get(module, module) is None:  # an import that failed may have taken it out
                del sys.modules[module]
