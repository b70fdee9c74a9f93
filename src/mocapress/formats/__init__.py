"""Formats of motion files: one file each, found by being registered.

Everything outside this folder knows formats only through this registry. Other packages add theirs
by an entry point of the group ``mocapress.formats`` that names a ``Format``.
"""

import warnings
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points

from mocapress.errors import ParameterError, UnsupportedError
from mocapress.formats.contract import Format, Split
from mocapress.formats.encodings import head_as_utf8

__all__ = [
    "Format",
    "Split",
    "by_id",
    "by_name",
    "configured",
    "for_writing",
    "formats",
    "listed",
    "readable",
    "recognise",
    "suffixes",
    "writable",
]

GROUP = "mocapress.formats"
# Modules whose ``FORMAT`` is asked in this order; an ASF can look like an AMC, too.
_OWN = ("c3d", "npy", "npz", "bvh", "asf", "amc", "trc", "tables", "parquet", "gltf")
_HEAD = 2**16


@cache
def _own() -> tuple[Format, ...]:
    return tuple(import_module(f"mocapress.formats.{name}").FORMAT for name in _OWN)


@cache
def _others() -> tuple[Format, ...]:
    """Load the formats of other packages: only when none of our own will do, for it takes time."""
    found = []
    for offer in entry_points(group=GROUP):
        try:
            made = offer.load()
        except Exception as error:  # noqa: BLE001 - another package's fault must not stop ours
            made = error
        if isinstance(made, Format):
            found.append(made)
        else:
            text = f"format {offer.name} ({offer.value}) is left out: {made!r}"
            warnings.warn(text, stacklevel=2)
    return tuple(found)


def _all() -> Iterator[Format]:
    yield from _own()
    yield from _others()


def formats() -> tuple[Format, ...]:
    """Give all formats, our own first."""
    return tuple(_all())


def readable() -> tuple[Format, ...]:
    """Give the formats of motion that can be read."""
    return tuple(made for made in _all() if made.split or made.read)


def writable() -> tuple[Format, ...]:
    """Give the formats that clips can be written in."""
    return tuple(made for made in _all() if made.write)


def by_id(name: str) -> Format:
    """Give the format of an id.

    Raises
    ------
    UnsupportedError
        When there is no such format.

    """
    found = next((made for made in _all() if made.id == name), None)
    if found is None:
        raise UnsupportedError(
            "unknown format",
            expected=", ".join(sorted(made.id for made in _all())),
            found=repr(name),
        )
    return found


def configured(text: str) -> Format:
    """Give the format of an id with options of writing: ``glb`` or ``glb:max=0.1cm,unit=cm``.

    Raises
    ------
    ParameterError
        When it has no such option, or not with this value.
    UnsupportedError
        When there is no such format.

    """
    name, _, rest = text.partition(":")
    found = by_id(name)
    if not rest:
        return found
    if found.configured is None:
        raise ParameterError(f"format {name} has no options", found=repr(rest))
    parts = [item.partition("=") for item in rest.split(",")]
    return found.configured({key: value for key, _, value in parts})


def by_name(file: str) -> Format | None:
    """Tell a format from a file's name."""
    name = file.lower()
    return next((made for made in _all() if name.endswith(made.suffixes)), None)


def for_writing(file: str) -> Format | None:
    """Tell from a file's name the format in which a clip is written to it."""
    found = by_name(file)
    if found is None or not file.lower().endswith(found.written or found.suffixes):
        return None
    return found if found.write else None


def recognise(data: bytes, file: str = "") -> Format | None:
    """Tell a format that can be read from a file's contents, then from its name."""
    head = head_as_utf8(data[:_HEAD]).lstrip(b"\xef\xbb\xbf \t\r\n")
    found = next((made for made in _all() if made.recognises(head)), None)
    if found is None:
        found = by_name(file)
    return found if found and (found.split or found.read or found.read_skeleton) else None


def suffixes(of: Iterable[Format]) -> tuple[str, ...]:
    """Give the endings of formats' files, for finding them in folders."""
    return tuple(sorted({suffix for made in of for suffix in made.suffixes}))


def listed(of: Iterable[Format], last: str = "or") -> str:
    """List formats for people: ``AMC, ASF or BVH``."""
    *some, final = sorted(made.name for made in of)
    return f"{', '.join(some)} {last} {final}" if some else final
