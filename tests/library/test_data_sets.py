"""Windows of a library's clips, as data sets for machine learning."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import mocapress as mp
from mocapress.library import Library

BVH, BANK = "freebvh.bvh", "mocapbank.bvh"


@pytest.fixture
def two(samples: Path, library: Library) -> Library:
    library.add(samples / BANK, labels=["walk"])
    library.add(samples / BANK, "short.bvh")
    library.add(samples / BVH)
    return library


def test_windows_are_the_frames_of_the_clips(two: Library, samples: Path) -> None:
    whole = mp.read(samples / BANK)
    data = two.windows(64, stride=10, glob=[BANK, "short.bvh"], dtype=np.float64)
    starts = range(0, 455 - 63, 10)
    assert len(data) == 2 * len(starts)
    for index in (0, 1, len(starts) - 1, len(starts), -1):
        clip, first = data.where(index)
        assert first == starts[index % len(starts)]
        assert np.array_equal(data[index], whole.values[first : first + 64])
        assert two[BANK if 0 <= index < len(starts) else "short.bvh"].id == clip
    assert [window.shape for window in data[1:4]] == [(64, 60)] * 3
    with pytest.raises(IndexError):
        data[len(data)]
    assert len(two.windows(500)) == 0
    assert len(two.windows(64, label="walk")) == 455 // 64
    two.close()


def test_windows_of_columns_positions_and_rotations(two: Library, samples: Path) -> None:
    clip = mp.read(samples / BANK)
    some = two.windows(20, glob=BANK, columns=["*.tx", clip.columns[4].name])
    assert some[0].dtype == np.float32
    assert np.array_equal(some[1][:, -1], clip.values[20:40, 4].astype(np.float32))
    placed = two.windows(20, glob=BANK, of="positions", dtype=np.float64)
    assert np.array_equal(placed[2], mp.positions(clip)[40:60])
    turned = two.windows(20, glob=BANK, of="rotations")
    assert turned[0].shape == (20, len(clip.skeleton.joints) if clip.skeleton else 0, 6)
    for wrong in ({"frames": 0}, {"frames": 5, "stride": -1}, {"frames": 5, "of": "x"}):
        with pytest.raises(mp.ParameterError):
            two.windows(**wrong)
    two.close()


def test_windows_can_be_pickled(two: Library) -> None:
    data = two.windows(64)
    again = pickle.loads(pickle.dumps(data))
    assert np.array_equal(again[3], data[3])
    again.library.close()
    two.close()


@pytest.mark.parametrize("start", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore")  # of torch
def test_a_loader_with_workers_takes_them(two: Library, start: str) -> None:
    torch = pytest.importorskip("torch")
    data = two.windows(30, stride=15, glob=BANK, of="positions")
    loader = torch.utils.data.DataLoader(
        data, batch_size=8, num_workers=2, multiprocessing_context=start
    )
    batches = [batch.numpy() for batch in loader]
    assert np.array_equal(np.concatenate(batches), np.stack(data[:]))
    assert two.load(BANK, slice(1)).frames == 1  # the parent's connection still works
    two.close()
