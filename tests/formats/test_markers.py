"""What a laboratory records can be had as markers, events, force plates and segments."""

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from c3d_files import INTEL, c3d, walk

import mocapress as mp

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.mark.parametrize("floats", [True, False])
def test_markers_of_a_c3d(floats: bool) -> None:
    points, words, analog = walk(floats=floats)
    words[3, 1] = 256 * 5 + 4  # seen by the first and the third camera, a residual of 4
    words[4, 1] = -1  # stored, and not valid
    clip = mp.read(c3d(points, words, analog, processor=INTEL, floats=floats, samples=4))
    found = mp.markers(clip)
    assert found.positions.shape == points.shape
    assert found.labels == ("M0", "M1", "M2", "M3", "M4")
    assert (found.unit, found.first_frame) == ("mm", int(clip.metadata["first_frame"]))
    assert found.rate == pytest.approx(119.88)
    assert not found.valid[4, 1]
    assert np.isfinite(found.positions[4, 1]).all()
    assert found.residuals is not None
    assert found.cameras is not None
    assert found.residuals[3, 1] == pytest.approx(4 * float(clip.metadata["point_scale"]))
    assert np.isnan(found.residuals[4, 1])
    assert found.cameras[3, 1] == 5
    assert np.array_equal(found.of("M2"), found.positions[:, 2], equal_nan=True)
    with pytest.raises(KeyError):
        found.of("nobody")
    with pytest.raises(ValueError, match="read-only"):
        found.positions[0] = 0


def test_markers_of_a_trc_are_those_of_the_c3d() -> None:
    theirs, ours = (mp.markers(mp.read(SAMPLES / f"markers.{kind}")) for kind in ("c3d", "trc"))
    assert theirs.labels == ours.labels
    assert np.array_equal(theirs.valid, ours.valid)
    assert (~theirs.valid).sum() == 30
    assert np.allclose(theirs.positions, ours.positions, rtol=1e-6, equal_nan=True)
    assert (ours.residuals, ours.cameras) == (None, None)
    assert theirs.frame_time == ours.frame_time == Fraction(1, 120)


def test_what_is_not_there_is_said() -> None:
    clip = mp.read(SAMPLES / "freebvh.bvh")
    with pytest.raises(mp.UnsupportedError, match="no points; expected a stream 'points'"):
        mp.markers(clip)
    with pytest.raises(mp.UnsupportedError, match="no rotations"):
        mp.segments(clip)
    assert not mp.events(clip)
    assert not mp.force_plates(clip)


def test_segments_turn_columns() -> None:
    points, words, analog = walk()
    turned = np.zeros((40, 2, 17))
    turned[:, :, :16] = np.arange(16.0)
    turned[:, 1, 16] = -1
    found = mp.segments(mp.read(c3d(points, words, analog, samples=4, rotations=turned)))
    assert found.matrices.shape == (40, 2, 4, 4)
    assert found.matrices[0, 0, :3, 3].tolist() == [12, 13, 14]  # a position
    assert found.reliability[5].tolist() == [0, -1]


def test_events_and_force_plates_survive_writing(tmp_path: Path) -> None:
    points, words, analog = walk()
    clip = mp.read(c3d(points, words, analog, samples=4))
    plate = {
        "type": [2.0],
        "corners": [float(i) for i in range(12)],
        "origin": [0.0, 0.0, -40.0],
        "channel": [1.0, 2.0, 3.0],
        "cal_matrix": [float(i) for i in range(36)],
        "zero": [1.0, 10.0],
    }
    events = [{"seconds": 61.5, "label": "Foot Strike", "context": "Left"}]
    facts = {"force_plates": json.dumps(plate), "events": json.dumps(events), "point_scale": "0.25"}
    told = mp.Clip(clip.streams, None, "", {**clip.metadata, **facts})
    mp.write(told, tmp_path / "again.c3d")
    again = mp.read(tmp_path / "again.c3d")
    for one in (told, again):
        (found,) = mp.force_plates(one)
        assert (found.type, found.channels) == (2, (0, 1, 2))
        assert found.corners is not None
        assert found.corners[1].tolist() == [3, 4, 5]
        assert found.origin is not None
        assert found.origin.tolist() == [0, 0, -40]
        assert found.calibration is not None
        assert found.calibration[:, 1].tolist() == [6, 7, 8, 9, 10, 11]
        assert mp.events(one) == (mp.Event(61.5, "Foot Strike", "Left"),)
    assert json.loads(again.metadata["force_plates"]) == plate
    before, after = mp.markers(told).residuals, mp.markers(again).residuals
    assert before is not None
    assert after is not None
    assert np.array_equal(before, after, equal_nan=True)


def test_others_read_force_plates_that_were_written(tmp_path: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    points, words, analog = walk()
    plain = mp.read(c3d(points, words, analog, samples=4))
    plate = {"type": [1.0, 2.0], "corners": [float(i) for i in range(24)], "channel": [1.0, 2.0]}
    told = {**plain.metadata, "force_plates": json.dumps(plate)}
    mp.write(mp.Clip(plain.streams, None, "", told), tmp_path / "a.c3d")
    group = ezc3d.c3d(str(tmp_path / "a.c3d"))["parameters"]["FORCE_PLATFORM"]
    assert group["USED"]["value"].tolist() == [2]
    assert group["CORNERS"]["value"][:, 1, 1].tolist() == [15, 16, 17]
    assert group["CHANNEL"]["value"].tolist() == [[1, 2]]


CHANNELS = """name\tcomponent\ttype\ttracked_point\tunits
hip_x\tx\tPOS\thip\tm
hip_y\ty\tPOS\thip\tm
latency\tn/a\tLATENCY\tn/a\ts
hip_q\tquat_w\tORNT\thip\tn/a
"""


def bids(folder: Path, channels: str = CHANNELS, facts: str | None = None) -> Path:
    rows = [f"{i * 0.25 + i % 3:.2f}\t{i % 5 - 2}.5\t{i / 60:.6f}\t1.0" for i in range(90)]
    (folder / "sub-1_motion.tsv").write_text("\n".join(rows) + "\n")
    (folder / "sub-1_channels.tsv").write_text(channels)
    if facts is not None:
        (folder / "sub-1_motion.json").write_text(facts)
    return folder / "sub-1_motion.tsv"


def test_a_table_of_motion_bids_has_the_names_units_and_rate_beside_it(tmp_path: Path) -> None:
    path = bids(tmp_path, facts='{"SamplingFrequency": 59.94, "TaskName": "walk"}')
    (tmp_path / "sub-1_motion.mcz").write_bytes(mp.compress(path))
    (tmp_path / "sub-1_motion.tsv.mcz").write_bytes(mp.compress(path))
    for clip in (
        mp.read(path),
        mp.load(tmp_path / "sub-1_motion.mcz"),
        mp.load(tmp_path / "sub-1_motion.tsv.mcz"),
    ):
        names = [(column.name, column.unit) for column in clip.columns]
        assert names == [("hip_x", "m"), ("hip_y", "m"), ("latency", "s"), ("hip_q", "")]
        assert clip.frame_time == 1 / Fraction("59.94")


@pytest.mark.parametrize(
    ("channels", "facts", "fault"),
    [
        (CHANNELS + "another\tx\tPOS\thip\tm\n", None, "channels of another table"),
        ("label\nhip\n", None, "no column of names"),
        (CHANNELS, "{", "no JSON"),
    ],
)
def test_what_lies_beside_a_table_and_does_not_fit_is_left_away(
    tmp_path: Path, channels: str, facts: str | None, fault: str
) -> None:
    path = bids(tmp_path, channels, facts)
    with pytest.warns(mp.MotionWarning, match=fault):
        clip = mp.read(path)
    assert clip.values.shape == (90, 4)
    assert clip.columns[0].name == "column 1"


def test_near_counts_whole_numbers_in_the_unit_that_the_file_states() -> None:
    points, words, analog = walk(floats=False)
    made = c3d(points, words, analog, processor=INTEL, floats=False, samples=4)  # tenths
    original = mp.markers(mp.read(made))
    found = mp.markers(mp.read(mp.decompress(mp.compress(made, "near:max=4mm"))))
    assert (found.valid == original.valid).all()
    away = np.linalg.norm(found.positions - original.positions, axis=2)
    assert 1 < away[original.valid].max() <= 4.1


def test_near_rounds_whole_numbers_to_the_nearest() -> None:
    points, words, analog = walk(floats=False)
    made = c3d(points, words, analog, processor=INTEL, floats=False, samples=4)  # tenths
    blob = mp.compress(made, "near:max=4mm")
    decoded, found = mp.markers(mp.load(blob)), mp.markers(mp.read(mp.decompress(blob)))
    assert (found.valid == decoded.valid).all()
    rounding = np.abs(found.positions - decoded.positions)[found.valid]
    assert 0 < rounding.max() <= 0.05 + 1e-9


def test_near_knows_markers_beside_such_as_are_never_seen() -> None:
    lines = (SAMPLES / "markers.trc").read_text().splitlines(keepends=True)
    rows = [line.rstrip("\n").split("\t") for line in lines]
    for row in rows[6:]:
        if len(row) > 8:
            row[5:8] = ["", "", ""]  # the second marker
    made = "".join("\t".join(row) + "\n" for row in rows).encode()
    original = mp.markers(mp.read(made))
    assert not original.valid[:, 1].any()
    found = mp.markers(mp.read(mp.decompress(mp.compress(made, "near:max=4mm"))))
    assert (found.valid == original.valid).all()
    away = np.linalg.norm(found.positions - original.positions, axis=2)
    assert 0.1 < away[original.valid].max() <= 4
