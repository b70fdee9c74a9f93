"""The evaluation of patterns: its measures are the paper's, its rivals keep to clips."""

import numpy as np
import pytest

from mocapress_bench import patterns_rivals as rivals
from mocapress_bench.patterns import arms_of, at_arms, distances, of_codec, of_places, told

CLIPS = (100, 53, 147)


def places(markers: int = 5) -> np.ndarray:
    time = np.arange(sum(CLIPS))[:, None, None] / 30
    moved = 200 * np.sin(time + np.arange(3 * markers).reshape(1, markers, 3))
    moved[CLIPS[0] :] += 5000  # another clip is elsewhere
    return np.asarray(moved)


def test_arms_is_equation_3() -> None:
    values, decoded = np.zeros((2, 6)), np.array([[3.0, 4, 0, 0, 0, 0], [0, 0, 0, 0, 0, 2]])
    literal = (np.sqrt((25 + 0) / 2) + np.sqrt((0 + 4) / 2)) / 2
    assert arms_of(distances(values, decoded)) == pytest.approx(literal)


def test_coded_bits_are_those_of_an_adaptive_coder() -> None:
    numbers = np.random.default_rng(0).poisson(1, (80, 2)) * np.array([1, -1])
    bits = float((numbers != 0).sum())
    for column in np.abs(numbers).T:
        counts = np.full(rivals._MOST + 1, 0.5)
        for number in column:
            bits -= np.log2(counts[number] / counts.sum())
            counts[number] += 1
    assert rivals.coded_bits(numbers) == pytest.approx(bits)


def test_rivals_do_not_go_across_clips() -> None:
    data = of_places("made up", places(), list("abcde"), CLIPS)
    assert np.array_equal(
        rivals._joined(rivals._blocks(data.values, CLIPS, 64), CLIPS), data.values
    )
    decoded, size = rivals.subsampled(data.values, 12, CLIPS)
    assert np.abs(decoded - data.values).max() < 20
    assert size == 4 * 15 * sum(-(-(frames - 1) // 12) + 1 for frames in CLIPS)
    for way in (rivals.dct, rivals.klt_dct):
        decoded, size = at_arms(way, data, 3.0)
        assert 1 < arms_of(distances(data.values, decoded)) <= 3
        assert 0 < size < data.values.nbytes / 20
    decoded, _ = rivals.arikan(data.values, 5.0, CLIPS, clusters=2)
    assert np.abs(decoded - data.values).max() < 60


def test_the_codec_is_measured_by_what_it_decodes() -> None:
    data = of_places("made up", places(), list("abcde"), CLIPS)
    row = of_codec(data, 10**6, "patterns:arms=5")
    assert float(row["ARMS, mm"]) <= 5
    assert row["ratio to text"] == pytest.approx(10**6 / float(row["bytes"]))
    assert 0 < float(row["of which database"]) < float(row["bytes"])
    assert "| `patterns:arms=5` |" in told([row])
