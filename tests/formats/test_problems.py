"""What loses nothing is read with a warning; what loses motion is an error unless it is allowed."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import mocapress as mp
from mocapress.source import Source

AMC = b":FULLY-SPECIFIED\n:DEGREES\n" + b"".join(
    b"%d\nroot %d.5 2 3 4 5 6\nhip 1.25 -0.125\n" % (i, i) for i in range(1, 9)
)
BVH = (
    b"HIERARCHY\nROOT hip\n{\n  OFFSET 0 0 0\n  CHANNELS 3 Xrotation Yrotation Zrotation\n"
    b"  End Site\n  {\n    OFFSET 0 1 0\n  }\n}\nMOTION\nFrames: 4\nFrame Time: 0.01\n"
    b"1.0 2.0 3.0\n1.5 2.5 3.5\n1.25 -2.5 0.0\n9.0 8.0 7.0\n"
)


HEAD = BVH[: BVH.index(b"1.0 2.0")]


class Case(NamedTuple):
    data: bytes
    names: list[str]
    """Of the problems, in order."""
    values: list[float]
    """Of the first column, as lenient reading gives them."""
    place: tuple[int | None, str | None]
    """Line of the first problem, and what was found there."""


FIRST = [1.0, 1.5, 1.25, 9.0]
ROOT = [i + 0.5 for i in range(1, 9)]
LOSES_NOTHING = {
    "a row more than declared": Case(
        BVH.replace(b"Frames: 4", b"Frames: 3"), ["extra-rows"], FIRST, (17, "4")
    ),
    "no frame declared": Case(
        BVH.replace(b"Frames: 4", b"Frames: 0"), ["extra-rows"], FIRST, (14, "4")
    ),
    "rows with more numbers than channels": Case(
        HEAD + BVH[len(HEAD) :].replace(b"\n", b" 0.5 7\n"), ["extra-numbers"], FIRST, (14, "5")
    ),
    "twice as many numbers as channels": Case(
        HEAD + BVH[len(HEAD) :].replace(b"\n", b" 1 2 3\n"), ["extra-numbers"], FIRST, (14, "6")
    ),
    "values that are no numbers": Case(
        BVH.replace(b"2.5 3.5", b"nan -1.#IND00"), ["not-numbers"], FIRST, (15, "nan in hip.ry")
    ),
    "NULs": Case(
        BVH + b"\0\0\0", ["bytes-after-end"], FIRST, (18, r"3 bytes that begin with '\x00\x00\x00'")
    ),
    "Ctrl-Z": Case(
        BVH + b"\x1a", ["bytes-after-end"], FIRST, (18, r"1 bytes that begin with '\x1a'")
    ),
    "text behind the last row": Case(
        BVH + b"\nend of the take\n",
        ["bytes-after-end"],
        FIRST,
        (19, "15 bytes that begin with 'end of the take'"),
    ),
    "half a row more than declared": Case(
        BVH + b"1 2", ["bytes-after-end"], FIRST, (18, "3 bytes that begin with '1 2'")
    ),
    "NULs behind an AMC": Case(
        AMC + b"\0" * 99,
        ["bytes-after-end"],
        ROOT,
        (27, f"99 bytes that begin with {chr(0) * 16!r}"),
    ),
    "Ctrl-Z behind an AMC": Case(
        AMC + b"\x1a\r\n", ["bytes-after-end"], ROOT, (27, r"1 bytes that begin with '\x1a'")
    ),
}
LOSES_MOTION = {
    "an AMC is cut in a row": Case(
        AMC[:-8], ["unreadable-rows"], ROOT[:7], (26, "the end of the file")
    ),
    "rows are missing": Case(BVH[: BVH.index(b"1.25")], ["missing-rows"], FIRST[:2], (None, "2")),
    "no row": Case(BVH[: BVH.index(b"1.0 2")], ["missing-rows"], [], (None, "0")),
    "the last row is cut short": Case(
        BVH[:-5], ["unreadable-rows"], FIRST[:3], (17, "the end of the file")
    ),
    "cut in a row, with more missing": Case(
        BVH[: BVH.index(b"2.5 3.5")],
        ["unreadable-rows", "missing-rows"],
        FIRST[:1],
        (15, "the end of the file"),
    ),
    "a row among others is short": Case(
        BVH.replace(b"1.5 2.5 3.5", b"1.5 2.5"),
        ["unreadable-rows"],
        [1.0, 1.0, 1.25, 9.0],
        (15, "the end of the line"),
    ),
    "a row among others is long": Case(
        BVH.replace(b"1.5 2.5 3.5", b"1.5 2.5 3.5 4.5"),
        ["unreadable-rows"],
        [1.0, 1.0, 1.25, 9.0],
        (15, "'4.5'"),
    ),
    "the first rows cannot be read": Case(
        BVH.replace(b"1.0 2.0", b"1.0 ?").replace(b"1.5 2.5", b"1.5"),
        ["unreadable-rows"],
        [1.25, 1.25, 1.25, 9.0],
        (14, "'?'"),
    ),
    "fewer than declared, and NULs": Case(
        BVH.replace(b"Frames: 4", b"Frames: 5") + b"\0",
        ["missing-rows", "bytes-after-end"],
        FIRST,
        (None, "4"),
    ),
    "frames that were not declared are cut": Case(
        BVH.replace(b"Frames: 4", b"Frames: 0")[:-5],
        ["unreadable-rows", "extra-rows"],
        FIRST[:3],
        (17, "the end of the file"),
    ),
    "an AMC's bone has too few values": Case(
        AMC.replace(b"-0.125\n3", b"\n3"),
        ["unreadable-rows"],
        [1.5, 1.5, *ROOT[2:]],
        (8, "the end of the line"),
    ),
    "an AMC's value is no number": Case(
        AMC.replace(b"root 1.5 2", b"root 1.5 x"),
        ["unreadable-rows"],
        [2.5, *ROOT[1:]],
        (4, "'x'"),
    ),
}
ALL = LOSES_NOTHING | LOSES_MOTION


@pytest.mark.parametrize("name", ALL)
def test_problems_are_named_and_placed(name: str) -> None:
    case = ALL[name]
    clip, layout, problems, _ = Source(case.data).split()
    assert [problem.name for problem in problems] == case.names
    assert (problems[0].line, problems[0].found) == case.place
    assert any(problem.loses_motion for problem in problems) == (name in LOSES_MOTION)
    assert clip.values[:, 0].tolist() == case.values
    assert layout.join(clip.values) == case.data


@pytest.fixture
def file(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    data = ALL[request.param].data
    path = tmp_path / ("a.amc" if data[:1] == b":" else "a.bvh")
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("file", LOSES_NOTHING, indirect=True)
def test_what_loses_nothing_is_read_with_a_warning(file: Path) -> None:
    with pytest.warns(mp.MotionWarning, match=re.escape(str(file))) as caught:
        strict = mp.read(file)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    with pytest.warns(mp.MotionWarning) as again:
        lenient = mp.read(file, strict=False)
    assert [str(warning.message) for warning in again] == [str(caught[0].message)]
    np.testing.assert_array_equal(strict.values, lenient.values)


@pytest.mark.parametrize("file", LOSES_MOTION, indirect=True)
def test_what_loses_motion_is_an_error_or_a_warning(file: Path) -> None:
    with pytest.raises(mp.FormatError, match=re.escape(str(file))) as error:
        mp.read(file)
    with pytest.warns(mp.MotionWarning) as caught:
        mp.read(file, strict=False)
    assert str(error.value) == str(caught[0].message)


@pytest.mark.parametrize("name", ALL)
def test_all_of_them_compress(name: str) -> None:
    assert mp.decompress(mp.compress(ALL[name].data)) == ALL[name].data


@pytest.mark.parametrize("rows", [range(10), range(40, 120, 3), range(100, 120), range(120)])
def test_a_take_with_unreadable_rows_keeps_its_duration(samples: Path, rows: range) -> None:
    """Rows between others that cannot be read hold the frame before."""
    data = (samples / "mocapbank.bvh").read_bytes()
    clip = Source(data).split().clip
    lines = data.splitlines(keepends=True)
    first = len(lines) - clip.frames
    for row in rows:
        lines[first + row] = lines[first + row].replace(b" ", b" # ", 1)
    read, layout, problems, _ = Source(b"".join(lines)).split()
    assert layout.join(read.values) == b"".join(lines)
    kept = [i for i in range(clip.frames) if i not in rows]
    assert [problem.name for problem in problems][:1] == ["unreadable-rows"]
    if len(rows) < 64:
        assert read.frames == clip.frames
        np.testing.assert_array_equal(read.values[kept], clip.values[kept])


WRAPPED = {
    "one number a line": HEAD + BVH[len(HEAD) :].replace(b" ", b"\n"),
    "two numbers and one": HEAD + re.sub(rb" (\S+\n)", rb"\n\1", BVH[len(HEAD) :]),
    "blank lines between": HEAD + BVH[len(HEAD) :].replace(b" ", b"\r\n\r\n"),
}


@pytest.mark.parametrize("name", WRAPPED)
def test_rows_may_all_wrap_alike(name: str) -> None:
    data = WRAPPED[name]
    clip, layout, problems, _ = Source(data).split()
    assert not problems
    np.testing.assert_array_equal(clip.values, Source(BVH).split().clip.values)
    assert layout.join(clip.values) == data
    assert layout.verbatim_bytes() == 0
    (cut,) = Source(data.rstrip()[:-4]).split().problems
    assert cut.name == "unreadable-rows"


def test_two_short_rows_are_no_wrapped_row() -> None:
    data = HEAD + b"1 2\n3\n4 5 6\n7 8 9\n"
    clip, _, problems, _ = Source(data).split()
    assert [problem.name for problem in problems] == ["unreadable-rows"]
    assert clip.values[:, 0].tolist() == [4, 4, 4, 7]


def test_a_bone_may_be_seen_first_in_a_later_frame() -> None:
    data = (
        b":DEGREES\n1\nroot 1 2 3 4 5 6\nhip 7\n2\nroot 1 2 3 4 5 6\nneck 8 9\nhip 7\n3\nneck 1 2\n"
    )
    clip, layout, problems, _ = Source(data).split()
    assert not problems
    assert [column.name for column in clip.columns[6:]] == ["neck.v1", "neck.v2", "hip.v1"]
    assert clip.values[:, 6:].tolist() == [[0, 0, 7], [8, 9, 7], [1, 2, 7]]
    assert layout.join(clip.values) == data
