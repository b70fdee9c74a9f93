"""NumPy's files come back byte for byte, and their arrays are streams."""

import contextlib
import io
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from array_files import by_columns, every_kind, npy, npz, wave
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.formats.array_layout import KINDS, read_layout
from mocapress.formats.array_splitting import split_npy, split_npz
from mocapress.formats.npz_digests import with_right_digests


def test_every_kind_comes_back_and_is_read() -> None:
    data = every_kind()
    blob = mp.compress(data)
    assert mp.decompress(blob) == data
    assert len(blob) < len(data) / 2
    arrays = np.load(io.BytesIO(data))
    for clip in (mp.read(data), mp.load(blob)):
        assert next(iter(clip.streams)) == "poses"
        assert set(clip.streams) == set(arrays) - {"gender", "mocap_framerate", "betas"}
        assert clip.frame_time == Fraction(1, 120)
        for name, stream in clip.streams.items():
            expected = arrays[name].reshape(len(stream.values), -1)
            assert np.array_equal(stream.values, expected, equal_nan=True), name


@pytest.mark.parametrize("array", [wave(), np.asfortranarray(wave()), wave().astype("f4")[:, 0]])
def test_one_array_comes_back(array: np.ndarray) -> None:
    data = npy(array)
    blob = mp.compress(data)
    assert mp.decompress(blob) == data
    assert np.array_equal(mp.load(blob).values, array.reshape(len(array), -1))


def test_what_is_written_is_read_with_names_and_rate(
    tmp_path: Path,
) -> None:
    path = tmp_path / "clip.npz"
    clip = mp.from_array(wave(), ["root.tx", "root.ry", "hip.rx", "hip.rz"], fps=30)
    mp.write(clip, path)
    again = mp.read(path)
    assert np.array_equal(again.values, clip.values)
    assert [(c.name, c.unit) for c in again.columns] == [(c.name, c.unit) for c in clip.columns]
    assert again.frame_time == Fraction(1, 30)


def test_arrays_that_are_packed_are_named_and_stored_whole() -> None:
    contents = io.BytesIO()
    np.savez_compressed(contents, poses=wave())
    with pytest.raises(mp.FormatError, match="no numbers in frames"):
        mp.read(contents.getvalue())


@pytest.mark.parametrize(
    "data",
    [
        npy(np.array(["a", "b"])),
        npy(np.array(3.0)),
        npy(np.zeros((0, 4))),
        npy(np.ones((300, 2), complex)),
        npy(np.ones((300, 2), ">f8")),
        npz(),
        by_columns()[:200],
        b"\x93NUMPY\x09\x00",
        b"\x93NUMPY\x01\x00\x10\x00" + b"(" * 16,
        every_kind()[:-40],
    ],
)
def test_other_arrays_and_damaged_files_are_named(data: bytes) -> None:
    with pytest.raises(mp.FormatError):
        mp.read(
            data,
        )


def test_a_forged_archive_costs_an_error_or_comes_back() -> None:
    data = every_kind()
    directory = data.rindex(b"PK\x01\x02")
    for place in range(directory, len(data)):
        for value in (0, 255):
            forged = data[:place] + bytes([value]) + data[place + 1 :]
            try:
                parts = split_npz(forged, None, None)
            except mp.FormatError:
                continue
            assert parts.stored is not None
            streams = [stream.values for stream in parts.clip.streams.values()]
            assert read_layout(parts.stored.record(), "npz").join(streams) == forged


@given(st.sampled_from(KINDS), st.integers(2, 40), st.integers(1, 9), st.booleans(), st.data())
def test_any_bits_come_back(
    kind: str, rows: int, columns: int, by_columns: bool, data: st.DataObject
) -> None:
    size = rows * columns * np.dtype(kind).itemsize
    bits = data.draw(st.binary(min_size=size, max_size=size))
    array = np.frombuffer(bits, kind).reshape(rows, columns)
    file = npy(np.asfortranarray(array) if by_columns else array)
    try:
        parts = split_npy(file, None, None)
    except mp.FormatError:
        return  # too few numbers, or a NaN that float64 cannot hold
    assert parts.stored is not None
    assert parts.stored.join([parts.clip.values]) == file


def test_a_forged_layout_is_refused() -> None:
    parts = split_npz(every_kind(), None, None)
    assert parts.stored is not None
    record = parts.stored.record()
    for length in range(len(record) // 4):
        with pytest.raises(mp.CorruptError):
            read_layout(record[:length], "npz")
    for place in range(60):
        forged = record[:place] + bytes([record[place] ^ 127]) + record[place + 1 :]
        streams = [stream.values for stream in parts.clip.streams.values()]
        with contextlib.suppress(mp.CorruptError):
            read_layout(forged, "npz").join(streams, len(record) * 2 + 10**6)


@pytest.mark.parametrize("streamed", [False, True])
def test_an_archive_that_comes_back_with_other_numbers_can_be_opened(streamed: bool) -> None:
    """Its digests are those of the numbers that it has; a stream's stand behind its files."""
    made = io.BytesIO()
    target = Unseekable(made) if streamed else made
    np.savez(target, poses=wave(400, 12), betas=np.arange(16.0))
    blob = mp.compress(made.getvalue(), "near:max=0.01")
    restored = mp.decompress(blob)
    assert restored != made.getvalue()
    with np.load(io.BytesIO(restored)) as archive:
        errors = np.abs(archive["poses"] - wave(400, 12))
        assert np.array_equal(archive["betas"], np.arange(16.0))
    assert 0 < errors.max() <= 0.01
    assert np.array_equal(mp.read(restored).values, mp.load(blob).values)


def test_what_is_no_archive_is_refused_and_never_grows() -> None:
    data = npz(poses=wave(40, 3))
    random = np.random.default_rng(5)
    for at in random.integers(0, len(data), 400):
        forged = bytearray(data)
        forged[at] ^= 1 << random.integers(8)
        for one in (bytes(forged), data[:at]):
            with contextlib.suppress(mp.CorruptError):
                assert len(with_right_digests(one)) == len(one)
    with pytest.raises(mp.CorruptError, match="no archive"):
        with_right_digests(data[:100])


class Unseekable(io.RawIOBase):
    def __init__(self, target: io.BytesIO) -> None:
        self.target = target

    def write(self, data: Any) -> int:
        return self.target.write(data)

    def writable(self) -> bool:
        return True
