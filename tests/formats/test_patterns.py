"""Patterns: what a layout leaves to the skeleton comes back, and nothing else is made up."""

import contextlib
from decimal import Decimal

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mocapress.errors import CorruptError
from mocapress.formats.header_pattern import header_pattern, style_of
from mocapress.formats.patterns import References, Style, print_header, raw
from mocapress.motion import Joint, Skeleton

SKELETON = Skeleton(
    (
        Joint("Hips", -1, (0.0, 0.0, 0.0), ("tx", "ty", "tz", "rz", "rx", "ry")),
        Joint("Spine {1}", 0, (-0.0, 12.5, -1.25), ("rz", "rx", "ry"), ends=((0.0, 3.5, 1e-9),)),
    )
)
REFERENCES = References.of(SKELETON, (), Decimal("0.0083333"))
HEADER = b"""HIERARCHY
ROOT Hips
{
\tOFFSET 0.00 0.00 0.00
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT Spine {1}
\t{
\t\tOFFSET -0.00\t12.50 -1.25
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0.00 3.50 1e-9
\t\t}
\t}
}
MOTION
Frames: 240
Frame Time: 0.0083333
"""


def shortened(header: bytes, rows: int, references: References) -> tuple[bytes, bytes]:
    """Give a header's pattern, and what it prints."""
    pattern, style = header_pattern(header, rows, references, style_of(header, b"", references))
    return pattern, print_header(pattern, references, style, rows, len(header))


@pytest.mark.parametrize("line_break", [b"\n", b"\r\n"])
def test_what_the_skeleton_says_is_left_out(line_break: bytes) -> None:
    header = HEADER.replace(b"\n", line_break)
    pattern, back = shortened(header, 240, REFERENCES)
    assert back == header
    for word in (b"Hips", b"Spine", b"rotation", b"12.5", b"240", b"0083333", b"\n"):
        assert word not in pattern
    assert b"1e-9" in pattern  # in no format that prints the others


@pytest.mark.parametrize(
    "change",
    [
        (b"Hips", b"Hip"),
        (b"12.50", b"12.5"),
        (b"-0.00", b"0.00"),
        (b"Zposition Zrotation", b"Zposition  Zrotation"),
        (b"Xposition", b"xposition"),
        (b"Frames: 240", b"Frames: 0240"),
        (b"0.0083333", b".0083333"),
        (b"\t\t\tOFFSET", b"\t\tOFFSET"),
        (b"\t\t}", b"\t}"),
        (b"{", b"{ {"),
        (b"MOTION", b"\0\1\2\x10MOTION"),
        (b"\tJOINT", b"\tOFFSET 1 2 3\n\tJOINT"),
        (b"\tJOINT", b"\tCHANNELS 0\n\tJOINT"),
        (b"\n", b"\r\n\n"),
    ],
    ids=repr,
)
def test_whatever_else_stands_there_comes_back(change: tuple[bytes, bytes]) -> None:
    header = HEADER.replace(*change)
    assert shortened(header, 240, REFERENCES)[1] == header
    assert shortened(header, 7, References())[1] == header


pieces = st.sampled_from(
    [
        b"ROOT ",
        b"JOINT ",
        b"Hips",
        b"{",
        b"}",
        b"\n",
        b"\r\n",
        b"\t",
        b"OFFSET 1 2.50 3",
        b"Frames: ",
    ]
)


@given(st.lists(pieces | st.binary(max_size=4), max_size=30).map(b"".join), st.integers(0, 300))
@example(b"\0", 0)
@example(b"}\n\t}", 0)
def test_any_header_comes_back(header: bytes, rows: int) -> None:
    for references in (REFERENCES, References()):
        assert shortened(header, rows, references)[1] == header
    style = Style()
    assert print_header(raw(header), References(), style, 0, len(header)) == header


@given(st.binary(max_size=60))
def test_any_pattern_gives_an_error_or_at_most_what_may_be(pattern: bytes) -> None:
    style = Style(b"\r\n", b"\t" * 50)
    with contextlib.suppress(CorruptError):
        assert len(print_header(pattern, REFERENCES, style, 5, 200)) <= 200


def test_a_deep_indentation_is_no_bomb() -> None:
    pattern = b"{" * 10**6 + b"\1" * 1000
    with pytest.raises(CorruptError, match="longer header"):
        print_header(pattern, References(), Style(b"\n", b"\t" * 10**6), 0, 10**6)


@pytest.mark.parametrize("name", ["Hüfte", "腰"])
@pytest.mark.parametrize("encoding", ["latin-1", "utf-8"])
def test_names_are_printed_as_they_were(name: str, encoding: str) -> None:
    references = References.of(Skeleton((Joint(name, -1),)), (), None)
    header = b"ROOT " + name.encode(encoding, "replace") + b"\n{\nOFFSET 0 0 0\n}\n"
    assert shortened(header, 1, references)[1] == header
