"""From motion files and clips to compressed files."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mocapress.api.clips import (
    Compressed,
    checked_codec,
    compress_clip,
    problems_told,
    stored_name,
)
from mocapress.api.encoding import (
    CodedStream,
    as_printed,
    coded,
    coded_streams,
    placed,
    stored_skeleton,
)
from mocapress.api.long import compress_long
from mocapress.api.opening import Opened
from mocapress.api.plain import compress_plain
from mocapress.api.repetition import Repetition, may_be_smaller
from mocapress.api.restoring import pieces
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.codecs.fallback import first_that_works
from mocapress.codecs.loss import checked_loss
from mocapress.container import Companion, Head, MczWriter, Original, is_storable_time, pack
from mocapress.container.columns import bone_names, bones_of
from mocapress.errors import CorruptError, FormatError, VerificationError
from mocapress.formats import Split
from mocapress.formats.layout_record import write_layout
from mocapress.formats.patterns import References
from mocapress.models import load_model
from mocapress.motion import Clip, Column
from mocapress.source import Named, Source

# Below this size the general-purpose way is tried as well.
_SMALL = 2**15
# Files of stored numbers, unlike text, may repeat themselves.
_SMALL_OF_NUMBERS = 2**23
_ROUNDED = 1e-4
"""How far stored numbers are from those that they stand for, where these are the same."""


def compress(
    source: Named | Clip,
    codec: str | Codec = DEFAULT_CODEC,
    *,
    asf_path: str | Path | None = None,
    embed_asf: bool = False,
    model: Model | str | Path | None = None,
    notes: Mapping[str, str] | None = None,
) -> bytes:
    """Compress a file, its bytes, or a clip to a ``.mcz``.

    Parameters
    ----------
    source
        A path, the contents, or a binary stream, of a motion file or any other; or a clip, of
        which all streams, the skeleton, name and metadata are kept.
    codec
        A codec or its text, ``"app:t=15,table=k3-non-uniform"``. A lossy one is for the first
        stream; others, such as residuals of markers, come back as they are.
    asf_path
        The skeleton of an AMC; without it, the ASF beside the file is taken, if there is one.
    embed_asf
        Whether to store the skeleton of an AMC, too, and its file.
    model
        What the codec learned from other clips (``train``), or its file. Decompressing needs it
        again. Where ``codec`` is a text that names no level, the model's is taken.
    notes
        What to say about the file in it, such as ``source`` and ``license``.

    Returns
    -------
    bytes
        The ``.mcz`` file; it was decoded again and compared with the source. Where a codec fails,
        another way is taken; ``compress_source`` says so.

    Raises
    ------
    ParameterError
        When there is no such codec, or it has no such parameter, or the model is not for it.
    FormatError
        When the ASF that was given cannot be read.
    UnsupportedError
        When a clip holds what a file cannot.
    VerificationError
        When the codec fails at a clip.

    """
    if model is not None and not isinstance(model, Model):
        model = load_model(model)
    if isinstance(source, Clip):
        made = checked_codec(codec, model)
        return compress_clip(made.prepared(source), made, model=model, notes=notes).blob
    opened = Source(source)
    long = None if model is not None else compress_long(opened, codec, notes)
    if long is not None:
        return b"".join(long)
    return compress_source(
        opened, codec, asf_path=asf_path, embed_asf=embed_asf, model=model, notes=notes
    ).blob


def compress_source(
    source: Source,
    codec: str | Codec = DEFAULT_CODEC,
    *,
    asf_path: str | Path | None = None,
    embed_asf: bool = False,
    model: Model | None = None,
    notes: Mapping[str, str] | None = None,
) -> Compressed:
    """Compress a file; see ``compress``."""
    made = checked_codec(codec, model)
    parts, warning = taken_apart(source, asf_path)
    if parts is not None and (prepared := made.prepared(parts.clip)) is not parts.clip:
        found = compress_clip(prepared, made, model=model, notes=notes)
        what = f"{source.format.id if source.format else 'the file'} does not come back"
        return replace(
            found, warning=f"{made.id} keeps joints as markers: {what}; convert writes them"
        )
    embed = embed_asf and source.used is not None
    if embed:
        source.warn_of_guess()
    # The skeleton of another file is stored only where that was asked for.
    return compress_parts(
        source,
        parts,
        made,
        with_skeleton=embed or source.used is None,
        companions=_companions(source) if embed else [],
        model=model,
        notes=notes,
        warning=warning,
    )


def taken_apart(
    source: Source, asf_path: str | Path | None = None
) -> tuple[Split | None, str | None]:
    """Take a file apart; where it is no motion that can be read, say so in a warning instead.

    Raises
    ------
    FormatError
        When the ASF that was given cannot be read.

    """
    if source.format is None:
        return None, "not a motion file; stored by a general-purpose compressor"
    if source.format.split is None:
        return None, None
    try:
        return source.split(asf_path), None
    except FormatError as error:
        if asf_path is not None and error.file == str(asf_path):
            raise
        return None, f"{error}; stored by a general-purpose compressor"


def compress_parts(
    source: Source,
    parts: Split | None,
    codec: Codec,
    *,
    with_skeleton: bool,
    companions: Sequence[Companion] = (),
    model: Model | None = None,
    notes: Mapping[str, str] | None = None,
    warning: str | None = None,
) -> Compressed:
    """Compress a file that was taken apart; see ``compress`` and ``taken_apart``."""
    data = source.data
    found: Compressed | None = None
    if parts is not None:
        warning = problems_told(parts.problems, source)
        reason = unfit(parts, len(data))
        if reason:
            warning = warning or f"{reason}; stored by a general-purpose compressor"
        else:

            def work(way: Codec) -> Compressed:
                own = model if way is codec else None
                clip = with_names(source, parts) if way.can.names else parts.clip
                streams = coded_streams(clip, way, own)
                printed = parts
                if not way.lossless:
                    finer = as_printed(parts.clip, way, streams[0].encoded)
                    printed = with_other_numbers(parts, finer.columns)

                def checked(said: Mapping[str, str] | None) -> Compressed:
                    made = motion_file(
                        printed,
                        source,
                        streams,
                        own,
                        with_skeleton=with_skeleton,
                        companions=companions,
                        notes=said,
                    )
                    return _checked(made, data, way, clip, own)

                found = checked(notes)
                # What was lost is known once the file is decoded, and stands in it.
                return checked(dict(notes or {}) | found.loss.notes()) if found.loss else found

            found, failure = first_that_works(codec, work)
            warning = "; ".join(filter(None, (failure, warning))) or None
    kept = smallest(source, parts, found.blob if found else None, codec, notes)
    close = parts is not None and 2 * len(kept) >= parts.clip.values.size
    if found is not None and found.loss and codec.can.stands_back and close:
        # From four bits a number on, the lossless way may take less.
        exact = compress_parts(
            source,
            parts,
            checked_codec(DEFAULT_CODEC, None),
            with_skeleton=with_skeleton,
            companions=companions,
            notes=notes,
        )
        if len(exact.blob) <= len(kept):
            return exact
    if found is None or kept is not found.blob:
        found = Compressed(kept, None)
    return replace(found, warning=warning)


def with_other_numbers(parts: Split, columns: Sequence[Column]) -> Split:
    """Give a file taken apart as it prints other numbers, with the digits of columns like its own.

    A layout of the format's own says itself how numbers are printed.
    """
    if parts.stored is not None:
        return parts
    clip = parts.clip
    own = zip(clip.columns, columns, strict=True)
    printed = tuple(replace(column, decimal=other.decimal) for column, other in own)
    layout = parts.layout.of_other_numbers(clip.values)
    return parts._replace(clip=clip.with_columns(printed), layout=layout)


def with_names(source: Source, parts: Split) -> Clip:
    """Give a file's clip with the names of its markers, where its layout knows them.

    The numbers are those that the file stores, and units are theirs: ``0.1 mm`` where it stores
    whole numbers of tenths. Columns before those of markers keep their names.
    """
    clip = parts.clip
    if source.format is None:
        return clip
    try:
        told = source.described(source.format, parts.stored, clip).main
    except FormatError:
        return clip
    columns, values = told.columns, told.values
    if clip.channels < len(columns):  # a table does not store columns without any number
        seen = np.flatnonzero(np.isfinite(values).any(axis=0))
        columns, values = tuple(columns[c] for c in seen.tolist()), values[:, seen]
    more = clip.channels - len(columns)
    if more < 0 or told.frames != clip.frames:
        return clip
    raw = clip.values[:, more:]
    known = np.isfinite(raw) & np.isfinite(values) & (raw != 0) & (values != 0)
    times = float(np.median(values[known] / raw[known])) if known.any() else 1.0
    if abs(times - 1) > _ROUNDED:
        scaled = (f"{times!r} {column.unit}" if column.unit else "" for column in columns)
        columns = tuple(
            replace(column, unit=unit) for column, unit in zip(columns, scaled, strict=True)
        )
    return clip.with_columns((*clip.columns[:more], *columns))


def smallest(
    source: Source,
    parts: Split | None,
    blob: bytes | None,
    codec: Codec,
    notes: Mapping[str, str] | None = None,
) -> bytes:
    """Give the file that a codec made, or one of a general-purpose compressor.

    The latter is tried where no codec made one, on small files, where the codec saves little, and
    where rows come again; the smaller is kept.
    """
    size = len(source.data)
    small = _SMALL if parts is None or parts.stored is None else _SMALL_OF_NUMBERS
    if parts is not None and blob is not None and size >= small:
        repetition = Repetition()
        repetition.add(parts.clip.values)
        if not may_be_smaller(repetition, len(blob), source, codec):
            return blob
    plain = compress_plain(source, notes or {})
    return plain if blob is None or len(plain) < len(blob) else blob


def unfit(parts: Split, size: int) -> str | None:
    """Say why a file of so many bytes cannot be compressed as motion; None where it can."""
    clip, layout, *_ = parts
    if not clip.frames:
        return "no frames"
    irregular = layout.verbatim_bytes() + len(layout.tail) > size / 2
    if irregular or not is_storable_time(clip.frame_time):
        return "numbers in no regular form"
    return None


def motion_file(
    parts: Split,
    source: Source,
    streams: Sequence[CodedStream],
    model: Model | None = None,
    *,
    with_skeleton: bool = True,
    companions: Sequence[Companion] = (),
    notes: Mapping[str, str] | None = None,
) -> bytes:
    """Put a file together from a motion file's parts, and what a codec made of its numbers.

    Parameters
    ----------
    parts, source
        The motion file taken apart, and itself.
    streams, model
        What codecs made of the clip's streams, and with what model of the first.
    with_skeleton
        Whether the clip's skeleton is stored.
    companions, notes
        What else is stored.

    """
    clip, layout, problems, stored = parts
    skeleton = stored_skeleton(clip) if with_skeleton else None
    columns, kind = clip.columns, layout.format
    if stored is None:
        columns = columns if skeleton else placed(columns)
        bones = bone_names(bones_of(columns))
        record = write_layout(layout, References.of(skeleton, bones, clip.frame_time))
    else:
        record, kind = stored.record(), stored.format
    name, size = stored_name(source.name), len(source.data)
    original = Original(kind, name, size, source.digest, problems, pack(record))
    heads, chunks = [], []
    for index, ((of_stream, stream), (codec, encoded)) in enumerate(
        zip(clip.streams.items(), streams, strict=True)
    ):
        alone, own = Clip({of_stream: stream}, clip.skeleton), model if index == 0 else None
        head, found = coded(alone, of_stream, index, codec, encoded, own)
        heads.append(head)
        chunks += found
    heads[0] = replace(heads[0], columns=columns)
    made: list[bytes] = []
    writer = MczWriter(made.append)
    writer.head(Head(tuple(heads), skeleton))
    writer.original(original)
    for companion in companions:
        writer.companion(companion)
    if notes:
        writer.notes(notes)
    for chunk in chunks:
        writer.chunk(chunk)
    writer.end()
    return b"".join(made)


def _companions(source: Source) -> list[Companion]:
    used = source.used
    of = source.format
    if used is None or of is None or of.companion is None:
        return []
    return [Companion(of.companion, stored_name(used.file), used.read())]


def _checked(blob: bytes, data: bytes, codec: Codec, clip: Clip, model: Model | None) -> Compressed:
    """Decode a file and compare: bytes of a lossless codec, else values."""
    failure = "the file does not come back"
    try:
        opened = Opened(Source(blob, limit=None), [model] if model else [])
        original = opened.mcz.original
        assert original is not None
        if not codec.lossless:
            for _ in pieces(opened, original):
                pass
            loss = checked_loss(codec, clip, opened.rows().values)
            return Compressed(blob, None, loss, opened.mcz)
        place = 0
        for piece in pieces(opened, original):
            if data[place : place + len(piece)] != piece:
                break
            place += len(piece)
        if place == len(data):
            return Compressed(blob, None, None, opened.mcz)
    except CorruptError as error:
        failure = error.what
    raise VerificationError(f"codec {codec.id} failed its check ({failure}); please report this")
