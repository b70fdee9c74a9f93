"""The columns of a stream as a record: docs/format.md, section "Stream"."""

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import NamedTuple

from mocapress.container import limits
from mocapress.formats.number_formats import read_format, record_of
from mocapress.motion.columns import numbered_columns
from mocapress.motion.skeleton import Skeleton
from mocapress.motion.stream import Column
from mocapress.records import Reader, Writer

_SKELETON, _BONES, _ONE_BY_ONE, _NUMBERED = range(4)
_MOST_KINDS = 64


class Bone(NamedTuple):
    """Successive columns of one joint."""

    name: str
    columns: int
    joint: int


class Columns(NamedTuple):
    """The columns of a stream, and the names by which its source calls their bones."""

    columns: tuple[Column, ...]
    bones: tuple[Bone, ...]
    """Empty where columns are told one by one."""


def write_columns(writer: Writer, columns: Sequence[Column], skeleton: Skeleton | None) -> None:
    """Append columns in the shortest form that gives them."""
    writer.integer(len(columns))
    if skeleton and _alike(_skeleton_columns(skeleton).columns, columns):
        writer.integer(_SKELETON)
    elif kinds := _numbered_kinds(columns):
        writer.integer(_NUMBERED)
        writer.integer(len(kinds))
        for kind in kinds:
            writer.text(kind)
    elif bones := bones_of(columns):
        writer.integer(_BONES)
        writer.integer(len(bones))
        expected = 0
        for bone in bones:
            writer.text(bone.name)
            writer.integer(bone.columns)
            writer.signed(bone.joint - expected)
            expected = bone.joint + 1
        _write_kinds(writer, columns)
    else:
        writer.integer(_ONE_BY_ONE)
        for column in columns:
            writer.text(column.name)
        writer.runs([column.joint + 1 for column in columns])
        _write_kinds(writer, columns)
    formats = list(dict.fromkeys(column.decimal for column in columns if column.decimal))
    writer.integer(len(formats))
    for number_format in formats:
        writer.data += record_of(number_format)
    places = {None: 0} | {number_format: i + 1 for i, number_format in enumerate(formats)}
    writer.runs([places[column.decimal] for column in columns])


def read_columns(reader: Reader, skeleton: Skeleton | None, most: int = limits.COLUMNS) -> Columns:
    """Take columns, at most so many."""
    count = reader.integer(most)
    form = reader.integer(_NUMBERED)
    if form == _SKELETON:
        found = _skeleton_columns(skeleton) if skeleton else Columns((), ())
        if len(found.columns) != count:
            raise reader.fail(f"{count} columns of {len(found.columns)} channels")
    elif form == _BONES:
        bones = _read_bones(reader, count)
        found = Columns(_columns_of(bones, *_read_kinds(reader, count)), bones)
    elif form == _NUMBERED:
        own = tuple(reader.text() for _ in range(reader.integer(_MOST_KINDS)))
        if not own or count % len(own):
            raise reader.fail(f"{count} columns in groups of {len(own)}")
        found = Columns(numbered_columns(count, own), ())
    else:
        names = [reader.text() for _ in range(count)]
        joints = reader.runs(count, limits.JOINTS).tolist()
        kinds, units = _read_kinds(reader, count)
        rows = zip(names, joints, kinds, units, strict=True)
        found = Columns(
            tuple(Column(n, joint - 1, kind, unit) for n, joint, kind, unit in rows), ()
        )
    joints = len(skeleton.joints) if skeleton else limits.JOINTS
    if any(not -1 <= column.joint < joints for column in found.columns):
        raise reader.fail("a column of no joint")
    formats = [None, *(read_format(reader) for _ in range(reader.count(4)))]
    places = reader.runs(count, len(formats) - 1).tolist()
    columns = (
        Column(column.name, column.joint, column.kind, column.unit, formats[place])
        for column, place in zip(found.columns, places, strict=True)
    )
    return Columns(tuple(columns), found.bones)


def _numbered_kinds(columns: Sequence[Column]) -> tuple[str, ...]:
    """Give the kinds of numbered columns; nothing where columns are no such."""
    kinds = tuple(column.kind for column in columns if column.name == f"1.{column.kind}")
    fitting = 0 < len(kinds) <= _MOST_KINDS and len(columns) % len(kinds) == 0
    same = fitting and _alike(numbered_columns(len(columns), kinds), columns)
    return kinds if same else ()


def bones_of(columns: Sequence[Column]) -> tuple[Bone, ...]:
    """Give the bones of columns; nothing where their names do not come from bones."""
    bones = []
    seen: dict[str, int] = {}
    groups = groupby(
        columns, lambda column: (column.joint, column.name.removesuffix(f".{column.kind}"))
    )
    for (joint, label), group in groups:
        base, hash_, number = label.rpartition("#")
        again = hash_ and base in seen and number == str(seen[base] + 1)
        name = base if again else label
        seen[name] = seen.get(name, 0) + 1
        bones.append(Bone(name, sum(1 for _ in group), joint))
    kinds = [column.kind for column in columns]
    units = [column.unit for column in columns]
    made = _columns_of(bones, kinds, units)
    same = all(a.name == b.name for a, b in zip(made, columns, strict=True))
    return tuple(bones) if same else ()


def bone_names(bones: Iterable[Bone]) -> list[str]:
    """Give the bone of each column."""
    return [bone.name for bone in bones for _ in range(bone.columns)]


def _alike(made: Sequence[Column], columns: Sequence[Column]) -> bool:
    """Tell whether columns are the same but for their number formats."""
    return len(made) == len(columns) and all(
        (a.name, a.joint, a.kind, a.unit) == (b.name, b.joint, b.kind, b.unit)
        for a, b in zip(made, columns, strict=True)
    )


def _skeleton_columns(skeleton: Skeleton) -> Columns:
    moved = [(index, joint) for index, joint in enumerate(skeleton.joints) if joint.channels]
    bones = tuple(Bone(joint.name, len(joint.channels), index) for index, joint in moved)
    kinds = [kind for _, joint in moved for kind in joint.channels]
    of_kind = {"r": skeleton.angle_unit, "t": "length", "l": "length"}
    units = [of_kind.get(kind[0], "") for kind in kinds]
    return Columns(_columns_of(bones, kinds, units), bones)


def _columns_of(
    bones: Sequence[Bone], kinds: Sequence[str], units: Sequence[str]
) -> tuple[Column, ...]:
    columns: list[Column] = []
    seen: dict[str, int] = {}
    for bone in bones:
        nth = seen[bone.name] = seen.get(bone.name, 0) + 1
        label = bone.name if nth == 1 else f"{bone.name}#{nth}"
        for _ in range(bone.columns):
            kind = kinds[len(columns)]
            columns.append(Column(f"{label}.{kind}", bone.joint, kind, units[len(columns)]))
    return tuple(columns)


def _read_bones(reader: Reader, columns: int) -> tuple[Bone, ...]:
    bones = []
    expected = 0
    left = columns
    for _ in range(reader.integer(columns)):
        name, count = reader.text(), reader.integer(left)
        joint = expected + reader.signed()
        if count == 0:
            raise reader.fail("a bone without columns")
        bones.append(Bone(name, count, joint))
        expected = joint + 1
        left -= count
    if left:
        raise reader.fail(f"{left} columns of no bone")
    return tuple(bones)


def _write_kinds(writer: Writer, columns: Sequence[Column]) -> None:
    for column in columns:
        writer.text(column.kind)
    writer.text_runs(column.unit for column in columns)


def _read_kinds(reader: Reader, count: int) -> tuple[list[str], list[str]]:
    return [reader.text() for _ in range(count)], reader.text_runs(count)
