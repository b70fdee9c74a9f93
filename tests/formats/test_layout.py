"""Bytes come back as they were: ``join`` undoes ``split``, apart from any codec."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapress.errors import CorruptError
from mocapress.formats.layout import Layout
from mocapress.formats.layout_record import read_layout, write_layout
from mocapress.formats.patterns import References
from mocapress.motion import Clip
from mocapress.source import Source

AMC = b":FULLY-SPECIFIED\n:DEGREES\n" + b"".join(
    b"%d\nroot %d.5 2 3 4 5 6\nhip 1.25 -0.125\n" % (i, i) for i in range(1, 9)
)
BVH = (
    b"HIERARCHY\nROOT hip\n{\n  OFFSET 0 0 0\n  CHANNELS 3 Xrotation Yrotation Zrotation\n"
    b"  End Site\n  {\n    OFFSET 0 1 0\n  }\n}\nMOTION\nFrames: 4\nFrame Time: 0.01\n"
    b"1.0 2.0 3.0\n1.5 2.5 3.5\n1.25 -2.5 0.0\n9.0 8.0 7.0\n"
)


def references(clip: Clip) -> References:
    """Give what a layout may refer to."""
    bones = [column.name.rpartition(".")[0] for column in clip.columns]
    return References.of(clip.skeleton, bones, clip.frame_time)


def restored(data: bytes) -> tuple[bytes, Layout]:
    """Take apart, store the layout, read it again and join."""
    clip, layout, *_ = Source(data).split()
    again = layout
    for refer in (References(), references(clip)):
        stored = write_layout(layout, refer)
        again = read_layout(stored, layout.format, clip.frames, layout.formats, refer, 2**30)
        assert write_layout(again, refer) == stored
        assert again.join(clip.values) == layout.join(clip.values)
    return again.join(clip.values), layout


@pytest.mark.parametrize("source", ["amc", "bvh"])
def test_rows_can_be_left_out(source: str) -> None:
    """Of rows that are lost, the rest is printed, and the header announces them."""
    data = AMC.replace(b"3\nroot 3.5", b"3\nroot  3.50") if source == "amc" else BVH
    data = data.replace(b"1.25 -2.5", b"1.250 -2.5")
    clip, layout, *_ = Source(data).split()
    keep = np.arange(clip.frames) % 2 == 0
    refer = references(clip)
    stored = write_layout(layout, refer)
    rest = read_layout(
        stored, layout.format, clip.frames, layout.formats, refer, 2**20, int(keep.sum())
    )
    text = rest.rows(keep).join(clip.values[keep])
    again = Source(text).split()
    assert again.clip.values.tolist() == clip.values[keep].tolist()
    assert not again.problems
    kept = [line for line in data.split(b"\n") if line in text.split(b"\n")]
    assert len(kept) > len(data.split(b"\n")) / 2


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
def test_samples_come_back(samples: Path, name: str) -> None:
    data = (samples / name).read_bytes()
    back, layout = restored(data)
    assert back == data
    assert layout.verbatim_bytes() == 0


VARIANTS: dict[str, Callable[[bytes], bytes]] = {
    "as it is": lambda d: d,
    "CRLF": lambda d: d.replace(b"\n", b"\r\n"),
    "no final newline": lambda d: d[:-1],
    "tabs": lambda d: d.replace(b" ", b"\t"),
    "trailing blanks": lambda d: d.replace(b"\n", b" \n"),
    "two blanks": lambda d: d.replace(b" ", b"  "),
    "empty lines at the end": lambda d: d + b"\n\n",
    "empty lines between": lambda d: d.replace(b"\n2\n", b"\n\n2\n").replace(b"\n1.5", b"\n\n1.5"),
    "comment first": lambda d: b"# a comment\n" + d if d.startswith(b":") else d,
    "comment between": lambda d: d.replace(b"\n3\n", b"\n# three\n3\n"),
    "other last line end": lambda d: d[:-1] + b"\r\n",
    "a number written otherwise": lambda d: d.replace(b"1.25", b"+01.250e0", 1),
    "long number": lambda d: d.replace(b"1.25", b"1.2500000000000000000000000000001", 1),
    "scientific": lambda d: d.replace(b"1.25", b"-1.6201e-014"),
    "frame numbers jump": lambda d: d.replace(b"\n4\nroot", b"\n400\nroot"),
    "bone left out": lambda d: d.replace(b"\nhip 1.25 -0.125\n3", b"\n3"),
    "bones in another order": lambda d: re.sub(
        rb"\n2\n(root[^\n]*)\n(hip[^\n]*)\n", rb"\n2\n\2\n\1\n", d
    ),
    "Latin-1 in the header": lambda d: d.replace(b":DEGREES", b"# f\xfcr\n:DEGREES"),
    "minus zero": lambda d: d.replace(b"2.5", b"-0").replace(b" 4 ", b" -0 "),
}


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("data", [AMC, BVH], ids=["amc", "bvh"])
def test_every_way_of_writing_comes_back(data: bytes, variant: str) -> None:
    data = VARIANTS[variant](data)
    assert restored(data)[0] == data


def test_numbers_padded_to_a_width_need_one_template_only() -> None:
    rows = np.random.default_rng(1).normal(0, 200, (30, 3))
    data = BVH[: BVH.index(b"1.0 2.0")].replace(b"Frames: 4", b"Frames: 30")
    data += b"".join(b"%10.4f%10.4f%10.4f\n" % tuple(row) for row in rows)
    back, layout = restored(data)
    assert back == data
    assert len(layout.templates) == 1
    assert layout.verbatim_bytes() == 0


def test_repeated_bone_names_keep_their_values_apart() -> None:
    data = AMC.replace(b"hip 1.25 -0.125", b"hip 1 2\nhip 3 4")
    clip, layout, *_ = Source(data).split()
    assert [c.name for c in clip.columns[6:]] == ["hip.v1", "hip.v2", "hip#2.v1", "hip#2.v2"]
    assert clip.values[0, 6:].tolist() == [1, 2, 3, 4]
    assert layout.join(clip.values) == data


def test_a_bone_left_out_keeps_its_values() -> None:
    data = VARIANTS["bone left out"](AMC).replace(b"hip 1.25", b"hip 7.5", 1)
    clip = Source(data).split().clip
    assert clip.values[:3, 6].tolist() == [7.5, 7.5, 1.25]


numbers = st.floats(-1e7, 1e7).map(lambda v: f"{v:.6g}") | st.sampled_from(
    ["0", "-0", "1e-014", ".5", "+3", "00", "1.0", "1E5", "12345678901234567890.5"]
)


@given(
    st.lists(st.lists(numbers, min_size=3, max_size=3), min_size=1, max_size=12),
    st.sampled_from([" ", "\t", "  "]),
    st.sampled_from(["\n", "\r\n", " \n"]),
    st.booleans(),
)
def test_any_numbers_come_back(rows: list[list[str]], gap: str, end: str, last: bool) -> None:
    text = end.join(gap.join(row) for row in rows) + (end if last else "")
    header = BVH[: BVH.index(b"1.0 2.0")].replace(b"Frames: 4", b"Frames: %d" % len(rows))
    data = header + text.encode()
    clip, layout, problems, _ = Source(data).split()
    assert not problems
    assert clip.values.tolist() == [[float(t) for t in row] for row in rows]
    assert layout.join(clip.values) == data


@given(st.binary(max_size=60), st.integers(0, 400), st.integers(0, 255))
def test_broken_layouts_give_an_error(junk: bytes, at: int, byte: int) -> None:
    clip, layout, *_ = Source(AMC).split()
    refer = references(clip)
    stored = bytearray(write_layout(layout, refer))
    stored[at % len(stored)] = byte
    for broken in (junk, bytes(stored), bytes(stored[: at % len(stored)])):
        try:
            read = read_layout(broken, "amc", 8, layout.formats, refer, 10_000)
            read.join(np.zeros((8, len(read.formats))), 10_000)
        except CorruptError:
            pass


@pytest.mark.corpus
def test_the_whole_corpus_comes_back(corpus_clips: list[Path]) -> None:
    for path in corpus_clips:
        data = path.read_bytes()
        clip, layout, problems, _ = Source(data, str(path)).split()
        assert not problems
        assert layout.join(clip.values) == data
