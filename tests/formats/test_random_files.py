"""Files of random skeletons, written here and not by mocapress, are read as what they are."""

import random

import numpy as np
import oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.motion import Clip

TRANSLATIONS = [f"{axis}position" for axis in "XYZ"]
ROTATIONS = [f"{axis}rotation" for axis in "XYZ"]
NUMBERS = ("{:.6f}", "{:.2f}", "{:g}", "{!r}", "{:.4e}", "{:+.3f}", "{:9.4f}")

seeds = st.integers(0, 2**32 - 1).map(random.Random)


def tree(chance: random.Random) -> list[int]:
    """Give the parent of each joint, in the order of a BVH, -1 for the root."""
    parents, above = [-1], [0]
    for i in range(1, chance.randint(1, 12)):
        above = above[: chance.randint(1, len(above))]
        parents.append(above[-1])
        above.append(i)
    return parents


def three(chance: random.Random) -> str:
    shape = chance.choice(NUMBERS)
    return " ".join(shape.format(chance.uniform(-20, 20)) for _ in range(3))


def rows(chance: random.Random, columns: int) -> list[list[str]]:
    shapes = [chance.choice(NUMBERS) for _ in range(columns)]
    frames = chance.randint(1, 5)
    return [[shape.format(chance.uniform(-170, 170)) for shape in shapes] for _ in range(frames)]


def bvh(chance: random.Random) -> tuple[bytes, list[int], list[list[str]]]:
    """Write a BVH; give it, the parents, and the numbers of each row."""
    parents, gap = tree(chance), chance.choice(("\t", "  ", ""))
    end = chance.choice(("\n", "\r\n"))
    brace = chance.choice((end, " "))
    lines, columns = ["HIERARCHY"], 0

    def add(joint: int, depth: int) -> None:
        nonlocal columns
        indent, inner = gap * depth, gap * (depth + 1)
        kind = "JOINT" if joint else "ROOT"
        lines.append(f"{indent}{kind} j{joint}{brace}{indent}{{")
        lines.append(f"{inner}OFFSET {three(chance)}")
        moved = chance.sample(TRANSLATIONS, 3) if not joint or chance.random() < 0.2 else []
        turned = chance.sample(ROTATIONS, chance.choice((1, 2, 3, 3, 3)))
        channels = turned + moved if chance.random() < 0.2 else moved + turned
        columns += len(channels)
        lines.append(f"{inner}CHANNELS {len(channels)} {' '.join(channels)}")
        below = [i for i, parent in enumerate(parents) if parent == joint]
        for child in below:
            add(child, depth + 1)
        if not below and chance.random() < 0.9:
            lines.append(f"{inner}End Site{end}{inner}{{{end}{inner}OFFSET {three(chance)}")
            lines.append(f"{inner}}}")
        lines.append(f"{indent}}}")

    add(0, 0)
    numbers = rows(chance, columns)
    blank = chance.choice((" ", "\t", "  "))
    lines += ["MOTION", f"Frames: {len(numbers)}", "Frame Time: 0.01"]
    lines += [blank.join(row) + chance.choice(("", " ")) for row in numbers]
    return (end.join(lines) + chance.choice((end, ""))).encode(), parents, numbers


def amc(chance: random.Random) -> tuple[bytes, bytes, dict[str, int], list[list[str]]]:
    """Write an ASF and an AMC; give them, the number of channels of each bone, and the rows."""
    parents, end = tree(chance), chance.choice(("\n", "\r\n"))
    names = ["root", *(f"bone{i}" for i in range(1, len(parents)))]
    used = chance.sample(("TX", "TY", "TZ", "RX", "RY", "RZ"), 6)
    channels = {"root": 6}
    lines = [":version 1.10", ":name random", ":units", f"length {chance.uniform(0.1, 3):.3f}"]
    lines += ["angle deg", ":root", f"order {' '.join(used)}", f"axis {order(chance)}"]
    lines += [f"position {three(chance)}", f"orientation {three(chance)}", ":bonedata"]
    for name in names[1:]:
        turned = [f"r{axis}" for axis in "xyz" if chance.random() < 0.7]
        channels[name] = len(turned)
        indent = chance.choice(("  ", "\t", ""))
        bone = ["begin", f"name {name}", f"direction {three(chance)}"]
        bone += [f"length {chance.uniform(0, 9):.4f}", f"axis {three(chance)} {order(chance)}"]
        if turned:
            bone.append(f"dof {' '.join(turned)}")
            if chance.random() < 0.5:
                bone.append("limits " + f"{end}".join("(-180 180)" for _ in turned))
        lines += [indent + line for line in [*bone, "end"]]
    lines += [":hierarchy", "begin"]
    for joint, name in enumerate(names):
        below = [names[i] for i, parent in enumerate(parents) if parent == joint]
        if below:
            lines.append(f"{name} {' '.join(below)}")
    asf = end.join([*lines, "end", ""])
    numbers = rows(chance, sum(channels.values()))
    moving = [name for name, count in channels.items() if count]
    text = [":FULLY-SPECIFIED", ":DEGREES"]
    for frame, row in enumerate(numbers, 1):
        left = iter(row)
        text.append(str(frame))
        text += [" ".join([name, *(next(left) for _ in range(channels[name]))]) for name in moving]
    return asf.encode(), end.join([*text, ""]).encode(), channels, numbers


def order(chance: random.Random) -> str:
    return "".join(chance.sample("XYZ", 3))


def check_numbers(clip: Clip, numbers: list[list[str]]) -> None:
    np.testing.assert_array_equal(clip.values, np.array(numbers, float))


@given(seeds)
def test_any_bvh_is_read(chance: random.Random) -> None:
    data, parents, numbers = bvh(chance)
    clip = mp.read(data)
    assert clip.skeleton is not None
    assert [joint.name for joint in clip.skeleton.joints] == [f"j{i}" for i in range(len(parents))]
    assert [joint.parent for joint in clip.skeleton.joints] == parents
    check_numbers(clip, numbers)
    expected = oracle.bvh_positions(data)
    np.testing.assert_allclose(mp.positions(clip), expected, rtol=0, atol=1e-9)
    assert mp.decompress(mp.compress(data, "exact:level=1")) == data


@given(seeds)
def test_any_amc_is_read(tmp_path_factory: pytest.TempPathFactory, chance: random.Random) -> None:
    asf, data, channels, numbers = amc(chance)
    folder = tmp_path_factory.mktemp("random")
    (folder / "a.asf").write_bytes(asf)
    (folder / "a.amc").write_bytes(data)
    clip = mp.read(folder / "a.amc")
    assert clip.skeleton is not None
    names = [joint.name for joint in clip.skeleton.joints]
    assert sorted(names) == sorted(channels)
    counts = {name: len(clip.skeleton.joints[i].channels) for i, name in enumerate(names)}
    assert counts == channels
    check_numbers(clip, numbers)
    expected = oracle.amc_positions(asf, data)
    places = np.stack([expected[name] for name in names], axis=1)
    np.testing.assert_allclose(mp.positions(clip), places, rtol=0, atol=1e-8)
    restored = mp.decompress(mp.compress(folder / "a.amc", "exact:level=1"))
    assert restored == data
