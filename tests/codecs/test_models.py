"""What every codec keeps that learns from other clips, by being registered.

A clip comes back with the model with which it was coded, whatever the model was learned from; a
damaged, a missing or another model is found out, or gives values of the right shape.
"""

import dataclasses
import hashlib

import numpy as np
import payloads
import pytest
from learner import Learner
from numpy.typing import NDArray
from test_contract import FORMATS, clip_of, on_grid, smooth

from mocapress import codecs
from mocapress.codecs import Codec, Model
from mocapress.errors import CorruptError, ParameterError
from mocapress.motion import Clip, NumberFormat

LEARNERS = [spec for spec in payloads.specs() if codecs.codec(spec).can.trains]
OTHERS = [spec for spec in payloads.specs() if spec not in LEARNERS]
DECIMAL = FORMATS[1]


@pytest.fixture(params=[*LEARNERS, "learner"])
def made(request: pytest.FixtureRequest) -> Codec:
    return Learner() if request.param == "learner" else codecs.codec(request.param)


def trained(made: Codec, *clips: Clip) -> Model:
    return codecs.learner(made).train(clip.main for clip in clips)


def motion(frames: int, channels: int, seed: int, decimal: NumberFormat | None = DECIMAL) -> Clip:
    return clip_of(on_grid(smooth(frames, channels, seed), decimal), decimal)


def decoded(
    made: Codec, clip: Clip, model: Model | None, other: Model | None
) -> NDArray[np.float64]:
    encoded = made.encode(clip.main, model=model)
    return made.decode(encoded.header, encoded.chunks, clip.columns, model=other)


@pytest.mark.parametrize("decimal", FORMATS, ids=lambda f: f.kind.name if f else "binary")
def test_a_clip_comes_back_with_a_model(made: Codec, decimal: NumberFormat | None) -> None:
    model = trained(made, *(motion(300, 6, seed, decimal) for seed in (1, 2, 3)))
    clip = motion(450, 6, 9, decimal)
    assert model.codec == made.id
    assert decoded(made, clip, model, model).tobytes() == clip.values.tobytes()


@pytest.mark.parametrize(
    "values",
    [
        np.empty((0, 6)),
        np.array([[1.5, -2.25, 0.0, 1e300, 5e-324, -0.0]]),
        np.full((300, 6), np.nan),
        np.random.default_rng(3).integers(0, 2**63, (64, 6)).view(np.float64),
        np.empty((0, 0)),
        np.array(smooth(150, 4)),
        np.array(smooth(150, 9)),
    ],
    ids=["no frames", "one frame", "NaN", "noise", "nothing", "fewer columns", "more columns"],
)
def test_clips_unlike_those_learned_from_come_back(
    made: Codec, values: NDArray[np.float64]
) -> None:
    model = trained(made, motion(200, 6, 1), motion(200, 6, 2))
    for decimal in (None, DECIMAL):
        clip = clip_of(values, decimal)
        assert decoded(made, clip, model, model).tobytes() == clip.values.tobytes()


@pytest.mark.parametrize(
    "clips",
    [
        [np.empty((0, 6))],
        [np.empty((0, 0))],
        [np.ones((1, 6))],
        [np.full((50, 6), np.nan), np.full((50, 6), np.inf)],
        [np.tile([1e300, -1e300, 5e-324, -0.0, 1e-310, 7.0], (50, 1))],
        [smooth(100, 6), smooth(100, 4), smooth(3, 9)],
    ],
    ids=["no frames", "nothing", "one frame", "no numbers", "huge", "of many widths"],
)
def test_whatever_was_learned_clips_come_back(
    made: Codec, clips: list[NDArray[np.float64]]
) -> None:
    model = trained(made, *map(clip_of, clips))
    clip = motion(120, 6, 5)
    assert decoded(made, clip, model, model).tobytes() == clip.values.tobytes()


def test_decoding_can_begin_at_every_restart_with_a_model(made: Codec) -> None:
    model = trained(made, motion(300, 6, 1))
    clip = motion(1500, 6, 2)
    encoded = made.encode(clip.main, model=model)
    starts = [i for i, chunk in enumerate(encoded.chunks) if chunk.restart]
    assert starts[0] == 0
    for start in starts:
        chunks = encoded.chunks[start:]
        found = made.decode(encoded.header, chunks, clip.columns, model=model)
        assert found.tobytes() == clip.values[chunks[0].first :].tobytes()


def test_the_same_model_and_bytes_on_every_run(made: Codec) -> None:
    clips = [motion(200, 6, seed) for seed in (1, 2)]
    model = trained(made, *clips)
    assert trained(made, *clips) == model
    assert trained(made, *clips).digest == model.digest
    assert made.encode(clips[0].main, model=model) == made.encode(clips[0].main, model=model)


def test_a_missing_model_is_found_out(made: Codec) -> None:
    with pytest.raises(CorruptError):
        decoded(made, motion(60, 6, 2), trained(made, motion(200, 6, 1)), None)


def right_shape_or_error(made: Codec, clip: Clip, model: Model, other: Model) -> None:
    """That the values are wrong is for the digests to find."""
    try:
        values = decoded(made, clip, model, other)
    except CorruptError:
        return
    assert values.shape == clip.values.shape


def test_another_model_gives_an_error_or_values_of_the_right_shape(made: Codec) -> None:
    clip, model = motion(60, 6, 3), trained(made, motion(200, 6, 1))
    for other in (trained(made, motion(200, 6, 2)), trained(made, motion(100, 5, 1))):
        right_shape_or_error(made, clip, model, other)
        right_shape_or_error(made, clip, other, model)


def places(size: int, most: int = 300) -> list[int]:
    """Give every place of small payloads, and some all over large ones."""
    return sorted({*range(min(size, most // 2)), *np.linspace(0, size - 1, most, dtype=int)})


def test_damaged_models_are_found_out(made: Codec) -> None:
    clip, model = motion(12, 6, 3), trained(made, motion(100, 6, 1))
    damaged = [dataclasses.replace(model, payload=model.payload + b"x")]
    for place in places(len(model.payload)):
        flipped = bytearray(model.payload)
        flipped[place] ^= 1 << place % 8
        damaged += [Model(model.codec, bytes(flipped)), Model(model.codec, model.payload[:place])]
    for broken in damaged:
        right_shape_or_error(made, clip, model, broken)
        right_shape_or_error(made, clip, broken, broken)


def test_codecs_that_learn_refuse_models_of_others(made: Codec) -> None:
    model = trained(made, motion(100, 6, 1))
    codecs.learner(made, model)
    with pytest.raises(ParameterError, match=f"model of another codec; expected {made.id}"):
        codecs.learner(made, dataclasses.replace(model, codec="other"))


@pytest.mark.parametrize("name", OTHERS)
def test_codecs_that_do_not_learn_say_so(name: str) -> None:
    with pytest.raises(ParameterError, match=f"codec {name} takes no model"):
        codecs.learner(codecs.codec(name))


def test_names_of_models_are_those_of_their_contents() -> None:
    digest = hashlib.sha256(b"\x07learner\x03abc").digest()
    assert Model("learner", b"abc").digest == digest
    for other in (Model("learne", b"rabc"), Model("learner", b"ab"), Model("learner", b"abcd")):
        assert other.digest != digest
