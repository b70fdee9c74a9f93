"""The container: what it holds comes back; every damage is found; old files stay readable."""

import contextlib
import math
import zlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.codecs import codec_ids
from mocapress.container import Kind, pack, pack_file, parse, unpack
from mocapress.errors import CorruptError, FormatError, MocapressError, UnsupportedError

GOLDEN = Path(__file__).parents[1] / "golden"
BVH = (
    b"HIERARCHY\nROOT hip\n{\n  OFFSET 0 0 0\n  CHANNELS 3 Xrotation Yrotation Zrotation\n"
    b"  End Site\n  {\n    OFFSET 0 1 0\n  }\n}\nMOTION\nFrames: 60\nFrame Time: 0.01\n"
    + b"".join(
        b" ".join(b"%.6g" % (c + 40 * math.sin(0.07 * i + c)) for c in range(3)) + b"\n"
        for i in range(60)
    )
)
# In context, even so short a clip is smaller as motion than as text.
CODEC = "app:mantissa_limit=53"


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


@given(
    st.lists(st.tuples(st.integers(0, 50), st.binary(max_size=40)), min_size=1, max_size=5),
    st.text(max_size=20),
    st.binary(max_size=40),
)
def test_sections_come_back(
    chunks: list[tuple[int, bytes]], codec: str, codec_header: bytes
) -> None:
    blob = pack_file(
        kind=Kind.AMC,
        size=123,
        digest=bytes(32),
        payloads=[(frames, i % 2 == 0, payload) for i, (frames, payload) in enumerate(chunks)],
        columns=3,
        codec=codec,
        codec_header=codec_header,
        layout=b"layout",
        skeleton=b"skeleton",
    )
    mcz = parse(blob)
    assert (mcz.kind, mcz.size, mcz.codec, mcz.codec_header) == (Kind.AMC, 123, codec, codec_header)
    assert (mcz.layout, mcz.skeleton) == (b"layout", b"skeleton")
    assert mcz.frames == sum(frames for frames, _ in chunks)
    assert [mcz.payload(i) for i in range(len(chunks))] == [payload for _, payload in chunks]


def test_only_the_chunks_needed_are_decoded() -> None:
    frames = [10, 10, 10, 10]
    restart = [True, False, True, True]
    blob = pack_file(
        kind=Kind.AMC,
        size=1,
        digest=bytes(32),
        payloads=[(f, r, b"x") for f, r in zip(frames, restart, strict=True)],
        columns=1,
        layout=b"l",
    )
    mcz = parse(blob)
    assert mcz.chunk_range(0, 5) == (0, 1, 0)
    assert mcz.chunk_range(12, 13) == (0, 2, 0)
    assert mcz.chunk_range(20, 21) == (2, 3, 20)
    assert mcz.chunk_range(29, 31) == (2, 4, 20)
    assert mcz.chunk_range(39, 40) == (3, 4, 30)


def test_the_clip_of_these_tests_is_kept_as_motion() -> None:
    assert parse(mp.compress(BVH, CODEC)).kind is Kind.BVH


@pytest.mark.parametrize("data", [BVH, b"not motion at all " * 5], ids=["bvh", "bytes"])
def test_every_truncation_is_found(data: bytes) -> None:
    blob = mp.compress(data, CODEC)
    for length in range(len(blob)):
        with pytest.raises(CorruptError):
            mp.decompress(blob[:length])
    with pytest.raises(CorruptError):
        mp.decompress(blob + b"x")


@pytest.mark.parametrize("data", [BVH, b"not motion at all " * 5], ids=["bvh", "bytes"])
def test_every_flipped_bit_is_found(data: bytes) -> None:
    blob = mp.compress(data, CODEC)
    for bit in range(8 * len(blob)):
        flipped = bytearray(blob)
        flipped[bit // 8] ^= 1 << bit % 8
        with pytest.raises(MocapressError):
            mp.decompress(bytes(flipped))


@given(st.binary(max_size=300))
def test_junk_is_refused(junk: bytes) -> None:
    with pytest.raises((CorruptError, FormatError)):  # the latter of what looks like JSON
        mp.decompress(junk)
    with pytest.raises(CorruptError):
        mp.decompress(b"\x89MCZ\x01" + junk)


@given(st.integers(0, 10**9), st.integers(0, 255), st.integers(1, 3))
def test_damage_behind_right_checksums_gives_an_error_or_the_file(
    place: int, byte: int, section: int
) -> None:
    """Whoever forges the checksums, too, gets no crash and no other file."""
    blob = mp.compress(BVH, CODEC)
    mcz = parse(blob)
    header, layout = bytearray(mcz.codec_header), bytearray(mcz.layout)
    payload = bytearray(mcz.payload(0))
    target = {1: header, 2: layout, 3: payload}[section]
    target[place % len(target)] = byte
    forged = pack_file(
        kind=mcz.kind,
        size=mcz.size,
        digest=mcz.digest,
        payloads=[(mcz.frames, True, bytes(payload))],
        columns=mcz.columns,
        codec=mcz.codec,
        codec_header=bytes(header),
        layout=bytes(layout),
    )
    with contextlib.suppress(CorruptError):
        assert mp.decompress(forged) == BVH


@pytest.mark.parametrize(
    "change",
    [{"frames": 10**12}, {"columns": 2**19}, {"size": 2**50}, {"codec": "app:chunk=99999999"}],
    ids=str,
)
def test_absurd_announcements_are_refused(change: dict[str, int | str]) -> None:
    mcz = parse(mp.compress(BVH, CODEC))
    frames = int(change.get("frames", mcz.frames))
    forged = pack_file(
        kind=mcz.kind,
        size=int(change.get("size", mcz.size)),
        digest=mcz.digest,
        payloads=[(frames, True, mcz.payload(0))],
        columns=int(change.get("columns", mcz.columns)),
        codec=str(change.get("codec", mcz.codec)),
        codec_header=mcz.codec_header,
        layout=mcz.layout,
    )
    with pytest.raises(CorruptError):
        mp.decompress(forged)


def test_a_later_version_says_so() -> None:
    blob = bytearray(mp.compress(BVH, CODEC))
    blob[4] = 2
    with pytest.raises(UnsupportedError, match="version of the file; expected 1; found 2"):
        mp.decompress(bytes(blob))


def test_the_checksum_is_that_of_zlib() -> None:
    blob = mp.compress(b"abc")
    length = blob[6]
    stored = int.from_bytes(blob[7 + length : 11 + length], "little")
    assert stored == zlib.crc32(blob[5 : 7 + length])


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.mcz")), ids=lambda path: path.name)
def test_files_of_old_versions_stay_readable(path: Path) -> None:
    original = path.with_suffix("").read_bytes()
    assert mp.decompress(path) == original


def test_there_are_golden_files_of_every_codec_and_kind() -> None:
    found = {(mcz.kind, mcz.codec) for mcz in (parse(p.read_bytes()) for p in GOLDEN.glob("*.mcz"))}
    assert {kind for kind, _ in found} == set(Kind)
    codecs = {codec for _, codec in found}
    assert {"app", "app:t=4,table=k4-non-uniform,mantissa_limit=53,chunk=8"} <= codecs
    assert {codec.partition(":")[0] for codec in codecs} == {"", *codec_ids()}
