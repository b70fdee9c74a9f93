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
from mocapress.codecs.qssd.quaternions import turned_degrees
from mocapress.errors import MocapressError, MotionWarning
from mocapress.models import model_bytes
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

    """
    rows = [Row(f"step {step:g}, {name}") for step in steps]
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
            _measure(row, path, clip, places, codecs.codec(f"qssd:step={step:g}"), model)
    for row in rows:
        if model is not None:
            row.model = len(model_bytes(model))
            row.files += row.model
    return [row.figures() for row in rows if row.frames]


def centimetres(clip: mp.Clip) -> Array:
    """Give positions of joints and ends, (F, P, 3): CMU's unit is 5.644 cm, others' 1 cm."""
    unit = clip.skeleton.length_unit if clip.skeleton else None
    by = _INCH / unit if unit == _CMU_LENGTH else 1.0
    scaled: Array = by * positions(clip, end_sites=True)
    return scaled


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
    row.degrees.append(float(turned_degrees(local_rotations(clip), local_rotations(back)).mean()))


def table(rows: Sequence[dict[str, float | str]]) -> str:
    """Give the rows as Markdown."""
    names = list(rows[0])
    lines = ["| " + " | ".join(names) + " |", "|---" + "|---:" * (len(names) - 1) + "|"]
    for row in rows:
        cells = [f"{v:.3g}" if isinstance(v, float) else str(v) for v in row.values()]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"
