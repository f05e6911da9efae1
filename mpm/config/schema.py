"""JSON Schema of configs, for editors: `# yaml-language-server: $schema=config.schema.json` in the first line of a config, and the file from `mpm schema`."""

from typing import Any

from mpm.config.experiment import Experiment


def schema() -> dict[str, Any]:
    """JSON Schema (2020-12): kinds as oneOf, quantities as a number in SI or text with a unit, units in the descriptions."""
    made = Experiment.model_json_schema()
    made["properties"]["extends"] = {"type": "string", "description": "a config that this one changes, relative to this file"}
    whole: dict[str, Any] = {"required": made.pop("required"), "properties": {}}
    for name, part in made["properties"].items():
        if needed := made["$defs"].get(part.get("$ref", "").rpartition("/")[2], {}).pop("required", None):
            whole["properties"][name] = {"required": needed}
    made["anyOf"] = [whole, {"required": ["extends"]}]  # what another file says need not be said again
    tidy(made)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **made, "title": "mpm experiment"}


def tidy(part: Any) -> None:
    """Units into the descriptions; no titles that only repeat the key."""
    if isinstance(part, dict):
        if isinstance(part.get("title"), str):
            part.pop("title")
        if isinstance(part.get("default"), dict):
            part.pop("default")
        for choice in part.get("anyOf", ()):
            if "x-unit" in choice and "x-unit" not in part:  # a quantity or nothing
                part["x-unit"] = choice.pop("x-unit")
        if isinstance(unit := part.get("x-unit"), str):
            part.pop("x-unit")
            part["description"] = f"{part.get('description', '')} [{unit}]".strip()
        for inner in part.values():
            tidy(inner)
    elif isinstance(part, list):
        for inner in part:
            tidy(inner)
