"""Make golden files; never overwrites one."""

import math
from pathlib import Path

import mocapress as mp

HERE = Path(__file__).parent
FRAMES = 240
BVH = """HIERARCHY
ROOT Hips
{
\tOFFSET 0.00 0.00 0.00
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT Spine
\t{
\t\tOFFSET 0.00 11.30 -1.20
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0.00 20.00 0.00
\t\t}
\t}
}
MOTION
Frames: 240
Frame Time: .0083333
"""


def wave(frame: int, channel: int) -> float:
    return 40 * math.sin(0.11 * frame + channel) + channel


def amc(end: str) -> str:
    lines = ["#!OML:ASF made up", ":FULLY-SPECIFIED", ":DEGREES"]
    for frame in range(FRAMES):
        values = [f"{wave(frame, channel):.6g}" for channel in range(9)]
        values[8] = "-1.6201e-014" if frame % 5 == 0 else values[8]
        values[7] = "0.50" if frame == 7 else values[7]  # not as the others are written
        lines += [str(frame + 1), "root " + " ".join(values[:6]), "hip " + " ".join(values[6:])]
    return end.join(lines) + end


def bvh_rows() -> str:
    return "".join(
        " ".join(f"{wave(frame, channel):10.5f}" for channel in range(9)) + "\n"
        for frame in range(FRAMES)
    )


FILES = {
    "v1_walk.amc": (amc("\r\n").encode(), "app"),
    "v1_walk_lf.amc": (
        amc("\n").encode()[:-1],
        "app:t=4,table=k4-non-uniform,mantissa_limit=53,chunk=8",
    ),
    "v1_walk.bvh": ((BVH + bvh_rows()).encode(), "app:mantissa_limit=53"),
    "v1_bytes.bin": (bytes(range(256)) * 3, "app"),
}

if __name__ == "__main__":
    for name, (data, codec) in FILES.items():
        target = HERE / f"{name}.mcz"
        if not target.exists():
            (HERE / name).write_bytes(data)
            target.write_bytes(mp.compress(data, codec))
            print(target)
    model = HERE / "v1_learner.mcm"
    if not model.exists():
        mp.save_model(mp.Model("learner", bytes(range(100)) * 2), model)
        print(model)
