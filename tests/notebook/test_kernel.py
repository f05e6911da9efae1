"""In a real notebook kernel: a bar while a sweep runs, results that show themselves, figures as pictures."""

import json
import sys
from pathlib import Path

import pytest

FAKES = str(Path(__file__).parents[1] / "fakes")
SLAB = {
    "title": "<b>A slab</b>",
    "grid": {"dimension": 1, "size": [0.1], "cell": 1e-3},
    "bodies": {"s": {"shape": {"box": {"lower": [0], "upper": [0.05]}}, "material": "m", "temperature": 300}},
    "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
    "time": {"end": 10},
    "output": {"every": 1, "probes": {"centre": [0.01]}},
}
CELLS = (
    f"import sys; sys.path.insert(0, {FAKES!r}); import mpm; from mpm.sweep import engine; engine.RUNNER = 'fake_runner'; slab = {SLAB!r}",
    "tree = mpm.sweep(mpm.load(slab | {'sweep': {'axes': {'kappa': [1.0, 2.0, 13.0]}}}), out='s', jobs=0)",
    "tree",
    "mpm.run(mpm.load(slab))",
    "mpm.plots.final(tree, 'temperature_mean')",
    "tree['series']",
)


@pytest.mark.slow
def test_a_sweep_in_a_kernel(tmp_path, monkeypatch):
    why = "pip install nbclient ipykernel matplotlib-inline runs this test"
    nbclient, nbformat = pytest.importorskip("nbclient", reason=why), pytest.importorskip("nbformat", reason=why)
    pytest.importorskip("ipykernel", reason=why)
    kernel = tmp_path / "kernels/here"
    kernel.mkdir(parents=True)
    kernel.joinpath("kernel.json").write_text(
        json.dumps({"argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"], "display_name": "here"})
    )
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in CELLS])
    nbclient.NotebookClient(book, kernel_name="here", timeout=200, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [[one.get("data", {}) for one in cell["outputs"]] for cell in book.cells]
    assert not outputs[0] and len(outputs[1]) == 1  # one bar, which is written anew
    assert '<progress value="3.000" max="3">' in outputs[1][0]["text/html"] and "3 of 3, 1 failed" in outputs[1][0]["text/html"]
    card = outputs[2][0]["text/html"]
    assert "&lt;b&gt;A slab&lt;/b&gt;" in card and "2 ok, 1 failed" in card and "data:image/png" in card and "kappa: 1, 2, 13 W/m/K" in card
    assert '<progress value="1.000" max="1">' in outputs[3][0]["text/html"] and "1 ok" in outputs[3][1]["text/html"]
    assert "image/png" in outputs[4][0] and "xarray" in outputs[5][0]["text/html"]
