"""In a notebook: results show what varied, their status and the overview, hostile words as words; a bar tells of a sweep; figures take axes."""

import html.parser
import sys
import types
import warnings

import pytest
import xarray as xr

import mpm
from mpm import notebook
from mpm.sweep import engine

HOSTILE = "<script>alert(1)</script>"
BODY = {"shape": {"box": {"lower": [0], "upper": [0.05]}}, "material": "m", "temperature": 300}


def experiment(title="A slab", **sections):
    return mpm.load({
        "title": title,
        "grid": {"dimension": 1, "size": [0.1], "cell": 1e-3},
        "bodies": {"s": BODY},
        "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
        "time": {"end": 10},
        "output": {"every": 1, "probes": {"centre": [0.01]}},
    } | sections)  # fmt: skip


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")


class Tags(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.text = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)

    def handle_data(self, data):
        self.text += data


def test_a_sweep_shows_itself(fake, tmp_path):
    tree = mpm.sweep(experiment(HOSTILE, sweep={"axes": {"kappa": [1.0, 2.0, 13.0]}}), out=tmp_path / "s", jobs=0)
    assert isinstance(tree, xr.DataTree) and tree["series"].sizes["kappa"] == 3
    xr.testing.assert_identical(xr.DataTree.from_dict(tree.to_dict()), xr.open_datatree(tmp_path / "s/sweep.nc").load())
    page = Tags(notebook.card(tree))
    assert page.tags.count("img") == 1 and "script" not in page.tags and HOSTILE in page.text
    assert "kappa: 1, 2, 13 W/m/K" in page.text and "2 ok, 1 failed" in page.text and "no such luck" in page.text
    assert "<details>" in tree._repr_html_() and tree["series"]._repr_html_()  # a part shows itself as xarray does


def test_a_run_shows_itself_and_one_that_failed_too(fake):
    assert "1 ok" in Tags(mpm.run(experiment())._repr_html_()).text
    body = BODY | {"temperature": 313}
    failed = mpm.run(experiment(bodies={"s": body}, materials={"m": {"density": 1000, "heat": {"fourier": {"kappa": 13.0, "alpha": 1000}}}}))
    assert "1 failed" in Tags(failed._repr_html_()).text


def test_warnings_point_at_the_caller(fake, monkeypatch):
    monkeypatch.setattr("mpm.config.cautions.cautions", lambda one: ["mind this"])
    for call in (lambda: mpm.run(experiment()), lambda: notebook.run(experiment())):
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            call()
        assert [one.filename for one in found if str(one.message) == "mind this"] == [__file__]


def test_a_bar_tells_of_a_sweep_in_a_kernel(fake, tmp_path, monkeypatch):
    shown = []
    handle = types.SimpleNamespace(update=shown.append)
    display = types.SimpleNamespace(HTML=str, display=lambda *_, display_id: handle)
    shell = types.SimpleNamespace(get_ipython=lambda: types.SimpleNamespace(kernel=object()), display=display)
    monkeypatch.setitem(sys.modules, "IPython", shell)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    assert notebook.in_notebook()
    mpm.sweep(experiment(sweep={"axes": {"kappa": [1.0, 2.0, 13.0]}}), out=tmp_path / "s", jobs=0)
    assert "0 of 3" in shown[0] and "3 of 3, 1 failed" in shown[-1] and "kappa=13" in shown[-1]
    shown.clear()
    mpm.run(experiment())
    assert "1 of 1" in shown[-1]
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: None))
    assert not notebook.in_notebook()
