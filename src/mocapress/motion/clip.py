"""A clip: streams of numbers recorded together, with the skeleton that they move."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from types import MappingProxyType
from typing import Self, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from mocapress.motion.frame_time import FrameTime
from mocapress.motion.skeleton import Skeleton, near
from mocapress.motion.stream import Column, Stream

MOTION = "motion"
"""Name of the stream that holds the channels of a skeleton's joints."""


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """One take: named streams, the first of which is the one that most clips have alone.

    Immutable: operations give new clips, arrays are read-only.

    Attributes
    ----------
    streams
        At least one.
    skeleton
        What the joints of the stream ``motion`` belong to.
    name
        Of the take, usually its file's name without suffix.
    metadata
        What else the file says, and which skeleton was used (``skeleton``, ``skeleton_found``).

    """

    streams: Mapping[str, Stream]
    skeleton: Skeleton | None = None
    name: str = ""
    metadata: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.streams:
            msg = "a clip needs at least one stream"
            raise ValueError(msg)
        object.__setattr__(self, "streams", MappingProxyType(dict(self.streams)))

    def __repr__(self) -> str:
        """Say what it is in a line, without the numbers."""
        streams = ", ".join(f"{name}: {stream!r}" for name, stream in self.streams.items())
        joints = f"{len(self.skeleton.joints)} joints" if self.skeleton else "no skeleton"
        return f"<Clip {self.name!r}: {streams}, {joints}>"

    @classmethod
    def of(
        cls,
        values: NDArray[np.float64],
        columns: tuple[Column, ...],
        frame_time: FrameTime = None,
        skeleton: Skeleton | None = None,
        name: str = "",
    ) -> Self:
        """Make a clip of one stream, ``motion``, from (F, C) values."""
        return cls({MOTION: Stream(values, columns, frame_time)}, skeleton, name)

    @classmethod
    def from_array(
        cls, values: ArrayLike, names: Sequence[str], fps: float | None = None, *, name: str = ""
    ) -> "Clip":
        """Make a clip of numbers with names, (F, C); see ``mp.from_array``."""
        from mocapress.motion.building import from_array

        return from_array(values, names, fps, name=name)

    @classmethod
    def from_positions(
        cls,
        positions: ArrayLike,
        names: Sequence[str],
        fps: float | None = None,
        *,
        parents: Sequence[int] | None = None,
        name: str = "",
    ) -> "Clip":
        """Make a clip of points in space, (F, P, 3); see ``mp.from_positions``."""
        from mocapress.motion.building import from_positions

        return from_positions(positions, names, fps, parents=parents, name=name)

    @classmethod
    def from_quaternions(
        cls,
        rotations: ArrayLike,
        offsets: ArrayLike,
        parents: Sequence[int],
        names: Sequence[str],
        fps: float | None = None,
        *,
        root: ArrayLike | None = None,
        name: str = "",
    ) -> "Clip":
        """Make a clip of joints' rotations, (F, J, 4); see ``mp.from_quaternions``."""
        from mocapress.motion.building import from_quaternions

        return from_quaternions(rotations, offsets, parents, names, fps, root=root, name=name)

    @property
    def main(self) -> Stream:
        """The first stream; ``values``, ``columns`` and so on are its own."""
        return next(iter(self.streams.values()))

    @property
    def values(self) -> NDArray[np.float64]:
        """(F, C) float64, read-only, of the first stream."""
        return self.main.values

    @property
    def columns(self) -> tuple[Column, ...]:
        """Columns of the first stream."""
        return self.main.columns

    @property
    def frame_time(self) -> FrameTime:
        """Seconds per frame of the first stream; None where the source does not say."""
        return self.main.frame_time

    @property
    def frames(self) -> int:
        """Number of frames of the first stream, F."""
        return self.main.frames

    @property
    def channels(self) -> int:
        """Number of channels of the first stream, C."""
        return self.main.channels

    @property
    def fps(self) -> float | None:
        """Frames per second of the first stream; None where the source does not say."""
        return float(1 / Fraction(self.frame_time)) if self.frame_time else None

    @property
    def duration(self) -> float | None:
        """Seconds that all frames of the first stream last; None where that is not known."""
        return None if self.frame_time is None else float(Fraction(self.frame_time) * self.frames)

    @property
    def times(self) -> NDArray[np.float64]:
        """(F,) seconds from the first frame to each frame of the first stream.

        Raises
        ------
        ValueError
            When the frame time is not known; ``mp.retime(clip, fps)`` states it.

        """
        if self.frame_time is None:
            msg = "the frame time is not known; mp.retime(clip, fps) states it"
            raise ValueError(msg)
        return np.arange(self.frames, dtype=np.float64) * np.float64(self.frame_time)

    def __len__(self) -> int:
        """Give the number of frames of the first stream."""
        return self.frames

    def __array__(
        self, dtype: DTypeLike | None = None, copy: bool | None = None
    ) -> NDArray[np.float64]:
        """Give ``values`` to NumPy: ``np.asarray(clip)``."""
        if dtype not in (None, self.values.dtype) or copy:
            return np.array(self.values, dtype)
        return self.values

    def __bool__(self) -> bool:
        """Say yes, also of a clip without frames."""
        return True

    def joint(self, name: str) -> NDArray[np.float64]:
        """Give the channels of a joint, (F, c) in the order of the columns.

        Raises
        ------
        KeyError
            When no column is a joint's of this name.

        """
        found = [
            c
            for c, column in enumerate(self.columns)
            if column.joint >= 0 and column.name.rpartition(".")[0] == name
        ]
        if not found:
            raise KeyError(near(name, [c.name.rpartition(".")[0] for c in self.columns]))
        return self.values[:, found]

    def _repr_html_(self) -> str | None:
        """Play the clip in a notebook.

        The model draws nothing itself: whoever can announces it as ``mocapress.display``.
        """
        from importlib.metadata import entry_points

        for offer in entry_points(group="mocapress.display", name="html"):
            return str(offer.load()(self)) if self.frames else None
        return None

    def contacts(
        self,
        joints: Sequence[str] | None = None,
        *,
        speed: float | None = None,
        height: float | None = None,
        fps: float | None = None,
    ) -> dict[str, NDArray[np.bool_]]:
        """Find the frames in which joints stand still on the floor.

        A joint stands where it is slow, and hardly above its own lowest places. So the floor need
        not be at height 0, but it has to be level: of stairs only the lowest step counts. Contacts
        shorter than 0.05 s do not count, nor do such gaps. Up is y, or z where the figure is longer
        along it and its lowest joint steadier.

        Parameters
        ----------
        joints
            Names of joints. By default those that are called foot, toe, ankle or heel.
        speed
            Length units a second up to which a joint stands; by default 0.15 of the figure's size.
        height
            Length units above its lowest places; by default 0.04 of the figure's size.
        fps
            Frames a second of a clip that does not state them.

        Returns
        -------
        dict
            By joint, (F,) bool.

        Raises
        ------
        ParameterError
            When there is no joint of a given name.
        UnsupportedError
            When the clip has no skeleton, no joint of a foot, bones that stretch, or no rate.

        """
        from mocapress.motion.contacts import contacts

        return contacts(self, joints, speed=speed, height=height, fps=fps)

    @overload
    def __getitem__(self, key: slice) -> Self: ...

    @overload
    def __getitem__(self, key: str) -> NDArray[np.float64]: ...

    def __getitem__(self, key: slice | str) -> Self | NDArray[np.float64]:
        """Give some of the frames, ``clip[a:b:step]``, or a column, ``clip["root.tx"]``.

        Frames are taken by Python's rules for slices, and the frame time follows the step: every
        second frame lasts twice as long. With a step below zero the clip runs backwards. All
        streams have to share their frames. A column is (F,), of the first stream.

        Raises
        ------
        KeyError
            When there is no such column.
        TypeError
            When it is neither. One frame is ``clip[a : a + 1]``, or ``clip.values[a]``.
        ValueError
            When the streams have different frames.

        """
        if isinstance(key, str):
            return self._column(key)
        if not isinstance(key, slice):
            msg = f"a clip takes a slice, such as clip[10:11], or a column's name, not {key!r}"
            raise TypeError(msg)
        step = abs(range(self.frames)[key].step)
        if any(
            (stream.frames, stream.frame_time) != (self.frames, self.frame_time)
            for stream in self.streams.values()
        ):
            msg = "the streams of this clip differ in their frames"
            raise ValueError(msg)
        frame_time = None if self.frame_time is None else self.frame_time * step
        streams = {
            name: replace(stream, values=stream.values[key], frame_time=frame_time)
            for name, stream in self.streams.items()
        }
        return replace(self, streams=streams)

    def _column(self, name: str) -> NDArray[np.float64]:
        names = [column.name for column in self.columns]
        if name not in names:
            raise KeyError(near(name, names))
        return self.values[:, names.index(name)]

    def with_values(self, values: NDArray[np.float64]) -> Self:
        """Give the same clip with other values in the first stream.

        Parameters
        ----------
        values
            (F, C), of as many frames as before: what other frames would last is not known here.
            ``clip[a:b:step]`` takes some of the frames, ``with_frames`` puts others in.

        Raises
        ------
        ValueError
            When there are more or fewer frames or channels.

        """
        if len(values) != self.frames:
            msg = f"{len(values)} frames of values for a clip of {self.frames}; see with_frames"
            raise ValueError(msg)
        return self._with_main(values=values)

    def with_frames(self, values: NDArray[np.float64], frame_time: FrameTime) -> Self:
        """Give the same clip with other frames in the first stream, and what each lasts.

        Parameters
        ----------
        values
            (F', C), of any number of frames.
        frame_time
            Seconds per frame; None where it is not known.

        """
        return self._with_main(values=values, frame_time=frame_time)

    def with_columns(self, columns: tuple[Column, ...]) -> Self:
        """Give the same clip with other columns in the first stream, as many as before."""
        return self._with_main(columns=columns)

    def with_frame_time(self, frame_time: FrameTime) -> Self:
        """Give the same frames with another frame time in the first stream.

        The clip then lasts longer or shorter, and plays slower or faster.
        """
        return self._with_main(frame_time=frame_time)

    def _with_main(self, **changes: object) -> Self:
        name = next(iter(self.streams))
        changed = replace(self.main, **changes)  # type: ignore[arg-type]
        return replace(self, streams={**self.streams, name: changed})
