"""What a laboratory records, of a clip's streams: markers, force plates, events, segments."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapress.errors import UnsupportedError
from mocapress.motion.clip import Clip
from mocapress.motion.frame_time import FrameTime
from mocapress.motion.kinematics import positions
from mocapress.motion.stream import Column, Stream

POINTS, RESIDUALS, CAMERAS, ANALOG, ROTATIONS = (
    "points",
    "residuals",
    "cameras",
    "analog",
    "rotations",
)
"""Names of streams."""
WHOLE_WORD = 256
"""In ``cameras``: the residual is the fourth word of a C3D as it is."""
_IN_ROTATION = 17

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Markers:
    """Points in space over time; all arrays are read-only.

    Attributes
    ----------
    positions
        (F, P, 3), in ``unit``; NaN where a marker is missing.
    valid
        (F, P): whether a marker was seen. A position can be stored though it is not valid; that of
        0, 0, 0 never is: many programs write it for a marker that is missing.
    residuals
        (F, P), in ``unit``; NaN where a marker is not valid. None where the file has none.
    cameras
        (F, P): bit k is set if camera k saw the marker. None where the file has none.
    labels
        Names of the markers.
    unit
        As the file states it, mostly ``mm`` or ``m``; may be empty.
    frame_time
        Seconds per frame, exactly; None where the file does not say.
    first_frame
        Number of the first frame, as the file counts.

    """

    positions: Array
    valid: NDArray[np.bool_]
    residuals: Array | None
    cameras: NDArray[np.int64] | None
    labels: tuple[str, ...]
    unit: str
    frame_time: FrameTime
    first_frame: int

    @property
    def rate(self) -> float | None:
        """Frames per second."""
        return float(1 / Fraction(self.frame_time)) if self.frame_time else None

    def of(self, label: str) -> Array:
        """Give the positions of one marker, (F, 3).

        Raises
        ------
        KeyError
            When there is no such label.

        """
        if label not in self.labels:
            raise KeyError(label)
        return self.positions[:, self.labels.index(label)]


@dataclass(frozen=True, slots=True)
class Event:
    """A moment that somebody has marked.

    Attributes
    ----------
    seconds
        Since the time that the file counts from: the first frame is ``first_frame`` / rate.
    label
        E.g. ``Foot Strike``.
    context
        E.g. ``Left``.

    """

    seconds: float
    label: str
    context: str


@dataclass(frozen=True, slots=True, eq=False)
class ForcePlate:
    """Parameters of a force plate of a C3D; its samples are columns of the stream ``analog``.

    Attributes
    ----------
    type
        As C3D numbers them: which forces its channels measure.
    corners
        (4, 3), in the unit of the points.
    origin
        (3,) of the plate's sensors, from the middle of its surface, in the unit of the points.
    channels
        Columns of the stream ``analog``, counted from 0.
    calibration
        (6, n): the matrix that makes forces and moments of the channels.

    """

    type: int
    corners: Array | None
    origin: Array | None
    channels: tuple[int, ...]
    calibration: Array | None


@dataclass(frozen=True, slots=True, eq=False)
class Segments:
    """Rigid bodies of a C3D: where each is and how it is turned.

    Attributes
    ----------
    matrices
        (T, R, 4, 4): rotation and position of each, as it acts on columns.
    reliability
        (T, R); below 0 where a segment is not valid.
    labels
        Names of the segments.
    frame_time
        Seconds per frame; None where the file does not say.

    """

    matrices: Array
    reliability: Array
    labels: tuple[str, ...]
    frame_time: FrameTime


def markers(clip: Clip) -> Markers:
    """Give the markers of a clip.

    Parameters
    ----------
    clip
        Of a C3D or TRC, or any with a stream ``points`` of columns x, y and z for each marker.

    Raises
    ------
    UnsupportedError
        When it has no such stream.

    """
    points = _stream(clip, POINTS)
    kinds = [column.name.rpartition(".")[2] for column in points.columns]
    if not kinds or kinds != ["x", "y", "z"] * (len(kinds) // 3):
        raise UnsupportedError("the points of this clip are not x, y and z of markers")
    positions = points.values.reshape(points.frames, points.channels // 3, 3)
    seen = ~np.isnan(positions).any(axis=2) & (positions != 0).any(axis=2)
    valid = np.asarray(seen)
    residuals, cameras = _fourth_words(clip, valid)
    for array in (valid, residuals, cameras):
        if array is not None:
            array.flags.writeable = False
    return Markers(
        positions,
        valid,
        residuals,
        cameras,
        tuple(column.name.rpartition(".")[0] for column in points.columns[::3]),
        points.columns[0].unit,
        points.frame_time,
        int(clip.metadata.get("first_frame", "1")),
    )


def _fourth_words(
    clip: Clip, valid: NDArray[np.bool_]
) -> tuple[Array | None, NDArray[np.int64] | None]:
    """Give residuals and cameras, and take what these say is not valid out of ``valid``."""
    streams = clip.streams
    if RESIDUALS not in streams or CAMERAS not in streams:
        return None, None
    residuals, cameras = streams[RESIDUALS].values, streams[CAMERAS].values
    if residuals.shape != valid.shape or cameras.shape != valid.shape:
        return None, None
    whole = cameras == WHOLE_WORD
    valid &= np.where(whole, residuals >= 0, cameras >= 0)
    scale = float(clip.metadata.get("point_scale", "1"))
    seen = np.where(valid & ~whole, cameras, 0).astype(np.int64)
    return np.where(valid, residuals * scale, np.nan), seen


def joints_as_points(clip: Clip, scale: float = 1.0, unit: str = "") -> Stream:
    """Give the positions of a skeleton's joints as the stream of points of markers.

    Parameters
    ----------
    clip
        With a skeleton.
    scale, unit
        What lengths are multiplied by, and what they are then in.

    Raises
    ------
    UnsupportedError
        When the clip has no skeleton, or stretches bones.

    """
    places = positions(clip) * scale
    joints = clip.skeleton.joints if clip.skeleton else ()
    columns = tuple(
        Column(f"{joint.name}.{kind}", i, kind, unit)
        for i, joint in enumerate(joints)
        for kind in "xyz"
    )
    return Stream(places.reshape(len(places), len(columns)), columns, clip.frame_time)


def events(clip: Clip) -> tuple[Event, ...]:
    """Give the events of a clip in the order of its file."""
    found = json.loads(clip.metadata.get("events", "[]"))
    return tuple(
        Event(float(one["seconds"]), one.get("label", ""), one.get("context", "")) for one in found
    )


def force_plates(clip: Clip) -> tuple[ForcePlate, ...]:
    """Give the force plates of a clip of a C3D."""
    told: dict[str, list[float]] = json.loads(clip.metadata.get("force_plates", "{}"))
    count = len(told.get("type", []))

    def of_plate(name: str, place: int) -> Array:
        numbers = told.get(name, [])
        each = len(numbers) // count
        return np.array(numbers[place * each : (place + 1) * each], np.float64)

    plates = []
    for place in range(count):
        corners, origin = of_plate("corners", place), of_plate("origin", place)
        matrix = of_plate("cal_matrix", place)
        plates.append(
            ForcePlate(
                int(told["type"][place]),
                corners.reshape(4, 3) if corners.size == 12 else None,
                origin if origin.size == 3 else None,
                tuple(int(number) - 1 for number in of_plate("channel", place) if number > 0),
                matrix.reshape(-1, 6).T if matrix.size and matrix.size % 6 == 0 else None,
            )
        )
    return tuple(plates)


def segments(clip: Clip) -> Segments:
    """Give the rotations that a C3D holds.

    Raises
    ------
    UnsupportedError
        When the clip has none.

    """
    stream = _stream(clip, ROTATIONS)
    numbers = stream.values.reshape(stream.frames, stream.channels // _IN_ROTATION, _IN_ROTATION)
    # A column of the matrix stands behind the other.
    matrices = numbers[:, :, :16].reshape(*numbers.shape[:2], 4, 4).swapaxes(2, 3)
    labels = [column.name.rpartition(".")[0] for column in stream.columns[::_IN_ROTATION]]
    return Segments(matrices, numbers[:, :, 16], tuple(labels), stream.frame_time)


def _stream(clip: Clip, name: str) -> Stream:
    if name not in clip.streams:
        raise UnsupportedError(
            f"this clip has no {name}", expected=f"a stream {name!r}", found=_listed(clip.streams)
        )
    return clip.streams[name]


def _listed(streams: Any) -> str:
    names: Sequence[str] = list(streams)
    return ", ".join(names)
