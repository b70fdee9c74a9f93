"""The paper's comparison schemes are lossless and no codecs of the command line."""

import numpy as np
import pytest
from hypothesis import given
from test_app import SIX_DIGITS, assert_same_bits, formats, make_clip, matrices, walk

import mocapress.codecs
from mocapress.codecs import Codec
from mocapress.motion import Clip, NumberFormat
from mocapress_bench.baselines import Parallelogram, PreviousFrame
from mocapress_bench.dct import Dct, _basis

BASELINES: list[Codec] = [Parallelogram(), PreviousFrame(), Dct()]


def ids(codec: Codec) -> str:
    return codec.id


def assert_round_trip(codec: Codec, clip: Clip) -> int:
    coded = codec.encode(clip.main, skeleton=clip.skeleton)
    assert_same_bits(codec.decode(coded.header, coded.chunks, clip.columns), clip.values)
    return sum(len(chunk.payload) for chunk in coded.chunks)


@pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")
@pytest.mark.filterwarnings("ignore:invalid value encountered:RuntimeWarning")
@pytest.mark.parametrize("codec", BASELINES, ids=ids)
@given(values=matrices, decimal=formats)
def test_any_matrix_comes_back(
    codec: Codec, values: np.ndarray, decimal: NumberFormat | None
) -> None:
    assert_round_trip(codec, make_clip(values, decimal))


@pytest.mark.parametrize("codec", BASELINES, ids=ids)
def test_motion_gets_smaller(codec: Codec) -> None:
    clip = make_clip(walk(500), SIX_DIGITS)
    assert assert_round_trip(codec, clip) < 500 * 7 * 4


@pytest.mark.parametrize("codec", BASELINES, ids=ids)
def test_no_baseline_is_registered(codec: Codec) -> None:
    assert codec.id not in mocapress.codecs.codec_ids()


def test_dct_basis_is_orthonormal_and_a_cosine() -> None:
    basis = _basis()
    np.testing.assert_allclose(basis @ basis.T, np.eye(16), atol=1e-15)
    k, n = np.mgrid[:16, :16]
    cosines = np.cos(np.pi * (2 * n + 1) * k / 32) * np.sqrt(np.where(k == 0, 1, 2) / 16)
    np.testing.assert_allclose(basis, cosines, atol=1e-15)
