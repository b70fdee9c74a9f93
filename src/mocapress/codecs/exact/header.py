"""The codec header: roles of the columns, constants and couplings (docs/format.md, ``exact``)."""

import struct
from collections.abc import Sequence

from mocapress.codecs.exact.columns import Told
from mocapress.codecs.exact.coupling import (
    Coupling,
    arrange,
    read_couplings,
    write_couplings,
)
from mocapress.codecs.exact.roles import EXPONENT_STEP, MOST_EXPONENT, Role, Roles
from mocapress.codecs.exact.skeletons import CHANNELS, CMU, NONE, OWN_COUPLINGS
from mocapress.codecs.palette import (
    indexed,
    read_indices,
    read_palette,
    write_indices,
    write_palette,
)
from mocapress.records import Reader, Writer

_MODEL, _OWN_COUPLINGS, _LEVEL, _SKELETON = 1, 2, 4, 8
_MOST_LEVEL = 9
_LINES, _LINE_DIGITS = 7, 32
_TURNS = 3


def pack_header(roles: Roles, told: Told, *, has_model: bool, level: int | None = None) -> bytes:
    """Make the header of a clip with these roles, coded with a model or without.

    ``level`` where it is not that of the codec's parameters.
    """
    own = roles.skeleton != NONE and set(roles.couplings) <= set(OWN_COUPLINGS)
    writer = Writer()
    flags = _MODEL * has_model + _OWN_COUPLINGS * own + _SKELETON * roles.skeleton
    writer.integer(flags + _LEVEL * (level is not None))
    if level is not None:
        writer.integer(level)
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


def unpack_header(header: bytes, columns: int) -> tuple[Roles, Told, bool, int | None]:
    """Give roles, gaps and tables of as many columns, whether a model was used, and the level.

    The level is None where it is that of the codec's parameters.

    Raises
    ------
    CorruptError
        When the header is not one that ``pack_header`` makes for as many columns.

    """
    reader = Reader(header, "exact header")
    flags = reader.integer(_MODEL + _OWN_COUPLINGS + _LEVEL + _SKELETON * CMU)
    level = reader.integer(_MOST_LEVEL) if flags & _LEVEL else None
    if level == 0:
        raise reader.fail("a level that there is not")
    skeleton, own = flags // _SKELETON, bool(flags & _OWN_COUPLINGS)
    if CHANNELS.get(skeleton, columns) != columns or (own and skeleton == NONE):
        raise reader.fail("the channels of a skeleton that has others")
    codes = read_palette(reader, columns, _TURNS * len(Role) - 1)
    roles = tuple(Role(code % len(Role)) for code in codes)
    moving = _moving(roles)
    lines = [(0, 0)] * columns
    for column, line in zip(
        moving, read_palette(reader, len(moving), _LINES * _LINE_DIGITS - 1), strict=True
    ):
        lines[column] = divmod(line, _LINE_DIGITS)
    predicted = [column for column, role in enumerate(roles) if role is Role.PREDICTED]
    exponents = [0] * columns
    steps = read_palette(reader, len(predicted), 2 * MOST_EXPONENT // EXPONENT_STEP)
    for column, step in zip(predicted, steps, strict=True):
        exponents[column] = EXPONENT_STEP * (step >> 1 if step % 2 == 0 else -(step + 1 >> 1))
    originals = _read_originals(reader, roles)
    constants = _read_constants(reader, roles.count(Role.CONSTANT))
    couplings = _read_couplings(reader, predicted, own=own)
    told = Told.read(reader, columns)
    reader.end()
    made = Roles(
        roles,
        tuple(originals),
        tuple(lines),
        tuple(exponents),
        tuple(code // len(Role) for code in codes),
        tuple(couplings),
        skeleton,
        constants,
    )
    return made, told, bool(flags & _MODEL), level


def _moving(roles: Sequence[Role]) -> list[int]:
    return [c for c, role in enumerate(roles) if role in (Role.PREDICTED, Role.NOISE)]


def _read_originals(reader: Reader, roles: Sequence[Role]) -> list[int]:
    originals = list(range(len(roles)))
    copies = [column for column, role in enumerate(roles) if role is Role.COPY]
    for column, back in zip(copies, read_palette(reader, len(copies), len(roles)), strict=True):
        originals[column] = column - 1 - back
        if originals[column] < 0 or roles[originals[column]] is Role.COPY:
            raise reader.fail("a column copies one that is not there")
    return originals


def _write_constants(writer: Writer, constants: Sequence[float]) -> None:
    """Append constants as a palette of numbers; what counts is their bits."""
    palette, indices = indexed([struct.pack("<d", number) for number in constants])
    writer.integer(len(palette))
    if palette:
        writer.numbers([struct.unpack("<d", number)[0] for number in palette])
    write_indices(writer, indices, len(palette))


def _read_constants(reader: Reader, count: int) -> tuple[float, ...]:
    size = reader.integer(min(count, reader.left))
    palette = reader.numbers(size) if size else []
    return tuple(palette[index] for index in read_indices(reader, count, size))


def _read_couplings(reader: Reader, predicted: list[int], *, own: bool) -> list[Coupling]:
    if own:
        used = reader.integer(2 ** len(OWN_COUPLINGS) - 1)
        couplings = [coupling for i, coupling in enumerate(OWN_COUPLINGS) if used >> i & 1]
    else:
        couplings = read_couplings(reader)
    known = set(predicted)
    if any(not known.issuperset(coupling.columns) for coupling in couplings):
        raise reader.fail("a coupling of columns that are not predicted")
    if arrange(predicted, couplings)[1] != couplings:
        raise reader.fail("couplings that cannot stand together")
    return couplings
