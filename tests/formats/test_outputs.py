"""Clips as CSV, NPZ and Parquet: what others read of them is what is in the clip."""

import csv
import io
import json
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from c3d_files import c3d, walk

import mocapress as mp
from mocapress.formats import by_id

SAMPLES = Path(__file__).parents[2] / "samples"


def recorded() -> mp.Clip:
    """Give markers with gaps, and analog data at four times their rate."""
    points, words, analog = walk()
    return mp.read(c3d(points, words, analog, samples=4))


def table(path: Path) -> tuple[list[str], np.ndarray]:
    head, *rows = csv.reader(io.StringIO(path.read_text()))
    return head, np.array([[float(cell or "nan") for cell in row] for row in rows])


def test_csv_has_every_stream_with_frames_and_times(tmp_path: Path) -> None:
    clip = recorded()
    mp.write(clip, tmp_path / "walk.csv")
    head, rows = table(tmp_path / "walk.csv")
    assert head == ["frame", "time", *(column.name for column in clip.columns)]
    assert np.array_equal(rows[:, 2:], clip.values, equal_nan=True)
    assert rows[:2, 0].tolist() == [int(clip.metadata["first_frame"]) + i for i in range(2)]
    assert rows[:, 1] == pytest.approx(np.arange(40) / 119.88)
    head, rows = table(tmp_path / "walk.analog.csv")
    assert np.array_equal(rows[:, 2:], clip.streams["analog"].values)
    assert rows[-1, 1] == pytest.approx(159 / (4 * 119.88))
    again = mp.read(tmp_path / "walk.csv")
    assert [column.name for column in again.columns][2:] == head_of(clip)
    assert np.array_equal(again.values[:, 2:], clip.values, equal_nan=True)


def head_of(clip: mp.Clip) -> list[str]:
    return [column.name for column in clip.columns]


def test_csv_of_channels_prints_numbers_as_their_source_did(tmp_path: Path) -> None:
    clip = mp.read(SAMPLES / "cmu_01_01.amc")
    mp.write(clip, tmp_path / "walk.csv")
    head, *rows = (tmp_path / "walk.csv").read_text().splitlines()
    assert head.split(",")[:3] == ["frame", "root.tx", "root.ty"]  # an AMC states no times
    first = (SAMPLES / "cmu_01_01.amc").read_text().splitlines()[4]
    assert rows[0].startswith(",".join(["1", *first.split()[1:]]))


def test_npz_has_plain_arrays(tmp_path: Path) -> None:
    clip = recorded()
    mp.write(clip, tmp_path / "walk.npz")
    found, markers = np.load(tmp_path / "walk.npz"), mp.markers(clip)
    assert np.array_equal(found["points"], markers.positions, equal_nan=True)
    assert found["points_names"].tolist() == list(markers.labels)
    assert np.array_equal(found["valid"], markers.valid)
    assert markers.residuals is not None
    assert np.array_equal(found["residuals"], markers.residuals, equal_nan=True)
    assert np.array_equal(found["analog"], clip.streams["analog"].values)
    assert found["analog_rate"] == pytest.approx(4 * 119.88)
    assert json.loads(str(found["metadata"]))["encoding"] == "Intel, floats"


def test_npz_of_a_skeleton(tmp_path: Path) -> None:
    clip = mp.read(SAMPLES / "freebvh.bvh")
    mp.write(clip, tmp_path / "a.npz")
    found = np.load(tmp_path / "a.npz")
    assert np.array_equal(found["motion"], clip.values)
    assert clip.skeleton is not None
    assert found["joint_names"].tolist() == [joint.name for joint in clip.skeleton.joints]
    assert found["joint_parents"].tolist() == [joint.parent for joint in clip.skeleton.joints]
    assert found["joint_offsets"].shape == (len(clip.skeleton.joints), 3)


def test_parquet_has_columns_units_and_the_clips_facts(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    clip = recorded()
    mp.write(clip, tmp_path / "walk.parquet")
    found = parquet.read_table(tmp_path / "walk.parquet")
    assert found.column_names[:3] == ["frame", "time", "M0.x"]
    for column, values in zip(clip.columns, clip.values.T, strict=True):
        assert np.array_equal(found[column.name].to_numpy(), values, equal_nan=True)
        assert found.schema.field(column.name).metadata == {b"unit": b"mm"}
    assert json.loads(found.schema.metadata[b"mocapress"])["encoding"] == "Intel, floats"
    assert parquet.read_table(tmp_path / "walk.analog.parquet").num_rows == 160


def test_parquet_without_pyarrow_says_what_to_install() -> None:
    script = (
        "import sys; sys.modules['pyarrow'] = None\n"
        "import mocapress as mp\n"
        f"mp.write(mp.read({str(SAMPLES / 'markers.trc')!r}), 'never.parquet')"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode
    assert "pip install 'mocapress[parquet]'" in done.stderr


def test_trc_is_written_with_gaps_frames_and_rate(tmp_path: Path) -> None:
    clip = recorded()
    with pytest.warns(mp.MotionWarning, match="residuals, cameras, analog .* not written"):
        mp.write(clip, tmp_path / "walk.trc")
    again = mp.read(tmp_path / "walk.trc")
    assert np.array_equal(again.values, clip.values, equal_nan=True)
    assert head_of(again) == head_of(clip)
    assert again.frame_time == clip.frame_time
    assert again.metadata["first_frame"] == clip.metadata["first_frame"]


def test_another_rate_is_that_of_all_streams(tmp_path: Path) -> None:
    mp.write(recorded(), tmp_path / "a.c3d", fps=50)
    found = mp.read(tmp_path / "a.c3d")
    assert found.frame_time * 50 == 1  # type: ignore[operator]
    assert found.streams["analog"].frame_time * 200 == 1  # type: ignore[operator]


def test_endings_of_tables_that_are_only_read_are_refused(tmp_path: Path) -> None:
    for ending in ("mot", "sto", "tsv"):
        with pytest.raises(mp.UnsupportedError, match="no format to write"):
            mp.write(recorded(), tmp_path / f"a.{ending}")


@pytest.mark.parametrize("kind", ["csv", "npz", "parquet", "trc", "c3d"])
def test_clips_without_frames_are_refused(kind: str) -> None:
    clip = mp.read(SAMPLES / "markers.trc")
    stream = clip.streams["points"]
    empty = mp.Stream(np.empty((0, stream.channels)), stream.columns, stream.frame_time)
    with pytest.raises(mp.UnsupportedError, match="no frames"):
        by_id(kind).fit(mp.Clip({"points": empty}))


@pytest.mark.parametrize("kind", ["csv", "npz", "parquet", "trc", "c3d"])
def test_one_frame_is_written(kind: str, tmp_path: Path) -> None:
    if kind == "parquet":
        pytest.importorskip("pyarrow")
    points, words, analog = walk(1)
    clip = mp.read(c3d(points, words, analog, samples=4))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        mp.write(clip, tmp_path / f"one.{kind}")
    if kind in ("trc", "c3d"):
        again = mp.read(tmp_path / f"one.{kind}")
        assert np.array_equal(again.values, clip.values, equal_nan=True)
