"""Measures what gltfpack makes of a clip: bytes, and how far its joints move.

    npm install gltfpack
    python benchmarks/gltfpack.py samples/cmu_01_01.amc [--command "npx gltfpack"]

The clip is written as GLB by mocapress and packed with all of its frames (-af 0) and joints (-kn),
compressed as strongly as gltfpack does for all readers of its files (-cc). Rotations have 16 bits,
or the 12 that are usual. Errors are those of the same file without compression, read back; such a
file has rotations of 16 bits, so those of 12 bits have no errors here.
"""

import argparse
import shlex
import subprocess
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import mocapress as mp
from mocapress_bench.tables import markdown


def packed(command: str, source: Path, target: Path, *options: str) -> Path:
    """Run gltfpack, and give its output."""
    arguments = ["-i", str(source), "-o", str(target), "-kn", "-af", "0", *options]
    whole = [*shlex.split(command), *arguments]
    subprocess.run(whole, check=True, capture_output=True)  # noqa: S603
    return target


def errors(first: Path, second: Path) -> np.ndarray:
    """Give how far joints of the same names lie apart, (F, J), cm."""
    clips = [mp.read(path) for path in (first, second)]
    places = []
    for clip in clips:
        assert clip.skeleton is not None
        names = [joint.name for joint in clip.skeleton.joints]
        order = np.argsort(names)
        places.append((sorted(names), mp.positions(clip)[:, order]))
    (names, ours), (other_names, theirs) = places
    assert names == other_names
    assert ours.shape == theirs.shape
    distances: np.ndarray = 100 * np.linalg.norm(ours - theirs, axis=2)
    return distances


def main(path: Path, command: str) -> None:
    """Print the table."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        plain = folder / "plain.glb"
        mp.write(mp.read(path), plain)
        off = errors(plain, packed(command, plain, folder / "quantized.glb"))
        rows = [["GLB", f"{plain.stat().st_size:,}", "", ""]]
        for bits in (16, 12):
            made = packed(command, plain, folder / f"{bits}.glb", "-cc", "-ar", str(bits))
            told = [f"{off.mean():.4f}", f"{off.max():.4f}"] if bits == 16 else ["", ""]
            rows.append([f"gltfpack, {bits} bits", f"{made.stat().st_size:,}", *told])
        print(markdown(["", "bytes", "mean error, cm", "largest error, cm"], rows))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clip", type=Path)
    parser.add_argument("--command", default="npx gltfpack")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore", mp.MotionWarning)
    main(arguments.clip, arguments.command)
