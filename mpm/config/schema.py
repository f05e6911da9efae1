"""JSON Schema of configs, for editors: `# yaml-language-server: $schema=config.schema.json` in the first line of a config, and the file from `mpm schema`."""

from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from mpm.config.base import Kind, Model
from mpm.config.examples import example
from mpm.config.experiment import Experiment, plain
from mpm.config.schema_paths import Slot


class Plain(GenerateJsonSchema):
    """Defaults as a config would write them, and an example of every key."""

    def model_schema(self, schema: core_schema.ModelSchema) -> dict[str, Any]:
        """Of a class, with an example of each of its keys."""
        made, kind = super().model_schema(schema), schema["cls"]
        bases = tuple(base.__name__ for base in kind.__mro__)
        for name, part in made.get("properties", {}).items():
            if slot := Slot(kind).step(name):
                part["examples"] = [example(kind.__name__, name, slot, bases)]
        return made

    def encode_default(self, dft: Any) -> Any:
        """A default as a config writes it."""
        if isinstance(dft, Kind) and dft.bare() and not plain(dft, defaults=False)[dft.kind]:
            return dft.kind
        return plain(dft, defaults=False) if isinstance(dft, Model) else super().encode_default(dft)


def schema() -> dict[str, Any]:
    """JSON Schema (2020-12): kinds as oneOf, quantities as a number in SI or text with a unit, units in the descriptions,
    examples and defaults as a config writes them."""
    made = Experiment.model_json_schema(schema_generator=Plain)
    made["properties"]["extends"] = {"type": "string", "description": "a config that this one changes, relative to this file", "examples": ["base.yaml"]}
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
