"""What the skeleton tells about the channels of a frame, beside a literal version of it."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core
from mocapress.codecs.exact import Exact
from mocapress.codecs.exact.skeletons import CMU, NONE, skeleton_of
from mocapress.errors import CorruptError
from mocapress.motion import Clip, Column, Joint, Skeleton
from mocapress.motion.kinematics import positions, rotations

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
KINDS = ("tx", "ty", "tz", "rx", "ry", "rz")


def numbers(text: str) -> Array:
    """Give the numbers of a data file of the format, or of a part of it."""
    return np.array(re.findall(r"-?[\d.]+(?:e[+-]?\d+)?(?=,)", text), dtype=np.float64)


class Table:
    """The bones of core/exact/data/skeleton_cmu_1.txt."""

    def __init__(self) -> None:
        text = (ROOT / "core/exact/data/skeleton_cmu_1.txt").read_text()
        bones, channels = text.split("// channel")
        self.bones = numbers(bones).reshape(-1, 18)
        self.resistances = numbers(channels).reshape(-1, 3)[:, 2]
        self.columns = sorted(
            (int(place), bone, kind)
            for bone, record in enumerate(self.bones)
            for kind, place in zip(KINDS, record[10:16], strict=True)
            if place >= 0
        )

    def clip(self, values: Array) -> Clip:
        """Give a clip of this skeleton; a bone's end is a joint of its own."""
        joints = []
        for i, (parent, *record) in enumerate(self.bones):
            axis, start, end, places = record[:3], record[3:6], record[6:9], record[9:15]
            channels = tuple(k for k, place in zip(KINDS, places, strict=True) if place >= 0)
            joints.append(
                Joint(str(i), int(parent), tuple(start), channels, tuple(axis), ends=(tuple(end),))
            )
        columns = tuple(
            Column(f"{bone}.{kind}", bone, kind, "deg" if kind[0] == "r" else "length")
            for _, bone, kind in self.columns
        )
        return Clip.of(values, columns, skeleton=Skeleton(tuple(joints), "fixed"))


def matrices(turns: Array) -> Array:
    w, x, y, z = np.moveaxis(turns, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def axes(turns: Array) -> Array:
    """Give the axes of rotation matrices, as long as the sines of their angles."""
    return (
        np.stack(
            [turns[..., i, j] - turns[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))], axis=-1
        )
        / 2
    )


def law(table: Table, earlier: Array, last: Array) -> tuple[Array, Array]:
    """Give precision and mean of the second differences after two frames, (C,) each.

    How channels move bones is found by moving each a little.
    """
    pose, step = 2 * last - earlier, 1e-4
    count = len(pose)
    nudged = [pose + sign * step * np.eye(count) for sign in (1, -1)]
    clip = table.clip(np.vstack([*nudged, pose, last, earlier]))
    root = clip.values[:, None, :3]
    ends = positions(clip, end_sites=True)[:, len(table.bones) :]
    turned = matrices(rotations(clip))
    slide = (ends[:count] - ends[count : 2 * count]) / (2 * step)
    whirl = axes(turned[:count] @ turned[count : 2 * count].swapaxes(-1, -2)) / (2 * step)
    masses, inertias = table.bones[:, 16:].T
    pull = 2 * (ends - root)[-2] - (ends - root)[-1] - (ends - root)[-3]
    going = turned[-2] @ turned[-1].swapaxes(-1, -2) @ turned[-2]
    twist = axes(going @ turned[-3].swapaxes(-1, -2))
    precision = (
        np.einsum("abk,cbk,b->ac", slide, slide, masses)
        + np.einsum("abk,cbk,b->ac", whirl, whirl, inertias)
        + np.diag(table.resistances)
    )
    push = np.einsum("abk,bk,b->a", slide, pull, masses) + np.einsum(
        "abk,bk,b->a", whirl, twist, inertias
    )
    return precision, np.linalg.solve(precision, push)


def means(precision: Array, mean: Array, deltas: Array) -> Array:
    """Give each channel's mean given those before it, from the covariance of all."""
    covariance = np.linalg.inv(precision)
    off = deltas - mean
    return np.array(
        [
            mean[k] + covariance[k, :k] @ np.linalg.solve(covariance[:k, :k], off[:k])
            for k in range(len(deltas))
        ]
    )


@pytest.fixture(scope="module")
def walk(samples: Path) -> Clip:
    return mp.read(samples / "cmu_01_01.amc")


@pytest.mark.parametrize("apart", [1, 40])
def test_guesses_are_the_conditional_means(walk: Clip, apart: int) -> None:
    table = Table()
    values = np.ascontiguousarray(walk.values[500::apart][:8])
    guesses = _core.exact_guesses(values, list(range(62)))
    for frame in range(2, 8):
        earlier, last, now = values[frame - 2 : frame + 1]
        precision, mean = law(table, earlier, last)
        expected = means(precision, mean, now - (2 * last - earlier))
        np.testing.assert_allclose(guesses[frame], expected, rtol=1e-5, atol=1e-6)


def test_a_channel_that_is_missing_stays_where_it_is(walk: Clip) -> None:
    table = Table()
    gone = [3, 17, 33, 51]
    left = [place for place in range(62) if place not in gone]
    values = walk.values[500:506].copy()
    values[:, gone] = 0
    guesses = _core.exact_guesses(np.ascontiguousarray(values[:, left]), left)
    precision, mean = law(table, values[3], values[4])
    push = (precision @ mean)[left]
    precision = precision[np.ix_(left, left)]
    deltas = (values[5] - (2 * values[4] - values[3]))[left]
    mean = np.asarray(np.linalg.solve(precision, push), dtype=np.float64)
    expected = means(precision, mean, deltas)
    np.testing.assert_allclose(guesses[5], expected, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("wild", [1e308, -1e300, 1e-300, 1e6, 720.0])
def test_nonsense_gives_finite_guesses(wild: float) -> None:
    rng = np.random.default_rng(3)
    values = rng.choice([wild, -wild, 0, 1], (20, 62))
    assert np.isfinite(_core.exact_guesses(values, list(range(62)))).all()


@pytest.mark.parametrize("places", [[62], [3, 3], [29, 6, 30], [70, 1]])
def test_impossible_places_are_refused(places: list[int]) -> None:
    with pytest.raises(ValueError, match=r"place|stands before"):
        _core.exact_guesses(np.zeros((3, len(places))), places)


@pytest.mark.parametrize("level", [7, 8, 9])
def test_clips_of_the_skeleton_come_back(walk: Clip, level: int) -> None:
    values = walk.values[:300].copy()
    values[:, 30] = 12.5  # constant
    values[:, 41] = values[:, 29]  # a copy
    values[100:110, 50] = [np.nan, np.inf, -np.inf, 1e300, -0.0, 5e-324, 1e6, -1e6, 720, 1]
    codec = Exact(level=level)
    clip = walk[:300].with_values(values)
    coded = codec.encode(clip.main)
    decoded = codec.decode(coded.header, coded.chunks, clip.columns)
    assert decoded.tobytes() == values.tobytes()


def test_geometry_makes_clips_of_the_skeleton_smaller(walk: Clip) -> None:
    known = walk[:1000]
    unknown = known.with_columns(tuple(replace(c, unit="") for c in known.columns))
    assert skeleton_of(known.columns) == CMU
    assert skeleton_of(unknown.columns) == NONE
    small, large = (
        sum(len(chunk.payload) for chunk in Exact(level=9).encode(clip.main).chunks)
        for clip in (known, unknown)
    )
    assert small < 0.995 * large


def test_a_header_cannot_claim_the_skeleton_for_other_columns(walk: Clip) -> None:
    clip = walk[:10]
    coded = Exact(level=9).encode(clip.main)
    with pytest.raises(CorruptError):
        Exact(level=9).decode(coded.header, coded.chunks, clip.columns[:-1])
