"""Some frames of a file, printed as they stand in it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mocapress import formats
from mocapress.api.loading import load_opened
from mocapress.api.opening import Opened
from mocapress.api.reading import printed, read_source
from mocapress.api.restoring import contents, layout_of, own_layout
from mocapress.container import Original, limits
from mocapress.container.columns import bone_names, bones_of
from mocapress.errors import UnsupportedError
from mocapress.formats.header_pattern import announcing
from mocapress.formats.layout import Layout
from mocapress.formats.patterns import References
from mocapress.models import Place
from mocapress.motion import Clip
from mocapress.source import MCZ, Source


def excerpt(source: Source, frames: slice, models: Sequence[Place] = ()) -> bytes:
    """Give a motion file with some of its frames only, each line as it stands in the file.

    The header states the new number of frames. Tables and C3D, whose headers say more of their
    frames, are written anew. Of a ``.mcz``, only the chunks with these frames are decoded.

    Parameters
    ----------
    source
        A motion file, compressed or not.
    frames
        Without a step.
    models
        Where to look for the model that a ``.mcz`` may need, as in ``decompress``.

    Raises
    ------
    CorruptError, FormatError, MissingModelError
        As ``read`` does.
    UnsupportedError
        When the format cannot be written, or there was no file.

    """
    if source.kind != MCZ:
        return _of_motion_file(source, frames)
    opened = Opened(source, models)
    original = opened.mcz.original
    if original is None:
        raise UnsupportedError("there is no original file: this one was recorded")
    if not opened.streams:
        return _of_motion_file(Source(contents(opened, original)), frames)
    if own_layout(original) is not None:
        return _anew(load_opened(opened, frames), original.format)
    return _of_rows(opened, original, frames)


def _of_rows(opened: Opened, original: Original, frames: slice) -> bytes:
    first, last, _ = frames.indices(opened.frames())
    keep = _kept(opened.frames(), frames)
    values = opened.rows(0, first, max(first, last)).values
    layout = layout_of(opened, original, len(values)).rows(keep)
    most = limits.most_printed(original.size, values.size)
    return opened.source.printed(lambda allowed: layout.join(values, allowed), most)


def _of_motion_file(source: Source, frames: slice) -> bytes:
    of = source.format
    if of is None or of.split is None or of.read_layout is not None:
        return _anew(read_source(source)[frames], of.id if of else "")
    parts = source.split()
    source.accept(parts.problems)
    values = parts.clip.values[frames]
    layout = _announcing(parts.layout, parts.clip, len(values))
    return layout.rows(_kept(len(parts.clip), frames)).join(values)


def _kept(count: int, frames: slice) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    keep = np.zeros(count, np.bool_)
    keep[frames] = True
    return keep


def _announcing(layout: Layout, clip: Clip, rows: int) -> Layout:
    """Give the layout with a header for so many rows."""
    bones = bone_names(bones_of(clip.columns))
    references = References.of(clip.skeleton, bones, clip.frame_time)
    return announcing(layout, references, rows, limits.most_layout(2**62, 2**62))


def _anew(clip: Clip, kind: str) -> bytes:
    of = formats.by_id(kind)
    return next(iter(printed(clip, of, Path(f"-{of.suffixes[0]}")).values()))
