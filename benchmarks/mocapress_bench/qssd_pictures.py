"""Atoms of QSSD's dictionaries as poses, and poses as they were and as they were coded."""

import io

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress import codecs, figures
from mocapress.codecs.qssd.quaternions import exponential, product
from mocapress_bench.qssd_rivals import Measured, Poses

Array = NDArray[np.float64]
_SHOWN = 8
"""Atoms of each dictionary, those that are used most; and poses of a clip."""
_CELL = (120, 190)
_NAME = 20
"""Pixels for a row's name."""
_FAR = 2.0
"""Standard deviations of a weight at which its atom is drawn."""
STEPS = (0.25, 0.5, 1.0, 2.0)


def draw_atoms(measured: Measured, like: Poses) -> bytes:
    """Draw the mean pose, and how it is turned by each dictionary's most used atoms: a PNG."""
    rows = []
    for name, learned in measured.learned.items():
        used = np.bincount(
            learned.weights.atoms[learned.weights.atoms >= 0], minlength=len(learned.dictionary)
        )
        chosen = np.argsort(-used, kind="stable")[:_SHOWN]
        weights = learned.weights.of_atoms(len(used))[chosen]
        far = np.array([_FAR * own[own != 0].std() if own.any() else 0.0 for own in weights])
        if learned.dictionary.shape[2] == 4:
            continue  # components are no turns by themselves
        turns = exponential(far[:, None, None] * learned.dictionary[chosen])
        poses = np.concatenate([measured.middle[None], product(measured.middle, turns)])
        rows.append((name, _clip(poses, like)))
    return _sheet(rows)


def draw_poses(one: Poses) -> bytes:
    """Draw poses of a clip, the original's and those of the codec ``qssd`` at some steps: a PNG."""
    clip = one.clip
    rows = [("original", clip)]
    for step in STEPS:
        codec = codecs.codec(f"qssd:step={step:g}")
        encoded = codec.encode(clip.main, skeleton=clip.skeleton)
        values = codec.decode(encoded.header, encoded.chunks, clip.columns)
        size = sum(len(chunk.payload) for chunk in encoded.chunks)
        rows.append((f"step {step:g}: {size} bytes", clip.with_values(values)))
    return _sheet(rows)


def _clip(turns: Array, like: Poses) -> mp.Clip:
    """Make a clip of poses, (M, J, 4); the root neither turns nor moves."""
    skeleton = like.clip.skeleton
    assert skeleton is not None
    none = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (len(turns), 1, 4))
    whole = np.concatenate([none, turns], axis=1)
    offsets = [joint.offset for joint in skeleton.joints]
    root = np.zeros((len(turns), 3))
    return mp.from_quaternions(whole, offsets, skeleton.parents, skeleton.names, root=root)


def _sheet(rows: list[tuple[str, mp.Clip]]) -> bytes:
    from PIL import Image, ImageDraw

    width, height = _CELL[0] * (_SHOWN + 1), _CELL[1] + _NAME
    sheet = Image.new("RGB", (width, height * len(rows)), figures.GROUND)
    for number, (name, clip) in enumerate(rows):
        frames = figures.moments(clip.frames, _SHOWN + 1)
        sheet.paste(figures.strip(clip, frames, (width, _CELL[1])), (0, number * height + _NAME))
        ImageDraw.Draw(sheet).text((8, number * height + 4), name, fill=(40, 40, 40))
    made = io.BytesIO()
    sheet.save(made, "PNG", optimize=True)
    return made.getvalue()
