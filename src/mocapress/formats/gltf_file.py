"""GLB and glTF files as such: a JSON document and arrays of numbers in it."""

import base64
import binascii
import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import FormatError

MAGIC = b"glTF"
_HEADER = struct.Struct("<4sII")
_CHUNK = struct.Struct("<I4s")
_JSON, _BINARY = b"JSON", b"BIN\0"
_EMBEDDED = "data:"

_KINDS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""Numbers by the code that glTF has for them."""
_CODES = {np.dtype(kind).str: code for code, kind in _KINDS.items()}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_TYPES = {size: name for name, size in _SIZES.items()}
_MOST_NUMBERS = 2**28

Array = NDArray[np.float64]


class Node(NamedTuple):
    """An item of the document, with its place in it for messages."""

    place: str
    facts: dict[str, Any]

    def whole(self, name: str, most: int, default: int | None = None) -> int:
        """Give a whole number from 0 to ``most - 1``.

        Raises
        ------
        FormatError
            When it is none.

        """
        found = self.facts.get(name, default)
        if isinstance(found, int) and not isinstance(found, bool) and 0 <= found < most:
            return found
        raise self.fault(name, f"a whole number below {most}", found)

    def wholes(self, name: str, most: int) -> list[int]:
        """Give several of them; none where there is no such list."""
        found = self.facts.get(name, [])
        if isinstance(found, list):
            items = {str(i): one for i, one in enumerate(found)}
            return [Node(f"{self.place}.{name}", items).whole(i, most) for i in items]
        raise self.fault(name, "a list", found)

    def numbers(self, name: str, default: tuple[float, ...]) -> Array:
        """Give as many finite numbers as the default has."""
        found = self.facts.get(name, default)
        numbers = isinstance(found, list | tuple) and all(
            isinstance(one, int | float) and not isinstance(one, bool) for one in found
        )
        if numbers and len(found) == len(default):
            try:
                given = np.array(found, np.float64)
            except OverflowError:
                given = np.array([np.inf])
            if np.isfinite(given).all():
                return given
        raise self.fault(name, f"{len(default)} finite numbers", found)

    def text(self, name: str, default: str = "") -> str:
        """Give a text."""
        found = self.facts.get(name, default)
        if isinstance(found, str):
            return found
        raise self.fault(name, "a text", found)

    def item(self, name: str) -> "Node":
        """Give an object in it; an empty one where there is none."""
        found = self.facts.get(name, {})
        if isinstance(found, dict):
            return Node(f"{self.place}.{name}".lstrip("."), found)
        raise self.fault(name, "an object", found)

    def items(self, name: str) -> list["Node"]:
        """Give a list of objects in it; an empty one where there is none."""
        found = self.facts.get(name, [])
        if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
            raise self.fault(name, "a list of objects", found)
        place = f"{self.place}.{name}".lstrip(".")
        return [Node(f"{place}[{i}]", one) for i, one in enumerate(found)]

    def fault(self, name: str, expected: str, found: object) -> FormatError:
        """Give the error of what stands under a name."""
        what = f"{self.place}.{name}".lstrip(".") + " in the JSON"
        return FormatError(
            what, expected=expected, found="nothing" if found is None else repr(found)[:60]
        )


class Gltf:
    """A file that was read."""

    def __init__(self, data: bytes) -> None:
        text, self._binary = _chunks(data) if data[:4] == MAGIC else (data, b"")
        try:
            # A document nests some ten levels; the parser gives up at a thousand or so.
            facts = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise FormatError(
                "the JSON cannot be read", expected="JSON", found=str(error)
            ) from None
        if not isinstance(facts, dict):
            raise FormatError("the JSON", expected="an object", found=type(facts).__name__)
        self.document = Node("", facts)
        version = self.document.item("asset").text("version")
        if version.partition(".")[0] != "2":
            raise FormatError("version of glTF", expected="2.0", found=repr(version))
        self._accessors = self.document.items("accessors")
        self._views = self.document.items("bufferViews")
        self._buffers = self.document.items("buffers")
        self._read: dict[int, bytes] = {}

    def array(self, of: Node, name: str, width: int) -> Array:
        """Give the numbers of the accessor that an item names, (n, width).

        Raises
        ------
        FormatError
            When there are none, they do not lie in the file, or are not finite.

        """
        accessor = self._accessors[of.whole(name, len(self._accessors))]
        if "sparse" in accessor.facts or "bufferView" not in accessor.facts:
            raise accessor.fault("bufferView", "numbers that are stored one by one", "others")
        if _SIZES.get(accessor.text("type")) != width:
            raise accessor.fault("type", _TYPES[width], accessor.facts.get("type"))
        code = accessor.whole("componentType", 2**16)
        if code not in _KINDS:
            raise accessor.fault("componentType", ", ".join(map(str, _KINDS)), code)
        kind = np.dtype(_KINDS[code])
        count = accessor.whole("count", _MOST_NUMBERS)
        view = self._views[accessor.whole("bufferView", len(self._views))]
        place = view.whole("byteOffset", 2**40, 0) + accessor.whole("byteOffset", 2**40, 0)
        own = kind.itemsize * width
        step = view.whole("byteStride", 2**10, own) or own
        data = self._buffer(view.whole("buffer", len(self._buffers)))
        if not count or step < own or place + step * (count - 1) + own > len(data):
            raise accessor.fault("count", f"numbers inside {len(data)} bytes", count)
        strided = np.ndarray((count, width), kind, data, place, (step, kind.itemsize))
        numbers = strided.astype(np.float64)
        if kind.kind != "f" and accessor.facts.get("normalized") is True:
            numbers = np.maximum(numbers / np.iinfo(kind).max, -1.0)
        if not np.isfinite(numbers).all():
            raise accessor.fault("bufferView", "finite numbers", "an infinite one, or none")
        return numbers

    def _buffer(self, index: int) -> bytes:
        if index not in self._read:
            buffer = self._buffers[index]
            address = buffer.text("uri")
            if not address:
                self._read[index] = self._binary
            elif address.startswith(_EMBEDDED) and ";base64," in address:
                try:
                    self._read[index] = base64.b64decode(address.partition(";base64,")[2])
                except binascii.Error as error:
                    raise buffer.fault("uri", "base64", str(error)) from None
            else:
                raise buffer.fault("uri", "numbers inside the file (.glb)", address)
        return self._read[index]


def _chunks(data: bytes) -> tuple[bytes, bytes]:
    """Give the JSON and the numbers of a GLB."""
    if len(data) < _HEADER.size:
        raise FormatError("a GLB of a few bytes", expected="a header", found=f"{len(data)} bytes")
    _, version, length = _HEADER.unpack_from(data)
    if version != 2:
        raise FormatError("version of the GLB", offset=4, expected="2", found=str(version))
    if length > len(data):
        raise FormatError(
            "the GLB is cut short", offset=8, expected=f"{length} bytes", found=str(len(data))
        )
    found: dict[bytes, bytes] = {}
    place = _HEADER.size
    while place + _CHUNK.size <= length:
        size, kind = _CHUNK.unpack_from(data, place)
        begin = place + _CHUNK.size
        if begin + size > length:
            raise FormatError(
                "a chunk is cut short",
                offset=place,
                expected=f"{size} bytes",
                found=str(length - begin),
            )
        found.setdefault(kind, data[begin : begin + size])
        place = begin + size
    if _JSON not in found:
        raise FormatError("no JSON in the GLB", expected="a chunk JSON")
    return found[_JSON], found.get(_BINARY, b"")


@dataclass
class GlbWriter:
    """A GLB that is being put together."""

    document: dict[str, Any] = field(default_factory=dict)
    accessors: list[dict[str, Any]] = field(default_factory=list)
    _views: list[dict[str, Any]] = field(default_factory=list)
    _binary: bytearray = field(default_factory=bytearray)

    def array(
        self, numbers: NDArray[np.generic], *, target: int | None = None, bounded: bool = False
    ) -> int:
        """Add (n, width) or (n,) numbers, and give the index of their accessor.

        ``target`` is what a graphics card takes them for, ``bounded`` states smallest and largest.
        """
        view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": numbers.nbytes}
        self._views.append(view | ({"target": target} if target else {}))
        self._binary += numbers.tobytes()
        self._binary += bytes(-len(self._binary) % 4)
        width = numbers.shape[1] if numbers.ndim > 1 else 1
        accessor: dict[str, Any] = {
            "bufferView": len(self._views) - 1,
            "componentType": _CODES[numbers.dtype.str],
            "count": len(numbers),
            "type": _TYPES[width],
        }
        if bounded:
            rows = numbers.reshape(len(numbers), width)
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def contents(self) -> bytes:
        """Give the file."""
        document = {
            **self.document,
            "accessors": self.accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._binary)}],
        }
        said = json.dumps(document, separators=(",", ":"), ensure_ascii=False)
        text = said.encode(errors="replace")
        text += b" " * (-len(text) % 4)
        parts = ((_JSON, text), (_BINARY, bytes(self._binary)))
        body = b"".join(_CHUNK.pack(len(part), kind) + part for kind, part in parts)
        return _HEADER.pack(MAGIC, 2, _HEADER.size + len(body)) + body


def walk(children: list[list[int]], roots: list[int]) -> Iterator[tuple[int, int]]:
    """Give nodes and their parents, -1 for roots, depth first.

    Raises
    ------
    FormatError
        When a node is reached twice, or not at all.

    """
    seen: set[int] = set()
    pending = [(root, -1) for root in reversed(roots)]
    while pending:
        node, parent = pending.pop()
        if node in seen:
            raise FormatError("nodes", expected="a tree", found=f"node {node} twice")
        seen.add(node)
        yield node, parent
        pending += [(child, node) for child in reversed(children[node])]
    if len(seen) < len(children):
        raise FormatError("nodes", expected="a tree", found="a node that is its own ancestor")
