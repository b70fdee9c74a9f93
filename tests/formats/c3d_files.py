"""Small C3D files of every encoding, put together byte by byte."""

import struct

import numpy as np
from numpy.typing import NDArray

INTEL, DEC, MIPS = 84, 85, 86
Values = NDArray[np.float64]


def integers(processor: int, numbers: object) -> bytes:
    return (
        np.asarray(numbers).astype(np.int64).astype(">i2" if processor == MIPS else "<i2").tobytes()
    )


def reals(processor: int, numbers: object) -> bytes:
    floats = np.asarray(numbers, np.float32).ravel()
    if processor == DEC:
        bits = (floats * np.float32(4)).view(np.uint32)
        return np.stack([bits >> 16, bits & 0xFFFF], axis=-1).astype("<u2").tobytes()
    return floats.astype(">f4" if processor == MIPS else "<f4").tobytes()


def record(processor: int, name: str, number: int, content: bytes) -> bytes:
    link = integers(processor, [len(content) + 2])
    return bytes([len(name), number % 256]) + name.encode() + link + content


def parameter(
    processor: int, name: str, group: int, kind: int, shape: list[int], data: bytes
) -> bytes:
    content = bytes([kind % 256, len(shape), *shape]) + data + b"\0"
    return record(processor, name, group, content)


def texts(processor: int, name: str, group: int, words: list[str]) -> bytes:
    data = b"".join(word.encode().ljust(8) for word in words)
    return parameter(processor, name, group, -1, [8, len(words)], data)


def c3d(
    points: Values,
    words: Values,
    analog: Values,
    *,
    processor: int = INTEL,
    floats: bool = True,
    samples: int = 1,
    rotations: Values | None = None,
    announced: int | None = None,
    stated: int | None = None,
    tail: bytes = b"",
    scale: float = 0.1,
) -> bytes:
    """Give a file.

    Parameters
    ----------
    points, words
        (F, P, 3) and (F, P), as they are stored.
    analog
        (F * samples, A)
    rotations
        (F, R, 17)
    announced
        Frames that the header announces.
    stated
        Frames that a parameter states.
    tail
        What stands behind the frames.

    """
    frames, count = words.shape
    channels = analog.shape[1]
    group = [
        bytes([len(name), 256 - i]) + name
        for i, name in ((1, b"POINT"), (2, b"ANALOG"), (3, b"ROTATION"))
    ]
    groups = [g + integers(processor, [3]) + b"\0" for g in group]
    labels = [f"M{i}" for i in range(count)]
    start = 5
    turned = 0 if rotations is None else rotations.shape[1]
    content = [
        groups[0],
        parameter(processor, "USED", 1, 2, [], integers(processor, [count])),
        parameter(processor, "DATA_START", 1, 2, [], integers(processor, [start])),
        parameter(processor, "RATE", 1, 4, [], reals(processor, [119.88])),
        parameter(processor, "SCALE", 1, 4, [], reals(processor, [-1.0 if floats else scale])),
        *(
            []
            if stated is None
            else [parameter(processor, "LONG_FRAMES", 1, 4, [], reals(processor, [stated]))]
        ),
        texts(processor, "LABELS", 1, labels),
        texts(processor, "UNITS", 1, ["mm"]),
        groups[1],
        parameter(processor, "USED", 2, 2, [], integers(processor, [channels])),
        parameter(processor, "GEN_SCALE", 2, 4, [], reals(processor, [0.5])),
        parameter(
            processor, "SCALE", 2, 4, [channels], reals(processor, np.arange(channels) + 1.0)
        ),
        parameter(processor, "OFFSET", 2, 2, [channels], integers(processor, np.full(channels, 7))),
        texts(processor, "LABELS", 2, [f"A{i}" for i in range(channels)]),
    ]
    numbers = np.concatenate(
        [
            np.concatenate([points, words[:, :, None]], axis=2).reshape(frames, -1),
            analog.reshape(frames, samples * channels),
        ],
        axis=1,
    )
    encode = reals if floats else integers
    data = encode(processor, numbers) + tail
    if rotations is not None:
        data += b"\0" * (-len(data) % 512)
        begin = start + len(data) // 512
        content += [
            groups[2],
            parameter(processor, "USED", 3, 2, [], integers(processor, [turned])),
            parameter(processor, "DATA_START", 3, 2, [], integers(processor, [begin])),
        ]
        data += encode(processor, rotations)
    section = (bytes([1, 0x50, 3, processor]) + b"".join(content)).ljust(3 * 512, b"\0")
    assert len(section) == 3 * 512
    stated = frames if announced is None else announced
    header = b"\x02\x50" + integers(processor, [count, channels * samples, 1, stated, 0])
    header += reals(processor, [-1.0 if floats else scale])
    header += integers(processor, [start, samples]) + reals(processor, [119.88])
    return header.ljust(512, b"\0") + section + data


def walk(frames: int = 40, *, floats: bool = True) -> tuple[Values, Values, Values]:
    """Give points with a gap, fourth words, and analog data of four samples a frame."""
    time = np.arange(frames)[:, None, None]
    points = 900 * np.sin(0.05 * time + np.arange(15).reshape(1, 5, 3))
    points += np.random.default_rng(1).normal(size=points.shape)
    points[12:20, 1] = 0
    points[:, 4] = 0
    words = np.full((frames, 5), 3 * 256 + 5.0)
    words[time[:, 0, 0] % 7 == 0, 2] = 7 * 256 + 9
    words[12:20, 1] = -1
    words[:, 4] = -1
    samples = np.arange(4 * frames)[:, None]
    analog = np.rint(400 * np.sin(0.02 * samples + np.arange(3)))
    if floats:
        # On a grid; on a grid but for roundings; few numbers.
        analog[:, 0] *= 0.25
        analog[:, 1] = (analog[:, 1] * 0.3).astype(np.float32) * np.float32(0.0173)
        analog[:, 2] = np.sqrt(analog[:, 2] % 7 + 20)
        analog = analog.astype(np.float32).astype(np.float64)
        return points.astype(np.float32).astype(np.float64), words, analog
    return np.rint(10 * points), words, analog


def swapped(data: bytes, at: int, number: int) -> bytes:
    """Give a file with another integer of 16 bits at an offset."""
    return data[:at] + struct.pack("<H", number) + data[at + 2 :]


def odd_floats(processor: int) -> bytes:
    """Give a C3D with gaps, rotations, NaN, and words that no number has."""
    points, words, analog = walk(150)
    points[3, 0, 2], points[4, 0, 1], words[6, 0], words[7, 0] = np.nan, -0.0, -0.0, 1.5
    analog[9, 2] = np.inf
    turned = np.sin(0.03 * np.arange(150)[:, None, None] + np.arange(34).reshape(1, 2, 17))
    return c3d(
        points, words, analog, processor=processor, samples=4, rotations=turned, tail=b"between"
    )


def whole_numbers(processor: int) -> bytes:
    """Give a C3D of integers, with a gap."""
    points, words, analog = walk(150, floats=False)
    return c3d(points, words, analog, processor=processor, floats=False, samples=4)
