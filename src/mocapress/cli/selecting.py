"""Options that take a part of a clip, or give it at another rate."""

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from mocapress.motion import Clip


@dataclass(frozen=True, slots=True)
class Seconds:
    """A stretch of time, from the first frame on; without an end, to the clip's."""

    start: float
    end: float | None


def _frames(text: str) -> slice:
    """Read ``a:b``; as in Python, ends may be missing, and negative ones count from the last."""
    found = re.fullmatch(r"(-?[0-9]{1,15})?:(-?[0-9]{1,15})?", text)
    if found is None:
        raise typer.BadParameter(f"{text!r} is no stretch of frames such as 100:200")
    first, last = (None if end is None else int(end) for end in found.groups())
    return slice(first, last)


def _time(text: str) -> Seconds:
    found = re.fullmatch(r"([0-9]+\.?[0-9]*)?:([0-9]+\.?[0-9]*)?", text)
    if found is None:
        raise typer.BadParameter(f"{text!r} is no stretch of seconds such as 1.5:4")
    first, last = found.groups()
    return Seconds(float(first or 0), None if last is None else float(last))


Frames = Annotated[
    slice | None,
    typer.Option(
        "--frames",
        parser=_frames,
        metavar="A:B",
        help="Only frames A to B - 1, counted from 0; negative numbers count from the end.",
    ),
]
Time = Annotated[
    Seconds | None,
    typer.Option(
        "--time",
        parser=_time,
        metavar="A:B",
        help="Only the frames from second A to before second B, counted from the first frame.",
    ),
]
Every = Annotated[
    int | None, typer.Option("--every", min=1, metavar="N", help="Only every Nth frame.")
]
Columns = Annotated[
    str | None,
    typer.Option(
        "--columns",
        metavar="NAMES",
        help="Only these columns, separated by commas, e.g. root.*,lfemur.rx; for tables.",
    ),
]
Resample = Annotated[
    float | None,
    typer.Option(
        "--resample",
        min=1e-3,
        metavar="FPS",
        help="The same motion at this rate: frames are interpolated, rotations on the sphere.",
    ),
]
Retime = Annotated[
    float | None,
    typer.Option(
        "--retime", min=1e-3, metavar="FPS", help="The same frames at this rate: faster or slower."
    ),
]


@dataclass(frozen=True, slots=True)
class Selection:
    """What is wanted of a clip."""

    frames: slice | None = None
    time: Seconds | None = None
    every: int | None = None
    resample: float | None = None
    retime: float | None = None
    fps: float | None = None
    """The rate of a clip that states none."""
    columns: str | None = None

    def __post_init__(self) -> None:
        from mocapress.cli.batch import usage

        if self.frames is not None and self.time is not None:
            usage("--frames and --time exclude each other")
        if self.resample is not None and self.retime is not None:
            usage("--resample and --retime exclude each other")

    def of(self, clip: "Clip") -> "Clip":
        """Take it.

        Raises
        ------
        ParameterError
            When ``fps`` contradicts the rate that the clip states, or no frames are left.
        UnsupportedError
            When a rate is needed and the clip has none.

        """
        from mocapress.errors import ParameterError
        from mocapress.motion import editing
        from mocapress.motion.convert import with_rate
        from mocapress.motion.frame_time import of_rate

        if self.fps is not None:
            stated = clip.frame_time
            if stated and abs(float(Fraction(stated) / of_rate(self.fps)) - 1) > _SAME_RATE:
                raise ParameterError(
                    "--fps, but the file states its rate",
                    expected="--retime for the same frames faster or slower, --resample for the "
                    "same motion in other frames",
                    found=f"{clip.fps:g} frames per second in the file",
                )
            clip = clip if stated else with_rate(clip, self.fps)
        whole = len(clip)
        if self.frames is not None:
            clip = clip[self.frames]
        if self.time is not None:
            clip = editing.crop(clip, self.time.start, self.time.end)
        if self.every is not None:
            clip = clip[:: self.every]
        if whole and not len(clip):
            raise ParameterError(
                "no frames are left", expected=f"some of the {whole} frames of the clip"
            )
        if self.resample is not None:
            clip = editing.resample(clip, self.resample)
        if self.retime is not None:
            clip = editing.retime(clip, self.retime)
        return clip if self.columns is None else editing.only(clip, self.columns.split(","))


_SAME_RATE = 1e-3
"""Part of a rate by which a stated one, printed with few digits, may miss one that is given."""
