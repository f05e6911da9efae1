"""The schema that the shipped configs name in their first line is the one the models give."""

import json
from pathlib import Path

import mpm

SHIPPED = Path(__file__).parents[2] / "configs" / "schema.json"


def test_shipped_schema_is_current():
    """Fails after a change of the models: run `mpm schema > configs/schema.json`."""
    assert json.loads(SHIPPED.read_text(encoding="utf-8")) == json.loads(json.dumps(mpm.schema()))
