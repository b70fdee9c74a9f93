"""Codecs: one folder each, found by being registered.

The command line, container, library, benchmark, contract tests and documentation know codecs only
through this registry.
"""

import dataclasses
import importlib
from typing import Any, get_type_hints

from mocapress.codecs.contract import Chunk, Codec, Encoded, Model
from mocapress.errors import ParameterError, UnsupportedError

__all__ = ["Chunk", "Codec", "Encoded", "Model", "codec", "codec_ids", "spec"]

# id -> module and class; imported when first asked for, so that one codec does not pay for others.
_REGISTRY: dict[str, tuple[str, str]] = {
    "app": ("mocapress.codecs.app", "App"),
}


def codec_ids() -> list[str]:
    """Give the ids of all registered codecs."""
    return list(_REGISTRY)


def codec(text: str) -> Codec:
    """Make a codec from ``id`` or ``id:name=value,name=value``.

    Raises
    ------
    ParameterError
        When the id, a parameter's name or its value is not known.

    """
    name, _, rest = text.partition(":")
    if name not in _REGISTRY:
        raise ParameterError("unknown codec", expected=", ".join(_REGISTRY), found=repr(name))
    module, attribute = _REGISTRY[name]
    cls: Any = getattr(importlib.import_module(module), attribute)
    types = get_type_hints(cls)
    known = {field.name: types[field.name] for field in dataclasses.fields(cls)}
    values: dict[str, Any] = {}
    for item in filter(None, rest.split(",")):
        key, equals, value = item.partition("=")
        if key not in known or not equals:
            raise ParameterError(
                f"codec {name} has no such parameter",
                expected=", ".join(f"{parameter}=…" for parameter in known),
                found=repr(item),
            )
        values[key] = _parse(known[key], value, f"{name}:{key}")
    made: Codec = cls(**values)
    return made


def spec(made: Codec) -> str:
    """Give the text that makes this codec again: only what differs from the defaults."""
    fields: Any = dataclasses.fields(made)  # type: ignore[arg-type]
    given = {field.name: getattr(made, field.name) for field in fields}
    changed = [
        f"{field.name}={given[field.name]}"
        for field in fields
        if given[field.name] != field.default
    ]
    return f"{made.id}:{','.join(changed)}" if changed else made.id


def _parse(kind: Any, text: str, where: str) -> Any:
    if kind not in (int, float, str, bool):
        raise UnsupportedError(f"{where} cannot be given as text")
    if kind is bool:
        if text not in ("true", "false"):
            raise ParameterError(where, expected="true or false", found=repr(text))
        return text == "true"
    try:
        return kind(text)
    except ValueError as error:
        raise ParameterError(where, expected=str(kind.__name__), found=repr(text)) from error
