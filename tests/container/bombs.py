"""Files that pass every checksum and ask for far more memory than they are worth."""

import hashlib
import lzma
import zlib
from collections.abc import Callable

import numpy as np

from mocapress.codecs import Model
from mocapress.codecs.diffma.coding import Plan
from mocapress.codecs.diffma.payload import pack_header as diffma_header
from mocapress.codecs.exact import Exact
from mocapress.container import (
    CodecSpec,
    Companion,
    Head,
    MczWriter,
    Original,
    StreamHead,
    pack,
    unpack,
)
from mocapress.container.chunks import CodedChunk, Entry
from mocapress.container.original import write_companion
from mocapress.container.sections import section
from mocapress.container.tags import Tag
from mocapress.formats.layout import Layout
from mocapress.formats.layout_record import write_layout
from mocapress.formats.number_formats import SHORTEST
from mocapress.formats.patterns import References
from mocapress.formats.row_templates import RowTemplate
from mocapress.models import model_bytes
from mocapress.motion import Column, Stream
from mocapress.motion.columns import numbered_columns
from mocapress.records import Writer

MAGIC = b"\x89MCZ\x01"
NO_END = section(Tag.END, b"\x00\x0b\x00\x00\x00")
BOMBS: dict[str, Callable[[], bytes]] = {}


def bomb(made: Callable[[], bytes]) -> Callable[[], bytes]:
    BOMBS[made.__name__] = made
    return made


def record(*fields: int | bytes | str) -> bytes:
    """Give integers, texts, and bytes as they are, one behind the other."""
    writer = Writer()
    for field in fields:
        if isinstance(field, int):
            writer.integer(field)
        elif isinstance(field, str):
            writer.text(field)
        else:
            writer.data += field
    return bytes(writer.data)


def layout(frames: int, columns: int, literals: list[bytes], tail: bytes = b"") -> bytes:
    """Give a packed layout whose rows are all alike."""
    made = Layout(
        "amc",
        b"",
        tail,
        (SHORTEST,) * columns,
        (RowTemplate(False, tuple(literals), tuple(range(columns)), (0,) * columns),),
        np.zeros(frames, np.int32),
        np.empty(0, np.int64),
        np.empty(0, np.uint64),
        np.empty(0, np.uint32),
        (),
        (),
    )
    return pack(write_layout(made, References()))


def mcz(
    columns: tuple[Column, ...],
    spec: CodecSpec,
    header: bytes,
    payloads: list[tuple[int, bytes, int]],
    original: Original,
    model: bytes = b"",
) -> bytes:
    """Put a file together; payloads are frames, bytes and digest of each chunk."""
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    frames = sum(count for count, _, _ in payloads)
    writer.head(Head((StreamHead("motion", frames, None, columns, spec, model, header),)))
    writer.original(original)
    first = 0
    for count, payload, digest in payloads:
        entry = Entry(0, first, count, True, False, False, 0, 0)
        writer.chunk(CodedChunk(entry, digest, b"", payload))
        first += count
    writer.end()
    return b"".join(parts)


def zero_digest(values: int) -> int:
    return zlib.crc32(bytes(8 * values))


def sha_of(unit: bytes, times: int, tail: bytes = b"") -> bytes:
    made = hashlib.sha256()
    block = unit * max(1, 2**20 // len(unit))
    whole, rest = divmod(len(unit) * times, len(block))
    for _ in range(whole):
        made.update(block)
    made.update(block[:rest])
    made.update(tail)
    return made.digest()


def still(columns: int, frames: int, chunk: int, row: list[bytes], size: int) -> bytes:
    """Give a file of zeros whose columns never move."""
    named = numbered_columns(columns, ("x",))
    header = Exact().encode(Stream(np.zeros((2, columns)), named, None)).header
    text = b"0".join(row)
    counts = [chunk] * (frames // chunk) + [frames % chunk] * bool(frames % chunk)
    digests = {count: zero_digest(count * columns) for count in set(counts)}
    return mcz(
        named,
        CodecSpec("exact", {"level": 6, "chunk": chunk}),
        header,
        [(count, b"", digests[count]) for count in counts],
        Original("amc", "a.amc", size, sha_of(text, frames), (), layout(frames, columns, row)),
    )


@bomb
def still_one_column() -> bytes:
    frames = 2**24 - 2**20
    return still(1, frames, 2**20, [b"", b"\n"], 2 * frames)


@bomb
def still_of_many_chunks() -> bytes:
    frames = 2**18
    return still(62, frames, 512, [b"", *[b" "] * 61, b"\n"], 2 * 62 * frames)


@bomb
def text_of_blanks() -> bytes:
    """One zero a row, and a million blanks."""
    frames = 250
    return still(1, frames, 512, [b"", b" " * (2**20 - 2) + b"\n"], 2**20 * frames)


@bomb
def lossy_text() -> bytes:
    """What a lossy codec restores has no announced size."""
    frames = 2**14
    payload = lzma.compress(
        b"2" * (frames - 1) + b"\n0",
        lzma.FORMAT_RAW,
        filters=[{"id": lzma.FILTER_LZMA2, "preset": 9, "dict_size": 1 << 20, "lc": 4, "pb": 0}],
    )
    return mcz(
        numbered_columns(1, ("x",)),
        CodecSpec("diffma", {"chunk": frames}),
        diffma_header([Plan(1.0, 0)]),
        [(frames, payload, 0)],
        Original(
            "amc",
            "a.amc",
            2**27,
            bytes(32),
            (),
            layout(frames, 1, [b"", b" " * (2**20) + b"\n"]),
        ),
    )


@bomb
def layout_of_zeros() -> bytes:
    named = numbered_columns(1, ("x",))
    header = Exact().encode(Stream(np.zeros((2, 1)), named, None)).header
    tail = bytes(2**27)
    packed = layout(2, 1, [b"", b"\n"], tail)
    original = Original("amc", "a.amc", 2**27, bytes(32), (), packed)
    return mcz(named, CodecSpec("exact", {}), header, [(2, b"", zero_digest(2))], original)


@bomb
def layout_of_cells() -> bytes:
    """Numbers written otherwise than their column, ten millions of them."""
    named = numbered_columns(1, ("x",))
    header = Exact().encode(Stream(np.zeros((2, 1)), named, None)).header
    frames, cells = 2, 2**23
    plain = layout(frames, 1, [b"", b"\n"])
    record_ = unpack(plain, "layout")
    assert record_[-1:] == b"\0"
    forged = record_[:-1] + record(cells) + b"\0\0\0" * cells
    original = Original("amc", "a.amc", 2**25, bytes(32), (), pack(forged))
    return mcz(named, CodecSpec("exact", {}), header, [(2, b"", zero_digest(2))], original)


@bomb
def contents_of_zeros() -> bytes:
    """An honest file of zeros, 256 MB."""
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    size = 2**28
    zeros = bytes(size)
    writer.original(
        Original("", "zeros.bin", size, hashlib.sha256(zeros).digest(), (), pack(zeros))
    )
    writer.end()
    return b"".join(parts)


@bomb
def companions_of_zeros() -> bytes:
    content = write_companion(Companion("asf", "a.asf", bytes(2**24)))
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.original(Original("", "a", 1, hashlib.sha256(b"a").digest(), (), pack(b"a")))
    for _ in range(32):
        parts.append(section(Tag.COMPANION, content))
        writer.length += len(parts[-1])
    writer.end()
    return b"".join(parts)


@bomb
def head_of_ends() -> bytes:
    return of_skeleton(b"", 0, 2**24 // 4)


@bomb
def head_of_as_many_ends_as_may_be() -> bytes:
    return of_skeleton(b"", 0, 2**17)


@bomb
def head_of_facts() -> bytes:
    return of_skeleton(b"".join(record(f"{i:x}", "") for i in range(2**21)), 2**21, 0)


@bomb
def head_of_channels() -> bytes:
    channels = 2**24 - 2**10
    return of_head(record(1, 0, "s", 0, "a", 0, channels, bytes(channels), 0, 0, bytes(3), 0))


@bomb
def head_of_columns() -> bytes:
    return of_columns(2**18, 256)


@bomb
def head_of_as_many_columns_as_may_be() -> bytes:
    return of_columns(2**10, 256)


@bomb
def notes_of_keys() -> bytes:
    pairs = b"".join(record(f"{i:x}", "") for i in range(2**21))
    notes = section(Tag.NOTES, pack(record(2**21, pairs)))
    return MAGIC + section(Tag.HEAD, pack(record(0, 1, "s", "none", 0))) + notes + NO_END


def of_head(content: bytes) -> bytes:
    return MAGIC + section(Tag.HEAD, pack(content)) + NO_END


def of_skeleton(facts: bytes, count: int, ends: int) -> bytes:
    """Give a file of one joint."""
    numbers = record(0) + b"\1" * (3 * (ends + 1))
    streams = record(1, "s", "none", 0)
    return of_head(record(1, 0, "s", count, facts, "a", 0, 0, ends, numbers, streams))


def of_columns(count: int, streams: int) -> bytes:
    """Give a file of so many streams of so many columns, and no frames."""
    columns = record(count, 3, 1, "x", 0, 0, count)
    one = record(1, 0, columns, "exact", 0, 0, 0)
    listed = (record(f"s{i}", "channels", len(one), one) for i in range(streams))
    return of_head(record(0, streams, *listed))


def of_codec_header(columns: int, frames: int, header: bytes, payload: bytes) -> bytes:
    named = numbered_columns(columns, ("x",))
    row = [b"", *[b" "] * (columns - 1), b"\n"]
    original = Original(
        "amc", "a.amc", 2 * columns * frames, bytes(32), (), layout(frames, columns, row)
    )
    spec = CodecSpec("exact", {"level": 6, "chunk": 2**20})
    return mcz(named, spec, header, [(frames, payload, 0)], original)


@bomb
def frames_that_are_lost() -> bytes:
    """A chunk that announces a million frames, and has none."""
    return of_lost_chunks(2**20)


@bomb
def more_frames_than_the_stream_lost() -> bytes:
    """The head announces one frame, the chunks a million."""
    return of_lost_chunks(1)


def of_lost_chunks(announced: int) -> bytes:
    """Give a recording of two chunks, the first of which needs one before it."""
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    named = numbered_columns(62, ("x",))
    spec = CodecSpec("exact", {"level": 6, "chunk": 2**20})
    head = StreamHead("motion", announced, None, named, spec, b"", polynomials(62, []))
    writer.head(Head((head,)))
    first = Entry(0, 0, 2**20 - 1, False, False, False, 0, 0)
    writer.chunk(CodedChunk(first, 0, b"", bytes(2**14)))
    writer.chunk(CodedChunk(Entry(0, first.last, 1, True, False, False, 0, 0), 0, b"", b""))
    writer.end()
    return b"".join(parts)


def polynomials(columns: int, couplings: list[tuple[int, ...]]) -> bytes:
    """Give a codec header of predicted columns and polynomial couplings of 6 sources, 3 targets."""
    parts = [record(0), record(1, 0), record(1, 3 * 32), record(1, 0), record(0), record(0)]
    parts.append(record(len(couplings)))
    parts += [record(1, 6, 3, *coupled) for coupled in couplings]
    return b"".join(parts)


@bomb
def couplings_of_one_part() -> bytes:
    """As many polynomials as 1024 columns take, with the sources farthest from the targets."""
    made = []
    for k in range(339):
        at = 1023 - 3 * k
        sources = tuple(range(max(at - 8, 0), max(at - 8, 0) + 6))
        if sources[-1] < at - 2:
            made.append((*sources, at - 2, at - 1, at))
    return of_codec_header(1024, 1, polynomials(1024, made), bytes(64))


@bomb
def couplings_of_many_parts() -> bytes:
    made = [
        tuple(range(part + at, part + at + 9))
        for part in range(0, 2**16, 1024)
        for at in range(0, 1015, 9)
    ]
    return of_codec_header(2**16, 1, polynomials(2**16, made), bytes(2**10))


@bomb
def masks() -> bytes:
    """Two thousand masks of a million frames, all of them full."""
    count = 2000
    header = [record(0), record(1, 1), record(0), record(0), record(0), record(1, 0, 1), record(0)]
    header += [record(count), bytes(8 * count), record(1, 0), record(1, 0), record(0)]
    return of_codec_header(1, 2**20, b"".join(header), b"\1\0" * count)


def xz(text: bytes) -> bytes:
    return lzma.compress(text, preset=6)


_MOST = 2**26


@bomb
def json_of_floats() -> bytes:
    return xz(b'{"channels":[' + b"0," * ((_MOST - 20) // 2) + b"0]}")


@bomb
def json_of_lists() -> bytes:
    return xz(b'{"channels":[' + b"[]," * ((_MOST - 20) // 3) + b"0]}")


@bomb
def json_of_names() -> bytes:
    return xz(b'{"channels":[' + b'"",' * ((_MOST - 20) // 3) + b'""]}')


@bomb
def json_of_table() -> bytes:
    return xz(
        b'{"channels":["a"],"params":{"bits":6,"window":8,"bound":1},'
        b'"records":{"b":["0"],"t":[[' + b"0," * ((_MOST - 200) // 2) + b"0]]}}"
    )


@bomb
def json_of_blanks() -> bytes:
    return xz(b" " * _MOST)


@bomb
def json_of_one_name() -> bytes:
    return xz(b'{"channels":["' + b"a" * _MOST + b'"]}')


@bomb
def json_of_ends() -> bytes:
    return xz(
        b'{"skeleton":{"rotation":"fixed","columns":[],"joints":[{"name":"a","parent":-1,'
        b'"offset":[0,0,0],"ends":[' + b"[0,0,0]," * ((_MOST - 200) // 8) + b"[0,0,0]]}]}}"
    )


@bomb
def model_of_floats() -> bytes:
    return model_bytes(Model("exact", record(2**23 - 64, bytes(2**23 - 64), 0)))


@bomb
def model_of_columns() -> bytes:
    count = 3 * 2**19
    index = np.arange(2**21, 2**21 + count, dtype=np.uint32)
    pairs = np.zeros((count, 5), np.uint8)
    for place in range(3):
        pairs[:, place] = (index >> 7 * place) & 127 | 128
    pairs[:, 3] = (index >> 21) & 127
    return model_bytes(Model("exact", record(0, count) + pairs.tobytes()))


def diffma_text(channels: str, tables: str) -> bytes:
    """Give DiffMA JSON with these lists, as they are written."""
    params = '{"bits":6,"window":64,"bound":2}'
    records = f'{{"b":["2222"],"t":{tables}}}'
    return f'{{"channels":{channels},"records":{records},"params":{params}}}'.encode()


@bomb
def densest_names_of_channels() -> bytes:
    """As many names as there may be in so many bytes, each an object in memory."""
    names = ",".join(['"ab"'] * 1_700_000)
    return diffma_text(f"[{names}]".ljust(12 * 2**20), "[[1]]")


@bomb
def densest_tables_of_channels() -> bytes:
    tables = ",".join(["[1]"] * 580_000)
    return diffma_text('["a"]', f"[{tables}]".ljust(12 * 2**20))
