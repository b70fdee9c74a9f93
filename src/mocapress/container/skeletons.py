"""The skeleton of a file as a record: docs/format.md, section "Skeleton"."""

from mocapress.container import limits
from mocapress.motion.skeleton import Joint, Skeleton, Vec3
from mocapress.records import Reader, Writer

_KINDS = ("tx", "ty", "tz", "rx", "ry", "rz", "l", "sx", "sy", "sz")
_FIXED, _RADIANS, _LENGTH_UNIT, _AXES, _LIMITS = 1, 2, 4, 8, 16
_NO_AXIS = ((0.0, 0.0, 0.0), "xyz")


def is_storable(skeleton: Skeleton) -> bool:
    """Tell whether a skeleton has only channels that a file can name."""
    joints = skeleton.joints
    return (
        len(joints) <= limits.JOINTS
        and sum(len(joint.ends) for joint in joints) <= limits.ENDS
        and sum(len(joint.channels) for joint in joints) <= limits.COLUMNS
        and len(skeleton.metadata) <= limits.FACTS
        and all(set(joint.channels) <= set(_KINDS) for joint in joints)
    )


class _Recent:
    """The last skeletons and their records: of many clips in a row most have the same."""

    MOST, LONGEST = 4, 2**16

    def __init__(self) -> None:
        self.pairs: tuple[tuple[Skeleton, bytes], ...] = ()

    def keep(self, skeleton: Skeleton, record: bytes) -> None:
        if len(record) <= self.LONGEST:
            self.pairs = ((skeleton, record), *self.pairs[: self.MOST - 1])


_read, _written = _Recent(), _Recent()


def write_skeleton(writer: Writer, skeleton: Skeleton | None) -> None:
    """Append a skeleton, or that there is none."""
    for known, record in _written.pairs:
        if known is skeleton:
            writer.data += record
            return
    begin = len(writer.data)
    _write_skeleton(writer, skeleton)
    if skeleton is not None:
        _written.keep(skeleton, bytes(writer.data[begin:]))


def _write_skeleton(writer: Writer, skeleton: Skeleton | None) -> None:
    joints = skeleton.joints if skeleton else ()
    writer.integer(len(joints))
    if skeleton is None or not joints:
        return
    # Compared as texts, in which -0.0 is another number than 0.0.
    axes = any(str((joint.axis, joint.axis_order)) != str(_NO_AXIS) for joint in joints)
    limited = any(joint.limits for joint in joints)
    writer.integer(
        _FIXED * (skeleton.rotation == "fixed")
        | _RADIANS * (skeleton.angle_unit == "rad")
        | _LENGTH_UNIT * (skeleton.length_unit is not None)
        | _AXES * axes
        | _LIMITS * limited
    )
    writer.text(skeleton.name)
    writer.integer(len(skeleton.metadata))
    for key, value in skeleton.metadata.items():
        writer.text(key)
        writer.text(value)
    if skeleton.length_unit is not None:
        writer.double(skeleton.length_unit)
    for joint in joints:
        writer.text(joint.name)
    for index, joint in enumerate(joints):
        writer.integer(index - 1 - joint.parent)
    for joint in joints:
        writer.bytes(bytes(_KINDS.index(kind) for kind in joint.channels))
    for joint in joints:
        writer.integer(len(joint.ends))
    writer.numbers(vector_numbers(skeleton))
    if axes:
        for joint in joints:
            writer.bytes(bytes("xyz".index(axis) for axis in joint.axis_order))
        writer.numbers([angle for joint in joints for angle in joint.axis])
    if limited:
        for joint in joints:
            writer.integer(len(joint.limits))
        writer.numbers([bound for joint in joints for pair in joint.limits for bound in pair])


def vector_numbers(skeleton: Skeleton) -> list[float]:
    """Give the numbers of all offsets and end sites, in the order in which a file has them."""
    return [
        number
        for joint in skeleton.joints
        for vector in (joint.offset, *joint.ends)
        for number in vector
    ]


def read_skeleton(reader: Reader) -> Skeleton | None:
    """Take a skeleton, or None where there is none."""
    begin = reader.position
    for known, record in _read.pairs:
        if reader.data[begin : begin + len(record)] == record:
            reader.position += len(record)
            return known
    skeleton = _read_skeleton(reader)
    if skeleton is not None:
        _read.keep(skeleton, bytes(reader.data[begin : reader.position]))
    return skeleton


def _read_skeleton(reader: Reader) -> Skeleton | None:
    count = reader.integer(limits.JOINTS)
    if count == 0:
        return None
    flags = reader.integer(31)
    name = reader.text()
    metadata = {}
    for _ in range(reader.integer(limits.FACTS)):
        key = reader.text()
        metadata[key] = reader.text()
    length_unit = reader.double() if flags & _LENGTH_UNIT else None
    names = [reader.text() for _ in range(count)]
    parents = [index - 1 - reader.integer(index) for index in range(count)]
    channels: list[tuple[str, ...]] = []
    left = limits.COLUMNS
    for _ in range(count):
        codes = reader.raw(reader.integer(left))
        left -= len(codes)
        channels.append(tuple(_word(reader, code) for code in codes))
    ends: list[int] = []
    left = limits.ENDS
    for _ in range(count):
        ends.append(reader.integer(left))
        left -= ends[-1]
    vectors = _vectors(reader, count + sum(ends))
    orders, axes = ["xyz"] * count, [(0.0, 0.0, 0.0)] * count
    if flags & _AXES:
        orders = [_order(reader, reader.bytes()) for _ in range(count)]
        axes = _vectors(reader, count)
    limited = [0] * count
    if flags & _LIMITS:
        limited = [reader.integer(len(channels[index])) for index in range(count)]
    bounds = reader.numbers(2 * sum(limited)) if flags & _LIMITS else []
    joints = []
    at = pair = 0
    for index in range(count):
        joints.append(
            Joint(
                names[index],
                parents[index],
                vectors[at],
                channels[index],
                axes[index],
                orders[index],
                tuple(
                    (bounds[2 * k], bounds[2 * k + 1]) for k in range(pair, pair + limited[index])
                ),
                tuple(vectors[at + 1 : at + 1 + ends[index]]),
            )
        )
        at += 1 + ends[index]
        pair += limited[index]
    return Skeleton(
        tuple(joints),
        "fixed" if flags & _FIXED else "moving",
        "rad" if flags & _RADIANS else "deg",
        length_unit,
        name,
        metadata,
    )


def _vectors(reader: Reader, count: int) -> list[Vec3]:
    if count > len(reader.data):
        raise reader.fail(f"{count} end sites announced")
    numbers = reader.numbers(3 * count)
    return list(zip(numbers[0::3], numbers[1::3], numbers[2::3], strict=True))


def _word(reader: Reader, code: int) -> str:
    if code >= len(_KINDS):
        raise reader.fail("a channel of no kind")
    return _KINDS[code]


def _order(reader: Reader, codes: bytes) -> str:
    if sorted(codes) != [0, 1, 2]:
        raise reader.fail("no order of axes")
    return "".join("xyz"[code] for code in codes)
