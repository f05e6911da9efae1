"""Reports: everything escaped, self-contained, small; in a real browser (skipped where there is none) no error, no request, and controls that work."""

import html.parser
import importlib.util
import json
import os
import re
import time
from pathlib import Path

import h5py
import pytest

import mpm
from mpm.sweep import engine

HERE = Path(__file__).parent
spec = importlib.util.spec_from_file_location("browser", HERE / "browser.py")
browsers = importlib.util.module_from_spec(spec)
spec.loader.exec_module(browsers)
NAME = "</script><script>document.title='owned'</script>"
HOSTILE = "</script><script>document.title='owned'</script><img src=x onerror=\"document.title='owned'\">'\"&{{7*7}}"


def configured(title="A slab", kappas=(1.0, 2.0, 3.0), **sections):
    body = {"shape": {"box": {"lower": [0], "upper": [0.05]}}, "material": "m", "temperature": 300}
    return {
        "title": title,
        "grid": {"dimension": 1, "size": [0.1], "cell": 1e-3},
        "bodies": {"s": body},
        "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
        "time": {"end": 10},
        "output": {"every": 1, "probes": {"centre": [0.01]}, "observables": ["temperature.mean", "time_to.centre.95_degC"]},
        "sweep": {"axes": {"kappa": list(kappas)}},
    } | sections


def sweep(folder, monkeypatch, **sections):
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    mpm.sweep(mpm.load(configured(**sections)), out=folder, jobs=0)
    return folder


SAMPLE = {"sobol": {"count": 64, "seed": 1, "ranges": {"kappa": [1, 9], "alpha": [500, 2000]}}}


def failed(folder, monkeypatch):
    return sweep(folder, monkeypatch, kappas=(13.0, 17.0))


def partly(folder, monkeypatch):
    return sweep(folder, monkeypatch, kappas=(1.0, 10.0, 13.0, 17.0))


def sample(folder, monkeypatch):
    return sweep(folder, monkeypatch, sweep={"sample": SAMPLE})


def plane(folder, monkeypatch):
    return sweep(folder, monkeypatch, sweep={"axes": {"kappa": [1, 2, 3, 4], "alpha": [500, 1000, 2000]}})


def hostile(folder, monkeypatch):
    """Script in the title, a comment, the head of a measured table, an error and a warning, names and units of a dataset; names of the config are refused."""
    import fake_runner

    monkeypatch.setattr(fake_runner, "WARNINGS", [f"volume: {HOSTILE}; {HOSTILE}"])
    before = fake_runner.run_point

    def run_point(experiment, beat=None, keeper=None):
        if experiment.materials["m"].heat.kappa.value == 3:
            raise ValueError(HOSTILE)
        return before(experiment, beat, keeper)

    monkeypatch.setattr(fake_runner, "run_point", run_point)
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    folder.parent.joinpath("curve.csv").write_text(f"minute,{NAME}_degC\n0.05,30\n0.1,40\n")
    one = configured(title=HOSTILE, kappas=(1.0, 3.0, 10.0))
    curve = {"file": "curve.csv", "time": "minute", "value": f"{NAME}_degC"}
    one["output"]["measured"] = {"centre": curve}
    with pytest.raises(mpm.ConfigError, match="not a plain name"):
        mpm.load(one | {"bodies": {NAME: one["bodies"]["s"]}})
    folder.parent.joinpath("hostile.yaml").write_text(f"# {HOSTILE}\n{json.dumps(one)}\n")
    mpm.sweep(mpm.load(folder.parent / "hostile.yaml"), out=folder, jobs=0)
    with h5py.File(folder / "sweep.nc", "r+") as file:  # as one that somebody sent: words of its own everywhere
        for name in ("kappa", "temperature_mean", "series/temperature_centre"):
            for key in ("long_name", "units", "config_path"):
                if key in file[name].attrs:
                    file[name].attrs[key] = HOSTILE
        file.attrs["name"] = file.attrs["git_revision"] = HOSTILE
    return folder


def thousand(folder, monkeypatch):
    return sweep(folder, monkeypatch, sweep={"sample": {"sobol": {**SAMPLE["sobol"], "count": 1000}}})


def fit(folder, monkeypatch):
    """Of the fake's straight line: 300 K + kappa t."""
    samples = [[float(t), 300 + 2.5 * t + 0.1 * (-1) ** t] for t in range(1, 11)]
    output = {"every": 1, "probes": {"centre": [0.01]}, "measured": {"centre": {"samples": samples}}}
    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    one = configured(output=output, sweep=None, fit={"parameters": {"kappa": {"log": [0.1, 9]}}})
    mpm.fit(mpm.load(one), out=folder, jobs=0)
    return folder


def stability(folder, monkeypatch):
    """The fake fails at conductivities of 13 and of 17."""
    from mpm.study.stability import run
    from mpm.sweep.engine import Options

    monkeypatch.setattr(engine, "RUNNER", "fake_runner")
    about = {"across": {"alpha": [500, 1000]}, "along": {"kappa": [6, 8, 13, 15.5, 17]}, "panels": {"step": {}}, "toward": "larger", "resolution": 0.05}
    one = configured(sweep=None, stability=about | {"lines": [{"label": "theory <b>", "formula": "12 + 0*x", "source": "none"}]})
    run(mpm.load(one), folder, Options(jobs=0), told=lambda text: None)
    return folder


def sensitivity(folder, monkeypatch):
    pytest.importorskip("SALib", reason="SALib is not installed")
    mpm.sensitivity(sample(folder, monkeypatch))
    return folder


SWEEPS = {"failed": failed, "partly": partly, "sample": sample, "plane": plane, "hostile": hostile, "thousand": thousand,
          "fit": fit, "stability": stability, "sensitivity": sensitivity}  # fmt: skip
STUDIES = ("fit", "stability", "sensitivity")


class Tags(html.parser.HTMLParser):
    """Tags and attributes of a page, and what text it shows."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.text = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, *pair) for pair in attrs]

    def handle_data(self, data):
        self.text.append(data)


@pytest.mark.parametrize(
    "name",
    ["failed", "partly", "plane", "hostile", *(pytest.param(one, marks=[pytest.mark.slow] * (one == "stability")) for one in STUDIES)],  # a map takes 100 s
)
def test_a_page_stands_alone_and_escapes_everything(name, tmp_path, monkeypatch):
    path = mpm.report(SWEEPS[name](tmp_path / "s", monkeypatch))
    page = path.read_text(encoding="utf-8")
    tags = Tags(page)
    assert path.name == "report.html" and tags.tags.count("script") == 2 and tags.tags.count("style") == 1
    for tag, attribute, value in tags.attributes:
        assert not attribute.startswith("on") and attribute != "style", (tag, attribute)
        if attribute in ("src", "href"):
            assert value.startswith(("data:", "#")), value[:80]
    assert "{{" not in re.sub(r"\{\{7.7\}\}", "", page) and "49" not in "".join(tags.text)[:200]
    policy = next(value for tag, attribute, value in tags.attributes if attribute == "content" and "default-src" in value)
    assert policy.startswith("default-src 'none'") and "unsafe" not in policy
    assert all(value for tag, attribute, value in tags.attributes if tag == "img" and attribute == "alt")
    shown = "".join(tags.text)
    assert "built-in method" not in page
    if name == "plane":
        assert "1, 2, 3, 4 W/m/K" in shown and "materials.m.heat.fourier.kappa" in shown
    if name in STUDIES:
        answer = {"fit": "kappa 2.5", "stability": "boundary at 12.", "sensitivity": "kappa"}[name]
        assert answer in shown and ("img", "class", name) in tags.attributes and tags.tags.count("table") >= 3
        assert {"fit": "mpm fit experiment.yaml", "stability": "mpm stability experiment.yaml", "sensitivity": "mpm sensitivity OUT"}[name] in shown
    if name == "fit":
        assert "Parameters with 95 % intervals" in shown and "materials.m.heat.fourier.kappa" in shown
    if name == "stability":
        assert "theory <b>" in shown and "b" not in tags.tags
    if name == "hostile":
        assert shown.count("document.title='owned'") >= 7  # as text: title, error, warning, a comment, a table's head, meanings, units, provenance
    if name == "failed":
        assert "no such luck" in shown and "det F <= 0" in shown


def test_a_thousand_points_are_small_and_quick(tmp_path, monkeypatch):
    folder = thousand(tmp_path / "s", monkeypatch)
    began = time.monotonic()
    path = mpm.report(folder)
    print(f"report of 1 000 points: {time.monotonic() - began:.1f} s, {path.stat().st_size / 1e6:.2f} MB")
    assert path.stat().st_size < 3e6


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    if browsers.FOUND is None:
        pytest.skip("no Chromium is installed here; apt-get install chromium-headless-shell runs this test")
    made = browsers.Browser(tmp_path_factory.mktemp("browser"))
    yield made
    made.close()


@pytest.mark.slow
@pytest.mark.parametrize("name", SWEEPS)
def test_in_a_browser(name, browser, tmp_path, monkeypatch):
    path = mpm.report(SWEEPS[name](tmp_path / "s", monkeypatch))
    for dark in (False, True):
        browser.open(path, dark=dark)
        assert not browser.errors, browser.errors
        assert [url for url in browser.requests if not url.startswith("data:")] == [path.resolve().as_uri()]
        assert browser.value("[...document.images].length >= 1 && [...document.images].every(image => image.complete && image.naturalWidth > 100)")
        assert browser.value("document.title") != "owned" and contrast(browser) >= 4.5
    if name != "failed":
        ok = browser.value("document.querySelectorAll('#chart .mark').length")
        assert ok >= {"partly": 2, "sample": 64, "plane": 12, "hostile": 2, "thousand": 1000, "fit": 4, "stability": 8, "sensitivity": 64}[name]
        before = browser.value("document.getElementById('chart').innerHTML")
        browser.value("const s = document.getElementById('up'); s.value = s.options[0].value; s.dispatchEvent(new Event('change'))")
        assert browser.value("document.getElementById('chart').innerHTML") != before
        browser.value("document.getElementById('chart').focus()")
        browser.ask("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight", code="ArrowRight")
        assert ": " in browser.value("document.getElementById('told').textContent")
        brush(browser)
        assert re.fullmatch(r"\d+ of \d+ points kept", browser.value("document.getElementById('kept').textContent"))
        browser.value("document.getElementById('clear').click()")
        assert browser.value("document.getElementById('kept').textContent") == ""
    browser.open(path, width=794)  # pixels of an A4 page
    browser.ask("Emulation.setEmulatedMedia", media="print")
    assert browser.value("document.documentElement.scrollWidth") <= 794
    assert not browser.errors, browser.errors
    browser.ask("Emulation.setEmulatedMedia", media="")
    if target := os.environ.get("SCREENSHOTS"):
        browser.screenshot(Path(target) / f"report_{name}.png")


def contrast(browser):
    """The least contrast of the palette's texts on the page (WCAG)."""
    return browser.value("""(() => {
      const style = getComputedStyle(document.documentElement), paper = style.getPropertyValue("--paper");
      const light = text => { const n = parseInt(text.trim().slice(1), 16);
        return [n >> 16, (n >> 8) & 255, n & 255].map(v => v / 255).map(v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
          .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0); };
      const ratio = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      return Math.min(...["--ink", "--quiet", "--accent", "--bad", "--good"].flatMap(name =>
        [paper, style.getPropertyValue("--shade")].map(back => ratio(light(style.getPropertyValue(name)), light(back)))));
    })()""")


def brush(browser):
    """Drag along the first axis of the parallel coordinates."""
    browser.value("document.querySelector('#parallel .handle').scrollIntoView({block: 'center'})")
    box = browser.value("(() => { const b = document.querySelector('#parallel .handle').getBoundingClientRect(); return [b.x, b.y, b.width, b.height] })()")
    x = box[0] + box[2] / 2
    browser.mouse("mousePressed", x, box[1] + 0.2 * box[3])
    for part in (0.3, 0.5, 0.6):
        browser.mouse("mouseMoved", x, box[1] + part * box[3])
    browser.mouse("mouseReleased", x, box[1] + 0.6 * box[3])


def test_results_without_snapshots_get_the_page_without_a_movie(tmp_path, monkeypatch, capsys):
    from mpm_cli.main import main

    sweep(tmp_path / "out", monkeypatch)
    assert main(["report", str(tmp_path / "out"), "--movie", "--paraview", "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out) == {"file": str(tmp_path / "out/report.html"), "also": []} and (tmp_path / "out/report.html").exists()
    assert re.search(r"^no movie: .*κ = 2 W/m/K: there are no snapshots; output\.snapshots in the config asks for them$", err, re.MULTILINE)
    assert "no file for ParaView: " in err
