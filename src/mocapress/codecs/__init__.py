"""Codecs: one folder each, found by being registered.

The command line, container, library, benchmark, contract tests and documentation know codecs only
through this registry.
"""

import dataclasses
import importlib
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, get_type_hints

from mocapress.codecs.contract import (
    NO_OTHERS,
    Bound,
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Origin,
    Others,
    Scope,
    Together,
    digest_of,
)
from mocapress.errors import ParameterError, UnsupportedError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoints

__all__ = [
    "DEFAULT_CODEC",
    "GROUP",
    "LEVELS",
    "NO_OTHERS",
    "Bound",
    "Capabilities",
    "Chunk",
    "Codec",
    "Encoded",
    "Model",
    "Origin",
    "Others",
    "Scope",
    "Together",
    "codec",
    "codec_ids",
    "digest_of",
    "from_parameters",
    "learner",
    "parameters",
    "spec",
    "with_level",
]

DEFAULT_CODEC = "exact"
LEVELS = range(1, 10)
"""From the fastest to the strongest, of codecs with the parameter ``level``."""

GROUP = "mocapress.codecs"
"""The group of entry points by which other packages add codecs: id -> class."""

# id -> module and class; imported when first asked for, so that one codec does not pay for others.
_REGISTRY: dict[str, tuple[str, str]] = {
    "exact": ("mocapress.codecs.exact", "Exact"),
    "app": ("mocapress.codecs.app", "App"),
    "diffma": ("mocapress.codecs.diffma", "DiffMA"),
    "mrpa": ("mocapress.codecs.mrpa", "Mrpa"),
    "near": ("mocapress.codecs.near", "Near"),
    "patterns": ("mocapress.codecs.patterns", "Patterns"),
    "qssd": ("mocapress.codecs.qssd", "QSSD"),
}


def codec_ids() -> list[str]:
    """Give the ids of all codecs: those of mocapress, then those of other packages."""
    return list(dict.fromkeys([*_REGISTRY, *sorted(_of_others().names)]))


def _class(name: str) -> Any:
    """Find the class of a codec.

    Raises
    ------
    ParameterError
        When there is no such codec.
    UnsupportedError
        When the package that has it cannot be imported.

    """
    if name in _REGISTRY:
        module, attribute = _REGISTRY[name]
        return getattr(importlib.import_module(module), attribute)
    for entry in _of_others().select(name=name):
        try:
            found = entry.load()
            if not issubclass(found, Codec):
                raise ImportError(f"{entry.value} is not a mocapress.codecs.Codec")
            return found
        except (ImportError, AttributeError, TypeError) as error:
            package = entry.dist.name if entry.dist else entry.module
            raise UnsupportedError(f"codec {name} of {package} cannot be used: {error}") from error
    raise ParameterError("unknown codec", expected=", ".join(codec_ids()), found=repr(name))


def _of_others() -> "EntryPoints":
    from importlib.metadata import entry_points

    return entry_points(group=GROUP)


def codec(text: str) -> Codec:
    """Make a codec from ``id`` or ``id:name=value,name=value``.

    Raises
    ------
    ParameterError
        When the id, a parameter's name or its value is not known.
    UnsupportedError
        When the codec is another package's, which cannot be imported.

    """
    name, _, rest = text.partition(":")
    cls = _class(name)
    known = _types(cls)
    values: dict[str, Any] = {}
    for item in filter(None, rest.split(",")):
        key, equals, value = item.partition("=")
        if equals and key and key not in known and cls.rest:
            values[cls.rest] = ",".join(filter(None, (values.get(cls.rest), item)))
            continue
        if key not in known or not equals:
            raise ParameterError(
                f"codec {name} has no such parameter",
                expected=", ".join(f"{parameter}=…" for parameter in known),
                found=repr(item),
            )
        if key in values:
            raise ParameterError(f"{name}:{key}", expected="it once", found="it again")
        values[key] = _parse(known[key], value, f"{name}:{key}")
    made: Codec = cls(**values)
    return made


def codec_for(text: str, model: Model | None) -> Codec:
    """Make a codec of its text that is to learn a model, or to code with the one given.

    Where the text names no level, this is the model's; to learn, the strongest.

    Raises
    ------
    ParameterError
        As ``codec``; or when it does not learn, or the model is another codec's.
    UnsupportedError
        When the codec is another package's, which cannot be imported.
    CorruptError
        When the model is no sound one.

    """
    made = learner(codec(text), model)
    named = {item.partition("=")[0] for item in text.partition(":")[2].split(",")}
    return made if "level" in named else made.for_model(model)


def spec(made: Codec) -> str:
    """Give the text that makes this codec again: only what differs from the defaults."""
    fields: Any = dataclasses.fields(made)  # type: ignore[arg-type]
    given = {field.name: getattr(made, field.name) for field in fields}
    changed = [
        given[field.name] if field.name == made.rest else f"{field.name}={given[field.name]}"
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
    cls = _class(name)
    types = _types(cls)
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


def learner(made: Codec, model: Model | None = None) -> Codec:
    """Give a codec back after checking that it learns, and that a model is its own.

    Raises
    ------
    ParameterError
        When it does not learn, or the model is another codec's.

    """
    if not made.can.trains:
        raise ParameterError(f"codec {made.id} takes no model")
    if model is not None and model.codec != made.id:
        raise ParameterError("model of another codec", expected=made.id, found=repr(model.codec))
    return made


def with_level(made: Codec, level: int) -> Codec:
    """Give the codec at a level, 1 to 9.

    Raises
    ------
    ParameterError
        When the codec has no levels, or not this one.

    """
    if not made.can.levels:
        raise ParameterError(f"codec {made.id} has no levels")
    if level not in LEVELS:
        raise ParameterError("level", expected="1 to 9", found=repr(level))
    leveled: Codec = dataclasses.replace(made, level=level)  # type: ignore[type-var]
    return leveled


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
        expected = "a number" if kind is float else "a whole number"
        raise ParameterError(where, expected=expected, found=repr(text)) from error
