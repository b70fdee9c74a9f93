"""What every codec keeps, by being registered.

Round trip (bit for bit, or within the stated error), any chunk alone, odd clips, truncation at
every byte, every flipped bit, the same bytes on every run, sizes that add up.
"""

import dataclasses
import tracemalloc

import numpy as np
import payloads
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from learner import Learner
from numpy.typing import NDArray

from mocapress import codecs
from mocapress.codecs import Bound, Chunk, Codec, Encoded, Scope
from mocapress.errors import CorruptError, ParameterError
from mocapress.formats.number_formats import printed
from mocapress.motion import Clip, Column, Joint, NumberFormat, Skeleton
from mocapress.motion.number_format import NumberKind

LOSSLESS = payloads.specs()
LOSSY = [name for name in codecs.codec_ids() if not codecs.codec(name).lossless]
ALL = [*LOSSLESS, *LOSSY]
FORMATS = [
    None,
    NumberFormat(NumberKind.GENERAL, 6, exponent_digits=3),
    NumberFormat(NumberKind.GENERAL, 17),
    NumberFormat(NumberKind.FIXED, 4),
    NumberFormat(NumberKind.TRIMMED, 6),
    NumberFormat(NumberKind.SCIENTIFIC, 5),
    NumberFormat(NumberKind.SHORTEST),
    NumberFormat(NumberKind.SHORTEST32),
]


def clip_of(values: NDArray[np.float64], decimal: NumberFormat | None = None) -> Clip:
    """Give a clip of a chain of joints with three rotations each."""
    count = values.shape[1]
    joints = tuple(
        Joint(f"j{i}", i - 1, channels=("rx", "ry", "rz")) for i in range(max(1, -(-count // 3)))
    )
    columns = tuple(
        Column(f"j{c // 3}.r{'xyz'[c % 3]}", c // 3, f"r{'xyz'[c % 3]}", "deg", decimal)
        for c in range(count)
    )
    return Clip.of(values, columns, None, Skeleton(joints))


def on_grid(values: NDArray[np.float64], decimal: NumberFormat | None) -> NDArray[np.float64]:
    """Round to what would be read from the text in this format."""
    if decimal is None:
        return values
    texts = printed(values.ravel(), decimal)
    return np.array([float(text) for text in texts]).reshape(values.shape)


def smooth(frames: int, channels: int, seed: int = 0) -> NDArray[np.float64]:
    random = np.random.default_rng(seed)
    time = np.arange(frames)[:, None] / 60
    phase, speed = random.uniform(0, 6, channels), random.uniform(0.2, 3, channels)
    waves = np.sin(time * speed + phase) * random.uniform(0.1, 90, channels)
    return np.asarray(waves + random.normal(0, 1e-3, (frames, channels)))


def encoded_by(codec: Codec, clip: Clip) -> Encoded:
    return codec.encode(clip.main, skeleton=clip.skeleton)


def round_trip(codec: Codec, clip: Clip) -> None:
    encoded = encoded_by(codec, clip)
    assert sum(chunk.frames for chunk in encoded.chunks) == clip.frames
    assert [chunk.first for chunk in encoded.chunks] == list(
        np.cumsum([0, *(chunk.frames for chunk in encoded.chunks)])[:-1]
    )
    decoded = codec.decode(encoded.header, encoded.chunks, clip.columns)
    assert decoded.shape == clip.values.shape
    assert decoded.dtype == np.float64
    assert decoded.tobytes() == clip.values.tobytes()


def whole(codec: Codec, clip: Clip) -> NDArray[np.float64]:
    encoded = encoded_by(codec, clip)
    return codec.decode(encoded.header, encoded.chunks, clip.columns)


def restarts(chunks: tuple[Chunk, ...]) -> list[int]:
    return [i for i, chunk in enumerate(chunks) if chunk.restart]


@pytest.mark.parametrize("name", LOSSLESS)
@pytest.mark.parametrize("decimal", FORMATS, ids=lambda f: f.kind.name if f else "binary")
def test_motion_comes_back(name: str, decimal: NumberFormat | None) -> None:
    round_trip(codecs.codec(name), clip_of(on_grid(smooth(700, 12), decimal), decimal))


@pytest.mark.parametrize("name", LOSSLESS)
@given(
    values=arrays(
        np.uint64,
        st.tuples(st.integers(0, 40), st.integers(1, 7)),
        elements=st.integers(0, 2**64 - 1)
        | st.sampled_from([0, 1 << 63, 0x7FF0 << 48, 0xFFF0 << 48, 0x7FF8 << 48, 1, 0x3FF0 << 48]),
    ),
    decimal=st.sampled_from(FORMATS),
)
def test_any_floats_come_back(
    name: str, values: NDArray[np.uint64], decimal: NumberFormat | None
) -> None:
    """Any bits: NaN with payloads, infinities, -0, denormals, huge numbers, off the grid."""
    round_trip(codecs.codec(name), clip_of(values.view(np.float64), decimal))


@pytest.mark.parametrize("name", LOSSLESS)
@pytest.mark.parametrize(
    "values",
    [
        np.empty((0, 5)),
        np.empty((0, 0)),
        np.array([[1.5, -2.25, 0.0]]),
        np.full((300, 4), 7.125),
        np.zeros((300, 4)),
        np.full((300, 4), np.nan),
        np.tile([1e300, -1e300, 5e-324, np.inf], (50, 1)) * np.resize([1, -1], (50, 1)),
        np.random.default_rng(3).integers(0, 2**63, (64, 3)).view(np.float64),
    ],
    ids=["no frames", "nothing", "one frame", "constant", "zeros", "NaN", "huge", "noise"],
)
def test_odd_clips_come_back(name: str, values: NDArray[np.float64]) -> None:
    for decimal in FORMATS:
        round_trip(codecs.codec(name), clip_of(values, decimal))


@pytest.mark.parametrize("name", LOSSY)
@pytest.mark.parametrize("limit", [0.0, 0.01, 0.5])
@given(
    values=arrays(
        np.float64,
        st.tuples(st.integers(0, 40), st.integers(1, 7)),
        elements=st.floats() | st.floats(-10, 10),
    )
)
def test_errors_stay_within_what_was_asked(
    name: str, limit: float, values: NDArray[np.float64]
) -> None:
    """Every lossy codec takes ``max_error``; what is no finite number comes back as it is."""
    decoded = whole(codecs.codec(f"{name}:max_error={limit}"), clip_of(values))
    finite = np.isfinite(values)
    assert decoded.shape == values.shape
    assert (np.abs(decoded[finite] - values[finite]) <= limit).all()
    assert np.array_equal(decoded[~finite], values[~finite], equal_nan=True)


@pytest.mark.parametrize("name", ALL)
def test_decoding_can_begin_at_every_restart(name: str) -> None:
    clip = clip_of(smooth(4500, 6))
    codec = codecs.codec(name)
    encoded, all_rows = encoded_by(codec, clip), whole(codec, clip)
    assert restarts(encoded.chunks)[0] == 0
    assert len(restarts(encoded.chunks)) > 1
    for start in restarts(encoded.chunks):
        for stop in (start + 1, len(encoded.chunks)):
            chunks = encoded.chunks[start:stop]
            rows = slice(chunks[0].first, chunks[-1].first + chunks[-1].frames)
            decoded = codec.decode(encoded.header, chunks, clip.columns)
            assert decoded.tobytes() == all_rows[rows].tobytes()


@pytest.mark.parametrize("name", ALL)
def test_decoding_stops_where_it_is_asked_to(name: str) -> None:
    clip = clip_of(smooth(1200, 6))
    codec = codecs.codec(name)
    encoded, all_rows = encoded_by(codec, clip), whole(codec, clip)
    borders = [chunk.first for chunk in encoded.chunks]
    for stop in {0, 1, 2, 17, 700, 1199, 1200, 1300, *borders, *(b + 1 for b in borders)}:
        decoded = codec.decode(encoded.header, encoded.chunks, clip.columns, stop=stop)
        assert decoded.shape == all_rows[:stop].shape
        assert decoded.tobytes() == all_rows[:stop].tobytes()


def test_of_many_columns_it_stops_too() -> None:
    """More columns than are coded together."""
    clip = clip_of(smooth(40, 1030))
    encoded = encoded_by(codecs.codec("exact:level=3"), clip)
    decoded = codecs.codec("exact:level=3").decode(
        encoded.header, encoded.chunks, clip.columns, stop=7
    )
    assert decoded.tobytes() == clip.values[:7].tobytes()


@pytest.mark.parametrize("name", ["exact", "exact:level=1"])
def test_what_is_behind_the_stop_is_not_read(name: str) -> None:
    clip = clip_of(smooth(500, 6))
    encoded = encoded_by(codecs.codec(name), clip)
    (chunk,) = encoded.chunks
    changed = chunk.payload[:-1] + bytes([chunk.payload[-1] ^ 0xFF])
    damaged = dataclasses.replace(chunk, payload=changed)
    decoded = codecs.codec(name).decode(encoded.header, [damaged], clip.columns, stop=100)
    assert decoded.tobytes() == clip.values[:100].tobytes()
    rest = decode_broken(codecs.codec(name), encoded.header, damaged, clip.columns)
    assert rest is None or rest.tobytes() != clip.values.tobytes()


@pytest.mark.parametrize("name", codecs.codec_ids())
def test_what_it_can_is_declared(name: str) -> None:
    made = codecs.codec(name)
    parameters = {field.name for field in dataclasses.fields(made)}  # type: ignore[arg-type]
    assert made.can.levels == ("level" in parameters)
    assert (Bound.MEAN in made.can.bounds) == ("target_psnr" in parameters)
    assert (Bound.LARGEST in made.can.bounds) == ("max_error" in parameters)
    for capability, method in (
        (made.can.trains, "train"),
        (made.can.document, "document"),
        (made.can.measured, "measure"),
        (made.can.scope is Scope.LIBRARY, "encode_together"),
    ):
        assert capability == (getattr(type(made), method) is not getattr(Codec, method))
    assert made.can.lossless == (not made.can.bounds)


@pytest.mark.parametrize("name", ALL)
def test_the_same_bytes_on_every_run(name: str) -> None:
    clip = clip_of(on_grid(smooth(600, 9), FORMATS[1]), FORMATS[1])
    assert encoded_by(codecs.codec(name), clip) == encoded_by(codecs.codec(name), clip)


@pytest.mark.parametrize("spec", payloads.specs())
def test_the_same_bytes_on_every_machine(spec: str) -> None:
    """The digests were made once; ``tests/golden/make.py`` makes those of new codecs."""
    assert payloads.digests(spec) == payloads.golden(spec).read_bytes()


def decode_broken(
    codec: Codec, header: bytes, chunk: Chunk, columns: tuple[Column, ...]
) -> NDArray[np.float64] | None:
    try:
        return codec.decode(header, [chunk], columns)
    except CorruptError:
        return None


@pytest.mark.parametrize("name", ALL)
def test_truncated_payloads_are_found_out(name: str) -> None:
    clip = clip_of(smooth(25, 4))
    codec = codecs.codec(name)
    encoded = encoded_by(codec, clip)
    chunk = encoded.chunks[0]
    for length in range(len(chunk.payload)):
        cut = dataclasses.replace(chunk, payload=chunk.payload[:length])
        assert decode_broken(codec, encoded.header, cut, clip.columns) is None
    for length in range(len(encoded.header)):
        found = decode_broken(codec, encoded.header[:length], chunk, clip.columns)
        assert found is None or found.tobytes() != whole(codec, clip).tobytes()


@pytest.mark.parametrize("name", ALL)
def test_flipped_bits_give_an_error_or_values_of_the_right_shape(name: str) -> None:
    """That they are wrong is for the container's checksums to find."""
    clip = clip_of(smooth(25, 4))
    codec = codecs.codec(name)
    encoded = encoded_by(codec, clip)
    chunk = encoded.chunks[0]
    for bit in range(8 * len(chunk.payload)):
        flipped = bytearray(chunk.payload)
        flipped[bit // 8] ^= 1 << bit % 8
        broken = dataclasses.replace(chunk, payload=bytes(flipped))
        found = decode_broken(codec, encoded.header, broken, clip.columns)
        assert found is None or found.shape == clip.values.shape
    for bit in range(8 * len(encoded.header)):
        header = bytearray(encoded.header)
        header[bit // 8] ^= 1 << bit % 8
        found = decode_broken(codec, bytes(header), chunk, clip.columns)
        assert found is None or found.shape == clip.values.shape


@pytest.mark.parametrize("name", ALL)
def test_memory_does_not_follow_announcements(name: str) -> None:
    clip = clip_of(smooth(25, 4))
    codec = codecs.codec(name)
    encoded = encoded_by(codec, clip)
    for frames in (26, 10**6, 10**12):
        lie = dataclasses.replace(encoded.chunks[0], frames=frames)
        tracemalloc.start()
        decode_broken(codec, encoded.header, lie, clip.columns)
        assert tracemalloc.get_traced_memory()[1] < max(64 * 2**20, 4 * 8 * 4 * min(frames, 10**6))
        tracemalloc.stop()


@pytest.mark.parametrize("name", codecs.codec_ids())
def test_parameters_travel_as_text(name: str) -> None:
    made = codecs.codec(name)
    assert codecs.spec(made) == name
    assert codecs.codec(codecs.spec(made)) == made
    with pytest.raises(ParameterError, match="no such parameter"):
        codecs.codec(f"{name}:colour=red")


def test_changed_parameters_travel_as_text() -> None:
    made = codecs.codec("app:t=10,table=k2-non-uniform")
    assert codecs.spec(made) == "app:t=10,table=k2-non-uniform"
    for wrong in ("nothing", "app:t=0", "app:t=x", "app:table=zero", "app:t"):
        with pytest.raises(ParameterError):
            codecs.codec(wrong)


@pytest.mark.parametrize("name", codecs.codec_ids())
def test_levels_are_parameters(name: str) -> None:
    made = codecs.codec(name)
    for level in (1, 9):
        if made.can.levels:
            assert codecs.with_level(made, level) == codecs.codec(f"{name}:level={level}")
        else:
            with pytest.raises(ParameterError, match=f"codec {name} has no levels"):
                codecs.with_level(made, level)


def test_there_are_nine_levels() -> None:
    assert codecs.spec(codecs.with_level(Learner(), 1)) == "learner:level=1"
    for wrong in (0, 10):
        with pytest.raises(ParameterError, match="level; expected 1 to 9"):
            codecs.with_level(Learner(), wrong)
