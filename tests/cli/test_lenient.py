"""One rule for every command: lost frames are refused, or, with --lenient, read with a warning."""

import json
import re
from pathlib import Path

import pytest
from running import mocapress

import mocapress as mp

READING = [["info"], ["convert", "--to", "amc"], ["view", "--export"]]


def command(words: list[str], file: Path, *more: str) -> list[object]:
    out = [file.with_name("page.html")] if "--export" in words else []
    return [*words, *out, file, *more]


@pytest.fixture
def take(samples: Path) -> bytes:
    return (samples / "mocapbank.bvh").read_bytes()


@pytest.mark.parametrize("words", READING, ids=lambda words: words[0])
def test_a_file_cut_at_60_percent_of_its_rows(
    take: bytes, tmp_path: Path, words: list[str]
) -> None:
    file = tmp_path / "cut.bvh"
    lines = take.splitlines(keepends=True)
    file.write_bytes(b"".join(lines[: -(455 * 4 // 10)]))
    refused = mocapress(*command(words, file))
    message = f"{file}: frames are missing; expected 455 frames, as declared; found 273"
    assert refused.exit_code == 1
    assert refused.stderr.splitlines() == [f"mocapress: {message}"]
    lenient = mocapress(*command(words, file, "--lenient"))
    assert lenient.exit_code == 0
    assert f"mocapress: warning: {message}" in lenient.stderr.splitlines()
    assert mocapress("compress", file).exit_code == 0


@pytest.mark.parametrize("words", READING, ids=lambda words: words[0])
def test_a_row_more_than_declared(take: bytes, tmp_path: Path, words: list[str]) -> None:
    file = tmp_path / "more.bvh"
    file.write_bytes(re.sub(rb"Frames:\s+455", b"Frames: 454", take))
    result = mocapress(*command(words, file))
    assert result.exit_code == 0
    assert "more frames than declared; expected 454 frames; found 455" in result.stderr


def test_json_lists_the_warnings(take: bytes, tmp_path: Path) -> None:
    file = tmp_path / "more.bvh"
    file.write_bytes(re.sub(rb"Frames:\s+455", b"Frames: 454", take) + b"\x1a")
    (row,) = json.loads(mocapress("info", file, "--json").stdout)
    assert row["frames"] == 455
    assert [warning["warning"] for warning in row["warnings"]] == ["extra-rows", "bytes-after-end"]
    assert row["warnings"][0]["found"] == "455"
    assert row["warnings"][0]["file"] == str(file)


def test_a_warning_stays_with_its_file(take: bytes, tmp_path: Path) -> None:
    for i in range(6):
        declared = b"Frames: %d" % (455 if i % 2 else 454)
        (tmp_path / f"{i}.bvh").write_bytes(re.sub(rb"Frames:\s+455", declared, take))
    rows = json.loads(mocapress("info", tmp_path, "--json", "--jobs", "3").stdout)
    rows.sort(key=lambda row: row["file"])  # they come as they are done
    assert [len(row["warnings"]) for row in rows] == [1, 0, 1, 0, 1, 0]


def test_load_follows_the_rule(take: bytes) -> None:
    """Of a file that was stored as it is; those stored as motion say the same."""
    small = take[: take.index(b"MOTION")] + b"MOTION\nFrames: 2\nFrame Time: 0.01\n"
    rows = take.splitlines(keepends=True)[-455:]
    blob = mp.compress(small + rows[0])
    with pytest.raises(mp.FormatError, match="frames are missing"):
        mp.load(blob)
    with pytest.warns(mp.MotionWarning, match="frames are missing"):
        assert mp.load(blob, strict=False).frames == 1
