"""Do the tests pass with other versions of Numba? `.venv/bin/python .ci/numba_versions.py 0.61.2,0.66.0 [PYTEST ARGUMENT...]`

Each version gets a fresh environment with all that the tests need, a copy of the checkout whose `mpm.linking.TESTED` holds the version, and an empty compile
cache. All default tests are run unless arguments say otherwise; the least that says something is

    .venv/bin/python .ci/numba_versions.py 0.66.0 -n 0 -m "slow or not slow" tests/test_linking.py tests/test_roles.py
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent


def passes(version: str, arguments: list[str]) -> bool:
    """Whether the tests pass with a version; what pytest says goes to the terminal."""
    with tempfile.TemporaryDirectory() as folder:
        source, python = Path(folder, "source"), Path(folder, "venv", "bin", "python")
        subprocess.run(["git", "-C", HERE, "worktree", "add", "-q", "--detach", source, "HEAD"], check=True)
        try:
            linking = source / "mpm" / "linking.py"
            first, last = re.search(r"^TESTED = (.*?\)), (\(.*?\))", text := linking.read_text(), re.MULTILINE).groups()
            tried = ", ".join(version.split(".")[:2])
            linking.write_text(text.replace(f"TESTED = {first}, {last}", f"TESTED = ({tried}), ({tried})"))
            subprocess.run([sys.executable, "-m", "venv", python.parents[1]], check=True)
            subprocess.run([python, "-m", "pip", "install", "-q", f"numba=={version}", "-e", f"{source}[test]"], check=True)
            environment = os.environ | {"MPM_CACHE_DIR": str(Path(folder, "cache"))}
            return subprocess.run([python, "-m", "pytest", *arguments], cwd=source, env=environment, check=False).returncode == 0
        finally:
            subprocess.run(["git", "-C", HERE, "worktree", "remove", "--force", source], check=True)


def main(versions: str, *arguments: str) -> int:
    found = {version: passes(version, list(arguments)) for version in versions.split(",")}
    for version, passed in found.items():
        print(f"numba {version}: {'passed' if passed else 'FAILED'}")
    return 0 if all(found.values()) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
