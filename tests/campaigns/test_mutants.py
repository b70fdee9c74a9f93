"""The short form of the campaign of mutants; ``make long`` runs the long one."""

import sys
import warnings

import pytest
from mutants import GOLDEN, put_together, run, sections_of, targets
from test_kills import a_seed

import mocapress as mp
from mocapress.container import pack, unpack
from mocapress.container.tags import Tag

TARGETS = targets()


@pytest.mark.skipif(sys.platform != "linux", reason="measures memory as Linux does")
@pytest.mark.parametrize("name", TARGETS)
def test_mutants_are_restored_or_refused(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        figures = run(name, TARGETS[name], 50, a_seed(), memory=False)
    assert figures["whole"] or figures["errors"]


@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
@pytest.mark.parametrize(
    ("file", "name"), [("v1_markers.trc", b"points"), ("v1_odd.csv", b"table")]
)
def test_a_layout_about_another_stream_is_refused(file: str, name: bytes) -> None:
    parts = [
        part for part in sections_of((GOLDEN / f"{file}.mcz").read_bytes()) if part[0] != Tag.END
    ]
    named = [
        (tag, pack(unpack(content, "head").replace(name, b"x" * len(name))))
        if tag == Tag.HEAD
        else (tag, content)
        for tag, content in parts
    ]
    assert named != parts
    with pytest.raises(mp.CorruptError, match="streams"):
        mp.load(put_together(named), strict=False)
