"""GLB out and in: joints stand where they stood, within the error asked for; damage is told."""

import base64
import json
import random
import struct
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import mocapress as mp
from mocapress.cli.app import app
from mocapress.formats.gltf_file import GlbWriter
from mocapress.motion.columns import skeleton_columns
from mocapress.motion.figure import centimetres
from mocapress.motion.kinematics import positions, rotations

SAMPLES = Path(__file__).parents[2] / "samples"
MARGIN = 1e-6
"""Metres: what float32 and the angles of the clip that is read may differ."""


def arm(frames: int = 41, fps: int = 50) -> mp.Clip:
    """Give three joints in centimetres that turn and bend; the last one has an end."""
    time = np.arange(frames) / fps
    turns = np.zeros((frames, 3, 4))
    for joint, speed in enumerate((1.0, 3.0, 7.0)):
        half = 0.4 * np.sin(speed * time) + 0.01 * np.sin(90 * time)
        turns[:, joint, 0] = np.cos(half)
        turns[:, joint, 1 + joint] = np.sin(half)
    root = np.stack([10 * time, 90 + np.sin(5 * time), 0 * time], axis=1)
    made = mp.from_quaternions(
        turns, [[0, 0, 0], [0, 45, 0], [0, 60, 5]], [-1, 0, 1], ["a", "b", "c"], fps, root=root
    )
    assert made.skeleton is not None
    *joints, last = made.skeleton.joints
    ended = replace(last, ends=((0.0, 30.0, 0.0), (5.0, 0.0, 0.0)))
    return replace(made, skeleton=replace(made.skeleton, joints=(*joints, ended)))


def written(clip: mp.Clip, folder: Path, to: str = "glb") -> Path:
    mp.write(clip, folder / "clip.glb", to=to, force=True)
    return folder / "clip.glb"


def by_name(clip: mp.Clip) -> np.ndarray:
    """Give points in metres, of joints sorted by their names: these, 3 cm along axes, and ends."""
    assert clip.skeleton is not None
    unit = centimetres(clip)
    assert unit is not None
    count = len(clip.skeleton.joints)
    placed = positions(clip, end_sites=True) * unit / 100
    axes = np.moveaxis(rotations(clip, form="matrix"), 3, 2) * 0.03
    own, ends = placed[:, :count], placed[:, count:]
    owners = [joint.name for joint in clip.skeleton.joints for _ in joint.ends]
    order = np.argsort(clip.skeleton.names)
    points = np.concatenate([own[:, :, None], own[:, :, None] + axes], axis=2)[:, order]
    last = ends[:, np.argsort(owners, kind="stable")]
    return np.concatenate([points.reshape(len(points), -1, 3), last], axis=1)


def furthest(a: mp.Clip, b: mp.Clip) -> float:
    return float(np.linalg.norm(by_name(a) - by_name(b), axis=2).max())


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
def test_joints_of_samples_come_back(name: str, tmp_path: Path) -> None:
    clip = mp.read(SAMPLES / name)
    clip = mp.retime(clip[:200], 120) if clip.frame_time is None else clip[:200]
    again = mp.read(written(clip, tmp_path))
    assert furthest(clip, again) < 2e-5
    assert again.frame_time == clip.frame_time
    assert again.skeleton is not None
    assert clip.skeleton is not None
    assert sorted(again.skeleton.names) == sorted(clip.skeleton.names)


@pytest.mark.parametrize("most", [0.02, 0.3, 2.0])
def test_the_largest_error_is_kept_with_fewer_keys(most: float, tmp_path: Path) -> None:
    clip = arm(400)
    whole = written(clip, tmp_path).stat().st_size
    made = written(clip, tmp_path, f"glb:max={most}cm")
    found = furthest(clip, mp.read(made))
    assert 0 < found <= most / 100 + MARGIN
    assert made.stat().st_size < whole
    assert mp.read(made).frame_time == clip.frame_time


def test_a_larger_error_leaves_fewer_keys(tmp_path: Path) -> None:
    sizes = [written(arm(400), tmp_path, f"glb:max={most}mm").stat().st_size for most in (1, 5, 50)]
    assert sizes == sorted(sizes, reverse=True)
    assert len(set(sizes)) == 3


def test_an_error_below_what_float32_keeps_is_refused(tmp_path: Path) -> None:
    with pytest.raises(mp.ParameterError, match="float32"):
        written(arm(), tmp_path, "glb:max=1e-7cm")


def test_lengths_become_metres_of_the_unit_that_is_known_or_given(tmp_path: Path) -> None:
    clip = arm()
    assert clip.skeleton is not None
    told = positions(mp.read(written(clip, tmp_path)))
    assert told[0, 1] - told[0, 0] == pytest.approx([0, 0.45, 0], abs=1e-6)
    inches = positions(mp.read(written(clip, tmp_path, "glb:unit=in")))
    assert inches == pytest.approx(told * 2.54, rel=1e-5, abs=1e-6)
    small = tuple(
        replace(joint, offset=(0.0, joint.offset[1] / 7000, 0.0), ends=())
        for joint in clip.skeleton.joints
    )
    unknown = replace(clip, skeleton=replace(clip.skeleton, joints=small))
    unknown = unknown.with_values(unknown.values * 0)
    with pytest.raises(mp.UnsupportedError, match=r"how long the units.*glb:unit=cm"):
        written(unknown, tmp_path)
    assert written(unknown, tmp_path, "glb:unit=5.644cm").exists()


@pytest.mark.parametrize(
    ("option", "fault"),
    [
        ("max=0.1deg", "a length"),
        ("max=none", "an amount"),
        ("unit=deg", "5.644cm"),
        ("keys=3", "no such option"),
        ("max", "an amount"),
    ],
)
def test_options_that_are_none_are_refused(option: str, fault: str, tmp_path: Path) -> None:
    with pytest.raises(mp.ParameterError, match=fault):
        written(arm(), tmp_path, f"glb:{option}")


def test_formats_without_options_say_so(tmp_path: Path) -> None:
    with pytest.raises(mp.ParameterError, match="bvh has no options"):
        mp.write(arm(), tmp_path / "a.bvh", to="bvh:max=1cm")


def test_missing_numbers_are_refused(tmp_path: Path) -> None:
    values = arm().values.copy()
    values[7, 4] = np.nan
    with pytest.raises(mp.UnsupportedError, match="in frame 8 of a"):
        written(arm().with_values(values), tmp_path)


@pytest.mark.parametrize("frames", [1, 2])
def test_few_frames_and_resting_joints(frames: int, tmp_path: Path) -> None:
    clip = arm(frames)
    again = mp.read(written(clip, tmp_path, "glb:max=1cm"))
    assert again.frames == frames
    still = clip.with_values(np.repeat(clip.values[:1], frames, axis=0))
    assert furthest(still, mp.read(written(still, tmp_path))) < MARGIN


def test_commands_convert_both_ways(tmp_path: Path) -> None:
    mp.write(arm(), tmp_path / "arm.bvh")
    run = CliRunner().invoke
    arguments = ["convert", str(tmp_path / "arm.bvh"), "--to", "glb:max=0.1cm"]
    done = run(app, arguments)
    assert done.exit_code == 0, done.output
    done = run(
        app, ["convert", str(tmp_path / "arm.glb"), "-o", str(tmp_path / "again.bvh"), "--json"]
    )
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)[0]["frames"] == 41
    assert run(app, ["info", str(tmp_path / "arm.glb")]).exit_code == 0
    assert "1 unit is 100 cm" in run(app, ["info", str(tmp_path / "arm.glb")]).stdout


def test_compressing_gives_the_bytes_back(tmp_path: Path) -> None:
    path = written(arm(), tmp_path)
    blob = mp.compress(path)
    assert mp.decompress(blob) == path.read_bytes()
    assert furthest(mp.load(blob), mp.read(path)) == 0


class Foreign(GlbWriter):
    """A file such as other programs write."""

    def file(
        self, nodes: list[dict[str, Any]], samplers: list[dict[str, Any]], **more: Any
    ) -> bytes:
        channels = [
            {"sampler": i, "target": {"node": sampler.pop("node"), "path": sampler.pop("path")}}
            for i, sampler in enumerate(samplers)
        ]
        self.document = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": nodes,
            "animations": [{"samplers": samplers, "channels": channels}],
            **more,
        }
        return self.contents()

    def keys(self, node: int, path: str, times: Any, values: Any, way: str) -> dict[str, Any]:
        of = self.array(np.array(times, np.float32), bounded=True)
        to = self.array(np.array(values, np.float32))
        return {"node": node, "path": path, "input": of, "output": to, "interpolation": way}


def foreign() -> bytes:
    """Give joints in centimetres below a node that scales and turns them, moved in all ways."""
    made = Foreign()
    half = float(np.sqrt(0.5))
    nodes = [
        {"name": "armature", "scale": [0.01] * 3, "rotation": [half, 0, 0, half], "children": [1]},
        {"name": "hip", "translation": [0, 0, 100], "children": [2]},
        {"name": "knee", "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, -50, 1]},
    ]
    splines = [[0] * 3, [0, 0, 100], [10, 0, 0], [0] * 3, [0, 10, 100], [0, 0, 0]]
    samplers = [
        made.keys(1, "translation", [0, 1], splines, "CUBICSPLINE"),
        made.keys(1, "rotation", [0, 0.5, 1], [[0, 0, 0, 1], [0, 0, 1, 0], [0, 0, 0, 1]], "STEP"),
    ]
    return made.file(nodes, samplers, skins=[{"joints": [1, 2]}])


def test_files_of_others_are_read() -> None:
    clip = mp.read(foreign())
    assert clip.skeleton is not None
    assert clip.skeleton.names == ("armature", "hip", "knee")
    assert clip.frame_time == Fraction(1, 24)
    placed = positions(clip)
    assert placed[0] == pytest.approx(np.array([[0, 0, 0], [0, -1, 0], [0, -0.5, 0]]), abs=1e-12)
    # Halfway along the spline, with a tangent of 10 cm a second at its start.
    assert placed[12, 1] == pytest.approx([0.0125, -1, 0.05], abs=1e-9)
    # A step half around the vertical axis leaves what hangs on it.
    assert placed[12, 2] - placed[12, 1] == pytest.approx([0, 0.5, 0], abs=1e-9)
    assert rotations(clip)[11, 1] == pytest.approx(rotations(clip)[0, 1])
    assert rotations(clip)[12, 1] != pytest.approx(rotations(clip)[0, 1], abs=0.1)


def test_gltf_with_its_numbers_in_the_text_is_read(tmp_path: Path) -> None:
    data = foreign()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    numbers = base64.b64encode(data[28 + length :]).decode()
    document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{numbers}"
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    assert np.array_equal(mp.read(tmp_path / "a.gltf").values, mp.read(data).values)
    document["buffers"][0]["uri"] = "numbers.bin"
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    with pytest.raises(mp.FormatError, match=r"inside the file \(.glb\).*numbers.bin"):
        mp.read(tmp_path / "a.gltf")


def test_keys_at_no_usual_rate_are_resampled_with_a_warning() -> None:
    made = Foreign()
    turns = [[0, 0, 0, 1], [0, 1, 0, 0], [0, 0, 0, 1]]
    data = made.file([{"name": "a"}], [made.keys(0, "rotation", [0, 0.1037, 1], turns, "LINEAR")])
    with pytest.warns(mp.MotionWarning, match="240 times a second"):
        clip = mp.read(data)
    assert (clip.frames, clip.frame_time) == (241, Fraction(1, 240))


def test_a_model_without_motion_is_one_frame() -> None:
    made = Foreign()
    data = made.file([{"translation": [1, 2, 3]}], [], skins=[{"joints": [0]}], animations=[])
    clip = mp.read(data)
    assert (clip.frames, clip.frame_time) == (1, None)
    assert positions(clip)[0, 0].tolist() == [1, 2, 3]


def _with(change: Any) -> bytes:
    """Give the foreign file with its document changed."""
    data = foreign()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    change(document)
    text = json.dumps(document).encode()
    parts = struct.pack("<I4s", len(text), b"JSON") + text + data[20 + length :]
    return struct.pack("<4sII", b"glTF", 2, 12 + len(parts)) + parts


def _put(place: str, value: object) -> Any:
    def change(document: Any) -> None:
        *path, last = [int(p) if p.isdigit() else p for p in place.split(".")]
        for key in path:
            document = document[key]
        document[last] = value

    return change


@pytest.mark.parametrize(
    ("place", "value", "fault"),
    [
        ("nodes.2.children", [0], "a tree"),
        ("nodes.1.children", [1], "a tree"),
        ("nodes.1.children", [99], "below 3"),
        ("nodes.1.children", 5, "a list"),
        ("nodes", {}, "a list of objects"),
        ("nodes.0.scale", [1, 2, 3], "one scale"),
        ("nodes.0.scale", [0, 0, 0], "one scale"),
        ("nodes.0.rotation", [0, 0, 0, 0], "unit quaternion"),
        ("nodes.0.rotation", [1e400, 0, 0, 0], "finite"),
        ("nodes.1.translation", [10**400, 0, 0], "finite"),
        ("nodes.1.translation", ["a", 0, 0], "finite"),
        ("nodes.2.matrix", [0] * 16, "one scale"),
        ("skins.0.joints", [True], "whole number"),
        ("accessors.0.count", 2**40, "whole number"),
        ("accessors.0.count", 200, "numbers inside"),
        ("accessors.0.byteOffset", 2**39, "numbers inside"),
        ("accessors.0.componentType", 5121, "numbers inside|rising"),
        ("accessors.0.componentType", 7, "5126"),
        ("accessors.0.type", "VEC9", "SCALAR"),
        ("accessors.0.type", [], "a text"),
        ("accessors.0.sparse", {}, "one by one"),
        ("bufferViews.0.buffer", 9, "below 1"),
        ("bufferViews.0.byteStride", 1, "numbers inside"),
        ("animations.0.samplers.0.input", 77, "whole number"),
        ("animations.0.samplers.1.interpolation", "SPLINE", "STEP"),
        ("animations.0.channels.0.target.node", -1, "whole number"),
        ("animations.0.channels.0.target", 7, "an object"),
        ("asset.version", "1.0", "2.0"),
        ("asset", [], "an object"),
        ("animations.0.extras", {"frame_time": "1/99999999999"}, "so many frames"),
        ("animations.0.extras", {"frame_time": "1/40000000"}, "so many frames; expected at most"),
    ],
)
def test_forged_documents_are_told(place: str, value: object, fault: str) -> None:
    with pytest.raises((mp.FormatError, mp.UnsupportedError), match=fault):
        mp.read(_with(_put(place, value)))


@pytest.mark.parametrize("text", ["1/0", "1e999999999", "-1", "nan", "0", "0.0", 7, None, "9" * 99])
def test_forged_frame_times_are_left_away(text: object) -> None:
    clip = mp.read(_with(_put("animations.0.extras", {"frame_time": text})))
    assert clip.frame_time == Fraction(1, 24)


def test_damage_anywhere_is_an_error_or_another_clip(tmp_path: Path) -> None:
    data = written(arm(9), tmp_path).read_bytes()
    picked = random.Random(1)
    for cut in picked.sample(range(4, len(data)), 60):
        with pytest.raises(mp.FormatError):
            mp.read(data[:cut], strict=True)
    for _ in range(300):
        forged = bytearray(data)
        for _ in range(picked.randint(1, 3)):
            forged[picked.randrange(4, len(data))] = picked.randrange(256)
        try:
            mp.read(bytes(forged))
        except (mp.FormatError, mp.UnsupportedError):
            pass
        except mp.MotionWarning:
            pass  # an error in tests


def test_a_thousand_joints(tmp_path: Path) -> None:
    count = 1_000
    joints = tuple(
        mp.Joint(f"j{j}", j - 1 if j % 100 else (j - 100 if j else -1), (0.0, 1.7, 0.0), ("rx",))
        for j in range(count)
    )
    columns = skeleton_columns(mp.Skeleton(joints))
    clip = mp.Clip.of(np.zeros((2, count)), columns, Fraction(1, 30), mp.Skeleton(joints))
    again = mp.read(written(clip, tmp_path, "glb:unit=cm"))
    assert again.skeleton is not None
    assert len(again.skeleton.joints) == count
