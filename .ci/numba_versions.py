"""Do the tests pass with other versions of Numba? `.venv/bin/python .ci/numba_versions.py 0.61.2,0.66.0 [PYTEST ARGUMENT...]`

Each version gets a fresh environment with all that the tests need, a copy of the checkout whose `mpm.linking.TESTED` holds the version, and an empty compile
cache. All default tests are run unless arguments say otherwise; the least that says something is

    .venv/bin/python .ci/numba_versions.py 0.66.0 -n 0 -m "slow or not slow" tests/test_linking.py tests/test_roles.py
"""

import io
import os
import re
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent


def passes(version: str, arguments: list[str]) -> bool:
    """Whether the tests pass with a version; what pytest says goes to the terminal."""
    with tempfile.TemporaryDirectory() as folder:
        source, python = Path(folder, "source"), Path(folder, "venv", "bin", "python")
        committed = subprocess.run(["git", "-C", HERE, "archive", "HEAD"], capture_output=True, check=True).stdout
        tarfile.open(fileobj=io.BytesIO(committed)).extractall(source, filter="data")
        linking = source / "mpm" / "linking.py"
        tried = "({}, {})".format(*version.split(".")[:2])
        linking.write_text(re.sub(r"^TESTED = .*", f"TESTED = {tried}, {tried}", linking.read_text(), flags=re.MULTILINE))
        subprocess.run([sys.executable, "-m", "venv", python.parents[1]], check=True)
        subprocess.run([python, "-m", "pip", "install", "-q", f"numba=={version}", "-e", f"{source}[test]"], check=True)
        environment = os.environ | {"MPM_CACHE_DIR": str(Path(folder, "cache"))}
        return subprocess.run([python, "-m", "pytest", *arguments], cwd=source, env=environment, check=False).returncode == 0


def main(versions: str, *arguments: str) -> int:
    found = {version: passes(version, list(arguments)) for version in versions.split(",")}
    for version, passed in found.items():
        print(f"numba {version}: {'passed' if passed else 'FAILED'}")
    return 0 if all(found.values()) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
