"""Other packages add codecs, as the guide shows, and codecs may refer to chunks of other clips."""

import re
import sys
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
import test_contract
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from typer.testing import CliRunner

import mocapress as mp
from mocapress import codecs
from mocapress.cli.app import app
from mocapress.codecs import (
    Capabilities,
    Chunk,
    Codec,
    Encoded,
    Model,
    Others,
    Scope,
    digest_of,
)
from mocapress.codecs.contract import NO_OTHERS
from mocapress.errors import CorruptError, ParameterError, UnsupportedError
from mocapress.motion import Column, Skeleton, Stream

GOLDEN = Path(__file__).parents[1] / "golden"

GUIDE = (Path(__file__).parents[2] / "docs/guide/codecs.md").read_text()
((METADATA, PACKAGE),) = re.findall(r"```toml\n(.*?)```.*?```python\n(.*?)```", GUIDE, re.DOTALL)


@pytest.fixture
def other_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Install a package with a codec, as pip would."""
    site = tmp_path / "site"
    metadata = site / "deflated_codec-1.0.dist-info"
    metadata.mkdir(parents=True)
    (site / "deflated_codec.py").write_text(PACKAGE)
    (metadata / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: deflated-codec\nVersion: 1.0\n"
    )
    groups = tomllib.loads(METADATA)["project"]["entry-points"]
    assert list(groups) == [codecs.GROUP]
    entries = groups[codecs.GROUP] | {"broken": "no_such_module:Codec", "stranger": "pathlib:Path"}
    lines = [f"[{codecs.GROUP}]", *(f"{name} = {value}" for name, value in entries.items())]
    (metadata / "entry_points.txt").write_text("\n".join(lines))
    monkeypatch.syspath_prepend(str(site))
    monkeypatch.delitem(sys.modules, "deflated_codec", raising=False)
    return "deflated"


def test_it_keeps_the_contract(other_package: str) -> None:
    assert codecs.codec_ids() == [
        "exact",
        "app",
        "diffma",
        "mrpa",
        "near",
        "patterns",
        "qssd",
        "broken",
        "deflated",
        "stranger",
    ]
    test_contract.test_motion_comes_back(other_package, None)
    test_contract.test_decoding_can_begin_at_every_restart(other_package)
    test_contract.test_decoding_stops_where_it_is_asked_to(other_package)
    test_contract.test_the_same_bytes_on_every_run(other_package)
    test_contract.test_truncated_payloads_are_found_out(other_package)
    test_contract.test_flipped_bits_give_an_error_or_values_of_the_right_shape(other_package)
    test_contract.test_memory_does_not_follow_announcements(other_package)
    test_contract.test_parameters_travel_as_text(other_package)
    test_contract.test_levels_are_parameters(other_package)
    test_contract.test_what_it_can_is_declared(other_package)


def test_commands_take_it(other_package: str, tmp_path: Path) -> None:
    # Large and regular, without repeating itself, so that the general-purpose way is not tried.
    head, _, rows = (GOLDEN / "v1_walk.bvh").read_text().partition("Frames: 240")
    time, first = rows.lstrip().splitlines(keepends=True)[:2]
    numbers = [
        " ".join(f"{1.5 * row + 1000 * place:.6f}" for place in range(len(first.split()))) + "\n"
        for row in range(2400)
    ]
    data = f"{head}Frames: 2400\n{time}{''.join(numbers)}".encode()
    file = tmp_path / "walk.bvh"
    file.write_bytes(data)
    words = ["compress", str(file), "--codec", f"{other_package}:chunk=100", "--level=9", "--json"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    packed = file.with_name("walk.bvh.mcz")
    told = CliRunner().invoke(app, ["info", str(packed)]).stdout
    assert f"{other_package}:level=9,chunk=100" in told
    assert (
        mp.load(packed, slice(150, 160)).values.tobytes() == mp.read(file).values[150:160].tobytes()
    )
    file.unlink()
    assert CliRunner().invoke(app, ["decompress", str(packed)]).exit_code == 0
    assert file.read_bytes() == data


def test_one_that_cannot_be_used_says_why(other_package: str) -> None:
    with pytest.raises(UnsupportedError, match="codec broken of deflated-codec cannot be used"):
        codecs.codec("broken")
    with pytest.raises(UnsupportedError, match=r"is not a mocapress\.codecs\.Codec"):
        codecs.codec("stranger")
    with pytest.raises(
        ParameterError,
        match="unknown codec; expected exact, app, diffma, mrpa, near, patterns, qssd, bro",
    ):
        codecs.codec("nothing")


@dataclass(frozen=True, slots=True)
class Repeats(Codec):
    """Of a library: chunks that another clip has, too, are only named."""

    id: ClassVar[str] = "repeats"
    can: ClassVar[Capabilities] = Capabilities(lossless=True, scope=Scope.LIBRARY)

    chunk: int = 50

    def encode(
        self,
        stream: Stream,
        *,
        skeleton: Skeleton | None = None,
        model: Model | None = None,
        others: Others = NO_OTHERS,
    ) -> Encoded:
        chunks = []
        for first in range(0, stream.frames, self.chunk):
            rows = stream.values[first : first + self.chunk]
            name = digest_of(rows)
            known = name in others
            payload = b"" if known else rows.tobytes()
            chunks.append(Chunk(first, len(rows), payload, needs=(name,) if known else ()))
        return Encoded(b"", tuple(chunks))

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
        parts = [np.empty((0, len(columns)))]
        for chunk in chunks:
            if any(name not in others for name in chunk.needs):
                raise CorruptError(f"chunk from frame {chunk.first} needs one that is missing")
            rows = others[chunk.needs[0]] if chunk.needs else np.frombuffer(chunk.payload)
            parts.append(rows.reshape(chunk.frames, len(columns)))
        return np.concatenate(parts)[:stop]


@given(st.lists(st.sampled_from("abc"), min_size=1, max_size=4))
def test_chunks_may_need_chunks_of_other_clips(takes: list[str]) -> None:
    codec, first = Repeats(), test_contract.clip_of(test_contract.smooth(100, 6))
    others = {digest_of(rows): rows for rows in (first.values[:50], first.values[50:])}
    takes_of = {"a": first.values[:50], "b": first.values[50:], "c": first.values[:50] + 1}
    values = np.concatenate([takes_of[take] for take in takes])
    stream = Stream(values, first.columns)
    alone, coded = codec.encode(stream), codec.encode(stream, others=others)
    assert [chunk.needs for chunk in alone.chunks] == [()] * len(takes)
    assert [bool(chunk.needs) for chunk in coded.chunks] == [take != "c" for take in takes]
    decoded = codec.decode(coded.header, coded.chunks, stream.columns, others=others)
    assert decoded.tobytes() == values.tobytes()
    for chunk in coded.chunks:
        needed = {name: others[name] for name in chunk.needs}
        rows = values[chunk.first : chunk.first + chunk.frames]
        assert codec.decode(b"", [chunk], stream.columns, others=needed).tobytes() == rows.tobytes()
        if chunk.needs:
            with pytest.raises(CorruptError, match="needs one that is missing"):
                codec.decode(b"", [chunk], stream.columns)


def test_a_chunk_is_named_by_shape_and_values() -> None:
    values = np.arange(6.0).reshape(2, 3)
    assert digest_of(values) == digest_of(np.asfortranarray(values))
    assert digest_of(values) != digest_of(values.reshape(3, 2))
    assert digest_of(values) != digest_of(-values)
