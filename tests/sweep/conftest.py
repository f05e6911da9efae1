import sys
from pathlib import Path

import pytest

FAKES = str(Path(__file__).parents[1] / "fakes")
if FAKES not in sys.path:
    sys.path.insert(0, FAKES)  # workers get their parent's module path


@pytest.fixture
def config():
    """A config for the fake runner: conductivities on an axis."""

    def make(kappas, **sections):
        base = {
            "grid": {"dimension": 1, "size": [0.1], "cell": 1e-3},
            "bodies": {"slab": {"shape": {"box": {"lower": [0], "upper": [0.05]}}, "material": "m", "temperature": 300}},
            "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
            "time": {"end": 10},
            "output": {"every": 1, "probes": {"centre": [0.01]}},
            "sweep": {"axes": {"kappa": list(kappas)}},
        }
        if sections.get("output", {}).get("snapshots", {}).get("particles"):  # which only a body that moves has
            base["materials"]["m"]["elastic"] = {"hencky": {"E": 1e4, "nu": 0.3}}
        return base | sections

    return make


@pytest.fixture
def marks(tmp_path, monkeypatch):
    """Lines that the fake runner left: [what, pid] each."""
    folder = tmp_path / "marks_folder"
    folder.mkdir()
    monkeypatch.setenv("FAKE_MARKS", str(folder))
    return lambda: [line.split() for line in (folder / "marks").read_text().splitlines()] if (folder / "marks").exists() else []
