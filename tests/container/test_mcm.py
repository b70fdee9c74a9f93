"""Model files: what they hold comes back; every damage is found; old files stay readable."""

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress.container import Mcm, pack, pack_model, parse_model, peek_model
from mocapress.container.mcm import LARGEST_PAYLOAD, LONGEST_HEADER
from mocapress.container.sections import section
from mocapress.errors import CorruptError, UnsupportedError
from mocapress.models import model_bytes

GOLDEN = Path(__file__).parents[1] / "golden"
MODEL = mp.Model("learner", bytes(range(100)) * 2)


@given(st.text(max_size=60), st.binary(max_size=3000))
def test_models_come_back(codec: str, payload: bytes) -> None:
    model = mp.Model(codec, payload)
    data = model_bytes(model)
    assert mp.load_model(data) == model
    assert peek_model(data[:LONGEST_HEADER]) == Mcm(codec, model.digest)


def test_every_truncation_is_found(tmp_path: Path) -> None:
    data = model_bytes(MODEL)
    for length in range(len(data)):
        with pytest.raises(CorruptError):
            mp.load_model(data[:length])
    with pytest.raises(CorruptError):
        mp.load_model(data + b"x")
    (tmp_path / "a.mcm").write_bytes(data[:-1])
    with pytest.raises(CorruptError, match=r"a\.mcm, byte"):
        mp.load_model(tmp_path / "a.mcm")


def test_every_flipped_bit_is_found() -> None:
    data = model_bytes(MODEL)
    for bit in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[bit // 8] ^= 1 << bit % 8
        with pytest.raises((CorruptError, UnsupportedError)):
            mp.load_model(bytes(flipped))


@given(st.binary(max_size=300))
def test_junk_is_refused(junk: bytes) -> None:
    for data in (junk, b"\x89MCM\x01" + junk):
        for read in (mp.load_model, peek_model):
            with pytest.raises(CorruptError):
                read(data)


@given(st.binary(max_size=80), st.binary(max_size=80))
def test_junk_behind_right_checksums_is_refused(header: bytes, payload: bytes) -> None:
    for parts in ((header, payload), (b"\x01a" + bytes(32), pack(payload))):
        sections = b"".join(section(i + 1, part) for i, part in enumerate(parts))
        with contextlib.suppress(CorruptError):
            mp.load_model(b"\x89MCM\x01" + sections)
            pytest.fail("the digest cannot be right")


def test_sections_stand_in_their_order() -> None:
    header = section(1, b"\x07learner" + MODEL.digest)
    payload = section(2, pack(MODEL.payload))
    assert mp.load_model(b"\x89MCM\x01" + header + payload) == MODEL
    for sections in (payload + header, header + header, payload + payload, header):
        with pytest.raises(CorruptError):
            mp.load_model(b"\x89MCM\x01" + sections)


def test_models_too_large_to_be_read_are_not_written() -> None:
    with pytest.raises(UnsupportedError, match="size of the model"):
        pack_model(Mcm("learner", bytes(32)), bytes(LARGEST_PAYLOAD + 1))
    bomb = section(2, pack(bytes(LARGEST_PAYLOAD + 1)))
    header = section(1, b"\x07learner" + bytes(32))
    with pytest.raises(CorruptError, match="at most"):
        parse_model(b"\x89MCM\x01" + header + bomb)


def test_a_later_version_says_so() -> None:
    data = bytearray(model_bytes(MODEL))
    data[4] = 2
    with pytest.raises(UnsupportedError, match="version of the file; expected 1; found 2"):
        mp.load_model(bytes(data))


def test_files_of_old_versions_stay_readable() -> None:
    assert mp.load_model(GOLDEN / "v1_learner.mcm") == MODEL
