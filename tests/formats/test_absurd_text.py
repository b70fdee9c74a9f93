"""Texts that are absurd: one clear error or a clip, in time that grows as the text does.

Each text is so long that a way whose time grows with the square of its length would take hours.
"""

import warnings

import numpy as np
import pytest

import mocapress as mp
from mocapress.formats import recognise
from mocapress.source import Source

N = 200_000
JOINT = b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n"
MOTION = b"}\nMOTION\nFrames: 1\nFrame Time: 0.1\n1\n"
END = b"End Site\n{\nOFFSET 0 1 0\n}\n"
ASF = b":root\norder rx\n:bonedata\n"
BONE = b"begin\nname a\ndirection 1 0 0\nlength 1\nend\n"
ABSURD = {
    "blank lines before the first frame": b":DEGREES\n" + b"\n" * N + b"1\nroot 1 2\n",
    "blank lines alone": b"\n" * N,
    "blanks before a keyword": b"\n" + b" " * N + b":DEGREES\n1\nroot 1 2\n",
    "blank lines between frames": b"".join(
        b"%d\nroot %d\n%s" % (i, i, b"\n" * 1000) for i in range(200)
    ),
    "frame numbers alone": b":DEGREES\n" + b"1\n" * N,
    "frames that cannot be read": b":DEGREES\n1\nroot 1\n" + b"2\nroot x\n" * N,
    "frames of other bones": b":DEGREES\n1\nroot 1\n"
    + b"".join(b"2\nb%d 1\n" % i for i in range(N // 10)),
    "bones of one name in an AMC": b":DEGREES\n1\n" + b"a 1\n" * N,
    "End Sites of one joint": JOINT + END * (N // 10) + MOTION,
    "joints of one name": JOINT + b"JOINT a\n{\nOFFSET 0 1 0\n}\n" * (N // 10) + MOTION,
    "joints in joints": JOINT + b"JOINT a\n{\nOFFSET 0 1 0\n" * 30_000 + b"}\n" * 30_000 + MOTION,
    "comments that never end": b"# {" * N,
    "lines of a wrapped row": JOINT + MOTION[:-2] + b"1 2 3\n4\n" * N,
    "a byte order mark on a line of its own": b"\xef\xbb\xbf\n" * N,
    "blanks that are none": b"HIERARCHY\n\xa0\n",
    "a number of many digits": JOINT + MOTION[:-2] + b"1" * N + b"\n",
    "a count of many digits": JOINT + b"}\nMOTION\nFrames: " + b"1" * N + b"\nFrame Time: 1\n1\n",
    "a frame number of many digits": b":DEGREES\n" + b"1" * N + b"\nroot 1\n",
    "a huge frame time": JOINT + b"}\nMOTION\nFrames: 1\nFrame Time: 1e100000000\n1\n",
    "a tiny frame time": JOINT + b"}\nMOTION\nFrames: 1\nFrame Time: 1e-100000000\n1\n",
}


@pytest.mark.parametrize("name", ABSURD)
def test_absurd_motion_is_read_or_refused_in_time(name: str) -> None:
    data = ABSURD[name]
    recognise(data)
    try:
        clip, layout, *_ = Source(data, "a.amc" if data[:1] == b":" else "a.bvh").split()
    except mp.FormatError:
        return
    assert layout.join(clip.values) == data
    assert clip.values.nbytes < 64 * len(data)


SKELETONS = {
    "bones of one name": ASF + BONE * (N // 10) + b":hierarchy\nroot" + b" a" * (N // 10) + b"\n",
    "a chain of bones of one name": ASF + BONE * 9999 + b":hierarchy\nroot a\n" + b"a a\n" * 9998,
    "sections without end": ASF + b":root\n" * N,
    "limits without end": ASF + b"begin\nname a\nlimits " + b"(" * N + b"\nend\n",
    "a length of nothing": b":units\nlength 0\n:root\norder rx\n",
    "a length of many digits": b":units\nlength " + b"1" * N + b"\n:root\norder rx\n",
}


@pytest.mark.parametrize("name", SKELETONS)
def test_absurd_skeletons_are_read_or_refused_in_time(name: str) -> None:
    try:
        clip = mp.read(SKELETONS[name])
    except mp.FormatError:
        return
    assert clip.skeleton is not None
    names = [joint.name for joint in clip.skeleton.joints]
    assert names == ["root", *["a"] * (len(names) - 1)]


def test_a_frame_that_leaves_all_out_costs_no_more_than_it_may() -> None:
    """Two bytes must not become a row of any width."""
    bones = b"".join(b"b%d 1 2 3\n" % i for i in range(4000))
    data = b":DEGREES\n1\n" + bones + b"".join(b"%d\n" % i for i in range(2, 9000))
    with pytest.raises(mp.FormatError, match="more frames and channels than a file of this size"):
        mp.read(data)
    assert mp.decompress(mp.compress(data)) == data


def test_a_file_in_utf16_is_read_as_any_other(samples: object) -> None:
    data = JOINT + MOTION[:-2] + b"1.25\n-2.5\n"
    for encoding in ("utf-16-le", "utf-16-be"):
        wide = ("\ufeff" + data.decode()).encode(encoding)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            clip = mp.read(wide)
        np.testing.assert_array_equal(clip.values, [[1.25], [-2.5]])
        (warning,) = (w.message for w in caught if isinstance(w.message, mp.MotionWarning))
        place = 2 + 2 * data.index(b"-2.5")
        assert (warning.name, warning.fact.offset) == ("extra-rows", place)
        clip, layout, *_ = Source(wide).split()
        assert layout.join(clip.values) == wide
        assert mp.decompress(mp.compress(wide)) == wide
