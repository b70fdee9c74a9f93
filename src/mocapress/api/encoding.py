"""From the numbers of a clip to the head and the chunks of a file."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapress import codecs
from mocapress.api.opening import decoded, digest
from mocapress.codecs import DEFAULT_CODEC, Codec, Encoded, Model
from mocapress.container import CodecSpec, CodedChunk, Entry, StreamHead, is_storable
from mocapress.errors import UnsupportedError
from mocapress.motion import Clip, Column, Skeleton, Stream

LONGEST_CHUNK = 2**20


def stream_head(
    name: str,
    stream: Stream,
    codec: Codec,
    *,
    frames: int | None,
    left_out: Collection[str] = (),
) -> StreamHead:
    """Give what a file says about a stream, but for what its codec adds.

    Parameters that are ``left_out`` it does not name.
    """
    named = {key: value for key, value in codecs.parameters(codec).items() if key not in left_out}
    spec = CodecSpec(codec.id, named)
    return StreamHead(name, frames, stream.frame_time, stream.columns, spec)


def coded(
    clip: Clip, name: str, index: int, codec: Codec, encoded: Encoded, model: Model | None
) -> tuple[StreamHead, list[CodedChunk]]:
    """Give what a file holds of the first stream of a clip: its stream ``index``, ``name``."""
    head = replace(
        stream_head(name, clip.main, codec, frames=clip.frames, left_out=codec.left_out()),
        model=model.digest if model and encoded.uses_model else b"",
        header=encoded.header,
    )
    return head, coded_chunks(clip, head, index, codec, encoded, model)


def coded_chunks(
    clip: Clip,
    head: StreamHead,
    index: int,
    codec: Codec,
    encoded: Encoded,
    model: Model | None,
    *,
    first: int = 0,
    own_header: bool = False,
) -> list[CodedChunk]:
    """Give chunks as a file holds them: with the digests of what they decode to.

    Parameters
    ----------
    clip, encoded
        Frames, and what the codec made of them.
    head, index
        Of the stream that they belong to.
    codec, model
        What they were coded with.
    first
        In the stream, of the clip's first frame.
    own_header
        Whether each chunk is to carry the codec header.

    """
    values: NDArray[np.float64] = clip.values
    if not codec.lossless and encoded.chunks:
        values = decoded(codec, encoded.header, encoded.chunks, head, model, clip.frames)
    chunks = []
    for chunk in encoded.chunks:
        rows = values[chunk.first : chunk.first + chunk.frames]
        begin, dependent = first + chunk.first, bool(chunk.needs)
        entry = Entry(index, begin, chunk.frames, chunk.restart, own_header, dependent, 0, 0)
        header = encoded.header if own_header else b""
        chunks.append(CodedChunk(entry, digest(rows), header, chunk.payload, chunk.needs))
    return chunks


class CodedStream(NamedTuple):
    """What a codec made of a stream."""

    codec: Codec
    encoded: Encoded


def coded_streams(
    clip: Clip, codec: Codec, model: Model | None, whole: Clip | None = None
) -> list[CodedStream]:
    """Code all streams of a motion file; a lossy codec and the model are for the first.

    ``whole`` is the file's clip where some of its frames are not coded.
    """
    made = []
    whole = whole or clip
    for index, (name, stream) in enumerate(clip.streams.items()):
        way = codec if index == 0 or codec.lossless else codecs.codec(DEFAULT_CODEC)
        # Chunks of all streams last as long.
        times = whole.streams[name].frames // whole.frames
        chunk = getattr(way, "chunk", None)
        if chunk and times > 1:
            way = codecs.from_parameters(
                way.id, {**codecs.parameters(way), "chunk": min(chunk * times, LONGEST_CHUNK)}
            )
        own = model if index == 0 else None
        made.append(CodedStream(way, way.encode(stream, skeleton=clip.skeleton, model=own)))
    return made


def as_printed(clip: Clip, codec: Codec, encoded: Encoded) -> Clip:
    """Give a clip that was coded with digits enough to print what a lossy codec made of it."""
    more = codec.more_digits(clip, encoded)
    columns = (
        replace(column, decimal=column.decimal and column.decimal.finer(more))
        for column in clip.columns
    )
    return clip.with_columns(tuple(columns))


def placed(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Give columns whose joints are numbered in the order of appearance."""
    places: dict[int, int] = {}
    return tuple(
        replace(column, joint=places.setdefault(column.joint, len(places))) for column in columns
    )


def stored_skeleton(clip: Clip) -> Skeleton | None:
    """Give a clip's skeleton as far as a file can hold it.

    Raises
    ------
    UnsupportedError
        When it cannot.

    """
    if clip.skeleton is not None and not is_storable(clip.skeleton):
        raise UnsupportedError("a skeleton with channels of unknown kinds cannot be stored")
    return clip.skeleton
