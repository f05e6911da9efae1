"""mpm info: what a bug report needs."""

from mpm_cli.options import Json
from mpm_cli.talk import document, say


def info(as_json: Json = False) -> None:
    """Print versions, source hash, machine, threads and compile cache, for a bug report."""
    from mpm import linking
    from mpm.jit import CACHE
    from mpm.records.provenance import git_revision, machine, source_hash, versions

    files = [path for path in CACHE.rglob("*") if path.is_file()]
    found = {
        "versions": versions(),
        "source_hash": source_hash(),
        "git_revision": git_revision(),
        "machine": machine(),
        "threads": "one a worker process; workers by --jobs",
        "compiling": "one module a kernel" if linking.stock else f"Numba's own way: only {linking.tried()} were tried",
        "cache": {"folder": CACHE, "files": len(files), "bytes": sum(path.stat().st_size for path in files)},
    }
    if as_json:
        document(found)
        return
    for name, value in found.items():
        say(f"{name:<13} " + (", ".join(f"{key} {inner}" for key, inner in value.items()) if isinstance(value, dict) else str(value)))
