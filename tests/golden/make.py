"""Make golden files; never overwrites one."""

import math
import random
import subprocess
import sys
import warnings
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import mocapress as mp
from mocapress.models import model_bytes

HERE = Path(__file__).parent
sys.path += [str(HERE), str(HERE.parent / "codecs"), str(HERE.parent / "formats")]
import array_files  # noqa: E402
import c3d_files  # noqa: E402
import clips  # noqa: E402
import payloads  # noqa: E402
import table_files  # noqa: E402

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


ASF = b""":version 1.10
:name made_up
:units
  mass 1.0
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name hip
    direction 0.5 -0.5 0.25
    length 2.5
    axis 10 0 -20 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 inf)
  end
:hierarchy
  begin
    root hip
  end
"""

WALK_AMC, WALK_LF, WALK_BVH = amc("\r\n").encode(), amc("\n").encode(), (BVH + bvh_rows()).encode()
# The middle one of three turns at a right angle; and a number that no motion has.
POLE_ROWS = ["0 0 0 0 90 0 0 90 0"] * FRAMES
POLE_ROWS[9] = "1e18 0 0 0 90 0 0 90 0"
POLE = (BVH + "\n".join([*POLE_ROWS, ""])).encode()
# What is compressed, and how; of each codec some have at least three chunks. NAME.mcz holds NAME.
FILES: dict[str, tuple[bytes, str, dict[str, Any]]] = {
    "v1_walk.amc": (WALK_AMC, "app:chunk=75", {}),
    "v1_walk_lf.amc": (
        WALK_LF[:-1],
        "app:t=4,table=k4-non-uniform,mantissa_limit=53,chunk=80",
        {"notes": {"source": "made up", "license": "Apache-2.0", "author": "mocapress"}},
    ),
    "v1_walk.bvh": (WALK_BVH, "app:mantissa_limit=53,chunk=90", {}),
    "v1_mrpa.amc": (WALK_AMC, "mrpa:chunk=75", {}),
    "v1_couplings_mrpa.bvh": (clips.couplings(), "mrpa:chunk=30", {}),
    "v1_bytes.bin": (bytes(range(256)) * 3, "exact", {}),
    "v1_exact.amc": (WALK_AMC, "exact:chunk=80", {}),
    "v1_exact_strong.amc": (WALK_LF, "exact:level=9,chunk=100", {}),
    "v1_exact_tuned.bvh": (WALK_BVH, "exact:level=9,chunk=100", {}),
    # Level 9 is asked for, and 5 is smaller.
    "v1_exact_still.bvh": ((BVH + 240 * "0 90 0 0 0 0 0 0 0\n").encode(), "exact:level=9", {}),
    "v1_exact_fast.bvh": (WALK_BVH, "exact:level=1,chunk=80", {}),
    "v1_exact_cut.bvh": (WALK_BVH[:-700], "exact:level=2,chunk=80", {}),
    "v1_lossy.amc": (WALK_LF, "diffma:bits=7,chunk=100", {}),
    "v1_lossy.bvh": (WALK_BVH, "diffma:target_psnr=40.0,per=channel,order=auto,chunk=80", {}),
    "v1_near.amc": (WALK_AMC, "near:quality=7,chunk=100", {}),
    # Together with the above they take every branch of the decoders (tests/reader).
    "v1_couplings_near.bvh": (clips.couplings(), "near:quality=9,max=0.02", {}),
    "v1_numbers_near.bvh": (clips.numbers(), "near:max_error=0.01", {}),
    "v1_coarse_near.amc": (WALK_LF, "near:quality=1", {}),
    "v1_turning_near.bvh": (clips.turning(), "near:max=0.1cm,chunk=80", {}),
    "v1_skeleton_near.amc": (
        clips.skeleton(),
        "near:max=0.1cm,chunk=20",
        {"asf_path": clips.SAMPLE.with_suffix(".asf")},
    ),
    "v1_finer_near.amc": (
        clips.skeleton(),
        "near:max=0.1cm,feet=0.02cm",
        {"asf_path": clips.SAMPLE.with_suffix(".asf")},
    ),
    "v1_unordered_near.amc": (
        clips.unordered(),
        "near:max=0.1cm,chunk=20",
        {"asf_path": clips.SAMPLE.with_suffix(".asf")},
    ),
    "v1_resting_near.amc": (
        clips.resting(),
        "near:max=0.1cm",
        {"asf_path": clips.SAMPLE.with_suffix(".asf")},
    ),
    "v1_random.bin": (random.Random(1).randbytes(200), "exact", {}),
    "v1_oddities.bvh": (clips.oddities(), "exact:level=6,chunk=12", {}),
    "v1_disorder.amc": (clips.disorder(), "exact:level=6,chunk=10", {}),
    "v1_numbers.bvh": (clips.numbers(), "exact:level=6,chunk=16", {}),
    "v1_couplings.bvh": (clips.couplings(), "exact:level=6,chunk=32", {}),
    "v1_couplings_lossy.bvh": (clips.couplings(), "diffma:bits=8,order=2,window=3,chunk=30", {}),
    "v1_sparse.amc": (WALK_LF, "qssd:chunk=100", {}),
    "v1_sparse.bvh": (WALK_BVH, "qssd:omit=1,levels=4,max_error=0.25,chunk=90", {}),
    "v1_sparse_disorder.amc": (clips.disorder(), "qssd:omit=0,levels=2,chunk=10", {}),
    "v1_patterns.amc": (WALK_LF, "patterns:chunk=100,theta=1.0,size=20.0,mode=published", {}),
    "v1_patterns.trc": (
        table_files.trc(np.hstack([table_files.markers(), table_files.markers()[:, :9]])),
        "patterns:chunk=140,size=800.0,protect=M0+M3,weights=M2:4,smooth=3",
        {},
    ),
    "v1_patterns_disorder.amc": (
        clips.disorder(),
        "patterns:chunk=10,max_error=0.25,smooth=0",
        {},
    ),
    "v1_leaps.amc": (clips.leaps(), "exact:level=7,chunk=22", {}),
    "v1_leaps_fast.amc": (clips.leaps(), "exact:level=3,chunk=22", {}),
    "v1_skeleton.amc": (clips.skeleton(), "exact:level=8,chunk=12", {}),
    "v1_signed.bvh": (clips.layouts("signed"), "exact:level=1,chunk=12", {}),
    "v1_left.bvh": (clips.layouts("left"), "exact:level=1,chunk=12", {}),
    "v1_zeros.amc": (clips.layouts("zeros"), "exact:level=1,chunk=12", {}),
    "v1_java.bvh": (clips.layouts("java"), "exact:level=1,chunk=12", {}),
    "v1_wide.amc": (clips.wide(), "exact:level=6,chunk=2", {}),
    "v1_intel.c3d": (c3d_files.odd_floats(c3d_files.INTEL), "exact:level=2,chunk=60", {}),
    "v1_dec.c3d": (c3d_files.odd_floats(c3d_files.DEC), "exact:level=2,chunk=60", {}),
    "v1_mips.c3d": (c3d_files.odd_floats(c3d_files.MIPS), "exact:level=3,chunk=60", {}),
    "v1_integers.c3d": (c3d_files.whole_numbers(c3d_files.INTEL), "exact:level=2,chunk=60", {}),
    "v1_markers.trc": (table_files.trc(table_files.markers()), "exact:level=1,chunk=60", {}),
    "v1_odd.csv": (table_files.odd_table(), "exact:level=2,chunk=60", {}),
    "v1_commas.csv": (table_files.commas(), "exact:level=2,chunk=60", {}),
    "v1_cells.csv": (table_files.cells(), "exact:level=2,chunk=60", {}),
    "v1_archive_near.npz": (array_files.npz(poses=array_files.wave(400, 12)), "near:max=0.01", {}),
    "v1_kinds.npz": (array_files.every_kind(), "exact:level=2,chunk=60", {}),
    "v1_columns.npy": (array_files.by_columns(), "exact:level=3,chunk=60", {}),
    "v1_decimals.npy": (array_files.stored_decimals(), "exact:level=2,chunk=60", {}),
    "v1_mips_integers.c3d": (c3d_files.whole_numbers(c3d_files.MIPS), "exact:level=3,chunk=60", {}),
}
# NAME.mcz was coded with the model NAME.mcm, which was learned from the file itself.
TRAINED = {
    "v1_trained.bvh": (WALK_BVH, "exact:level=6,chunk=80"),
    "v1_trained_fast.bvh": (clips.couplings(), "exact:level=5,chunk=32"),
    "v1_trained_laws.amc": (clips.leaps(), "exact:level=9,chunk=22"),
    # With a model no lower level is taken.
    "v1_trained_disorder.amc": (clips.disorder(), "exact:level=6,chunk=10"),
    "v1_trained_numbers.bvh": (clips.numbers(), "exact:level=6,chunk=16"),
    "v1_trained_sparse.bvh": (clips.couplings(), "qssd:atoms=9,omit=0,chunk=30,max_error=5.0"),
    "v1_trained_patterns.amc": (WALK_LF, "patterns:max_error=0.05,cluster=0.1,size=20.0"),
    "v1_trained_skeleton.amc": (clips.skeleton(), "exact:level=9,chunk=12"),
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


def values(blob: bytes) -> bytes:
    """Give the numbers of all streams, one behind the other, as little-endian doubles."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        streams = mp.load(blob, strict=False).streams
    return b"".join(stream.values.astype("<f8").tobytes() for stream in streams.values())


def streams() -> mp.Clip:
    """Give a clip of two streams at two rates, and one without frames."""
    motion = mp.read(HERE / "v1_walk.bvh")
    columns = tuple(mp.Column(f"plate.{kind}", 0, kind, "N") for kind in ("fx", "fy", "fz"))
    times = np.arange(3 * FRAMES)[:, None]
    force = np.round(700 + 90 * np.sin(0.05 * times + np.arange(3)), 2)
    named = (mp.Column("start", -1, "v1"), mp.Column("a.b", -1, "v2", "s"))
    return replace(
        motion,
        streams={
            **motion.streams,
            "force": mp.Stream(force, columns, Fraction(1, 360)),
            "empty": mp.Stream(np.empty((0, 2)), named),
        },
        metadata={"actor": "nobody"},
    )


def still() -> mp.Clip:
    """Give a clip in which nothing moves."""
    walk = mp.read(HERE / "v1_walk.bvh")
    return mp.Clip.of(np.tile(walk.values[:1], (6, 1)), walk.columns, skeleton=walk.skeleton)


def recorded(codec: str, *, closed: bool) -> bytes:
    """Record the walk; one that is not closed has the beginning of a chunk at its end."""
    clip = mp.read(HERE / "v1_walk.amc")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "take.mcz"
        with mp.writer(path, clip.columns, 120, codec=codec) as recording:
            recording.append(clip.values[:100])
            recording.append(clip.values[100:])
            if not closed:
                recording.flush()
                return path.read_bytes() + b"\x03\x40"
        return path.read_bytes()


def embedded() -> bytes:
    """Compress the walk with its skeleton."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "v1_embedded.amc"
        path.write_bytes(WALK_LF)
        path.with_suffix(".asf").write_bytes(ASF)
        return mp.compress(path, "exact:chunk=80", embed_asf=True)


def library() -> bytes:
    """Put clips into a library that are predicted from each other, or share frames."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "library.mocapdb"
        with mp.open_library(path, "a") as made:
            for name, data in clips.recurring().items():
                made.add(data, name, codec="exact:level=1", index=False)
            made.recompress_together(["take.bvh", "bent.bvh"], "mrpa:chunk=90")
        return path.read_bytes()


def trained(name: str, codec: str) -> bytes:
    """Learn from a golden file."""
    learner = mp.codec(codec)
    return model_bytes(mp.train([HERE / name], learner if learner.learns else "exact"))


if __name__ == "__main__":
    for name, (data, codec, options) in FILES.items():
        put(name, partial(bytes, data))
        put(f"{name}.mcz", partial(mp.compress, HERE / name, codec, **options))
        # Of a lossy codec, what comes back is kept.
        if not mp.codec(codec).lossless:
            put(f"{name}.back", partial(mp.decompress, HERE / f"{name}.mcz"))
    put("v1_embedded.amc", partial(bytes, WALK_LF))
    put("v1_embedded.amc.mcz", embedded)
    put("v1_embedded.companion", partial(bytes, ASF))
    for name, (data, codec) in TRAINED.items():
        model = HERE / f"{Path(name).stem}.mcm"
        put(name, partial(bytes, data))
        put(model.name, partial(trained, name, codec))
        put(f"{name}.mcz", partial(mp.compress, HERE / name, codec, model=model))
        if not mp.codec(codec).lossless:
            put(f"{name}.back", partial(mp.decompress, HERE / f"{name}.mcz", models=[model]))
    # Without an original; NAME.f64 holds the numbers.
    numbers = mp.read(HERE / "v1_numbers.bvh")
    put("v1_numbers_app.mcz", lambda: mp.compress(numbers, "app:chunk=15"))
    put(
        "v1_numbers_mrpa.mcz",
        lambda: mp.compress(numbers, "mrpa:mode=published,mantissa_limit=12,chunk=15"),
    )
    put("v1_numbers_fast.mcz", lambda: mp.compress(numbers, "exact:level=2,chunk=16"))
    pole = mp.read(POLE)
    put("v1_sparse_pole.mcz", lambda: mp.compress(pole, "qssd:chunk=100"))
    put("v1_still.mcz", lambda: mp.compress(still(), "exact:chunk=2"))
    put("v1_streams.mcz", lambda: mp.compress(streams(), "exact:chunk=80"))
    put("v1_recorded.mcz", partial(recorded, "exact:chunk=80", closed=True))
    put("v1_recorded_killed.mcz", partial(recorded, "exact:level=1,chunk=80", closed=False))
    put("v1_recorded_lossy.mcz", partial(recorded, "diffma:chunk=80", closed=True))
    for path in sorted(HERE.glob("*.mcz")):
        if not path.with_suffix("").suffix:
            put(f"{path.stem}.f64", partial(values, path.read_bytes()))
    for name, (data, codec) in DOCUMENTS.items():
        put(f"{name}.diffma.json", partial(mp.to_json, data, codec))
        put(name, partial(mp.decompress, HERE / f"{name}.diffma.json"))
    put("v1_recurring.mocapdb", library)
    put("v1_alike.mocapdb", library)  # with the schema of version 5
    learned = mp.Model("learner", bytes(range(100)) * 2)
    put("v1_learner.mcm", partial(model_bytes, learned))
    for program in sorted(HERE.parents[1].glob("core/check/*.cpp")):
        put(f"kernels_{program.stem}.txt", partial(kernels, program.stem))
    for spec in payloads.specs():
        put(payloads.golden(spec).name, partial(payloads.digests, spec))
