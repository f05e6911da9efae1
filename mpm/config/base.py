"""Model, Kind, Menu: the three words that every config model is built from.

Model   a mapping with fixed keys: `grid: {dimension: 2, cell: 1e-3}`
Kind    a model that is named by the single key of its mapping: `{hencky: {E: 12e3, nu: 0.15}}`
Menu    the kinds that one field allows. To add a kind, write its class and add it to the list that the
        menu is made of; paths, errors, sweeps and schema follow.

A kind whose fields all have defaults may be written as a bare string: `transfer: apic`, `walls: {bottom: stick}`.
"""

import re
from typing import Annotated, Any, ClassVar, Union, get_args

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError, core_schema

doc = Field  # read as `kappa: Law = doc(description=...)`


class Model(BaseModel):
    """A mapping with fixed keys; frozen, no unknown keys, tuples for lists."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=False, protected_namespaces=(), hide_input_in_errors=True)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict:
        return cls.written(handler(schema), handler)

    @classmethod
    def written(cls, made: dict, handler: Any) -> dict:
        """The JSON schema of what a config holds, from that of the fields: the same, but for classes that are written in another way."""
        return made


class Kind(Model):
    """A model named by the single key of its mapping."""

    kind: ClassVar[str]

    @classmethod
    def bare(cls) -> bool:
        """Whether the kind's name alone says it (no field is required)."""
        return not any(field.is_required() for field in cls.model_fields.values())


def problem(type_: str, message: str, allowed: Any = (), suggestion: str = "", at: tuple = ()) -> PydanticCustomError:
    """An error with what errors.py needs to say it well: the allowed values, a suggestion, and the keys below the field to point at."""
    context = {"message": message, "allowed": allowed, "suggestion": suggestion, "at": at}
    return PydanticCustomError(type_, "{message}", context)


class Choice:
    """Annotation of a Literal: exactly one of its words or numbers (`true` is not 1), or an error that lists them. `pattern`: words like `example` too."""

    def __init__(self, pattern: str = "", example: str = ""):
        self.pattern, self.example = pattern, example

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        allowed = get_args(source)

        def validate(value: Any) -> Any:
            if not isinstance(value, bool) and isinstance(value, str | int | float):
                for word in allowed:
                    if word == value:
                        return word
                if self.pattern and re.fullmatch(self.pattern, str(value)):
                    return value
            raise problem("choice", "none of the allowed values", [*allowed, *([self.example] if self.pattern else [])])

        written: dict[str, Any] = {"enum": list(allowed)}
        if self.pattern:
            written = {"anyOf": [written, {"type": "string", "pattern": f"^{self.pattern}$", "examples": [self.example]}]}
        return core_schema.no_info_plain_validator_function(validate, metadata={"pydantic_js_functions": [lambda schema, handler: written]})


class Menu:
    """Annotation of a field that holds one of several kinds; see `one_of`."""

    def __init__(self, what: str, *kinds: type[Kind]):
        self.what = what
        self.kinds = {kind.kind: kind for kind in kinds}

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        choices: dict[Any, Any] = {
            name: core_schema.no_info_before_validator_function(unwrap, handler.generate_schema(kind)) for name, kind in self.kinds.items()
        }
        return core_schema.no_info_before_validator_function(self.check, core_schema.tagged_union_schema(choices, discriminator=tag))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        choices = []
        for name, kind in self.kinds.items():
            inner = kind.written(handler(kind.__pydantic_core_schema__), handler)
            if "$ref" in inner:  # a kind within a kind: named once, described wherever it stands
                inner = {**inner, "description": handler.resolve_ref_schema(inner).get("description", self.what)}
            choices.append({"type": "object", "properties": {name: inner}, "required": [name], "additionalProperties": False})
        bare = [name for name, kind in self.kinds.items() if kind.bare()]
        return {"oneOf": [*choices, *([{"enum": bare}] if bare else [])], "description": self.what}

    def check(self, value: Any) -> Any:
        """One known kind, or an error that lists them."""
        names = list(self.kinds)
        if isinstance(value, Kind):
            return value
        if isinstance(value, str):
            if value not in self.kinds:
                raise problem("kind", f"unknown {self.what} {value!r}", names)
            if not self.kinds[value].bare():
                parameters = ", ".join(f"{key}: ..." for key in self.kinds[value].model_fields)
                raise problem("kind", f"{self.what} {value!r} needs its parameters", f"{{{value}: {{{parameters}}}}}")
            return value
        if not isinstance(value, dict):
            raise problem("kind", f"expected a mapping with one key that names the {self.what}", names)
        unknown = [key for key in value if key not in self.kinds]
        if unknown:
            raise problem("kind", f"unknown {self.what} {unknown[0]!r}", names, at=(unknown[0],))
        if len(value) != 1:
            said = " and ".join(repr(key) for key in value) if value else "none"
            raise problem("kinds", f"expected exactly one {self.what}, found {said}", names, at=tuple(value)[1:2])
        return value


def one_of(what: str, *kinds: type[Kind]) -> Any:
    """The type of a field that holds one of several kinds: `elastic: one_of("elastic law", *ELASTIC) | None`."""
    return Annotated[Union[kinds], Menu(what, *kinds)]  # noqa: UP007


def tag(value: Any) -> str:
    """The name of the kind in `{name: {...}}`, in `name`, or of a model that is already built."""
    if isinstance(value, Kind):
        return value.kind
    return value if isinstance(value, str) else next(iter(value))


def unwrap(value: Any) -> Any:
    """What lies under the kind's name; `{apic: }` and `apic` are `{apic: {}}`."""
    if isinstance(value, Kind):
        return value
    inner = {} if isinstance(value, str) else next(iter(value.values()))
    return {} if inner is None else inner
