"""MRPA without parents: it is never larger than APP, and refuses what it does not write."""

from dataclasses import replace

import numpy as np
import pytest

import mocapress as mp
from mocapress.codecs import Chunk, codec
from mocapress.codecs.contract import Encoded
from mocapress.motion import Column, Joint, Skeleton, Stream

FRAMES, JOINTS = 120, 8


def chained(seed: int) -> tuple[Stream, Skeleton]:
    """Give joints whose steps are those of their parents, which nothing else predicts."""
    random = np.random.default_rng(seed)
    steps = np.round(random.normal(0, 3, (FRAMES, 1)), 2)
    values = np.round(np.cumsum(np.repeat(steps, JOINTS, axis=1), axis=0) + 100, 2)
    skeleton = Skeleton(tuple(Joint(f"j{j}", j - 1) for j in range(JOINTS)))
    columns = tuple(Column(f"j{j}.rx", j, "rx") for j in range(JOINTS))
    return Stream(values, columns), skeleton


def size_of(encoded: Encoded) -> int:
    return len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)


@pytest.mark.parametrize("seed", range(3))
def test_where_steps_of_parents_predict_it_is_as_small_as_app(seed: int) -> None:
    stream, skeleton = chained(seed)
    made = codec("mrpa").encode(stream, skeleton=skeleton)
    alone = codec("mrpa").encode(stream)
    others = [
        codec(spec).encode(stream, skeleton=skeleton) for spec in ("app", "app:mantissa_limit=53")
    ]
    assert size_of(made) < size_of(alone)
    assert size_of(made) <= min(map(size_of, others)) + 2 * len(made.chunks)
    back = codec("mrpa").decode(made.header, made.chunks, stream.columns)
    assert back.tobytes() == stream.values.tobytes()


@pytest.mark.parametrize("limit", [0, 54])
def test_a_limit_that_cannot_be_is_refused(limit: int) -> None:
    stream, skeleton = chained(1)
    made = codec("mrpa").encode(stream, skeleton=skeleton)
    payload = made.chunks[0].payload
    assert payload[0] == 0
    wrong = Chunk(0, FRAMES, bytes([0, limit]) + payload[2:])
    with pytest.raises(mp.CorruptError, match="MRPA chunk from frame 0"):
        codec("mrpa").decode(made.header, [wrong], stream.columns)


def test_parents_in_a_circle_are_refused() -> None:
    stream, skeleton = chained(1)
    made = codec("mrpa").encode(stream, skeleton=skeleton)
    circle = made.header[:2] + bytes([1, 1, 2, JOINTS - 1])  # 0 by 1, 1 by 0
    with pytest.raises(mp.CorruptError, match="no tree"):
        codec("mrpa").decode(circle, made.chunks, stream.columns)


def test_a_chunk_of_more_frames_than_there_can_be_is_refused() -> None:
    stream, skeleton = chained(0)
    codec_ = codec("mrpa")
    made = codec_.encode(stream, skeleton=skeleton)
    lie = replace(made.chunks[0], frames=2**30)
    assert made.chunks[0].payload[0] == 0, "coded as APP does"
    with pytest.raises(mp.CorruptError, match="impossible number of frames"):
        codec_.decode(made.header, [lie], stream.columns)
