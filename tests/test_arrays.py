"""Arrays for Zarr: the codec of numcodecs."""

from pathlib import Path

import numpy as np
import pytest

import mocapress as mp

numcodecs = pytest.importorskip("numcodecs")
zarr = pytest.importorskip("zarr")


@pytest.mark.parametrize("shape", [(0, 3), (1, 1), (5, 0), (700, 12), (40,), (0,)])
def test_arrays_come_back(shape: tuple[int, ...]) -> None:
    codec = numcodecs.get_codec({"id": "mocapress_exact", "level": 3})
    array = np.random.default_rng(4).normal(size=shape).round(4)
    if array.size > 3:
        array.flat[:3] = np.nan, -np.inf, -0.0
    for given in (array, np.asfortranarray(array)):
        back = codec.decode(codec.encode(given)).reshape(shape)
        assert back.tobytes() == array.tobytes()
        out = np.empty(shape)
        codec.decode(codec.encode(given), out=out)
        assert out.tobytes() == array.tobytes()


def test_the_configuration_makes_the_codec_again() -> None:
    codec = numcodecs.get_codec({"id": "mocapress_exact", "level": 9})
    assert codec.get_config() == {"id": "mocapress_exact", "level": 9}
    assert numcodecs.get_codec(codec.get_config()) == codec


def test_other_arrays_are_refused() -> None:
    codec = numcodecs.get_codec({"id": "mocapress_exact"})
    for array in (np.zeros((2, 2, 2)), np.zeros((3, 3), np.float32), np.zeros((3, 3), ">f8")):
        with pytest.raises(mp.ParameterError, match="frames x channels"):
            codec.encode(array)
    with pytest.raises(mp.ParameterError):
        numcodecs.get_codec({"id": "mocapress_exact", "level": 10})
    with pytest.raises(mp.CorruptError):
        codec.decode(b"no mcz")


def test_zarr_stores_and_reads_with_it(tmp_path: Path) -> None:
    values = np.random.default_rng(1).normal(size=(900, 12)).round(3)
    codec = numcodecs.get_codec({"id": "mocapress_exact", "level": 1})
    array = zarr.create_array(
        tmp_path / "clips.zarr",
        shape=values.shape,
        chunks=(400, 12),
        dtype="f8",
        zarr_format=2,
        compressors=codec,
    )
    array[:] = values
    again = zarr.open_array(tmp_path / "clips.zarr", mode="r")
    assert np.array_equal(again[:], values)
    stored = sum(path.stat().st_size for path in (tmp_path / "clips.zarr").iterdir())
    assert stored < values.nbytes / 3
