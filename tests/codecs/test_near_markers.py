"""What ``near`` promises of markers: none is off by more than asked, and gaps stay gaps."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress.codecs import Codec
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column

Values = NDArray[np.float64]


def decoded_by(codec: Codec, clip: Clip) -> Clip:
    encoded = codec.encode(clip.main)
    return clip.with_values(codec.decode(encoded.header, encoded.chunks, clip.columns))


def markers_clip(frames: int = 300, points: int = 9, unit: str = "mm") -> Clip:
    """Give markers of a body of 1.7 m that walks, in millimetres."""
    random = np.random.default_rng(3)
    time = np.arange(frames)[:, None, None] / 100
    places = random.uniform(0, 1, (points, 3)) * (400, 400, 1700)
    moves = 60 * np.sin(
        time * random.uniform(2, 9, (points, 3)) + random.uniform(0, 6, (points, 3))
    )
    values = places + moves + time * (1300, 0, 0)
    columns = tuple(Column(f"M{p}.{k}", p, k, unit) for p in range(points) for k in "xyz")
    return Clip.of(values.reshape(frames, -1), columns, None)


def marker_errors(clip: Clip, other: Clip) -> Values:
    """Give how far markers are off, (F, P); 0 where both are missing."""
    missing = ~np.isfinite(clip.values) & ~np.isfinite(other.values)
    moved = np.where(missing, 0, other.values) - np.where(missing, 0, clip.values)
    moved = moved.reshape(clip.frames, -1, 3)
    return np.asarray(np.linalg.norm(moved, axis=2))


@pytest.mark.parametrize("asked", ["0.2mm", "1mm", "1cm", "3"])
def test_no_marker_is_off_by_more_than_asked(asked: str) -> None:
    clip = markers_clip()
    most = {"0.2mm": 0.2, "1mm": 1.0, "1cm": 10.0, "3": 3.0}[asked]
    codec = mp.codec(f"near:max={asked}")
    errors = marker_errors(clip, decoded_by(codec, clip))
    assert 0.2 * most < errors.max() <= most
    told = codec.measure(clip, codec.encode(clip.main), 1)
    assert told["largest_marker_error"] == pytest.approx(errors.max(), rel=0.01)


def test_markers_that_are_missing_come_back_as_they_are() -> None:
    clip = markers_clip()
    values = clip.values.copy()
    values[20:60, 3:6] = 0  # as C3D has it
    values[100:, 6:9] = np.nan
    values[:, 9:12] = np.nan
    values[7, 1] = np.inf
    clip = clip.with_values(values)
    found = decoded_by(mp.codec("near:max=1mm"), clip)
    for part in (np.s_[20:60, 3:6], np.s_[100:, 6:9], np.s_[:, 9:12], np.s_[7, :3]):
        assert found.values[part].tobytes() == values[part].tobytes()
    assert marker_errors(clip, found).max() <= 1
    assert np.isfinite(found.values[:, 12:]).all()


def test_markers_may_have_bounds_of_their_own() -> None:
    clip = markers_clip()
    codec = mp.codec("near:max=5mm,M2=0.1mm")
    largest = marker_errors(clip, decoded_by(codec, clip)).max(axis=0)
    assert largest[2] <= 0.1
    assert 1 < largest.max() <= 5
    with pytest.raises(ParameterError, match="or a joint or marker of M0, M1"):
        mp.codec("near:max=5mm,LTOE=1mm").encode(clip.main)


def test_markers_of_unknown_units_take_a_quality() -> None:
    clip = markers_clip(unit="")
    with pytest.raises(ParameterError, match="units of the file are not known"):
        mp.codec("near:max=1mm").encode(clip.main)
    assert marker_errors(clip, decoded_by(mp.codec("near:quality=5"), clip)).max() <= 2


def test_what_stands_beside_markers_is_exact(samples: Path) -> None:
    clip = mp.read(samples / "markers.c3d")
    found = mp.load(mp.compress(clip, "near:max=1mm"))
    assert marker_errors(clip, found).max() <= 1
    for name in ("residuals", "cameras"):
        assert found.streams[name].values.tobytes() == clip.streams[name].values.tobytes()


@pytest.mark.parametrize("name", ["markers.c3d", "markers.trc"])
def test_files_of_markers_come_back_in_their_layout(samples: Path, name: str) -> None:
    original = mp.read(samples / name)
    blob = mp.compress(samples / name, "near:max=1mm")
    assert len(blob) < len(mp.compress(samples / name)) / 2.5
    restored = mp.decompress(blob)
    found = mp.read(restored.data if hasattr(restored, "data") else restored)
    assert list(found.streams) == list(original.streams)
    for stream in list(found.streams)[1:]:
        assert (found.streams[stream].values == original.streams[stream].values).all()
    assert marker_errors(original, found).max() <= 1.01
