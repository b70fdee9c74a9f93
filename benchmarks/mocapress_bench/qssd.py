"""What ``qssd`` makes of a folder of clips: sizes with everything counted, and what is lost."""

import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import codecs
from mocapress.codecs.qssd.feet import ASSUMED_RATE
from mocapress.codecs.qssd.quaternions import turned_degrees
from mocapress.errors import MocapressError, MotionWarning, UnsupportedError
from mocapress.models import model_bytes
from mocapress.motion.contacts import contacts, slides, upward
from mocapress.motion.kinematics import local_rotations, positions

Array = NDArray[np.float64]
_CMU_LENGTH = 0.45
_INCH = 2.54


@dataclass(slots=True)
class Row:
    """Figures of a setting, over all clips."""

    setting: str
    text: int = 0
    payload: int = 0
    header: int = 0
    model: int = 0
    files: int = 0
    """Whole ``.mcz`` files, with skeletons, and the model's file."""
    frames: int = 0
    joint_samples: int = 0
    encoding: float = 0.0
    decoding: float = 0.0
    """Processor time, seconds."""
    arms: list[Array] = field(default_factory=list)
    """Eq. 12's term of each frame, cm."""
    distortion: list[float] = field(default_factory=list)
    """Eq. 13 of each clip."""
    degrees: list[float] = field(default_factory=list)
    slides: list[tuple[Array, Array]] = field(default_factory=list)
    """How far feet slide from frame to frame of a contact, original and decoded, cm, by clip."""
    feet: list[Array] = field(default_factory=list)
    """How far feet are from where they stand, in contacts, cm."""

    def figures(self) -> dict[str, float | str]:
        """Give the figures of a table's row."""
        arms = np.concatenate(self.arms)
        counted = self.payload + self.header + self.model
        return {
            "setting": self.setting,
            "ratio": self.text / counted,
            "ratio of files": self.text / self.files,
            "ARMS, cm": float(arms.mean()),
            "99 % of frames": float(np.percentile(arms, 99)),
            "largest": float(arms.max()),
            "distortion": float(np.mean(self.distortion)),
            "degrees": float(np.mean(self.degrees)),
            "feet slide, mm/frame": _millimetres([decoded for _, decoded in self.slides]),
            "in the original": _millimetres([original for original, _ in self.slides]),
            "feet in contact, largest, cm": max(
                (float(f.max(initial=0)) for f in self.feet), default=0.0
            ),
            "bits/joint sample": 8 * counted / self.joint_samples,
            "clips": len(self.distortion),
            "text": self.text,
            "payload": self.payload,
            "header": self.header,
            "model": self.model,
            "encode, µs/frame": 1e6 * self.encoding / self.frames,
            "decode, µs/frame": 1e6 * self.decoding / self.frames,
        }


def measure(
    paths: Sequence[Path],
    steps: Sequence[float],
    model: mp.Model | None,
    name: str,
    progress: Callable[[str], None] = lambda _: None,
    options: str = "",
) -> list[dict[str, float | str]]:
    """Code clips at each step of weights.

    Parameters
    ----------
    paths
        Clips; those that cannot be read, or have no skeleton, are left out.
    steps
        Of weights.
    model
        A dictionary; None: without one.
    name
        What the rows are called besides the step: which clips, which dictionary.
    progress
        Is told each clip.
    options
        Further parameters of the codec, such as ``protect=0.1``.

    """
    more = f",{options}" if options else ""
    rows = [Row(f"step {step:g}{more}, {name}") for step in steps]
    for path in paths:
        progress(path.name)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", MotionWarning)
                clip = mp.read(path)
                places = centimetres(clip)
        except MocapressError:
            continue
        for row, step in zip(rows, steps, strict=True):
            _measure(row, path, clip, places, codecs.codec(f"qssd:step={step:g}{more}"), model)
    for row in rows:
        if model is not None:
            row.model = len(model_bytes(model))
            row.files += row.model
    return [row.figures() for row in rows if row.frames]


def centimetres(clip: mp.Clip) -> Array:
    """Give positions of joints and ends, (F, P, 3): CMU's unit is 5.644 cm, others' 1 cm."""
    scaled: Array = centimetres_per_unit(clip) * positions(clip, end_sites=True)
    return scaled


def centimetres_per_unit(clip: mp.Clip) -> float:
    """Give CMU's unit in centimetres, and 1 for all others."""
    unit = clip.skeleton.length_unit if clip.skeleton else None
    return _INCH / unit if unit == _CMU_LENGTH else 1.0


def _millimetres(parts: Sequence[Array]) -> float:
    every = np.concatenate(parts) if parts else np.empty(0)
    return 10 * float(every.mean()) if len(every) else 0.0


def _measure(
    row: Row, path: Path, clip: mp.Clip, places: Array, codec: codecs.Codec, model: mp.Model | None
) -> None:
    start = time.process_time()
    encoded = codec.encode(clip.main, skeleton=clip.skeleton, model=model)
    middle = time.process_time()
    values = codec.decode(encoded.header, encoded.chunks, clip.columns, model=model)
    row.encoding += middle - start
    row.decoding += time.process_time() - middle
    back = clip.with_values(values)
    found = centimetres(back)
    row.text += path.stat().st_size
    row.payload += sum(len(chunk.payload) for chunk in encoded.chunks)
    row.header += len(encoded.header)
    row.files += len(mp.compress(path, codec, model=model))
    row.frames += clip.frames
    row.joint_samples += clip.frames * places.shape[1]
    row.arms.append(np.sqrt(((places - found) ** 2).sum(axis=-1).mean(axis=-1)))
    spread = float(np.linalg.norm(places - places.mean(axis=0)))
    row.distortion.append(100 * float(np.linalg.norm(places - found)) / spread if spread else 0.0)
    _measure_feet(row, clip, back)
    row.degrees.append(float(turned_degrees(local_rotations(clip), local_rotations(back)).mean()))


def _measure_feet(row: Row, clip: mp.Clip, back: mp.Clip) -> None:
    """See how feet keep to their places while the original's stand, at 120 frames a second."""
    try:
        standing = contacts(clip, fps=ASSUMED_RATE)
    except UnsupportedError:
        return
    assert clip.skeleton is not None
    joints = [clip.skeleton.index(name) for name in standing]
    frames = np.stack([*standing.values()], axis=1)
    by = centimetres_per_unit(clip)
    every = by * positions(clip)
    own, found = every[:, joints], by * positions(back)[:, joints]
    up = upward(every)
    row.slides.append((slides(own, frames, up), slides(found, frames, up)))
    row.feet.append(np.linalg.norm(found - own, axis=-1)[frames])


def table(rows: Sequence[dict[str, float | str]]) -> str:
    """Give the rows as Markdown."""
    names = list(rows[0])
    lines = ["| " + " | ".join(names) + " |", "|---" + "|---:" * (len(names) - 1) + "|"]
    for row in rows:
        cells = [f"{v:.3g}" if isinstance(v, float) else str(v) for v in row.values()]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"
