"""Arrays for Zarr: the codec of numcodecs."""

import numpy as np
import pytest

import mocapress as mp

numcodecs = pytest.importorskip("numcodecs")


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
