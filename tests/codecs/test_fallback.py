"""No failure of a codec reaches a user, and none is hidden from us."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from typer.testing import CliRunner

import mocapress as mp
from mocapress import api, codecs
from mocapress.cli.app import app
from mocapress.codecs import Capabilities, Chunk, Codec, Encoded, Model, Others
from mocapress.codecs.contract import NO_OTHERS
from mocapress.codecs.diffma import DiffMA
from mocapress.codecs.diffma.coding import Coding
from mocapress.codecs.exact import Exact
from mocapress.codecs.fallback import RAISE_VARIABLE
from mocapress.codecs.loss import Loss
from mocapress.container.diffma_json import file_to_json
from mocapress.errors import ParameterError, VerificationError
from mocapress.motion import Column, Skeleton, Stream
from mocapress.source import Source

CASES = Path(__file__).parents[1] / "cases"
MOTION = sorted(path for path in CASES.glob("*/*") if path.suffix in (".bvh", ".amc"))
WALK = Path(__file__).parents[1] / "golden/v1_walk.bvh"


@dataclass(frozen=True, slots=True)
class Faulty(Codec):
    """A codec that fails in the ways that codecs fail."""

    id: ClassVar[str] = "faulty"
    can: ClassVar[Capabilities] = Capabilities(lossless=True)

    how: str = "encode"

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        if self.how == "memory":
            raise MemoryError
        if self.how == "encode":
            raise IndexError("list index out of range")
        return Encoded(b"", (Chunk(0, stream.frames, b""),))

    def decode(
        self,
        header: bytes,
        chunks: Sequence[Chunk],
        columns: Sequence[Column],
        *,
        model: Model | None = None,
        others: Others = NO_OTHERS,
        stop: int | None = None,
    ) -> NDArray[np.float64]:
        if self.how == "decode":
            raise ZeroDivisionError("division by zero")
        return np.zeros((sum(chunk.frames for chunk in chunks), len(columns)))


@pytest.fixture
def faulty(monkeypatch: pytest.MonkeyPatch) -> None:
    registry = codecs._REGISTRY | {"faulty": (__name__, "Faulty")}
    monkeypatch.setattr(codecs, "_REGISTRY", registry)


@pytest.fixture
def _falling_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(RAISE_VARIABLE)


def fault_in(*_: object, **__: object) -> None:
    raise ValueError("a coupling to later columns")


@pytest.mark.usefixtures("faulty", "_falling_back")
@pytest.mark.parametrize(
    ("how", "named"),
    [("encode", "IndexError"), ("decode", "ZeroDivisionError"), ("values", "wrong digest")],
)
def test_where_a_codec_fails_a_plain_one_does_it(how: str, named: str) -> None:
    data = WALK.read_bytes()
    compressed = api.compress_source(Source(data), f"faulty:how={how}")
    assert mp.decompress(compressed.blob) == data
    assert compressed.warning is not None
    for words in ("codec faulty", named, "please report", "exact:level=1 instead"):
        assert words in compressed.warning
    assert len(compressed.blob) < len(mp.compress(data, "exact:level=1")) + 9


@pytest.mark.usefixtures("_falling_back")
def test_where_the_plain_one_fails_too_the_bytes_are_stored(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(Exact, "encode", fault_in)
    file, data = tmp_path / "walk.bvh", WALK.read_bytes()
    file.write_bytes(data)
    done = CliRunner().invoke(app, ["compress", str(file), "--json"])
    assert done.exit_code == 0
    (row,) = json.loads(done.stdout)
    assert "a coupling to later columns" in row["warning"]
    assert "general-purpose" in row["warning"]
    assert mp.decompress(tmp_path / "walk.bvh.mcz") == data


@pytest.mark.usefixtures("faulty")
def test_in_tests_a_fault_is_raised() -> None:
    with pytest.raises(IndexError):
        mp.compress(WALK, "faulty")
    with pytest.raises(VerificationError):
        mp.compress(WALK, "faulty:how=values")


@pytest.mark.usefixtures("faulty", "_falling_back")
def test_memory_and_parameters_are_no_faults() -> None:
    with pytest.raises(MemoryError):
        mp.compress(WALK, "faulty:how=memory")
    with pytest.raises(ParameterError):
        mp.compress(WALK, "diffma:levels=16")


@pytest.mark.usefixtures("_falling_back")
def test_other_commands_name_the_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Coding, "encode", fault_in)
    monkeypatch.setattr(Exact, "train", fault_in)
    with pytest.raises(VerificationError, match=r"codec diffma failed .* please report"):
        file_to_json(Source(WALK), DiffMA())
    with pytest.raises(VerificationError, match=r"codec exact failed .* please report"):
        mp.train([WALK])


@pytest.mark.parametrize("path", MOTION, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_cases_come_back_without_fallback(path: Path) -> None:
    """Here, as in all tests, what would fall back is raised."""
    data = path.read_bytes()
    assert mp.decompress(mp.compress(data)) == data
    for level in (1, 3, 9) if path.parent.name.startswith("44") else ():
        assert mp.decompress(mp.compress(data, f"exact:level={level}")) == data
        mp.train([path], f"exact:level={level}")


@pytest.mark.corpus
def test_the_corpus_comes_back_without_fallback(corpus_clips: list[Path]) -> None:
    sample = sorted(corpus_clips[::40], key=lambda path: path.stat().st_size)[:8]
    assert sample
    for path in sample:
        assert mp.decompress(mp.compress(path)) == path.read_bytes()


def test_the_loss_is_measured_from_what_is_decoded() -> None:
    data = WALK.read_bytes()
    found = api.compress_source(Source(data), "diffma:max_error=0.5")
    clip = mp.read(WALK)
    errors = np.abs(mp.load(found.blob).values - clip.values)
    assert found.loss is not None
    assert found.loss.largest == tuple(errors.max(axis=0))
    assert found.loss.most == errors.max() <= 0.5
    assert found.loss.psnr == pytest.approx(-10 * np.log10((errors**2).mean()))
    assert api.compress_source(Source(data)).loss is None


@pytest.mark.usefixtures("_falling_back")
def test_a_bound_that_does_not_hold_is_no_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(DiffMA, "largest_errors", lambda _, columns: [1e-6] * len(columns))
    data = WALK.read_bytes()
    found = api.compress_source(Source(data), "diffma")
    assert mp.decompress(found.blob) == data
    assert found.loss is None
    assert "codec diffma breaks its bound in channel" in str(found.warning)


@given(st.lists(st.floats(), min_size=1), st.data())
def test_any_change_of_a_value_is_a_loss(numbers: list[float], data: st.DataObject) -> None:
    values = np.array(numbers)[:, None]
    assert Loss.of(values, values.copy()).most == 0
    assert Loss.of(values, values.copy()).psnr == np.inf
    changed = values.copy()
    row = data.draw(st.integers(0, len(values) - 1))
    changed[row] = data.draw(st.floats().filter(lambda x: x not in values[row] and x == x))
    expected = abs(changed[row, 0] - values[row, 0])
    assert Loss.of(values, changed).most == (expected if np.isfinite(values[row, 0]) else np.inf)


def test_no_loss_is_shown_as_none(tmp_path: Path) -> None:
    """In JSON, too, which has no infinite numbers."""
    file, row = tmp_path / "still.bvh", "0.00000 " * 9 + "\n"
    head = WALK.read_text().split("MOTION")[0]
    file.write_text(f"{head}MOTION\nFrames: 1000\nFrame Time: .01\n{1000 * row}")
    words = ["compress", str(file), "--codec=diffma", "--json"]
    (told,) = json.loads(CliRunner().invoke(app, words).stdout, parse_constant=pytest.fail)
    assert told["largest_error"] == 0
    assert told["psnr"] is None
