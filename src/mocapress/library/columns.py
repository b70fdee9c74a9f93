"""Some columns of a clip."""

from collections.abc import Sequence
from fnmatch import fnmatchcase

from mocapress.errors import ParameterError
from mocapress.motion import Clip, Stream


def with_columns(clip: Clip, wanted: Sequence[str]) -> Clip:
    """Give a clip of only those columns of its first stream that are named, in this order.

    Parameters
    ----------
    clip
        Any clip.
    wanted
        Names of columns, such as ``lfemur.rx``, or globs, such as ``lfemur.*``.

    Raises
    ------
    ParameterError
        When a name is none of the clip's.

    """
    places: list[int] = []
    for pattern in wanted:
        exact = [i for i, column in enumerate(clip.columns) if column.name == pattern]
        found = exact or [
            i for i, column in enumerate(clip.columns) if fnmatchcase(column.name, pattern)
        ]
        if not found:
            some = ", ".join(column.name for column in clip.columns[:3])
            raise ParameterError(
                "no such column", expected=f"a name or glob, e.g. {some}", found=repr(pattern)
            )
        places += [place for place in found if place not in places]
    columns = tuple(clip.columns[place] for place in places)
    name = next(iter(clip.streams))
    stream = Stream(clip.values[:, places], columns, clip.frame_time)
    return Clip({name: stream}, clip.skeleton, clip.name, clip.metadata)
