"""What ``near`` promises: errors of joints within what was asked, whatever the clip."""

from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress.codecs import Codec
from mocapress.codecs.near.encoding import Encoder
from mocapress.codecs.near.figure import figure_of
from mocapress.codecs.near.goal import Goal, goal_of
from mocapress.describe import describe_mcz
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column, Joint, Skeleton
from mocapress.motion.kinematics import positions, rotations
from mocapress.motion.units import Amount, amount, figure_size
from mocapress.records import Reader
from mocapress.source import Source

Values = NDArray[np.float64]
CMU = 2.54 / 0.45


def decoded_by(codec: Codec, clip: Clip) -> Clip:
    encoded = codec.encode(clip.main, skeleton=clip.skeleton)
    return clip.with_values(codec.decode(encoded.header, encoded.chunks, clip.columns))


def joint_errors(clip: Clip, other: Clip, radius: float) -> Values:
    """Give how far joints, or any of three points along their axes, are off, (F, J), anew."""
    points = []
    for one in (clip, other):
        w, x, y, z = np.moveaxis(rotations(one), -1, 0)
        axes = [
            [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
        ]
        ends = np.moveaxis(np.array(axes), (0, 1), (-2, -1)) * radius
        places = positions(one)[..., None, :]
        points.append(np.concatenate([places, places + ends], axis=-2))
    errors: Values = np.linalg.norm(points[0] - points[1], axis=-1).max(axis=-1)
    return errors


def arm(frames: int, *, joints: int = 4, moving: float = 1.0, seed: int = 0) -> Clip:
    """Give a chain of joints with three rotations, in centimetres; 1.7 m long."""
    length = 170 / joints
    chain = tuple(
        Joint(
            f"j{j}",
            j - 1,
            (0.0, length if j else 0.0, 0.0),
            ("tx", "ty", "tz", "rz", "rx", "ry") if j == 0 else ("rz", "rx", "ry"),
            ends=((0.0, length, 0.0),) if j == joints - 1 else (),
        )
        for j in range(joints)
    )
    columns = tuple(
        Column(f"{joint.name}.{kind}", j, kind, "deg" if kind[0] == "r" else "length")
        for j, joint in enumerate(chain)
        for kind in joint.channels
    )
    random = np.random.default_rng(seed)
    time = np.arange(frames)[:, None] / 40
    speed, phase = random.uniform(0.3, 3, len(columns)), random.uniform(0, 6, len(columns))
    values = 30 * moving * np.sin(time * speed + phase) + 10
    return Clip.of(values, columns, None, Skeleton(chain))


@pytest.mark.parametrize("asked", ["0.02cm", "0.1cm", "1cm", "3mm"])
@pytest.mark.parametrize("name", ["cmu_01_01.amc", "mocapbank.bvh"])
def test_no_joint_is_off_by_more_than_asked(samples: Path, name: str, asked: str) -> None:
    clip = mp.read(samples / name)[:300]
    unit = CMU if name.endswith("amc") else 1.0
    most = {"0.02cm": 0.02, "0.1cm": 0.1, "1cm": 1.0, "3mm": 0.3}[asked] / unit
    decoded = decoded_by(mp.codec(f"near:max={asked}"), clip)
    errors = joint_errors(clip, decoded, 3 / unit)
    assert 0.2 * most < errors.max() <= most


@pytest.mark.parametrize(
    ("name", "feet"),
    [
        ("cmu_01_01.amc", {"lfoot", "ltoes", "rfoot", "rtoes"}),
        ("mocapbank.bvh", {"LeftAnkle", "RightAnkle"}),
    ],
)
def test_parts_of_the_body_keep_bounds_of_their_own(
    samples: Path, name: str, feet: set[str]
) -> None:
    clip = mp.read(samples / name)[:200]
    assert clip.skeleton is not None
    unit = CMU if name.endswith("amc") else 1.0
    head = "head" if name.endswith("amc") else "Head"
    decoded = decoded_by(mp.codec(f"near:max=0.1cm,feet=0.02cm,{head}=5mm"), clip)
    largest = joint_errors(clip, decoded, 3 / unit).max(axis=0) * unit
    bounds = dict.fromkeys(feet, 0.02) | {head: 0.5}
    for joint, found in zip(clip.skeleton.names, largest, strict=True):
        assert found <= bounds.get(joint, 0.1), joint
    assert largest[clip.skeleton.index(head)] > 0.1


def test_joints_that_weigh_more_have_finer_steps(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:300]
    assert clip.skeleton is not None
    goal = Goal(True, 0.1 / CMU, radius=3 / CMU, size=figure_size(clip.skeleton))
    encoder = Encoder(goal, inf, 4096, clip.main, clip.skeleton)
    hand = clip.skeleton.index("lhand")
    assert encoder.known
    before = encoder.chunks(0.25 / CMU, encoder.most)[1].mean(axis=0)
    weights = encoder.weights.copy()
    weights[hand] *= 100
    encoder.weigh(weights)
    after = encoder.chunks(0.25 / CMU, encoder.most)[1].mean(axis=0)
    assert (after / after.mean())[hand] < 0.7 * (before / before.mean())[hand]


def test_steps_that_differ_from_the_known_figures_are_checked(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:40]
    codec = mp.codec("near:max=0.1cm,feet=0.02cm")
    encoded = codec.encode(clip.main, skeleton=clip.skeleton)
    reader = Reader(encoded.header, "header of near")
    reader.numbers(2)
    assert reader.integer(31) & 24 == 24  # the known figure, with steps of its own
    for bit in range(8 * len(encoded.header)):
        header = bytearray(encoded.header)
        header[bit // 8] ^= 1 << bit % 8
        try:
            decoded = codec.decode(bytes(header), encoded.chunks, clip.columns)
        except mp.CorruptError:
            continue
        assert decoded.shape == clip.values.shape


def test_columns_may_stand_before_those_of_joints_above(samples: Path) -> None:
    """Errors can be made good further down only, so that columns are coded from the root on."""
    clip = mp.read(samples / "cmu_01_01.amc")[:300]
    codec = mp.codec("near:max=0.1cm")
    by_name = sorted(range(clip.channels), key=lambda c: clip.columns[c].name)
    columns = tuple(clip.columns[c] for c in by_name)
    other = Clip.of(clip.values[:, by_name], columns, None, clip.skeleton)
    encoded = codec.encode(other.main, skeleton=clip.skeleton)
    decoded = other.with_values(codec.decode(encoded.header, encoded.chunks, columns))
    assert joint_errors(other, decoded, 3 / CMU).max() * CMU <= 0.1
    any_figure = replace(clip.columns[0], name="other")
    ordered = codec.encode(
        clip.with_columns((any_figure, *clip.columns[1:])).main, skeleton=clip.skeleton
    )
    size, usual = (sum(len(c.payload) for c in each.chunks) for each in (encoded, ordered))
    assert size < 1.05 * usual
    for bit in range(8 * len(encoded.header)):
        header = bytearray(encoded.header)
        header[bit // 8] ^= 1 << bit % 8
        try:
            damaged = codec.decode(bytes(header), encoded.chunks, columns)
        except mp.CorruptError:
            continue
        assert damaged.shape == clip.values.shape


@pytest.mark.parametrize(
    ("digits", "asked"), [(2, "0.1cm"), (6, "0.1cm"), (6, "0.003cm"), (6, "0.0001cm")]
)
def test_text_that_comes_back_keeps_the_bound(
    samples: Path, tmp_path: Path, digits: int, asked: str
) -> None:
    source = tmp_path / "cmu_01_01.amc"
    clip = mp.read(samples / "cmu_01_01.amc")[:60]
    mp.write(clip.with_values(np.round(clip.values, digits)), source)
    (tmp_path / "cmu_01_01.asf").write_bytes((samples / "cmu_01_01.asf").read_bytes())
    clip = mp.read(source)
    blob = mp.compress(source, f"near:max={asked}", asf_path=tmp_path / "cmu_01_01.asf")
    source.write_bytes(mp.decompress(blob))
    back = mp.read(source)
    errors = joint_errors(clip, back, 3 / CMU).max() * CMU
    assert 0 < errors <= float(asked.removesuffix("cm"))


@pytest.mark.parametrize("most", ["1e25", "1e-6", "1e-8", "1e-12", "1e-25"])
def test_bounds_beyond_any_use_are_kept(samples: Path, most: str) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:40]
    decoded = decoded_by(mp.codec(f"near:max={most}cm"), clip)
    assert joint_errors(clip, decoded, 3 / CMU).max() * CMU <= float(most)


@pytest.mark.parametrize("most", ["1e-6", "1e-12"])
def test_a_bound_so_close_that_near_takes_more_ends_in_the_smallest(
    samples: Path, most: str
) -> None:
    path = samples / "cmu_01_01.amc"
    asf = samples / "cmu_01_01.asf"
    lines = path.read_bytes().splitlines(keepends=True)[:3000]
    data = b"".join(lines[: max(i for i, line in enumerate(lines) if line.strip().isdigit())])
    blob = mp.compress(data, f"near:max={most}cm", asf_path=asf)
    assert mp.decompress(blob) == data
    assert len(blob) <= len(mp.compress(data, asf_path=asf))


@pytest.mark.parametrize("seed", range(8))
def test_any_joints_of_any_skeleton_keep_their_bounds(seed: int) -> None:
    random = np.random.default_rng(seed)
    clip = arm(int(random.integers(1, 90)), joints=int(random.integers(1, 12)), seed=seed)
    assert clip.skeleton is not None
    joints = tuple(
        replace(joint, parent=int(random.integers(0, j)) if j else -1)
        for j, joint in enumerate(clip.skeleton.joints)
    )
    clip = Clip.of(clip.values.copy(), clip.columns, None, Skeleton(joints))
    parts = {
        f"j{j}": float(0.1 * 2 ** random.uniform(-5, 3))
        for j in range(len(joints))
        if random.random() < 0.5
    }
    told = ",".join(f"{name}={most!r}" for name, most in parts.items())
    codec = mp.codec(f"near:max=0.1,{told}")
    radius = codec.goal(clip.skeleton, clip.columns).radius  # type: ignore[attr-defined]
    largest = joint_errors(clip, decoded_by(codec, clip), radius).max(axis=0)
    for j, found in enumerate(largest):
        assert found <= parts.get(f"j{j}", 0.1)


def test_a_mean_beside_bounds_of_parts_is_that_of_all_errors(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:300]
    decoded = decoded_by(mp.codec("near:mean=0.05cm,hands=0.15cm"), clip)
    errors = joint_errors(clip, decoded, 3 / CMU) * CMU
    assert errors.mean() == pytest.approx(0.05, rel=0.03)
    assert clip.skeleton is not None
    assert errors[:, clip.skeleton.index("rfingers")].max() <= 0.15


def test_files_say_the_bounds_of_parts_and_what_came_of_them(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:100]
    blob = mp.compress(clip, "near:max=0.1cm,righthand=0.01cm,root=0.02cm")
    found = describe_mcz(Source(blob))
    assert found["codec"] == "near:max=0.1cm,righthand=0.01cm,root=0.02cm"
    assert mp.load(blob).frames == 100
    largest = float(found["notes"]["largest_joint_error_of_righthand"])
    assert 0 < largest <= 0.01 / CMU


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (
            "max=0.1cm,tail=0.1cm",
            "no such parameter, part or joint; expected one of head, lefthand",
        ),
        ("max=0.1cm,feet=thin", "no bound of a part of the body: feet; expected an amount above 0"),
        ("max=0.1cm,feet=0.1deg", "in space only"),
        ("max=0.1deg,feet=0.1cm", "in space only"),
        ("max=0.1cm,feet=1cm,feet=2cm", "each once"),
        ("max_error=1,feet=1cm", "no bounds of parts beside it"),
        ("feet", "no such parameter"),
    ],
)
def test_bounds_of_parts_that_cannot_be_kept_are_refused(
    samples: Path, asked: str, said: str
) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:9]
    with pytest.raises(ParameterError, match=said):
        mp.codec(f"near:{asked}").encode(clip.main, skeleton=clip.skeleton)


def test_parts_that_names_do_not_say_are_refused() -> None:
    clip = arm(9)
    with pytest.raises(ParameterError, match="names of joints do not say where it is"):
        mp.codec("near:max=0.1cm,feet=0.1cm").encode(clip.main, skeleton=clip.skeleton)


def test_the_mean_is_what_was_asked(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:400]
    decoded = decoded_by(mp.codec("near:mean=0.05cm"), clip)
    mean = joint_errors(clip, decoded, 3 / CMU).mean() * CMU
    assert mean == pytest.approx(0.05, rel=0.03)


@pytest.mark.parametrize("rate", [0.7, 2.0, 8.0])
def test_a_rate_is_filled_and_kept(samples: Path, rate: float) -> None:
    clip = mp.read(samples / "mocapbank.bvh")[:120]
    assert clip.frame_time
    budget = 1000 * rate * clip.frames * float(clip.frame_time)
    encoded = mp.codec(f"near:rate={rate}").encode(clip.main, skeleton=clip.skeleton)
    size = len(encoded.header) + sum(len(chunk.payload) for chunk in encoded.chunks)
    assert 0.9 * budget < size <= budget


def test_a_rate_that_no_scale_keeps_is_refused(samples: Path) -> None:
    clip = mp.read(samples / "mocapbank.bvh")[:60]
    with pytest.raises(ParameterError, match="near:rate; expected more"):
        mp.codec("near:rate=0.001").encode(clip.main, skeleton=clip.skeleton)
    for beside in ("max=1cm", "mean=1cm", "p=1cm", "feet=1cm", "max_error=1"):
        with pytest.raises(ParameterError, match="no bound of errors beside it"):
            mp.codec(f"near:rate=1,{beside}")


def test_a_finer_quality_has_smaller_errors(samples: Path) -> None:
    """The figure is some 1.7 m high, so that 1 stands for 1 cm and 9 for 0.01 cm."""
    clip = mp.read(samples / "cmu_01_01.amc")[:200]
    assert clip.skeleton is not None
    size = figure_size(clip.skeleton)
    for quality, part in ((1, 1.0), (5, 0.1), (9, 0.01)):
        errors = joint_errors(clip, decoded_by(mp.codec(f"near:quality={quality}"), clip), 3 / CMU)
        assert errors.mean() == pytest.approx(part / 170 * size / 3, rel=0.1)
        assert errors.max() <= 1.6 * part / 170 * size


@pytest.mark.parametrize("effort", [1, 2, 3])
def test_bounds_and_means_are_kept_by_all_efforts(samples: Path, effort: int) -> None:
    """The first looks at 512 frames of the middle, so that its mean is another."""
    clip = mp.read(samples / "cmu_01_01.amc")[:700]
    errors = joint_errors(
        clip, decoded_by(mp.codec(f"near:p=0.3cm,effort={effort}"), clip), 3 / CMU
    )
    assert errors.max() * CMU <= 1.6 * 0.3
    assert errors.mean() * CMU == pytest.approx(0.1, rel=0.2 if effort == 1 else 0.03)


def test_a_still_middle_does_not_mislead_the_first_effort(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:900]
    values = clip.values.copy()
    values[150:750] = values[150] + 1e-3 * np.sin(np.arange(600) / 20)[:, None]
    clip = clip.with_values(values)
    errors = joint_errors(clip, decoded_by(mp.codec("near:mean=0.1cm,effort=1"), clip), 3 / CMU)
    assert errors.mean() * CMU == pytest.approx(0.1, rel=0.25)


def test_a_mean_above_what_bounds_leave_costs_nothing(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:300]
    sizes = [
        sum(
            len(chunk.payload)
            for chunk in mp.codec(spec).encode(clip.main, skeleton=clip.skeleton).chunks
        )
        for spec in ("near:max=0.1cm", "near:max=0.1cm,mean=0.08cm", "near:max=0.1cm,mean=1cm")
    ]
    assert sizes[0] * 0.98 < min(sizes) <= max(sizes) < 1.02 * sizes[0]


def test_efforts_that_there_are_not_are_refused() -> None:
    with pytest.raises(ParameterError, match="near:effort; expected 1 to 3; found 4"):
        mp.codec("near:effort=4")


def test_corrections_leave_alone_what_is_kept_anyway() -> None:
    """Moving a number that the file keeps as it is would bring no joint back."""
    clip = arm(64)
    values = clip.values.copy()
    values[::2, 9:] = np.nan
    clip = clip.with_values(values)
    decoded = decoded_by(mp.codec("near:max=0.02cm"), clip)
    known = np.isfinite(values).all(axis=1)
    errors = joint_errors(clip, decoded, 3)[known]
    assert errors.max() <= 0.02


def test_what_it_costs_falls_with_the_error(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:400]
    sizes = [len(mp.compress(clip, f"near:p={p}cm")) for p in ("0.01", "0.1", "1")]
    assert sizes[0] > 1.5 * sizes[1] > 3 * sizes[2]
    assert len(mp.compress(clip, "exact")) > 2 * sizes[0]


@pytest.mark.parametrize("most", ["1e160", "1e300"])
def test_absurd_bounds_are_kept(most: str) -> None:
    values = np.cumsum(np.random.default_rng(3).normal(size=(300, 4)), axis=0)
    blob = mp.compress(mp.Clip.from_array(values, list("abcd")), f"near:max={most}")
    assert np.isfinite(mp.load(blob).values).all()


def test_info_tells_the_errors(samples: Path, tmp_path: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[:100]
    codec = mp.codec("near:max=0.1cm")
    encoded = codec.encode(clip.main, skeleton=clip.skeleton)
    told = codec.measure(clip, encoded, 1)
    errors = joint_errors(clip, decoded_by(codec, clip), 3 / CMU)
    assert told["largest_joint_error"] == pytest.approx(errors.max(), rel=0.01)
    assert told["mean_joint_error"] == pytest.approx(errors.mean(), rel=0.01)
    assert told["largest_joint_error"] >= errors.max()
    bare = replace(clip, skeleton=None)  # as an AMC has it
    assert "largest_joint_error" in codec.measure(bare, encoded, 1)


CODEC = "near:max=0.1cm"


@pytest.mark.parametrize(
    "clip",
    [
        arm(1),
        arm(2),
        arm(9),
        arm(65),
        arm(300, moving=0.0),
        arm(300, joints=1),
        arm(70, joints=40),
        arm(4, joints=300, moving=0.1),
    ],
    ids=["one frame", "two", "nine", "65", "still", "one joint", "many joints", "too many"],
)
def test_odd_clips_keep_the_bound(clip: Clip) -> None:
    errors = joint_errors(clip, decoded_by(mp.codec(CODEC), clip), 3)
    assert errors.max() <= 0.1


def test_a_figure_without_frames_comes_back(samples: Path) -> None:
    for clip in (arm(5)[:0], mp.read(samples / "cmu_01_01.amc")[:0]):
        for asked in ("max=0.1cm", "quality=3", "rate=2"):
            back = decoded_by(mp.codec(f"near:{asked}"), clip)
            assert back.values.shape == (0, clip.channels)


def test_jumps_keep_the_bound() -> None:
    clip = arm(260)
    values = clip.values.copy()
    values[100:, 3] += 180
    values[50:52, 4] = -500
    values[::7, 0] += 1e5
    clip = clip.with_values(values)
    errors = joint_errors(clip, decoded_by(mp.codec(CODEC), clip), 3)
    assert errors.max() <= 0.1


def test_what_is_no_number_comes_back_as_it_is() -> None:
    clip = arm(200)
    values = clip.values.copy()
    values[20:60, 5] = np.nan
    values[0, 3] = values[199, 2] = np.inf
    values[7, :] = -np.inf
    values[:, 8] = np.nan
    clip = clip.with_values(values)
    found = decoded_by(mp.codec(CODEC), clip).values
    lost = ~np.isfinite(values)
    assert found[lost].tobytes() == values[lost].tobytes()
    assert np.isfinite(found[~lost]).all()


def test_translations_in_every_joint_count() -> None:
    clip = arm(200)
    assert clip.skeleton is not None
    kinds = ("tx", "ty", "tz", "rz", "rx", "ry")
    skeleton = Skeleton(tuple(replace(joint, channels=kinds) for joint in clip.skeleton.joints))
    columns = tuple(
        Column(f"j{j}.{kind}", j, kind, "deg" if kind[0] == "r" else "length")
        for j in range(4)
        for kind in kinds
    )
    values = np.random.default_rng(1).normal(0, 0.3, (200, len(columns))).cumsum(axis=0)
    clip = Clip.of(values, columns, None, skeleton)
    errors = joint_errors(clip, decoded_by(mp.codec(CODEC), clip), 3)
    assert errors.max() <= 0.1


def test_scales_are_kept_as_parts_of_the_figure() -> None:
    clip = arm(200)
    assert clip.skeleton is not None
    joints = tuple(
        replace(joint, channels=(*joint.channels, "sx")) for joint in clip.skeleton.joints
    )
    columns = (*clip.columns, *(Column(f"j{j}.sx", j, "sx") for j in range(4)))
    scales = 1 + 0.2 * np.sin(np.arange(200)[:, None] / 30 + np.arange(4))
    scales[90:, 2] += np.random.default_rng(0).normal(size=110)
    values = np.concatenate([clip.values, scales], axis=1)
    clip = Clip.of(values, columns, None, Skeleton(joints))
    decoded = decoded_by(mp.codec(CODEC), clip)
    assert joint_errors(clip, decoded, 3).max() <= 0.1
    # 0.1 cm of 170 cm.
    assert np.abs(decoded.values - values)[:, -4:].max() <= 0.1 / 170


def turning(middle: float, *, whole_turns: bool) -> Clip:
    """Give a figure that leans while it turns round twice; its file has the heading innermost."""
    clip = arm(300)
    values = clip.values.copy()
    time = np.arange(300) / 40
    values[:, 3], values[:, 4] = 20 * np.sin(3 * time), middle + 15 * np.sin(2 * time)
    values[:, 5] = 95 * time
    if not whole_turns:
        values[:, 3:6] = (values[:, 3:6] + 180) % 360 - 180
    return clip.with_values(values)


@pytest.mark.parametrize(
    "clip",
    [
        turning(0, whole_turns=True),
        turning(0, whole_turns=False),
        turning(170, whole_turns=True),
    ],
    ids=["turns add up", "turns are cut", "over the right angle"],
)
def test_angles_of_turned_joints_come_back_as_the_file_writes_them(clip: Clip) -> None:
    found = decoded_by(mp.codec(f"{CODEC},chunk=128"), clip)
    assert joint_errors(clip, found, 3).max() <= 0.1
    # 0.1 cm are 1.9 degrees at 3 cm; angles that make good each other's errors may be off by more.
    assert np.abs(found.values - clip.values).max() < 6


def test_angles_that_leap_to_others_of_the_same_turn_cost_next_to_nothing() -> None:
    clip = arm(300)
    values = clip.values.copy()
    # With the middle angle mirrored and half turns beside it, the same turn: frames by chance.
    leaps = np.random.default_rng(3).random((300, 4)) < 0.3
    for joint, (first, leap) in enumerate(zip(range(3, 15, 3), leaps.T, strict=True)):
        half = 180 if joint % 2 else -180
        values[leap, first] += half
        values[leap, first + 1] = 180 - values[leap, first + 1]
        values[leap, first + 2] -= half
    leaping = clip.with_values(values)
    assert joint_errors(clip, leaping, 3).max() < 1e-9
    codec = mp.codec(CODEC)
    sizes = [
        sum(len(chunk.payload) for chunk in codec.encode(one.main, skeleton=one.skeleton).chunks)
        for one in (clip, leaping)
    ]
    assert sizes[1] < 1.05 * sizes[0]
    assert joint_errors(clip, decoded_by(codec, leaping), 3).max() <= 0.1


@pytest.mark.parametrize("rate", [240, 120, 24])
def test_any_frame_rate_will_do(samples: Path, rate: int) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")[: 150 if rate > 120 else 600 : max(1, 120 // rate)]
    if rate > 120:
        middles = (clip.values[1:] + clip.values[:-1]) / 2
        clip = clip.with_frames(np.stack([clip.values[:-1], middles], 1).reshape(-1, 62), None)
    errors = joint_errors(clip, decoded_by(mp.codec("near:max=0.2cm"), clip), 3 / CMU)
    assert errors.max() <= 0.2 / CMU


def test_without_a_skeleton_errors_are_degrees() -> None:
    clip = replace(arm(200), skeleton=None)
    codec = mp.codec("near:max=0.05deg")
    encoded = codec.encode(clip.main)
    found = codec.decode(encoded.header, encoded.chunks, clip.columns)
    assert 0.01 < np.abs(found - clip.values).max() <= 0.05
    assert "largest_value_error" in codec.measure(clip, encoded, 1)
    with pytest.raises(ParameterError, match=r"without a skeleton.*expected degrees"):
        mp.codec("near:max=0.1cm").encode(clip.main)
    assert decoded_by(mp.codec("near"), clip).values.shape == clip.values.shape


def test_an_amc_alone_keeps_degrees(samples: Path, tmp_path: Path) -> None:
    path = tmp_path / "alone.amc"
    text = (samples / "cmu_01_01.amc").read_bytes()
    path.write_bytes(text[: text.index(b"\n90\r\n") + 1])
    found = mp.read(mp.decompress(mp.compress(path, "near:max=0.05deg")))
    # Six digits are printed of each value.
    assert 0.01 < np.abs(found.values - mp.read(path).values).max() <= 0.0501


def test_bones_that_stretch_keep_degrees() -> None:
    """There is no telling where such joints are."""
    clip = arm(100)
    assert clip.skeleton is not None
    joints = tuple(
        replace(joint, channels=(*joint.channels, "l")) for joint in clip.skeleton.joints
    )
    columns = (*clip.columns, *(Column(f"j{j}.l", j, "l", "length") for j in range(4)))
    values = np.concatenate([clip.values, 1 + clip.values[:, :4] / 100], axis=1)
    clip = Clip.of(values, columns, None, Skeleton(joints))
    found = decoded_by(mp.codec("near:max=0.05deg"), clip).values
    assert 0.01 < np.abs(found - values).max() <= 0.05
    with pytest.raises(ParameterError, match="expected degrees"):
        mp.codec("near:max=0.1cm").encode(clip.main, skeleton=clip.skeleton)


def test_degrees_may_be_asked_for_with_a_skeleton() -> None:
    clip = arm(200)
    found = decoded_by(mp.codec("near:max=0.05deg"), clip).values
    assert np.abs(found - clip.values).max() <= 0.05


def test_unknown_units_take_a_quality() -> None:
    """The figure's size is all that is known of it."""
    clip = arm(200)
    assert clip.skeleton is not None
    joints = tuple(
        replace(
            joint,
            offset=tuple(7.3 * x for x in joint.offset),  # type: ignore[arg-type]
            ends=tuple(tuple(7.3 * x for x in end) for end in joint.ends),  # type: ignore[misc]
        )
        for joint in clip.skeleton.joints
    )
    other = Clip.of(clip.values * 1.0, clip.columns, None, Skeleton(joints))
    with pytest.raises(ParameterError, match="units of the file are not known; expected quality"):
        mp.codec("near:max=0.1cm").encode(other.main, skeleton=other.skeleton)
    errors = joint_errors(other, decoded_by(mp.codec("near:quality=5"), other), 3 * 7.3)
    assert errors.max() <= 1.6 * 0.1 * 7.3
    assert joint_errors(other, decoded_by(mp.codec("near:max=0.5"), other), 3 * 7.3).max() <= 0.5


def test_bounds_that_are_no_amounts_are_refused() -> None:
    for wrong in ("max=0.1ft", "max=-1cm", "max=0", "mean=cm", "p=nan", "p=1e999cm"):
        with pytest.raises(ParameterError, match="an amount above 0, such as"):
            mp.codec(f"near:{wrong}")
    for wrong in ("quality=0", "quality=10", "chunk=0", "max_error=-1", "p=1cm,max=1cm"):
        with pytest.raises(ParameterError):
            mp.codec(f"near:{wrong}")


def test_amounts_become_units_of_the_file(samples: Path) -> None:
    clip = mp.read(samples / "cmu_01_01.amc")
    figure = figure_of(clip.skeleton, clip.columns, clip.values)
    asked: dict[str, Amount | None] = {"most": amount("1cm", ""), "mean": None, "precision": None}
    goal = goal_of(figure, **asked, quality=5, parts={})
    assert goal.most == pytest.approx(1 / CMU)
    assert goal.radius == pytest.approx(3 / CMU)
    mean: dict[str, Amount | None] = {"most": None, "mean": amount("0.5mm", ""), "precision": None}
    goal = goal_of(figure, **mean, quality=5, parts={})
    assert goal.mean == pytest.approx(0.05 / CMU)
    assert goal.most == inf
