"""Recurring motion as one more input of ``exact``: what the best model here makes of a parent.

Usage: python benchmarks/mrpa_exact.py FOLDER [FOLDER ...]

``exact`` predicts a column from the frames before and from the columns of the same frame that come
first. So the parent's frames are put before a clip's own as columns: the model sees all of the
parent up to and with the frame that it codes, and learns what of it helps. What the clip takes
beside its parent is what both take together less what the parent takes alone.

The parent of a clip of the folder's first columns is the stretch of another clip whose postures are
nearest (Eq. 2) over all frames that both have, at least 60; before and behind it, it stands still.
More inputs cost by themselves, as more has to be learned: *beside a stranger* is the same with the
parent's frames in reverse, which say little. The last row is a control: parts of takes, and the
same with a smooth offset in a third of the channels and rounded again (as in
``mocapress_bench/mrpa_planted.py``), where the parent must help.
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mocapress as mp
from mocapress.codecs import codec
from mocapress.codecs.mrpa import trellis
from mocapress.motion import Clip, Stream
from mocapress_bench.inputs import clips_in
from mocapress_bench.mrpa_planted import edited, rounded
from mocapress_bench.tables import markdown

Array = NDArray[np.float64]
LEAST, MOST_FRAMES, LEVEL = 60, 4000, 6


def bits_of(stream: Stream) -> int:
    """Give what ``exact`` takes for a stream without a skeleton, in one chunk."""
    coded = codec(f"exact:level={LEVEL},chunk=100000").encode(stream)
    return 8 * (len(coded.header) + sum(len(chunk.payload) for chunk in coded.chunks))


def beside(own: Stream, parent: Array) -> tuple[int, int, int]:
    """Give the bits of a stream alone, beside its parent, and beside that in reverse."""
    columns = own.columns
    before = tuple(replace(c, name=f"parent {c.name}", joint=-1) for c in columns)
    after = tuple(replace(c, joint=-1) for c in columns)
    alone = replace(own, columns=after)

    def given(rows: Array) -> int:
        other = replace(own, values=rows, columns=before)
        both = replace(own, values=np.hstack([rows, own.values]), columns=before + after)
        return bits_of(both) - bits_of(other)

    return bits_of(alone), given(parent), given(np.ascontiguousarray(parent[::-1]))


def parent_of(clips: Sequence[Clip], number: int) -> Array | None:
    """Give the nearest stretch of another clip, at the length of this one."""
    weight = trellis.weights(clips[number].columns, clips[number].skeleton)
    own = clips[number].values * weight
    best, found = np.inf, None
    for i, clip in enumerate(clips):
        if i == number:
            continue
        other = clip.values * weight
        for shift in range(LEAST - len(other), len(own) - LEAST + 1, 2):
            first, last = max(shift, 0), min(shift + len(other), len(own))
            if last - first < max(LEAST, 0.7 * len(own)):
                continue
            away = np.abs(own[first:last] - other[first - shift : last - shift]).sum(axis=1).mean()
            if away < best:
                at = np.clip(np.arange(len(own)) - shift, 0, len(other) - 1)
                best, found = float(away), clip.values[at]
    return found


def row(name: str, pairs: Sequence[tuple[Stream, Array]]) -> list[str]:
    """Measure pairs of a stream and its parent."""
    told = np.array([beside(*pair) for pair in pairs]).sum(axis=0)
    values = sum(own.values.size for own, _ in pairs)
    more = [f"{bits / values:.3f} ({100 * (bits / told[0] - 1):+.1f} %)" for bits in told[1:]]
    return [name, str(len(pairs)), f"{told[0] / values:.3f}", *more]


def main() -> None:
    """Measure each folder, and the control."""
    rows = []
    takes: list[Clip] = []
    for folder in map(Path, sys.argv[1:]):
        clips: list[Clip] = []
        for path in clips_in(folder):
            clip = mp.read(path, strict=False)
            names = [c.name for c in (clips[0] if clips else clip).columns]
            if [c.name for c in clip.columns] == names and clip.frames >= LEAST:
                clips.append(clip[:600])
        clips = clips[: MOST_FRAMES // 300]
        found = [(clip.main, parent_of(clips, i)) for i, clip in enumerate(clips)]
        pairs = [(own, parent) for own, parent in found if parent is not None]
        if pairs:
            rows.append(row(folder.name, pairs))
        takes += clips[:3]
    random = np.random.default_rng(1)
    control = []
    for take in takes:
        part = take[:400]
        copied = rounded(edited(part.values, random), part.main)
        control.append((replace(part.main, values=copied), part.values))
    rows.append(row("edited copies", control))
    head = ["library", "clips", "bits a value", "beside its parent", "beside a stranger"]
    print(markdown(head, rows))


if __name__ == "__main__":
    main()
