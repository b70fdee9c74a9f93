"""Codecs: one folder each, found by being registered.

The command line, container, library, benchmark, contract tests and documentation know codecs only
through this registry.
"""

import dataclasses
import importlib
from collections.abc import Mapping
from functools import cache
from typing import Any, get_type_hints

from mocapress.codecs.contract import Chunk, Codec, Encoded, Model, Trainable
from mocapress.errors import ParameterError, UnsupportedError

__all__ = [
    "DEFAULT_CODEC",
    "LEVELS",
    "Chunk",
    "Codec",
    "Encoded",
    "Model",
    "codec",
    "codec_ids",
    "from_parameters",
    "has_level",
    "learner",
    "parameters",
    "spec",
    "with_level",
]

DEFAULT_CODEC = "exact"
LEVELS = range(1, 10)
"""From the fastest to the strongest, of codecs with the parameter ``level``."""

# id -> module and class; imported when first asked for, so that one codec does not pay for others.
_REGISTRY: dict[str, tuple[str, str]] = {
    "exact": ("mocapress.codecs.exact", "Exact"),
    "app": ("mocapress.codecs.app", "App"),
    "diffma": ("mocapress.codecs.diffma", "DiffMA"),
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
    cls, known = _class(name)
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


def parameters(made: Codec) -> dict[str, int | float | str | bool]:
    """Give all parameters of a codec, as a file keeps them."""
    fields: Any = dataclasses.fields(made)  # type: ignore[arg-type]
    return {field.name: getattr(made, field.name) for field in fields}


def from_parameters(name: str, given: Mapping[str, int | float | str | bool]) -> Codec:
    """Make a codec of its id and parameters; those that are missing have their usual values.

    Raises
    ------
    ParameterError
        When the id, a parameter's name or its value is not known.

    """
    cls, types = _class(name)
    for parameter, value in given.items():
        kind = types.get(parameter)
        # A bool is an int to Python, not to a file; a whole number may stand for a float.
        if type(value) is not kind and not (kind is float and type(value) is int):
            raise ParameterError(
                f"codec {name} has no such parameter",
                expected=", ".join(types),
                found=f"{parameter}={value!r}",
            )
    built: Codec = cls(**given)
    return built


def learner(made: Codec, model: Model | None = None) -> Trainable:
    """Give the codec as one that learns, and check that a model is its own.

    Raises
    ------
    ParameterError
        When it does not learn, or the model is another codec's.

    """
    if not isinstance(made, Trainable):
        raise ParameterError(f"codec {made.id} takes no model")
    if model is not None and model.codec != made.id:
        raise ParameterError("model of another codec", expected=made.id, found=repr(model.codec))
    return made


def has_level(made: Codec) -> bool:
    """Tell whether a codec has the parameter ``level``."""
    return "level" in {field.name for field in dataclasses.fields(made)}  # type: ignore[arg-type]


def with_level(made: Codec, level: int) -> Codec:
    """Give the codec at a level, 1 to 9.

    Raises
    ------
    ParameterError
        When the codec has no levels, or not this one.

    """
    if not has_level(made):
        raise ParameterError(f"codec {made.id} has no levels")
    if level not in LEVELS:
        raise ParameterError("level", expected="1 to 9", found=repr(level))
    leveled: Codec = dataclasses.replace(made, level=level)  # type: ignore[type-var]
    return leveled


def _class(name: str) -> tuple[Any, dict[str, Any]]:
    """Give the class of an id, and the types of its parameters."""
    if name not in _REGISTRY:
        raise ParameterError("unknown codec", expected=", ".join(_REGISTRY), found=repr(name))
    module, attribute = _REGISTRY[name]
    cls: Any = getattr(importlib.import_module(module), attribute)
    return cls, _types(cls)


@cache
def _types(cls: Any) -> dict[str, Any]:
    types = get_type_hints(cls)
    return {field.name: types[field.name] for field in dataclasses.fields(cls)}


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
