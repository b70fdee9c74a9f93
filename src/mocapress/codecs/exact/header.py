"""Writing the codec header: roles of the columns, constants and couplings.

docs/format/exact.md describes it; core/exact/header.cpp reads it.
"""

import struct
from collections.abc import Sequence
from typing import Final

from mocapress.codecs.exact.columns import Told
from mocapress.codecs.exact.coupling import write_couplings
from mocapress.codecs.exact.roles import EXPONENT_STEP, Role, Roles
from mocapress.codecs.exact.skeletons import NONE, OWN_COUPLINGS
from mocapress.codecs.palette import indexed, write_indices, write_palette
from mocapress.errors import CorruptError
from mocapress.records import Reader, Writer

_MODEL, _OWN_COUPLINGS, _LEVEL, _SKELETON, _ASKED = 1, 2, 4, 8, 16
_LINE_DIGITS = 32
USUAL_LEVEL: Final = 5
"""Which a header need not name; as in core/exact/codec.hpp and viewer/mcz/decoding.js."""


def pack_header(
    roles: Roles, told: Told, *, has_model: bool, level: int = USUAL_LEVEL, asked: int = USUAL_LEVEL
) -> bytes:
    """Make the header of a clip with these roles, coded with a model or without.

    ``asked`` is the level that was asked for, ``level`` that of the coder, which has ten.
    """
    own = roles.skeleton != NONE and set(roles.couplings) <= set(OWN_COUPLINGS)
    writer = Writer()
    flags = _MODEL * has_model + _OWN_COUPLINGS * own + _SKELETON * roles.skeleton
    if level == USUAL_LEVEL and asked >= USUAL_LEVEL:
        writer.integer(flags + _ASKED * (asked - USUAL_LEVEL))
    else:
        writer.integer(flags + _LEVEL)
        writer.integer(10 * asked + level % 10)
    codes = zip(roles.roles, roles.turns, strict=True)
    write_palette(writer, [role + len(Role) * turns for role, turns in codes])
    lines = [roles.lines[c] for c in _moving(roles.roles)]
    write_palette(writer, [line * _LINE_DIGITS + digits for line, digits in lines])
    exponents = [roles.exponents[c] // EXPONENT_STEP for c in roles.of(Role.PREDICTED)]
    write_palette(writer, [2 * e if e >= 0 else -2 * e - 1 for e in exponents])
    write_palette(writer, [c - roles.originals[c] - 1 for c in roles.of(Role.COPY)])
    _write_constants(writer, roles.constants)
    if own:
        used = [coupling in roles.couplings for coupling in OWN_COUPLINGS]
        writer.integer(sum(bit << i for i, bit in enumerate(used)))
    else:
        write_couplings(writer, roles.couplings)
    told.write(writer)
    return bytes(writer.data)


def asked_level(header: bytes) -> int:
    """Give the level that was asked for, if a header names one; otherwise 0."""
    reader = Reader(header, "exact header")
    try:
        flags = reader.integer()
        above = flags // _ASKED
        return reader.integer(99) // 10 if flags & _LEVEL else above and USUAL_LEVEL + above
    except CorruptError:
        return 0  # which reading the header tells of


def _moving(roles: Sequence[Role]) -> list[int]:
    return [c for c, role in enumerate(roles) if role in (Role.PREDICTED, Role.NOISE)]


def _write_constants(writer: Writer, constants: Sequence[float]) -> None:
    """Append constants as a palette of numbers; what counts is their bits."""
    palette, indices = indexed([struct.pack("<d", number) for number in constants])
    writer.integer(len(palette))
    if palette:
        writer.numbers([struct.unpack("<d", number)[0] for number in palette])
    write_indices(writer, indices, len(palette))
