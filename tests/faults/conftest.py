import sys
from pathlib import Path

import pytest

FOLDERS = Path(__file__).parent, Path(__file__).parents[1] / "fakes"
sys.path[:0] = [str(folder) for folder in FOLDERS if str(folder) not in sys.path]  # workers get their parent's module path


@pytest.fixture
def marks(tmp_path, monkeypatch):
    """Lines that the fake runner left: [what, ..., pid] each."""
    folder = tmp_path / "marks_folder"
    folder.mkdir()
    monkeypatch.setenv("FAKE_MARKS", str(folder))
    return lambda: [line.split() for line in (folder / "marks").read_text().splitlines()] if (folder / "marks").exists() else []


@pytest.fixture
def table(request):
    """table(what, measured): a row of the table that a run of these tests ends with."""
    return lambda what, measured: request.node.user_properties.append(("fault", f"| {what} | {measured} |"))


def pytest_terminal_summary(terminalreporter):
    reports = [report for outcome in ("passed", "failed") for report in terminalreporter.stats.get(outcome, [])]
    rows = [row for report in sorted(reports, key=lambda report: report.nodeid) for name, row in report.user_properties if name == "fault"]
    if rows:
        terminalreporter.write_line("\n".join(["", "| what happens | measured |", "|---|---|", *rows]))
