"""The solver's laws: the compiled ones against a slow literal version, on real motion.

The literal version follows docs/exact_laws.md: it is given the branch, solves by plain iteration,
and knows nothing of what the compiled one remembers from frame to frame.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress
from mocapress import _core
from mocapress.codecs.exact.coupling import CouplingKind

Array = NDArray[np.float64]

ROOT = Path(__file__).parents[2]
TABLES = {name: (ROOT / f"core/exact/data/{name}_1.txt").read_text() for name in ("spine", "neck")}
CLIP = mocapress.read(ROOT / "samples/cmu_01_01.amc")
JOINTS = {
    CouplingKind.SPINE: ("lowerback", "upperback", "thorax"),
    CouplingKind.NECK: ("lowerneck", "upperneck", "head"),
}
MIDDLES = {
    CouplingKind.SPINE_MIDDLE: CouplingKind.SPINE,
    CouplingKind.NECK_MIDDLE: CouplingKind.NECK,
}
UP = np.array([0.0, 1, 0])


def table(kind: CouplingKind, part: str) -> Array:
    """Give the numbers of a part: branch, twist of the last joint, twist of the middle joint."""
    found = re.findall(rf"// {part}.*\n([^/]*)", TABLES[kind.name.lower()])
    return np.array(re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", "".join(found)), dtype=np.float64)


def angles(*names: str) -> Array:
    places = {column.name: i for i, column in enumerate(CLIP.columns)}
    return np.ascontiguousarray(CLIP.values[:, [places[name] for name in names]])


def chain(kind: CouplingKind) -> Array:
    """Give x, y, z of two joints and y, x, z of the third, (F, 9) degrees."""
    first, second, third = JOINTS[kind]
    names = [f"{joint}.r{axis}" for joint in (first, second) for axis in "xyz"]
    return angles(*names, *(f"{third}.r{axis}" for axis in "yxz"))


def rotation(x: float, y: float, z: float) -> Array:
    (sx, sy, sz), (cx, cy, cz) = np.sin(np.radians([x, y, z])), np.cos(np.radians([x, y, z]))
    turn_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    turn_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    turn_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    product: Array = turn_z @ turn_y @ turn_x
    return product


def swing(a: Array, b: Array) -> Array:
    """Give the shortest rotation from one unit vector to another."""
    x, y, z = np.cross(a, b)
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn: Array = np.eye(3) + skew + skew @ skew / (1 + a @ b)
    return turn


def twist(a: Array, b: Array) -> float:
    left = (swing(a[:, 1], b[:, 1]) @ a).T @ b
    return float(np.arctan2(left[0, 2], left[0, 0]))


def terms(bends: Array, degree: int) -> Array:
    a, b, c = bends
    return np.array(
        [
            a**i * b**j * c ** (d - i - j)
            for d in range(degree + 1)
            for i in range(d, -1, -1)
            for j in range(d - i, -1, -1)
        ]
    )


def third_axis(first: Array, second: Array, near: Array, root: Array) -> Array:
    """Give y3 such that y2 is along y1 + g y3 + h y0."""
    y1, y2 = first[:, 1], second[:, 1]
    y3 = y2
    for _ in range(60):
        powers = terms(np.array([1 - UP @ y1, 1 - UP @ y3, 1 - y1 @ y3]), 4)
        g, rest = powers @ near, y1 + (powers @ root) * UP
        along = y2 @ rest
        length = along + np.sqrt(max(along**2 - rest @ rest + g * g, 0))
        y3 = length * y2 - rest
        y3 /= np.linalg.norm(y3)
    return y3


def third_twist(first: Array, second: Array, numbers: Array) -> float:
    y1, y2 = first[:, 1], second[:, 1]
    linear = terms(np.array([1 - UP @ y1, 1 - UP @ y2, 1 - y1 @ y2]), 1)
    p, q, v = twist(np.eye(3), first), twist(first, second), UP @ np.cross(y1, y2)
    cubic = [p**i * q**j * v ** (3 - i - j) for i in range(4) for j in range(4 - i)]
    return float(numbers @ [*(p * linear), *(q * linear), *(v * linear), *cubic])


def literal(kind: CouplingKind, row: Array) -> tuple[Array, float]:
    """Give x, z of the third joint by the branch that comes nearest, and y by the first branch."""
    first = rotation(*row[:3])
    second = first @ rotation(*row[3:6])
    y, x, z = row[6:]
    told: list[Array] = []
    for near, root in table(kind, "branch").reshape(-1, 2, 35):
        own = second.T @ third_axis(first, second, near, root)
        told_x = np.degrees(np.arcsin(own[2] / np.cos(np.radians(y))))
        sx, sy, cx = np.sin(np.radians(x)), np.sin(np.radians(y)), np.cos(np.radians(x))
        told_z = np.degrees(np.arctan2(own[1], own[0]) - np.arctan2(cx, sy * sx))
        told.append(np.array([told_x, (told_z - z + 180) % 360 - 180 + z]))
    y3 = third_axis(first, second, *table(kind, "branch").reshape(-1, 2, 35)[0])
    turn = third_twist(first, second, table(kind, "twist of the last"))
    swung = swing(second[:, 1], y3) @ second @ rotation(0, np.degrees(turn), 0)
    told_y = np.degrees(-np.arcsin((second.T @ swung)[2, 0]))
    return min(told, key=lambda pair: abs(pair[0] - x)), float(told_y)


def wrapped(off: Array) -> Array:
    apart: Array = np.abs((off + 180) % 360 - 180)
    return apart


@pytest.mark.parametrize("kind", JOINTS)
def test_a_chain_follows_the_literal_law(kind: CouplingKind) -> None:
    rows = chain(kind)
    told = _core.exact_law(kind, rows)
    # The branch was right in the frame before, too, so the compiled law does not have to find it.
    right = wrapped(told[:, 1] - rows[:, 7]) < 1e-3
    chosen = [i for i in range(1, len(rows), 97) if right[i] and right[i - 1]]
    assert len(chosen) > 20
    for i in chosen:
        own, _ = literal(kind, rows[i])
        assert wrapped(told[i, 1:] - own).max() < 1e-5


@pytest.mark.parametrize("kind", JOINTS)
def test_the_twist_follows_the_literal_law_on_the_first_branch(kind: CouplingKind) -> None:
    # A law that has seen one frame alone is on its first branch.
    for row in chain(kind)[::211]:
        told = _core.exact_law(kind, row[None])
        _, own = literal(kind, row)
        assert abs(told[0, 0] - own) < 1e-5


@pytest.mark.parametrize(("kind", "share"), [(CouplingKind.SPINE, 0.98), (CouplingKind.NECK, 0.95)])
def test_a_chain_holds_to_a_thousandth_of_a_degree(kind: CouplingKind, share: float) -> None:
    rows = chain(kind)
    off = wrapped(_core.exact_law(kind, rows) - rows[:, 6:])
    assert (off[:, 1:] < 1e-3).all(axis=1).mean() > share


@pytest.mark.parametrize("kind", MIDDLES)
def test_the_middle_joint_turns_as_its_law_says(kind: CouplingKind) -> None:
    rows = chain(MIDDLES[kind])[:, [0, 1, 2, 3, 5, 4]]
    told = _core.exact_law(kind, rows)
    numbers = table(MIDDLES[kind], "twist of the middle")
    for row, y in zip(rows[::211], told[::211, 0], strict=True):
        first, local = rotation(*row[:3]), rotation(row[3], y, row[4])
        y1, y2 = first[:, 1], (first @ local)[:, 1]
        linear = terms(np.array([1 - UP @ y1, 1 - UP @ y2, 1 - y1 @ y2]), 1)
        p, v = twist(np.eye(3), first), UP @ np.cross(y1, y2)
        cubic = [p**i * v ** (3 - i) for i in range(4)]
        own = float(numbers @ [*(p * linear), *(v * linear), *cubic])
        assert twist(np.eye(3), local) == pytest.approx(own, abs=1e-6)


@pytest.mark.parametrize(
    ("kind", "side", "sign"),
    [(CouplingKind.THUMB, "l", 1), (CouplingKind.OTHER_THUMB, "r", -1)],
)
def test_thumbs_follow_their_closed_form(kind: CouplingKind, side: str, sign: int) -> None:
    rows = angles(f"{side}hand.rx", f"{side}hand.rz", f"{side}thumb.rx", f"{side}thumb.rz")
    told = _core.exact_law(kind, rows)
    x = np.radians(rows[:, 0])
    along = np.stack([0.3 + 0 * x, 0.5 * np.cos(x) + np.sin(x), np.cos(x) - 0.5 * np.sin(x)])
    own_x = np.degrees(np.arcsin(along[1] / np.linalg.norm(along, axis=0)))
    own_z = rows[:, 1] + sign * (45 - np.degrees(np.arctan2(along[0], along[2])))
    assert wrapped(told - np.stack([own_x, own_z], axis=1)).max() < 1e-9
    assert (wrapped(told - rows[:, 2:]) < 2e-4).all(axis=1).mean() > 0.99


@pytest.mark.parametrize("kind", JOINTS)
def test_whole_turns_of_the_sources_change_nothing(kind: CouplingKind) -> None:
    rows = chain(kind)
    turned = rows.copy()
    turned[:, :6] += 360 * np.array([1, -1, 2, 0, 3, -2])
    assert wrapped(_core.exact_law(kind, turned) - _core.exact_law(kind, rows)).max() < 1e-6


@pytest.mark.parametrize(
    "kind",
    [kind for kind in CouplingKind if kind not in (CouplingKind.POLYNOMIAL, CouplingKind.JOINT)],
)
@pytest.mark.parametrize("nonsense", [np.nan, np.inf, -1e300, 1e5, 90.0, 180.0])
def test_nonsense_does_no_harm(kind: CouplingKind, nonsense: float) -> None:
    count = {CouplingKind.THUMB: 4, CouplingKind.OTHER_THUMB: 4}.get(
        kind, 9 if kind in JOINTS else 6
    )
    rows = np.zeros((3 * count, count))
    for i in range(count):
        rows[3 * i + 1, i] = nonsense
    rows[-1] = nonsense
    assert _core.exact_law(kind, rows).shape[0] == len(rows)
    # What it saw is forgotten once angles make sense again.
    after = _core.exact_law(kind, np.concatenate([rows, np.zeros((2, count))]))
    assert np.isfinite(after[-1]).all()
