"""The container: what it holds comes back; every damage is found; it costs what it holds."""

import contextlib
import hashlib
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from importlib import resources
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mocapress.container import (
    CodecSpec,
    CodedChunk,
    Companion,
    Entry,
    Head,
    Mcz,
    MczWriter,
    Original,
    StreamHead,
    open_mcz,
    pack,
    unpack,
)
from mocapress.container.chunks import read_end, write_end
from mocapress.container.head import read_head, write_head
from mocapress.container.sections import section
from mocapress.errors import CorruptError, UnsupportedError
from mocapress.formats.problems import Problem
from mocapress.motion import Column, Joint, NumberFormat, Skeleton
from mocapress.motion.number_format import NumberKind

COLUMNS = (Column("hip.tx", 0, "tx", "length"), Column("hip.rx", 0, "rx", "deg"))
SPEC = CodecSpec("app", {"t": 15, "table": "k3", "fast": True, "bound": 0.5})


class Data:
    """Bytes that count how much of them is read."""

    def __init__(self, data: bytes) -> None:
        self.data, self.taken = data, 0

    @property
    def size(self) -> int:
        return len(self.data)

    def read(self, start: int = 0, stop: int | None = None) -> bytes:
        found = self.data[start:stop]
        self.taken += len(found)
        return found


def stream(name: str, frames: int | None, columns: tuple[Column, ...] = COLUMNS) -> StreamHead:
    return StreamHead(name, frames, Decimal("0.0083333"), columns, SPEC, b"", b"header")


def chunk(
    index: int, first: int, frames: int, payload: bytes, *, restart: bool = True
) -> CodedChunk:
    return CodedChunk(Entry(index, first, frames, restart, False, False, 0, 0), 7, b"", payload)


def made(
    head: Head | None,
    chunks: list[CodedChunk],
    original: Original | None = None,
    *,
    end: bool = True,
    more: bytes = b"",
) -> bytes:
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    if head:
        writer.head(head)
    if original:
        writer.original(original)
    if more:
        writer._put(more)
    for one in chunks:
        writer.chunk(one)
    if end:
        writer.end()
    return b"".join(parts)


def read_all(data: bytes) -> list[bytes]:
    """Open a file and read all chunks."""
    mcz = parse(data)
    return [mcz.read_chunk(entry).payload for entry in mcz.entries]


def parse(data: bytes, *, salvage: bool = False) -> Mcz:
    return open_mcz(Data(data), salvage=salvage)


ORIGINAL = Original("bvh", "walk.bvh", 999, bytes(range(32)), (), pack(b"layout"))
TWO = Head((stream("motion", 30),), None)
BLOB = made(
    TWO, [chunk(0, 0, 10, b"one"), chunk(0, 10, 10, b"two"), chunk(0, 20, 10, b"three")], ORIGINAL
)


@given(st.binary(max_size=3000), st.sampled_from(["", "motion", "root 1.25 2.5\n" * 200]))
def test_packing_comes_back(data: bytes, text: str) -> None:
    data += text.encode()
    packed = pack(data)
    assert len(packed) <= len(data) + 5
    assert unpack(packed, "test") == data


@given(st.binary(max_size=200))
def test_unpacking_junk_gives_an_error_or_what_was_announced(junk: bytes) -> None:
    with contextlib.suppress(CorruptError):
        assert len(unpack(junk, "test", 10_000)) <= 10_000


def test_a_bomb_stops_at_its_announced_size() -> None:
    packed = bytearray(pack(bytes(10_000_000)))
    assert len(packed) < 5000
    with pytest.raises(CorruptError):
        unpack(bytes(packed), "test", 1_000_000)


names = st.text(max_size=8)
numbers = st.floats(allow_nan=False) | st.decimals(-999, 999, places=3).map(float) | st.just(-0.0)
vectors = st.tuples(numbers, numbers, numbers)


@st.composite
def joints(draw: st.DrawFn, index: int) -> Joint:
    channels = tuple(
        draw(st.permutations(["tx", "ty", "rz", "rx", "l"]))[: draw(st.integers(0, 5))]
    )
    return Joint(
        draw(names),
        draw(st.integers(-1, index - 1)),
        draw(vectors),
        channels,
        draw(vectors | st.just((0.0, 0.0, 0.0))),
        draw(st.permutations("xyz").map("".join)),
        tuple(draw(st.lists(st.tuples(numbers, numbers), max_size=len(channels)))),
        tuple(draw(st.lists(vectors, max_size=2))),
    )


@st.composite
def skeletons(draw: st.DrawFn) -> Skeleton:
    return Skeleton(
        tuple(draw(joints(index)) for index in range(draw(st.integers(1, 5)))),
        draw(st.sampled_from(["moving", "fixed"])),
        draw(st.sampled_from(["deg", "rad"])),
        draw(st.none() | numbers),
        draw(names),
        draw(st.dictionaries(names, names, max_size=2)),
    )


formats = st.builds(
    NumberFormat, st.sampled_from(NumberKind), st.integers(1, 17), st.integers(0, 8), st.booleans()
)


@st.composite
def column_tables(draw: st.DrawFn) -> tuple[Column, ...]:
    named = st.builds(
        Column,
        names,
        st.integers(-1, 0),
        st.sampled_from(["tx", "rx", "v1", ""]),
        st.sampled_from(["deg", "length", ""]),
        st.none() | formats,
    )
    bones = st.lists(
        st.tuples(st.sampled_from(["hip", "knee", "a#2", "a"]), st.sampled_from(["tx", "rx"])),
        max_size=6,
    ).map(lambda found: tuple(Column(f"{name}.{kind}", 0, kind) for name, kind in found))
    return draw(st.lists(named, max_size=6).map(tuple) | bones)


@given(
    st.none() | skeletons(),
    column_tables(),
    st.none() | st.fractions(0, 10) | st.decimals(0, 100, allow_nan=False),
    st.none() | st.integers(0, 10**9),
    st.binary(max_size=30),
    st.sampled_from([b"", bytes(32)]),
)
@example(Skeleton((Joint("", -1, axis=(-0.0, 0.0, 0.0)),)), (), None, None, b"", b"")
def test_heads_come_back(
    skeleton: Skeleton | None,
    columns: tuple[Column, ...],
    time: Fraction | Decimal | None,
    frames: int | None,
    header: bytes,
    model: bytes,
) -> None:
    found = StreamHead("motion", frames, time, columns, SPEC, model, header)
    other = stream("force", 5, ())
    back = read_head(write_head(Head((found, other), skeleton)))
    assert repr(back.skeleton) == repr(skeleton)  # -0.0 is another number than 0.0
    assert [replace(one, bones=()) for one in back.streams] == [found, other]
    assert back.streams[0].codec == SPEC


def test_the_columns_of_a_skeleton_are_stored_once() -> None:
    joints = (Joint("Hips", -1, (0, 0, 0), ("tx", "rz")), Joint("Hips", 0, (0, 1, 0), ("rx",)))
    columns = (
        Column("Hips.tx", 0, "tx", "length"),
        Column("Hips.rz", 0, "rz", "deg"),
        Column("Hips#2.rx", 1, "rx", "deg"),
    )
    skeleton = Skeleton(joints)
    with_it = write_head(Head((stream("motion", 3, columns),), skeleton))
    assert read_head(with_it).streams[0].columns == columns
    other = (replace(columns[0], name="Hips.t"), *columns[1:])
    assert len(with_it) + 10 < len(write_head(Head((stream("motion", 3, other),), skeleton)))
    assert (
        read_head(write_head(Head((stream("motion", 3, other),), skeleton))).streams[0].columns
        == other
    )


@given(
    st.lists(st.tuples(st.integers(1, 50), st.binary(max_size=40)), max_size=5),
    st.text(max_size=20),
)
def test_sections_come_back(chunks: list[tuple[int, bytes]], name: str) -> None:
    frames = sum(count for count, _ in chunks)
    problem = Problem.of("extra-rows", "more rows", 3, 0, None, "4")
    original = replace(ORIGINAL, name=name, problems=(problem,))
    coded, first = [], 0
    for count, payload in chunks:
        coded.append(chunk(0, first, count, payload, restart=first % 2 == 0))
        first += count
    mcz = parse(made(Head((stream("motion", frames),)), coded, original))
    assert mcz.original == original
    assert [mcz.read_chunk(entry).payload for entry in mcz.of_stream[0]] == [p for _, p in chunks]
    assert [entry.restart for entry in mcz.entries] == [one.entry.restart for one in coded]
    assert mcz.closed
    assert not mcz.damage


def test_notes_and_companions_come_back_wherever_they_stand() -> None:
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.notes({"source": "CMU", "license": "free"})
    writer.head(TWO)
    for first in (0, 10):
        writer.chunk(chunk(0, first, 10, b"x"))
        writer.companion(Companion("asf", f"{first}.asf", b":root"))
    writer.chunk(chunk(0, 20, 10, b"x"))
    writer.end()
    mcz = parse(b"".join(parts))
    assert mcz.notes == {"source": "CMU", "license": "free"}
    assert [companion.name for companion in mcz.companions] == ["0.asf", "10.asf"]


def test_only_what_is_needed_is_read() -> None:
    chunks = [chunk(0, 10 * i, 10, bytes(20_000)) for i in range(3)]
    data = Data(made(TWO, chunks, ORIGINAL))
    mcz = open_mcz(data)
    mcz.read_chunk(mcz.entries[1])
    assert data.taken < 20_000 + 2**14 + 1000


def test_every_truncation_is_found() -> None:
    for length in range(len(BLOB)):
        with pytest.raises(CorruptError):
            parse(BLOB[:length])
    with pytest.raises(CorruptError):
        parse(BLOB + b"x")


def test_every_flipped_bit_is_found() -> None:
    for bit in range(8 * len(BLOB)):
        flipped = bytearray(BLOB)
        flipped[bit // 8] ^= 1 << bit % 8
        with pytest.raises((CorruptError, UnsupportedError)):
            read_all(bytes(flipped))


def test_of_a_flipped_bit_only_what_it_stands_in_is_lost() -> None:
    """Salvaged, a file gives every chunk but the one that is damaged."""
    begins = parse(BLOB).entries[0].begin
    for bit in range(8 * begins, 8 * len(BLOB)):
        flipped = bytearray(BLOB)
        flipped[bit // 8] ^= 1 << bit % 8
        mcz = parse(bytes(flipped), salvage=True)
        found = []
        for entry in mcz.of_stream[0]:
            with contextlib.suppress(CorruptError):
                found.append(mcz.read_chunk(entry).payload)
        assert len(found) >= 2
        assert set(found) <= {b"one", b"two", b"three"}


@given(st.binary(max_size=300))
def test_junk_is_refused(junk: bytes) -> None:
    for salvage in (False, True):
        for data in (junk, b"\x89MCZ\x01" + junk):
            with pytest.raises((CorruptError, UnsupportedError)):
                parse(data, salvage=salvage)


def test_a_later_version_says_so() -> None:
    data = bytearray(BLOB)
    data[4] = 2
    with pytest.raises(UnsupportedError, match="version of the file; expected 1; found 2"):
        parse(bytes(data))


def test_unknown_sections_are_skipped_where_they_may_be() -> None:
    chunks = [chunk(0, 0, 30, b"x")]
    assert parse(made(TWO, chunks, more=section(0x85, b"later"))).entries
    with pytest.raises(UnsupportedError, match="section 05 is not known"):
        parse(made(TWO, chunks, more=section(0x05, b"later")))


@pytest.mark.parametrize("end", [True, False])
def test_what_must_be_known_stands_before_the_chunks(end: bool) -> None:
    recording = Head((stream("motion", None),))
    for late in (section(0x05, b"x"), section(0x01, write_head(TWO)), section(0x02, b"")):
        parts: list[bytes] = []
        writer = MczWriter(parts.append)
        writer.head(recording)
        writer.chunk(chunk(0, 0, 10, b"x"))
        writer._put(late)
        writer.chunk(chunk(0, 10, 10, b"x"))
        if end:
            writer.end()
        with pytest.raises((CorruptError, UnsupportedError)):
            parse(b"".join(parts))


def test_each_section_stands_once_and_in_order() -> None:
    chunks = [chunk(0, 0, 30, b"x")]
    head, original = section(1, write_head(TWO)), made(None, [], ORIGINAL, end=False)[5:]
    for more in (head, head + original, section(0x81, pack(b"\0")) * 2):
        with pytest.raises(CorruptError):
            parse(made(TWO, chunks, more=more))
    with pytest.raises(CorruptError):
        parse(made(None, chunks, more=original + head))
    for one in (made(None, []), made(None, chunks), made(None, chunks, ORIGINAL)):
        with pytest.raises(CorruptError):
            parse(one)


@pytest.mark.parametrize(
    "chunks",
    [
        [chunk(0, 0, 10, b"a"), chunk(0, 0, 10, b"a"), chunk(0, 20, 10, b"b")],
        [chunk(0, 10, 10, b"b"), chunk(0, 0, 10, b"a"), chunk(0, 20, 10, b"c")],
        [chunk(0, 0, 10, b"a"), chunk(0, 20, 10, b"c")],
        [chunk(0, 0, 10, b"a"), chunk(0, 10, 10, b"b")],
        [chunk(0, 0, 10, b"a"), chunk(0, 10, 10, b"b"), chunk(0, 20, 11, b"c")],
        [chunk(1, 0, 30, b"a")],
        [chunk(0, 0, 30, b"a", restart=False)],
        [],
    ],
    ids=["twice", "swapped", "gap", "too few", "too many", "no stream", "no restart", "none"],
)
@pytest.mark.parametrize("end", [True, False])
def test_chunks_make_up_their_stream(chunks: list[CodedChunk], end: bool) -> None:
    with pytest.raises(CorruptError):
        read_all(made(TWO, chunks, end=end))


def test_streams_share_a_file() -> None:
    head = Head((stream("motion", 20), stream("force", 50)))
    mcz = parse(made(head, [chunk(0, 0, 20, b"m"), chunk(1, 0, 30, b"f"), chunk(1, 30, 20, b"g")]))
    assert [mcz.frames(0), mcz.frames(1)] == [20, 50]
    assert [mcz.read_chunk(entry).payload for entry in mcz.of_stream[1]] == [b"f", b"g"]
    with pytest.raises(CorruptError, match="two of one name"):
        parse(made(Head((stream("motion", 0), stream("motion", 0))), []))


def test_a_stream_of_an_unknown_kind_is_named() -> None:
    later = replace(stream("events", 0), kind="events")
    mcz = parse(made(Head((stream("motion", 30), later)), [chunk(0, 0, 30, b"m")]))
    assert mcz.head is not None
    assert [(one.name, one.kind) for one in mcz.head.streams] == [
        ("motion", "channels"),
        ("events", "events"),
    ]


def test_a_recording_needs_no_end() -> None:
    recording = Head((stream("motion", None),))
    chunks = [chunk(0, 0, 10, b"one"), chunk(0, 10, 10, b"two")]
    closed = parse(made(recording, chunks))
    assert (closed.frames(), closed.closed) == (20, True)
    killed = made(recording, chunks, end=False)
    begins = [entry.begin for entry in closed.entries]
    for length in range(begins[0], len(killed) + 1):
        mcz = parse(killed[:length])
        whole = sum(entry.end <= length for entry in closed.entries)
        assert (mcz.frames(), mcz.closed) == (10 * whole, False)
        assert not mcz.damage
    assert parse(killed + bytes(4096)).frames() == 20
    broken = bytearray(killed)
    broken[begins[1] - 6] ^= 1
    with pytest.raises(CorruptError):
        parse(bytes(broken))
    assert [entry.first for entry in parse(bytes(broken), salvage=True).entries] == [10]


@pytest.mark.parametrize(
    "forged",
    [
        made(Head((stream("motion", 10**12),)), [chunk(0, 0, 10**12, b"x")]),
        made(Head((stream("motion", 2**24),)), [chunk(0, 0, 2**24, b"x")]),
        made(Head((stream("motion", 2**25, ()),)), [chunk(0, 0, 2**25, b"x")]),
        made(None, [], replace(ORIGINAL, format="", size=2**50)),
    ],
    ids=["frames", "values", "frames without columns", "size"],
)
def test_absurd_announcements_are_refused(forged: bytes) -> None:
    with pytest.raises(CorruptError):
        parse(forged)


@pytest.mark.parametrize(
    "content",
    [
        b"\xff\xff\xff\xff\x7f",
        b"\x03\x00\x03\x00\x03\x00\x03\x0a\x0a\x0a",
        b"\x02\x00\x02\x05\x01\x05\x01\x05\x02\x0a\x7f",
        b"\x02\x00\x02\x05\x02\x64\x02\x01\x01",
    ],
    ids=["many", "without frames", "outside", "without bytes"],
)
def test_impossible_ends_are_refused(content: bytes) -> None:
    with pytest.raises(CorruptError):
        read_end(content + bytes(4), 100)


@given(st.binary(max_size=60))
def test_junk_behind_right_checksums_is_refused_or_read(junk: bytes) -> None:
    start = b"\x89MCZ\x01"
    for tag in (1, 2, 0x81, 0x82):
        for content in (junk, pack(junk)):
            with contextlib.suppress(CorruptError, UnsupportedError):
                parse(start + section(tag, content) + BLOB[5:])
    with contextlib.suppress(CorruptError):
        read_end(junk, 50)


def test_opening_costs_as_much_as_there_is() -> None:
    """What is read grows with the file, not with its square."""

    def taken(chunks: int) -> int:
        head = Head((stream("motion", chunks),))
        data = Data(made(head, [chunk(0, i, 1, b"x") for i in range(chunks)]))
        mcz = open_mcz(data)
        for entry in mcz.entries:
            mcz.read_chunk(entry)
        return data.taken

    assert taken(4000) < 2.2 * taken(2000)


def test_what_the_end_costs() -> None:
    entries = [
        Entry(0, 512 * i, 512, True, False, False, 5 + 9000 * i, 5 + 9000 * (i + 1))
        for i in range(9)
    ]
    assert len(write_end(entries)) <= 2 * len(entries) + 16


def test_the_dictionary_is_the_one_that_the_format_names() -> None:
    """Whoever changes it makes every file unreadable that was packed with it."""
    data = (resources.files("mocapress.container") / "dictionary1.bin").read_bytes()
    page = (Path(__file__).parents[2] / "docs/format.md").read_text()
    assert hashlib.sha256(data).hexdigest() in page
