"""What `exact` finds in clips that were converted from others, and what that saves.

Sizes are compared with those of clips in which there is nothing to find.
"""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress import _core
from mocapress.codecs import Encoded
from mocapress.codecs.exact import Exact
from mocapress.codecs.exact.coupling import Coupling, CouplingKind
from mocapress.codecs.exact.coupling_search import find_couplings
from mocapress.codecs.exact.roles import Role, Roles, find_roles
from mocapress.errors import CorruptError
from mocapress.motion import Clip, Column

Floats = NDArray[np.float64]

FRAMES = 600
DECIMALS, PRINTED32, DEGREES32 = 3, 5, 6


@pytest.fixture(autouse=True)
def _at_one_level(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compare what one level makes of clips, also where a lower one would be smaller."""
    monkeypatch.setattr("mocapress.codecs.exact.codec._smallest", lambda way, *_: way)


def clip_of(values: Floats, axes: str = "zyx") -> Clip:
    """Give a clip of joints with three angles each."""
    columns = tuple(
        Column(f"j{c // 3}.r{axes[c % 3]}", c // 3, f"r{axes[c % 3]}", "deg")
        for c in range(values.shape[1])
    )
    return Clip.of(np.ascontiguousarray(values), columns)


def roles_of(clip: Clip) -> Roles:
    return find_roles(
        clip.values,
        lambda chosen, lines: find_couplings(clip.values, clip.columns, chosen, lines),
    )


def joints_of(clip: Clip) -> list[Coupling]:
    return [told for told in roles_of(clip).couplings if told.kind is CouplingKind.JOINT]


def size(encoded: Encoded) -> int:
    return len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)


def coded(clip: Clip, level: int = 9) -> int:
    """Give the size of a clip, having seen that it comes back."""
    codec = Exact(level)
    encoded = codec.encode(clip.main)
    decoded = codec.decode(encoded.header, encoded.chunks, clip.columns)
    assert decoded.tobytes() == clip.values.tobytes()
    return size(encoded)


def wave(seed: int, reach: float) -> Floats:
    """Give an angle that moves without repeating itself, (F,) degrees."""
    random = np.random.default_rng(seed)
    steps = random.normal(0, 1, FRAMES)
    for _ in range(2):
        steps = np.convolve(steps, np.hanning(25), "same")
    return np.asarray(steps / np.abs(steps).max() * reach)


def rotations(axis: Floats, angles: Floats) -> Floats:
    """Rodrigues' formula: (F, 3, 3)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turns = np.radians(angles)[:, None, None]
    turned: Floats = np.eye(3) + np.sin(turns) * cross + (1 - np.cos(turns)) * (cross @ cross)
    return turned


def euler(rotation: Floats) -> Floats:
    """Angles in degrees, 4 decimals, of Rz Ry Rx: (F, 3) of z, y, x."""
    angles = np.stack(
        [
            np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]),
            np.arcsin(-rotation[:, 2, 0]),
            np.arctan2(rotation[:, 2, 1], rotation[:, 2, 2]),
        ],
        axis=1,
    )
    return np.asarray(np.round(np.degrees(angles), 4), dtype=np.float64)


def hinge() -> Floats:
    return euler(rotations(np.array([0.3, -0.5, 0.8]), 30 + wave(1, 60)))


def two_axes() -> Floats:
    tilt = rotations(np.array([1.0, 2.0, 0.5]), np.array([40.0]))
    bend = rotations(np.array([0.0, 0.0, 1.0]), wave(2, 50))
    side = rotations(np.array([1.0, 0.0, 0.0]), wave(3, 30))
    return euler(tilt @ bend @ side @ np.swapaxes(tilt, 1, 2))


def free() -> Floats:
    return np.stack([wave(seed, 40).round(4) for seed in (4, 5, 6)], axis=1)


def test_a_hinge_costs_little_more_than_one_angle() -> None:
    clip = clip_of(hinge())
    first, second = joints_of(clip)
    assert len(first.sources) == 1
    assert {*second.sources, *second.targets} == {0, 1, 2}
    dearest = max(coded(clip_of(clip.values[:, [c]])) for c in range(3))
    assert coded(clip) < 1.75 * dearest


def test_a_joint_of_two_axes_costs_little_more_than_two_angles() -> None:
    clip = clip_of(two_axes())
    (found,) = joints_of(clip)
    assert len(found.sources) == 2
    alone, kept = (
        coded(clip_of(clip.values[:, list(chosen)])) for chosen in (found.targets, found.sources)
    )
    assert coded(clip) < kept + alone / 2


def test_a_joint_without_limits_has_none_found() -> None:
    assert joints_of(clip_of(free())) == []


def test_a_joint_among_others_is_found_in_its_place() -> None:
    joints = [free(), hinge(), two_axes(), free()[::-1]]
    clip = clip_of(np.hstack(joints))
    assert {told.targets[0] // 3 for told in joints_of(clip)} == {1, 2}
    assert coded(clip) < 1.05 * sum(coded(clip_of(joint)) for joint in joints)


def test_the_samples_have_columns_that_jump_by_whole_turns(samples: Path) -> None:
    clip = mp.read(samples / "mocapbank.bvh")
    roles = roles_of(clip)
    assert any(roles.turns)
    assert payload(clip, roles) < payload(clip, dataclasses.replace(roles, turns=(0,) * 60))


def payload(clip: Clip, roles: Roles) -> int:
    rows = np.ascontiguousarray(clip.values[:, roles.coded])
    plan, couplings = roles.plan(roles.coded), roles.coupled(roles.coded)
    return len(
        _core.exact_encode(rows, plan, couplings, 9, ([], [[]] * len(roles.coded)), False)[0]
    )


@pytest.mark.parametrize("lowest", [-180, 0])
@pytest.mark.parametrize("speed", [3.7, -2.1])
def test_an_angle_that_leaves_its_range_costs_as_much_as_one_that_goes_on(
    lowest: int, speed: float
) -> None:
    angle = np.round(speed * np.arange(FRAMES) + wave(7, 100), 2)
    around = np.round((angle - lowest) % 360 + lowest, 2)
    turning, going = (np.stack([one, free()[:, 0]], axis=1) for one in (around, angle))
    assert roles_of(clip_of(turning)).turns == (1 if lowest else 2, 0)
    assert coded(clip_of(turning)) < coded(clip_of(going)) + FRAMES / 40


def test_half_turns_among_whole_ones_come_back() -> None:
    random = np.random.default_rng(8)
    angle = wave(9, 300) + 180 * (random.random(FRAMES) < 0.1)
    coded(clip_of(np.round((angle[:, None] + [0, 90, 180]) % 360 - 180, 3)))


def printed(numbers: Floats, unit: float) -> Floats:
    floats = (numbers / unit).astype(np.float32).astype(np.float64)
    return np.array([[float(f"{number * unit:.6f}") for number in row] for row in floats])


@pytest.mark.parametrize(("line", "unit"), [(PRINTED32, 1.0), (DEGREES32, 180 / np.pi)])
def test_printed_floats_are_coded_as_floats(line: int, unit: float) -> None:
    numbers = free() * 3
    clip, plain = clip_of(printed(numbers, unit)), clip_of(np.round(numbers * np.pi, 6))
    assert set(roles_of(clip).lines) == {(line, 6)}
    assert set(roles_of(plain).lines) == {(DECIMALS, 6)}
    assert coded(clip) < coded(plain) - FRAMES / 2


def test_printed_floats_of_one_decade_are_coded_as_floats() -> None:
    numbers = 500 + np.pi * free()
    clip, plain = clip_of(printed(numbers, 1.0)), clip_of(np.round(numbers, 6))
    assert set(roles_of(clip).lines) == {(PRINTED32, 6)}
    assert coded(clip) < coded(plain) - FRAMES / 2 * numbers.shape[1]


def test_what_is_on_no_line_of_printed_floats_comes_back_among_them() -> None:
    values = printed(free() * 3, 1.0)
    values[::70] = np.round(values[::70] + 1e-6, 6)
    values[5] = [np.nan, -np.inf, -0.0]
    values[300] = [1e300, 3.5e38, -1e-320]
    coded(clip_of(values))


def test_a_first_frame_of_another_pose_teaches_nothing() -> None:
    motion = np.hstack([free(), hinge()])
    posed = np.vstack([np.zeros((1, 6)), motion])
    assert coded(clip_of(posed)) < coded(clip_of(motion)) + 6 * 4


@pytest.mark.parametrize("made", [hinge, two_axes])
def test_damaged_headers_are_refused_or_give_other_numbers(made: Callable[[], Floats]) -> None:
    clip = clip_of(made()[:100])
    codec = Exact(1)
    encoded = codec.encode(clip.main)
    assert joints_of(clip)
    refused = 0
    for place in range(len(encoded.header)):
        for bit in range(8):
            header = bytearray(encoded.header)
            header[place] ^= 1 << bit
            try:
                decoded = codec.decode(bytes(header), encoded.chunks, clip.columns)
            except CorruptError:
                refused += 1
            else:
                assert decoded.shape == clip.values.shape
    assert refused > 0


def test_roles_of_turning_columns_come_back_from_the_header() -> None:
    clip = clip_of(np.round((wave(7, 400)[:, None] + [0, 50, 100] + 180) % 360 - 180, 2))
    encoded = Exact().encode(clip.main)
    roles = roles_of(clip)
    assert roles.turns == (1, 1, 1)
    assert roles.roles == (Role.PREDICTED,) * 3
    assert Exact().decode(encoded.header, encoded.chunks, clip.columns).shape == (FRAMES, 3)


@pytest.mark.parametrize(("polynomials", "fits"), [(12, True), (20, False)])
def test_a_column_has_no_more_predictors_than_there_is_room_for(
    polynomials: int, fits: bool
) -> None:
    """Headers with two polynomials of one column are refused before; the core relies on nothing."""
    values = np.random.default_rng(5).normal(0, 1, (40, 3)).cumsum(axis=0)
    plan = np.array([(0, 0, 0, 0, 0, -1)] * 3, np.int32)
    couplings: list[tuple[int, list[int], list[int], list[float]]]
    couplings = [(0, [0, 1], [2], [])] * polynomials
    start: tuple[list[float], list[list[float]]] = ([], [[]] * 3)
    if fits:
        payload, _, _ = _core.exact_encode(values, plan, couplings, 6, start, False)
        rows = np.empty_like(values)
        _core.exact_decode(payload, rows, plan, couplings, 6, start, True)
        assert rows.tobytes() == values.tobytes()
    else:
        with pytest.raises(ValueError, match="more predictors of a column"):
            _core.exact_encode(values, plan, couplings, 6, start, False)
