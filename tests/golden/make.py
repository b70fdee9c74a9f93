"""Make golden files; never overwrites one."""

import math
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import mocapress as mp
from mocapress.models import model_bytes

HERE = Path(__file__).parent
sys.path.append(str(HERE.parent / "codecs"))
import payloads  # noqa: E402

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
    "v1_exact.amc": (amc("\r\n").encode(), "exact"),
    "v1_exact_strong.amc": (amc("\n").encode(), "exact:level=9,chunk=100"),
    "v1_exact_fast.bvh": ((BVH + bvh_rows()).encode(), "exact:level=1"),
    "v1_lossy.amc": (amc("\n").encode(), "diffma:bits=7,chunk=100"),
    "v1_lossy.bvh": (
        (BVH + bvh_rows()).encode(),
        "diffma:target_psnr=40.0,per=channel,order=auto",
    ),
}
# Beside NAME the document NAME.diffma.json; what comes back of it is NAME.
DOCUMENTS = {
    "v1_published.amc": (amc("\n").encode(), "diffma"),
    "v1_extended.bvh": (
        (BVH + bvh_rows()).encode(),
        "diffma:bits=8,max_error=0.1,per=channel,order=auto,levels=64",
    ),
}


def put(name: str, make: Callable[[], bytes]) -> None:
    """Write a file that is not there yet."""
    target = HERE / name
    if not target.exists():
        target.write_bytes(make())
        print(target)


def kernels(codec: str) -> bytes:
    """Give what the check program of a codec prints (tests/core/test_determinism.py)."""
    program = f"build/check/usual/{codec}"
    subprocess.run(["make", "-s", program], cwd=HERE.parents[1], check=True)
    return subprocess.run([HERE.parents[1] / program], check=True, capture_output=True).stdout


if __name__ == "__main__":
    for name, (data, codec) in FILES.items():
        put(f"{name}.mcz", partial(mp.compress, data, codec))
        # Of a lossy codec, what comes back is kept.
        lossless = mp.codec(codec).lossless
        put(
            name, partial(bytes, data) if lossless else partial(mp.decompress, HERE / f"{name}.mcz")
        )
    for name, (data, codec) in DOCUMENTS.items():
        put(f"{name}.diffma.json", partial(mp.to_json, data, codec))
        put(name, partial(mp.decompress, HERE / f"{name}.diffma.json"))
    learned = mp.Model("learner", bytes(range(100)) * 2)
    put("v1_learner.mcm", partial(model_bytes, learned))
    for program in sorted(HERE.parents[1].glob("core/check/*.cpp")):
        put(f"kernels_{program.stem}.txt", partial(kernels, program.stem))
    for spec in payloads.specs():
        put(payloads.golden(spec).name, partial(payloads.digests, spec))
