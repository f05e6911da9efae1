"""A config that is partly wrong, as far as it can be read: so that checks across sections still run and all errors are told at once.

What failed is `MISSING`; whatever a check does with it raises `Unknown`, and that one check is skipped.
"""

from typing import Any, get_args, get_origin

from pydantic import TypeAdapter, ValidationError

from mpm.config.base import Model
from mpm.config.schema_paths import Slot


class Unknown(Exception):
    """A check needs a value that is not known."""


class Missing:
    """A value that is absent or wrong."""

    def _unknown(self, *_: Any) -> Any:
        raise Unknown

    __getattr__ = __getitem__ = __iter__ = __len__ = __bool__ = __contains__ = __float__ = __eq__ = __lt__ = __gt__ = __le__ = __ge__ = _unknown
    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __hash__ = _unknown


MISSING = Missing()


def loose(slot: Slot, raw: Any) -> Any:
    """`raw` validated as far as possible; MISSING in place of what is wrong."""
    try:
        return TypeAdapter(slot.annotated).validate_python(raw)
    except ValidationError:
        pass  # told by explain.py; here we go on with its parts
    if slot.menu:
        key = next(iter(raw)) if isinstance(raw, dict) and len(raw) == 1 else None
        return model(slot.menu.kinds[key], raw[key]) if key in slot.menu.kinds and isinstance(raw[key], dict) else MISSING
    if slot.model:
        return model(slot.model, raw) if isinstance(raw, dict) else MISSING
    if get_origin(slot.type) is dict and isinstance(raw, dict):
        return {key: loose(slot.under(key), item) for key, item in raw.items()}
    if get_origin(slot.type) is tuple and isinstance(raw, list | tuple) and get_args(slot.type):
        return tuple(loose(slot.under(index), item) for index, item in enumerate(raw))
    return MISSING


def model(kind: type[Model], raw: dict) -> Any:
    """A model whose wrong fields are MISSING."""
    values = {}
    for name, field in kind.model_fields.items():
        if name in raw:
            optional = raw[name] is None and not field.is_required() and field.default is None
            values[name] = None if optional else loose(Slot(kind).under(name), raw[name])
        else:
            values[name] = MISSING if field.is_required() else field.get_default()
    return kind.model_construct(**values)
