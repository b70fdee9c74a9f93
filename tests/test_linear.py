"""Nothing takes time that grows with the square of its input.

Each kind of input is made in two sizes, the larger eight times the smaller, which are such that
quadratic work takes seconds to minutes.
"""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from linear import Work, is_linear

import mocapress as mp
from mocapress import api
from mocapress.formats.asf import parse_asf
from mocapress.library import open_library
from mocapress.motion import Stream
from mocapress.motion.columns import numbered_columns
from mocapress.source import Source

HEAD = "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
END = "End Site\n{\nOFFSET 0 1 0\n}\n"
MOTION = "MOTION\nFrames: 2\nFrame Time: 0.01\n"
ASF = ":units\n length 1\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n:bonedata\n"


def bvh(joints: str, rows: str, head: str = HEAD, motion: str = MOTION) -> bytes:
    return f"{head}{joints}}}\n{motion}{rows}".encode()


def asf(names: list[str]) -> bytes:
    bones = "".join(
        f"begin\nid {n}\nname {name}\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\nend\n"
        for n, name in enumerate(names)
    )
    tree = "".join(f"root {name}\n" for name in names)
    return f"{ASF}{bones}:hierarchy\nbegin\n{tree}end\n".encode()


def reading(data: bytes) -> Work:
    return lambda: mp.read(data, strict=False)


def blank_lines(n: int) -> bytes:
    return b"\n" * n + b"1\nroot 1 2 3 4 5 6\n2\nroot 1 2 3 4 5 7\n"


def chain(n: int) -> bytes:
    joint = "JOINT a\n{\nOFFSET 0 1 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
    return bvh(joint * n + END + "}\n" * n, (" ".join(["0"] * (3 * n + 3)) + "\n") * 2)


def channels(n: int) -> bytes:
    return f"{HEAD[: HEAD.index('CHANNELS')]}CHANNELS {n} {'Xrotation ' * n}\n{END}}}\n".encode()


def chunks(n: int) -> bytes:
    clip = mp.from_array(np.arange(n, dtype=float)[:, None], ["x"])
    return api.compress_clip(clip, "exact:level=1,chunk=1").blob


def streams(n: int) -> mp.Clip:
    columns = numbered_columns(1, ("x",))
    made = {f"s{i}": Stream(np.zeros((2, 1)), columns, None) for i in range(n)}
    return mp.Clip(made, None)


def packed_blank_lines(n: int) -> Work:
    blob = mp.compress(blank_lines(n), "exact:level=1")
    return lambda: (mp.decompress(blob), mp.verify(blob))


KINDS: dict[str, tuple[int, Callable[[int], Work]]] = {
    "blank lines before the frames of an AMC": (20000, lambda n: reading(blank_lines(n))),
    "blank lines before an AMC, in a .mcz": (20000, packed_blank_lines),
    "blank lines before anything": (40000, lambda n: lambda: Source(b"\n" * n + b"x").kind),
    "blanks before anything": (40000, lambda n: lambda: Source(b" \t" * n + b"x").kind),
    "End Sites of a joint": (2000, lambda n: reading(bvh(END * n, "0 0 0\n0 0 1\n"))),
    "joints in a chain": (250, lambda n: reading(chain(n))),
    "joints side by side": (
        500,
        lambda n: reading(
            bvh(f"JOINT a\n{{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n{END}}}\n" * n, "0 " * (n + 3))
        ),
    ),
    "channels of a joint": (5000, lambda n: reading(channels(n))),
    "rows wrapped after each number": (
        5000,
        lambda n: reading(bvh(END, "0\n" * 3 * n, motion=MOTION.replace("2", str(n), 1))),
    ),
    "rows of one number": (4000, lambda n: reading(bvh(END, "0 0 0\n1\n" * n))),
    "comments": (20000, lambda n: reading(b"# no\n" * n + blank_lines(1))),
    "bones of one name": (1000, lambda n: lambda: parse_asf(asf(["bone"] * n))),
    "bones": (1000, lambda n: lambda: parse_asf(asf([f"bone{i}" for i in range(n)]))),
    "rows of one name in a frame": (
        4000,
        lambda n: reading(b"1\n" + b"bone 1\n" * n + b"2\n" + b"bone 1\n" * n),
    ),
    "names in a frame": (
        2000,
        lambda n: reading("".join(["1\n", *(f"b{i} 1\n" for i in range(n)), "2\nb0 2\n"]).encode()),
    ),
    "columns of a table": (
        500,
        lambda n: reading(
            "\n".join(["\t".join(f"c{i}" for i in range(n)), *["\t".join(["1"] * n)] * 2]).encode()
        ),
    ),
    "digits of a number": (10000, lambda n: reading(bvh(END, f"{'1' * n} 0 0\n0 0 0\n"))),
    "digits of a rate": (
        10000,
        lambda n: reading(
            bvh(END, "0 0 0\n0 0 1\n", motion=f"MOTION\nFrames: 2\nFrame Time: 0.{'1' * n}\n")
        ),
    ),
}


@pytest.mark.parametrize("kind", KINDS)
def test_eight_times_the_input_takes_about_eight_times_as_long(kind: str) -> None:
    size, made = KINDS[kind]
    assert is_linear(made, size)


def test_an_index_of_many_chunks_is_linear() -> None:
    blobs = {n: chunks(n) for n in (125, 1000)}
    assert is_linear(lambda n: lambda: mp.load(blobs[n]), 125)
    assert is_linear(lambda n: lambda: mp.load(blobs[n], frames=slice(n - 2, n)), 125)
    assert is_linear(lambda n: lambda: mp.verify(blobs[n]), 125)


def test_streams_of_a_clip_are_linear() -> None:
    assert is_linear(lambda n: lambda: api.compress_clip(streams(n), "exact:level=1"), 30)


def test_adding_to_a_library_is_linear(tmp_path: Path) -> None:
    clip = mp.from_array(np.arange(4, dtype=float)[:, None], ["x"])

    def filled(n: int) -> Work:
        def work() -> None:
            path = tmp_path / f"{time.monotonic_ns()}.mocapdb"
            with open_library(path, "a") as library, library.db.writing():
                for number in range(n):
                    library.add(clip, str(number), codec="exact:level=1")

        return work

    assert is_linear(filled, 5)


def test_quadratic_work_is_seen() -> None:
    """The measure itself: a list that is gone through for each of its entries."""

    def quadratic(n: int) -> Work:
        return lambda: [sum(range(n)) for _ in range(n)]

    def linear(n: int) -> Work:
        return lambda: [sum(range(2000)) for _ in range(n)]

    assert not is_linear(quadratic, 700, tries=1)
    assert is_linear(linear, 700)
