"""The codec ``qssd``: what is lost, models, odd clips; both readers agree in tests/reader."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress import codecs
from mocapress.codecs import Encoded, Model
from mocapress.codecs.qssd.body import body_of
from mocapress.codecs.qssd.quaternions import turned_degrees
from mocapress.errors import CorruptError, ParameterError, UnsupportedError
from mocapress.motion.kinematics import local_rotations, positions

Array = NDArray[np.float64]
CENTIMETRES = 2.54 / 0.45


@pytest.fixture(scope="module")
def walk() -> mp.Clip:
    return mp.read(Path(__file__).parents[2] / "samples/cmu_01_01.amc")[:1200]


@pytest.fixture(scope="module")
def model(walk: mp.Clip) -> Model:
    return mp.train([walk], "qssd:atoms=12,iterations=4,omit=2")


def coded(codec: str, clip: mp.Clip, model: Model | None = None) -> tuple[Encoded, mp.Clip]:
    made = codecs.codec(codec)
    encoded = made.encode(clip.main, skeleton=clip.skeleton, model=model)
    values = made.decode(encoded.header, encoded.chunks, clip.columns, model=model)
    return encoded, clip.with_values(values)


def size(encoded: Encoded) -> int:
    return len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)


def arms(clip: mp.Clip, other: mp.Clip) -> float:
    """Eq. 12, centimetres."""
    squares = ((positions(clip) - positions(other)) ** 2).sum(axis=-1)
    return CENTIMETRES * float(np.sqrt(squares.mean(axis=-1)).mean())


@pytest.mark.parametrize("source", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
def test_a_smaller_step_costs_more_and_loses_less(samples: Path, source: str) -> None:
    clip = mp.read(samples / source)[:600]
    made = [coded(f"qssd:omit=1,step={step}", clip) for step in (0.1, 0.4, 1.6)]
    sizes = [size(encoded) for encoded, _ in made]
    errors = [
        float(turned_degrees(local_rotations(clip), local_rotations(back)).mean())
        for _, back in made
    ]
    assert sizes == sorted(sizes, reverse=True)
    assert errors == sorted(errors)
    assert errors[0] < 0.5


def test_the_step_is_about_centimetres(walk: mp.Clip) -> None:
    for step in (0.1, 0.3):
        assert step / 2 < arms(walk, coded(f"qssd:omit=0,step={step}", walk)[1]) < 3 * step


def test_a_dictionary_saves_much(walk: mp.Clip, model: Model) -> None:
    without, plain = coded("qssd:omit=2", walk)
    learned, back = coded("qssd:omit=2", walk, model)
    assert size(learned) < 0.9 * size(without)
    assert arms(walk, back) < 1.3 * arms(walk, plain)


def test_training_repeats(walk: mp.Clip, model: Model) -> None:
    again = mp.train([walk], "qssd:atoms=12,iterations=4,omit=2")
    other = mp.train([walk], "qssd:atoms=12,iterations=4,omit=2,seed=1")
    assert again == model != other


def test_a_model_serves_any_settings_and_clips(walk: mp.Clip, model: Model) -> None:
    """Of the same columns; others are coded without it."""
    shorter = walk[100:350:2]
    for spec in ("qssd:omit=0,levels=3", "qssd:levels=12", "qssd:levels=0,omit=0", "qssd:most=1"):
        encoded, back = coded(spec, shorter, model)
        assert encoded.header[0] == 1
        assert arms(shorter, back) < 4
    fewer = mp.Clip.of(walk.values[:, :40], walk.columns[:40], None, walk.skeleton)
    encoded, back = coded("qssd", fewer, model)
    assert encoded.header[0] == 0
    assert np.array_equal(back.values, coded("qssd", fewer)[1].values)


def test_a_clip_that_needs_its_model_says_so(walk: mp.Clip, model: Model) -> None:
    encoded, _ = coded("qssd", walk, model)
    with pytest.raises(CorruptError, match="coded with a model"):
        codecs.codec("qssd").decode(encoded.header, encoded.chunks, walk.columns)


def test_damaged_models_are_refused_or_harmless(walk: mp.Clip, model: Model) -> None:
    codec, clip = codecs.codec("qssd"), walk[:40]
    encoded, _ = coded("qssd", clip, model)
    random = np.random.default_rng(0)
    refused = 0
    for place in [*range(60), *random.integers(0, len(model.payload), 100).tolist()]:
        flipped = bytearray(model.payload)
        flipped[place] ^= 1 << place % 8
        for payload in (model.payload[:place], bytes(flipped)):
            damaged = replace(model, payload=payload)
            try:
                codec.encode(clip.main, model=damaged)
                codec.decode(encoded.header, encoded.chunks, clip.columns, model=damaged)
            except CorruptError:
                refused += 1
    assert refused >= 160


@pytest.mark.parametrize("frames", [0, 1, 2, 3, 65, 66])
def test_few_frames(walk: mp.Clip, model: Model, frames: int) -> None:
    for own in (None, model):
        encoded, back = coded("qssd:step=0.1,max_error=0.5", walk[:frames], own)
        assert back.values.shape == (frames, walk.channels)
        assert (np.abs(back.values - walk.values[:frames]) <= 0.5).all()
        assert len(encoded.chunks) == (1 if frames else 0)


def test_a_still_clip_costs_next_to_nothing(walk: mp.Clip) -> None:
    still = walk.with_values(np.tile(walk.values[:1], (walk.frames, 1)))
    encoded, back = coded("qssd:step=0.1", still)
    # A bit for each number of a frame that is coded, of which each costs less and less.
    assert sum(len(chunk.payload) for chunk in encoded.chunks) < 900
    assert arms(still, back) < 0.3
    assert np.ptp(back.values, axis=0).max() < 1e-9


def test_what_is_no_number_comes_back(walk: mp.Clip, model: Model) -> None:
    values = walk.values[:300].copy()
    values[10:20, 5] = np.nan
    values[:, 30] = -np.inf
    values[0] = np.nan
    values[50, 8] = 1e300
    values[60, 0] = -1e18
    clip = walk[:300].with_values(values)
    for own in (None, model):
        back = coded("qssd", clip, own)[1].values
        odd = ~(np.abs(values) < 1e15)
        np.testing.assert_array_equal(back[odd], values[odd])
        near = np.where(odd, 0, values)[:, :3] - np.where(odd, 0, back)[:, :3]
        assert np.abs(near).max() < 1


def test_angles_follow_each_other(walk: mp.Clip) -> None:
    """Whole turns and both sets of Euler angles: decoded columns do not jump."""
    values = walk.values[:400].copy()
    values[:, 4] = np.linspace(-500, 700, 400)  # root.ry
    clip = walk[:400].with_values(values)
    back = coded("qssd:step=0.05,omit=0", clip)[1]
    assert np.abs(np.diff(back.values[:, 3:6], axis=0)).max() < 30
    assert float(turned_degrees(local_rotations(clip), local_rotations(back)).max()) < 5


def test_gimbal_lock_keeps_the_turn() -> None:
    joints = (mp.Joint("a", -1, channels=("rz", "ry", "rx")),)
    columns = tuple(mp.Column(f"a.{kind}", 0, kind, "deg") for kind in joints[0].channels)
    values = np.array([[30.0, 90.0, 10.0], [30.0, -90.0, 10.0], [0.0, 90.0, 0.0]])
    clip = mp.Clip.of(values, columns, None, mp.Skeleton(joints))
    back = coded("qssd:step=0.01,omit=0,levels=0", clip)[1]
    assert float(turned_degrees(local_rotations(clip), local_rotations(back)).max()) < 0.1


def test_radians_are_radians(walk: mp.Clip) -> None:
    assert walk.skeleton is not None
    turns = np.array([column.kind[0] == "r" for column in walk.columns])
    columns = tuple(
        replace(column, unit="rad") if column.kind[0] == "r" else column for column in walk.columns
    )
    values = np.where(turns, np.radians(walk.values), walk.values)
    radians = mp.Clip.of(values, columns, None, walk.skeleton)
    degrees = coded("qssd", walk)[1].values
    found = coded("qssd", radians)[1].values
    np.testing.assert_allclose(np.where(turns, np.degrees(found), found), degrees, atol=1e-6)


def test_columns_are_joints_and_numbers(walk: mp.Clip) -> None:
    body = body_of(walk.columns, walk.skeleton)
    assert sum(role == 0 for role in body.roles) == 3
    assert sum(0 < role < 4 for role in body.roles) == len(body.importance) == 29
    assert body.reversed
    assert body.apart.index(True) == 0
    assert not any(body.apart[1:])
    by_name = dict(
        zip(
            [c.name for c, r in zip(walk.columns, body.roles, strict=True) if 0 < r < 4],
            body.importance,
            strict=True,
        )
    )
    assert by_name["lowerback.rx"] > by_name["lfemur.rx"] > by_name["ltibia.rx"]
    assert by_name["ltibia.rx"] > by_name["lfoot.rx"]
    assert body_of(walk.columns, None).roles == body.roles


@pytest.mark.parametrize(
    "wrong", ["step=0", "step=nan", "omit=7", "levels=17", "most=65", "max_error=-1", "chunk=0"]
)
def test_wrong_parameters_are_refused(wrong: str) -> None:
    with pytest.raises(ParameterError, match=f"qssd:{wrong.partition('=')[0]}"):
        codecs.codec(f"qssd:{wrong}")


@pytest.mark.parametrize(("source", "most"), [("cmu_01_01.amc", 0.1), ("freebvh.bvh", 0.5)])
def test_protected_feet_stay_where_they_stand(samples: Path, source: str, most: float) -> None:
    clip = mp.read(samples / source)[:600]
    assert clip.skeleton is not None
    standing = clip.contacts(fps=120)
    joints = [clip.skeleton.index(name) for name in standing]
    frames = np.stack([*standing.values()], axis=1)

    def farthest(codec: str, model: Model | None = None) -> tuple[int, float]:
        encoded, back = coded(codec, clip, model)
        apart = np.linalg.norm(positions(clip)[:, joints] - positions(back)[:, joints], axis=-1)
        return size(encoded), float(apart[frames].max())

    without, far = farthest("qssd:step=1")
    assert far > most
    sizes = [without]
    for limit in (most, most / 10):
        bytes_, kept = farthest(f"qssd:step=1,protect={limit}")
        assert kept <= limit
        sizes.append(bytes_)
    assert sizes == sorted(sizes)
    learned = mp.train([clip], "qssd:atoms=4,iterations=2")
    assert farthest(f"qssd:step=1,protect={most}", learned)[1] <= most


def test_protected_feet_and_bounded_values_are_kept_together(walk: mp.Clip) -> None:
    clip = walk[:300]
    _, back = coded("qssd:protect=0.05,max_error=2", clip)
    assert np.abs(back.values - clip.values).max() <= 2
    for name, frames in clip.contacts(fps=120).items():
        assert clip.skeleton is not None
        joint = clip.skeleton.index(name)
        apart = np.linalg.norm(positions(clip)[:, joint] - positions(back)[:, joint], axis=-1)
        assert apart[frames].max(initial=0) <= 0.05


def test_feet_are_protected_only_where_there_are_some(walk: mp.Clip) -> None:
    made = codecs.codec("qssd:protect=0.1")
    with pytest.raises(UnsupportedError, match="skeleton"):
        made.encode(walk.main)
    with pytest.raises(ParameterError, match="protect"):
        codecs.codec("qssd:protect=0")
    still = walk[:1]
    encoded = made.encode(still.main, skeleton=still.skeleton)
    assert made.decode(encoded.header, encoded.chunks, still.columns).shape == still.values.shape


def test_a_model_of_another_skeleton_is_not_needed(samples: Path, model: Model) -> None:
    clip = mp.read(samples / "freebvh.bvh")
    packed = mp.compress(clip, "qssd", model=model)
    assert packed == mp.compress(clip, "qssd")
    assert mp.load(packed).frames == clip.frames
    own = mp.compress(mp.read(samples / "cmu_01_01.amc")[:200], "qssd", model=model)
    with pytest.raises(mp.MocapressError, match="model"):
        mp.load(own)
