"""Damaged and forged files of a real codec: an error, or exactly the file; never anything else."""

import contextlib
import math
import warnings
from collections.abc import Iterator
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.api import Opened, compressing
from mocapress.container import CodecSpec, Head, MczWriter, pack, unpack
from mocapress.container.head import write_head
from mocapress.container.sections import next_section, section
from mocapress.container.tags import Tag
from mocapress.records import Reader
from mocapress.source import Source

BVH = (
    b"HIERARCHY\nROOT hip\n{\n  OFFSET 0 0 0\n  CHANNELS 3 Xrotation Yrotation Zrotation\n"
    b"  End Site\n  {\n    OFFSET 0 1 0\n  }\n}\nMOTION\nFrames: 24\nFrame Time: 0.01\n"
    + b"".join(
        b" ".join(b"%.6g" % (c + 40 * math.sin(0.07 * i + c)) for c in range(3)) + b"\n"
        for i in range(24)
    )
)
SPECS = ("exact:chunk=8", "exact:level=1,chunk=8", "app:chunk=15", "diffma:chunk=8")


@pytest.fixture(scope="module", autouse=True)
def _as_motion() -> Iterator[None]:
    """Keep even so short a clip as motion."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compressing, "_SMALL", 0)
        patch.setattr(compressing, "may_be_smaller", lambda *_: False)
        yield


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    made = {spec: mp.compress(BVH, spec) for spec in SPECS}
    assert all(Opened(Source(blob)).streams for blob in made.values())
    return made


@pytest.mark.parametrize("spec", SPECS)
def test_every_truncation_is_found(files: dict[str, bytes], spec: str) -> None:
    blob = files[spec]
    for length in range(len(blob)):
        for work in (mp.decompress, mp.load):
            with pytest.raises(mp.CorruptError):
                work(blob[:length])
    with pytest.raises(mp.CorruptError):
        mp.decompress(blob + b"x")


@pytest.mark.parametrize("spec", SPECS)
def test_every_flipped_bit_is_found(files: dict[str, bytes], spec: str) -> None:
    blob = files[spec]
    for bit in range(8 * len(blob)):
        flipped = bytearray(blob)
        flipped[bit // 8] ^= 1 << bit % 8
        with pytest.raises(mp.MocapressError):
            mp.decompress(bytes(flipped))


def sections(blob: bytes) -> list[tuple[int, bytes]]:
    """Give tags and contents of a file's sections."""
    reader = Reader(blob[5:], "file")
    found = []
    while reader.left:
        one = next_section(reader)
        found.append((one.tag, one.content))
    return found


def changed(data: bytes, place: int, byte: int, how: int) -> bytes:
    """Replace, insert or take out a byte."""
    at = place % max(len(data), 1)
    return data[:at] + bytes([byte] * (how != 2)) + data[at + (how != 1) :]


@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
@given(
    spec=st.sampled_from(SPECS),
    tag=st.sampled_from([Tag.HEAD, Tag.FILE, Tag.CHUNK, Tag.END]),
    place=st.integers(0, 10**6),
    byte=st.integers(0, 255),
    how=st.integers(0, 2),
    inside=st.booleans(),
)
def test_what_is_forged_behind_right_checksums_gives_an_error_or_the_file(
    files: dict[str, bytes], spec: str, tag: Tag, place: int, byte: int, how: int, *, inside: bool
) -> None:
    original = mp.decompress(files[spec])
    forged = files[spec][:5]
    done = False
    for number, content in sections(files[spec]):
        made = content
        if number == tag and not done:
            done = True
            if inside and tag == Tag.HEAD:
                made = pack(changed(unpack(content, "head"), place, byte, how))
            else:
                made = changed(content, place, byte, how)
        forged += section(number, made)
    with contextlib.suppress(mp.CorruptError, mp.UnsupportedError, mp.MissingModelError):
        restored = mp.decompress(forged)
        assert restored == original or "diffma" in spec
    with contextlib.suppress(mp.MocapressError):
        mp.load(forged, errors="skip")


@given(st.integers(0, 10**6), st.integers(0, 255), st.integers(0, 2))
def test_a_forged_layout_gives_an_error_or_the_file(place: int, byte: int, how: int) -> None:
    blob = mp.compress(BVH, SPECS[0])
    opened = Opened(Source(blob))
    original = opened.mcz.original
    assert original is not None
    packed = pack(changed(original.layout(), place, byte, how))
    with contextlib.suppress(mp.CorruptError):
        assert mp.decompress(rebuilt(opened, layout=packed)) == BVH


def rebuilt(opened: Opened, *, layout: bytes | None = None, head: Head | None = None) -> bytes:
    """Write a file again with another layout or head."""
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    assert opened.mcz.head is not None
    assert opened.mcz.original is not None
    writer.head(head or opened.mcz.head)
    writer.original(replace(opened.mcz.original, packed=layout or opened.mcz.original.packed))
    for entry in opened.mcz.entries:
        writer.chunk(opened.mcz.read_chunk(entry))
    writer.end()
    return b"".join(parts)


@pytest.mark.parametrize(
    "codec",
    [
        CodecSpec("none", {}),
        CodecSpec("exact", {"level": 99}),
        CodecSpec("exact", {"level": "6"}),
        CodecSpec("exact", {"level": True}),
        CodecSpec("exact", {"levels": 6}),
        CodecSpec("app", {"table": "none"}),
        CodecSpec("app", {"chunk": 2**40}),
    ],
    ids=str,
)
def test_a_codec_that_cannot_be_is_an_error(files: dict[str, bytes], codec: CodecSpec) -> None:
    opened = Opened(Source(files[SPECS[0]]))
    assert opened.mcz.head is not None
    head = Head((replace(opened.streams[0], codec=codec),), opened.mcz.head.skeleton)
    with pytest.raises(mp.CorruptError, match="motion"):
        mp.load(rebuilt(opened, head=head))


def test_what_a_file_says_of_its_codec_counts_not_the_defaults(files: dict[str, bytes]) -> None:
    """Were a default to change, old files decode as they did; the codec header names the level."""
    opened = Opened(Source(files[SPECS[0]]))
    assert opened.streams[0].codec == CodecSpec("exact", {"chunk": 8})
    assert opened.codec() == mp.codec("exact:level=5,chunk=8")


def test_many_columns_in_few_bytes_are_refused() -> None:
    """Columns that are told in runs cost memory only as far as the file bounds them."""
    opened = Opened(Source(mp.compress(BVH, SPECS[0])))
    assert opened.mcz.head is not None
    content = bytearray(unpack(write_head(opened.mcz.head), "head"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for place in range(len(content)):
            huge = bytes(content[:place]) + b"\xff\xff\x3f" + bytes(content[place + 1 :])
            blob = b"\x89MCZ\x01" + section(Tag.HEAD, pack(huge))
            with pytest.raises(mp.CorruptError):
                mp.load(blob + section(Tag.END, b"\x00\x0b\x00\x00\x00"))
