"""Named parameters: `parameters: {thickness: 25 mm}` and, wherever a number stands, `=thickness` or a formula over names, `=thickness / 2`.

    named(root)     the section with its units, before overrides: `{value: 25 mm, unit: m}`
    bind(root)      the config with numbers in place of formulas, and `formulas`: which path follows from which formula

A point of a sweep carries numbers alone, so that two configs that come to the same numbers are the same run; `formulas` lets a sweep or a fit of a
parameter set them anew (config.vary). Formulas reckon in SI. A name alone must have the dimension of its place; of longer formulas it is not checked.
"""

import math
from dataclasses import replace
from typing import Any

from pydantic import ValidationInfo, field_validator, model_validator

from mpm.config.base import Model, doc, problem
from mpm.config.condition import ConditionError, Formula
from mpm.config.explain import Finding
from mpm.config.nodes import BAD, Node
from mpm.config.problems import listed, near
from mpm.config.quantities import Number, Quantity
from mpm.config.schema_paths import Path, Slot

SIGN = "="
APART = ("title", "sweep", "smoke", "chart", "stability", "fit", "formulas")  # hold no number of the scene


class Named(Model):
    """A named parameter: a number, or text with a unit; as a mapping it may say more."""

    value: Number = doc(description="the number, in SI or as text with a unit; or a formula over parameters above it, as in '=thickness / 2'")
    unit: str = doc("", description="SI unit of the value; from its text unless given")
    label: str = doc("", description="what it is, for datasets and figures")

    @model_validator(mode="before")
    @classmethod
    def short(cls, data: Any) -> Any:
        """A number or a text alone is the value; a text is converted to the unit."""
        given = dict(data) if isinstance(data, dict) else {"value": data} if not isinstance(data, cls) else data
        if isinstance(given, dict) and isinstance(text := given.get("value"), str):
            unit = given.get("unit") or unit_of(text)
            if unit:
                given |= {"value": quantity(f"parameter in {unit}", unit).validate(text), "unit": unit}
        return given

    @field_validator("unit")
    @classmethod
    def coherent(cls, unit: str, info: ValidationInfo) -> str:
        """Numbers are in SI: 25 with `unit: mm` would be 25 m."""
        if is_coherent(unit):
            return unit
        right = unit_of(f"1 {unit}")
        instead = f"value: {info.data.get('value', 1.0):g} {unit}, and no unit, or unit: {right}" if right else "a unit of SI, or no unit"
        raise problem("unit", f"{unit!r} is no SI unit, and numbers are in SI", instead)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict:
        return {"anyOf": [{"type": "number"}, {"type": "string"}, handler(schema)], "description": "a number, text with a unit, or {value, unit, label}"}


def quantity(name: str, unit: str) -> Quantity:
    """What a parameter of a unit may be."""
    return Quantity(unit, name)


def unit_of(text: str) -> str:
    """The SI unit that a text's own unit converts to; empty where it has none that is known."""
    from mpm.config.units import UnitError, si

    try:
        return si(text)
    except UnitError:
        return ""


def is_coherent(unit: str) -> bool:
    """Whether a number in this unit is the number in SI."""
    from mpm.config.units import SI  # pint is loaded for other units only

    return unit in ("", "1", *SI) or ((right := unit_of(f"1 {unit}")) != "" and as_written(f"1 {unit}", right) == 1.0)


def as_written(text: str, unit: str, difference: bool = False) -> float:
    """The number of a text in a unit; NaN where it is none."""
    from mpm.config.units import UnitError, convert

    try:
        return convert(text, unit, "parameter", difference)
    except UnitError:
        return math.nan


def slot_of(name: str, named: Any, difference: bool = False) -> Slot:
    """What a parameter's value may be, with its unit. `difference`: it stands where a difference of temperatures does, and degC is one there."""
    unit = getattr(named, "unit", "")
    label = getattr(named, "label", "")
    may_be = replace(quantity(name, unit if isinstance(unit, str) else ""), difference=difference)
    return Slot(float, (may_be,), (label if isinstance(label, str) else "") or name)


def named(root: Node) -> None:
    """Write every parameter as a mapping with its unit, so that an override by a plain number keeps the unit."""
    section = root.value.get("parameters") if isinstance(root.value, dict) else None
    if section is None or not isinstance(section.value, dict):
        return
    made = Node({}, section.origin, section.line, section.column, dict(section.keys))
    for name, node in section.value.items():
        whole = node if isinstance(node.value, dict) else Node({"value": node}, node.origin, node.line, node.column, {"value": section.keys[name]})
        text = value.value if (value := whole.value.get("value")) is not None else None
        if isinstance(text, str) and not text.startswith(SIGN) and "unit" not in whole.value and (unit := unit_of(text)):
            whole = Node({**whole.value, "unit": Node(unit, node.origin, node.line, node.column)}, *placed(whole))
        made.value[name] = whole
    root.value = {**root.value, "parameters": made}


def placed(node: Node) -> tuple:
    """Where a node stands."""
    return node.origin, node.line, node.column, node.keys


class Binder:
    """Puts numbers in the place of formulas; what is wrong collects in `found`."""

    def __init__(self, root: Node, whole: Slot):
        self.root, self.whole = root, whole
        self.found: list[Finding] = []
        self.formulas: dict[str, str] = {}
        self.values: dict[str, float] = {}
        self.units: dict[str, str] = {}
        self.wrong: set[str] = set()  # parameters that are told as such
        self.scales: dict[str, str] = {}  # the texts of those that are temperatures on a scale, as 20 degC, and no differences

    def bind(self) -> Node:
        """A root with numbers alone, and `formulas`."""
        section = self.root.value.get("parameters")
        kept = self.root.value.get("formulas")
        if (section is None or not isinstance(section.value, dict)) and not self.has_formula():
            return self.root
        root = Node(dict(self.root.value), *placed(self.root))
        if section is not None and isinstance(section.value, dict):
            root.value["parameters"] = self.parameters(section, kept)
        for key, node in root.value.items():
            if key not in (*APART, "parameters"):
                root.value[key] = self.walk(node, (key,))
        for path, text in kept.plain().items() if kept is not None and isinstance(kept.value, dict) else ():
            if path not in self.formulas and not path.startswith("parameters."):
                self.again(root, tuple(path.split(".")), str(text))
        if self.formulas:
            root.value["formulas"] = Node({path: Node(text, root.origin) for path, text in self.formulas.items()}, root.origin)
        return root

    def has_formula(self) -> bool:
        """Whether a text anywhere begins with the sign."""
        left = [node for key, node in self.root.value.items() if key not in APART]
        while left:
            node = left.pop()
            if isinstance(node.value, dict):
                left += node.value.values()
            elif isinstance(node.value, list):
                left += node.value
            elif isinstance(node.value, str) and node.value.startswith(SIGN):
                return True
        return False

    def parameters(self, section: Node, kept: Node | None) -> Node:
        """The section, in the order of the file; one may follow from those above it."""
        made = Node(dict(section.value), *placed(section))
        before = kept.plain() if kept is not None and isinstance(kept.value, dict) else {}
        for name, node in section.value.items():
            value = node.child("value") if isinstance(node.value, dict) else None
            if value is None or value.value is BAD:
                self.wrong.add(name)
                continue
            path: Path = ("parameters", name, "value")
            unit = node.child("unit")
            self.units[name] = unit.value if unit is not None and isinstance(unit.value, str) else ""
            if (known := before.get(f"parameters.{name}.value")) is not None and not isinstance(value.value, str):
                value = Node(SIGN + str(known), *placed(value))
            if isinstance(value.value, str) and value.value.startswith(SIGN):
                value = self.formula(value, path)
                made.value[name] = Node({**node.value, "value": value}, *placed(node))
            try:
                number = quantity(name, self.units[name]).validate(value.value) if value.value is not BAD else None
            except ValueError:
                number = None  # told when the section is validated
            if number is None or not is_coherent(self.units[name]):
                self.wrong.add(name)
            else:
                self.values[name] = number
                if self.units[name] == "K" and isinstance(value.value, str) and as_written(value.value, "K", difference=True) != number:
                    self.scales[name] = value.value
        return made

    def walk(self, node: Node, path: Path) -> Node:
        """A node with numbers in place of formulas."""
        if isinstance(node.value, dict):
            return Node({key: self.walk(inner, (*path, key)) for key, inner in node.value.items()}, *placed(node))
        if isinstance(node.value, list):
            return Node([self.walk(inner, (*path, index)) for index, inner in enumerate(node.value)], *placed(node))
        if isinstance(node.value, str) and node.value.startswith(SIGN):
            return self.formula(node, path)
        return node

    def again(self, root: Node, path: tuple[str, ...], text: str) -> None:
        """A place that followed from a formula when the config was written down."""
        node, keys = root, []
        for word in path:
            key = int(word) if isinstance(node.value, list) and word.isdigit() else word
            keys.append(key)
            parent, below = node, node.child(key)
            if below is None:
                return  # another kind stands there now
            node = below
        if not isinstance(node.value, str | dict | list) and node.value is not BAD:
            parent.value[keys[-1]] = self.formula(Node(SIGN + text, *placed(node)), tuple(keys))

    def formula(self, node: Node, path: Path) -> Node:
        """The number that a formula comes to, at its place; BAD where it is wrong."""
        text = node.value.removeprefix(SIGN).strip()
        try:
            formula = Formula(text)
            unknown = [name for name in formula.names if name not in self.values]
            if self.wrong.intersection(unknown):
                return Node(BAD, *placed(node))
            if unknown:
                said = f"there is no parameter {unknown[0]!r}" + (" above this one" if path[0] == "parameters" else "")
                self.report(path, said, listed(list(self.values)) or "a name under `parameters:`", near(unknown[0], list(self.values)), text)
                return Node(BAD, *placed(node))
            value = formula(self.values)
        except ConditionError as error:
            self.report(path, str(error), Formula.allowed, "", text)
            return Node(BAD, *placed(node))
        if wrong := self.mismatch(formula, path, text):
            self.report(path, wrong[0], wrong[1], "", text)
            return Node(BAD, *placed(node))
        self.formulas[".".join(map(str, path))] = text
        return Node(value, *placed(node))

    def mismatch(self, formula: Formula, path: Path, text: str) -> tuple[str, str] | None:
        """What is wrong with the dimension of a name alone, and what would be right; None where nothing is, or nothing is known."""
        from mpm.config.units import alike

        slot = self.whole.walk(path)
        wanted = slot.quantity if slot is not None else None
        unit = self.units.get(text, "")
        if text not in formula.names or not unit or wanted is None or path[0] == "parameters":
            return None
        if text in self.scales and wanted.difference and wanted.unit == "K":
            said = f"{text} is a temperature ({self.scales[text]}), and a {wanted.name} is expected"
            return said, f"parameters: {{{text}: {as_written(self.scales[text], 'K', difference=True):g} K}}"
        if alike(unit, wanted.unit):
            return None
        said = f"{text} is in {unit}, and a {wanted.name}" + (f" in {wanted.unit}" if wanted.unit else "") + " is expected"
        return said, "a parameter of the dimension of its place"

    def report(self, path: Path, message: str, allowed: str, suggestion: str, text: str) -> None:
        """What is wrong with a formula at a path."""
        self.found.append(Finding(path, message, allowed, suggestion, given=SIGN + text))
