"""What a lossy codec lost, measured on its decoder's output."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.contract import Codec
from mocapress.codecs.markers import markers_of
from mocapress.errors import UnsupportedError, VerificationError
from mocapress.motion import Clip, Column
from mocapress.motion.comparing import distances_of, errors_of
from mocapress.motion.figure import centimetres


@dataclass(frozen=True, slots=True)
class Loss:
    """How far decoded values are from the original ones."""

    largest: tuple[float, ...]
    """Largest error of each channel, in its unit; infinite where a NaN or infinity changed."""
    mean: float
    """Mean error of all finite values, each in its unit."""
    psnr: float
    """-10 log10 of the mean squared error over all finite values, dB; infinite without error."""
    joints: float | None = None
    """Largest distance of a joint from its place, in the clip's units of length; None where it is
    not known. Angles may be far off that together turn a joint as before."""
    markers: float | None = None
    """Largest distance of a marker from its place."""
    parts: Mapping[str, float] = field(default_factory=dict)
    """The same of parts of the body that have bounds of their own."""
    centimetres: float | None = None
    """In the unit of these distances; None where nothing says so."""

    @classmethod
    def of(
        cls,
        original: NDArray[np.float64],
        decoded: NDArray[np.float64],
        columns: Sequence[Column] = (),
    ) -> Self:
        """Measure the loss of (F, C) values; of columns that are angles, modulo whole turns."""
        finite = np.isfinite(original)
        errors = errors_of(original, decoded, columns)
        known = errors[finite]
        with np.errstate(over="ignore"):
            square = float((known**2).mean()) if known.size else 0.0
            mean = float(known.mean()) if known.size else 0.0
        largest = errors.max(axis=0, initial=0)
        return cls(
            tuple(float(error) for error in largest),
            mean,
            float(-10 * np.log10(square)) if square else float("inf"),
        )

    @property
    def most(self) -> float:
        """The largest error of any channel."""
        return max(self.largest, default=0.0)

    def notes(self) -> dict[str, str]:
        """Give what a file says of what it lost, as its notes."""
        facts = zip(LOSS_NOTES, (self.most, self.mean, self.psnr), strict=True)
        notes = {key: f"{value:.6g}" for key, value in facts}
        return notes | {f"{LARGEST_OF}{part}": f"{most:.6g}" for part, most in self.parts.items()}


LOSS_NOTES = ("largest_error", "mean_error", "psnr")
"""Keys of the notes in which a lossy file says what it lost."""
LARGEST_OF = "largest_joint_error_of_"
"""Before the name of a part of the body, the key of a note that says how far its joints are off."""


def checked_loss(codec: Codec, clip: Clip, decoded: NDArray[np.float64]) -> Loss:
    """Measure what a codec lost, and check that it kept its bounds.

    An angle that is off by whole turns has lost nothing, unless a bound was asked for.

    Raises
    ------
    VerificationError
        When a channel's error is above its bound.

    """
    bounds = codec.largest_errors(clip.columns)
    bounded = Loss.of(clip.values, decoded)
    for column, error, bound in zip(clip.columns, bounded.largest, bounds, strict=True):
        if error > bound:
            raise VerificationError(
                f"codec {codec.id} breaks its bound in channel {column.name}; please report this",
                expected=f"errors up to {bound:g}",
                found=f"{error:g}",
            )
    loss = Loss.of(clip.values, decoded, clip.columns)
    largest = _largest_distances(clip, decoded)
    if largest is None:
        return loss
    if clip.skeleton is None:
        loss = replace(loss, centimetres=markers_of(clip.columns).centimetres(clip.columns))
    else:
        loss = replace(loss, centimetres=centimetres(clip))
    most = float(largest.max(initial=0))
    parts = {part: float(largest[joints].max()) for part, joints in codec.parts_of(clip).items()}
    if clip.skeleton is None:
        return replace(loss, markers=most, parts=parts)
    return replace(loss, joints=most, parts=parts)


def _largest_distances(clip: Clip, decoded: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Give how far each joint, or each marker, is from its place at most, (J,).

    None where they have no places; a marker that is missing is nowhere.
    """
    if clip.skeleton is None:
        return _distances_of_markers(clip, decoded)
    if not clip.frames:
        return None
    try:
        with np.errstate(all="ignore"):
            distances = distances_of(clip, clip.with_values(decoded))
    except UnsupportedError:
        return None
    largest: NDArray[np.float64] = distances.max(axis=0)
    return largest if np.isfinite(largest).all() else None


def _distances_of_markers(clip: Clip, decoded: NDArray[np.float64]) -> NDArray[np.float64] | None:
    markers = markers_of(clip.columns)
    if not markers.first:
        return None
    with np.errstate(all="ignore"):
        moved = markers.places(decoded) - markers.places(clip.values)
        distances = np.sqrt((moved * moved).sum(axis=2))
    largest: NDArray[np.float64] = np.where(np.isfinite(distances), distances, 0).max(
        axis=0, initial=0
    )
    return largest


def missed_target(codec: Codec, loss: Loss) -> str | None:
    """Say that a mean error was asked for which the codec cannot reach, to 1 dB."""
    target = float(getattr(codec, "target_psnr", 0.0))
    if not target or loss.psnr > target - 1:
        return None
    return f"a PSNR of {target:g} dB was asked for; {codec.id} reaches {loss.psnr:.1f} dB"
