"""Make markers.c3d and markers.trc: joints of cmu_01_01 as points, with a gap.

python samples/make_markers.py
"""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np

import mocapress as mp

HERE = Path(__file__).parent
INCH, FRAMES = 25.4, 300


def main() -> None:
    """Write both files beside this one."""
    clip = mp.read(HERE / "cmu_01_01.amc")[:FRAMES].with_frame_time(Fraction(1, 120))
    places = np.round(mp.positions(clip)[:, ::2] * INCH / 0.45, 2)
    places[100:130, 3] = np.nan
    joints = clip.skeleton.joints[::2]
    columns = tuple(
        mp.Column(f"{joint.name}.{axis}", i, axis, "mm")
        for i, joint in enumerate(joints)
        for axis in "xyz"
    )
    stream = mp.Stream(places.reshape(FRAMES, -1), columns, clip.frame_time)
    points = replace(clip, streams={"points": stream}, skeleton=None, name="markers")
    for suffix in ("c3d", "trc"):
        mp.write(points, HERE / f"markers.{suffix}", force=True)


if __name__ == "__main__":
    main()
