"""The second reader, docs/reader, decodes what mocapress codes, bit for bit.

It was written from the specification, so where both differ one of them or the specification is
wrong.
"""

import hashlib
import re
import sqlite3
import struct
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress.formats.number_formats import printed
from mocapress.motion import Clip, Column
from mocapress.motion.number_format import NumberFormat, NumberKind

ROOT = Path(__file__).parents[2]
sys.path += [str(ROOT / "docs/reader"), str(ROOT / "tests/golden")]
import clips  # noqa: E402
import mocapdb  # noqa: E402
import printing  # noqa: E402

Values = NDArray[np.float64]

# Clips, and how they are coded; with a model, one that was learned from the clip itself.
CASES = [
    ("couplings.bvh", "app:chunk=30"),
    ("numbers.bvh", "app:t=4,table=k4-non-uniform,mantissa_limit=53,chunk=16"),
    ("couplings.bvh", "mrpa:chunk=30"),
    ("numbers.bvh", "mrpa:mantissa_limit=12,chunk=16"),
    ("numbers.bvh", "mrpa:mode=published,chunk=20"),
    ("couplings.bvh", "diffma:bits=8,chunk=30,max_error=0.01,per=channel,order=auto"),
    ("numbers.bvh", "diffma:order=2,chunk=16,window=3"),
    ("couplings.bvh", "near:quality=8,chunk=200"),
    ("numbers.bvh", "near:chunk=16"),
    ("couplings.bvh", "patterns:chunk=30,max_error=0.5"),
    ("numbers.bvh", "patterns:chunk=16,mode=published with a model"),
    ("couplings.bvh", "qssd:step=0.1,chunk=40"),
    ("numbers.bvh", "qssd:omit=0,max_error=0.01,chunk=16"),
    ("couplings.bvh", "qssd:atoms=6,iterations=2,chunk=64 with a model"),
    ("skeleton.amc", "exact:level=1,chunk=13"),
    ("numbers.bvh", "exact:level=1"),
    ("numbers.bvh", "exact:level=2,chunk=16"),
    ("couplings.bvh", "exact:level=3,chunk=32"),
    ("leaps.amc", "exact:level=3,chunk=22"),
    ("couplings.bvh", "exact:level=4,chunk=32"),
    ("couplings.bvh", "exact:level=5,chunk=32"),
    ("leaps.amc", "exact:chunk=30"),
    ("skeleton.amc", "exact:chunk=40"),
    ("numbers.bvh", "exact:chunk=16"),
    ("couplings.bvh", "exact:level=6,chunk=32"),
    ("leaps.amc", "exact:level=6,chunk=22"),
    ("numbers.bvh", "exact:level=6,chunk=16"),
    ("wide.amc", "exact:level=6,chunk=2"),
    ("couplings.bvh", "exact:level=7"),
    ("skeleton.amc", "exact:level=8,chunk=12"),
    ("leaps.amc", "exact:level=9,chunk=30"),
    ("couplings.bvh", "exact:level=6,chunk=32 with a model"),
    ("leaps.amc", "exact:level=9,chunk=30 with a model"),
    ("numbers.bvh", "exact:level=6,chunk=16 with a model"),
]


def decoded_by_reader(
    clip: Clip, spec: str, header: bytes, chunks: list[tuple[int, bytes]], model: bytes | None
) -> bytes:
    """Give the values row by row."""
    name, _, told = spec.partition(":")
    parameters = dict(pair.split("=") for pair in told.split(","))
    formats = [
        (int(column.decimal.kind), column.decimal.digits) if column.decimal else (4, 0)
        for column in clip.columns
    ]
    more = {"model": model} if model else {}
    rows = import_module(name).decode(header, parameters, chunks, formats, **more)
    return b"".join(struct.pack(f"<{len(row)}d", *row) for row in rows)


def assert_same(clip: Clip, told: str) -> None:
    spec, with_model, _ = told.partition(" with a model")
    codec = mp.codec(spec)
    stream = clip.streams["motion"]
    model = mp.train([clip], spec) if with_model else None
    encoded = codec.encode(stream, skeleton=clip.skeleton, model=model)
    chunks = [(chunk.frames, chunk.payload) for chunk in encoded.chunks]
    payload = model.payload if model else None
    found = decoded_by_reader(clip, spec, encoded.header, chunks, payload)
    own = codec.decode(encoded.header, encoded.chunks, clip.columns, model=model)
    assert found == own.tobytes()


@pytest.mark.parametrize(("name", "told"), CASES)
def test_every_codec_decodes_to_the_same_bits(tmp_path: Path, name: str, told: str) -> None:
    path = tmp_path / name
    path.write_bytes(getattr(clips, path.stem)())
    assert_same(mp.read(path), told)


@pytest.mark.parametrize("told", ["near:max=1cm,chunk=70", "near:max=0.1cm", "near:max=0.01cm"])
def test_the_known_figure_of_near_decodes_to_the_same_bits(samples: Path, told: str) -> None:
    assert_same(mp.read(samples / "cmu_01_01.amc")[: 100 if "chunk" in told else 20], told)


# The same clips in libraries of version 3 and 5.
LIBRARIES = pytest.mark.parametrize("name", ["v1_recurring.mocapdb", "v1_alike.mocapdb"])


@LIBRARIES
def test_clips_of_a_library_come_back(name: str) -> None:
    """Chunks of one are predicted from another's, and a third shares frames."""
    golden = ROOT / "tests/golden" / name
    with sqlite3.connect(f"{golden.as_uri()}?immutable=1", uri=True) as tables:
        assert tables.execute("SELECT count(*) FROM needs").fetchone()[0]
        assert tables.execute("SELECT count(*) FROM runs").fetchone()[0]
    tables.close()
    reader = mocapdb.Library(golden)
    for clip, original in clips.recurring().items():
        assert reader.restored(clip) == original


def test_clips_that_are_alike_are_packed_beside_a_sample() -> None:
    golden = ROOT / "tests/golden/v1_alike.mocapdb"
    with sqlite3.connect(f"{golden.as_uri()}?immutable=1", uri=True) as tables:
        (found,) = tables.execute(
            "SELECT count(layout) FROM clips JOIN skeletons ON skeletons.id = skeleton "
            "WHERE sample IS NOT NULL"
        ).fetchone()
    tables.close()
    assert found == len(clips.recurring())


@LIBRARIES
def test_mocapress_reads_the_golden_library(tmp_path: Path, name: str) -> None:
    path = tmp_path / "library.mocapdb"
    path.write_bytes((ROOT / "tests/golden" / name).read_bytes())
    with mp.open_library(path) as opened:
        assert not opened.verify()
        for clip, original in clips.recurring().items():
            assert opened.read_bytes(clip) == original


def test_couplings_of_a_part_of_many_columns_decode_to_the_same_bits(tmp_path: Path) -> None:
    path = tmp_path / "couplings.bvh"
    path.write_bytes(clips.couplings(50))
    joints = mp.read(path)
    more = np.round(np.cumsum(np.random.default_rng(1).normal(size=(50, 1030)), axis=0), 1)
    values = np.hstack([joints.values, more])
    others = tuple(Column(f"v{i}", -1, f"v{i}") for i in range(1030))
    clip = Clip.of(values[:30], (*joints.columns, *others))
    assert_same(clip, "exact:level=3")


@pytest.mark.parametrize("kind", range(6))
@pytest.mark.parametrize("flags", range(8))
def test_numbers_are_printed_alike(kind: int, flags: int) -> None:
    random = np.random.default_rng(kind)
    numbers = random.normal(size=400) * 10.0 ** random.integers(-30, 30, 400)
    usual = np.round(random.normal(size=200) * 50, 3)
    odd = [0.0, -0.0, 1.0, -1.0, 0.5, 100.0, 1e-5, 9.9995, np.nan, np.inf, -np.inf, 1e300, 5e-324]
    values = np.array([*numbers, *usual, *odd, 1e22, 1e16, 123456.5, 0.00012345])
    for digits in (1, 4, 6, 15, 17):
        told = bytes([kind, digits, 2 + digits % 3, flags])
        own = NumberFormat(
            NumberKind(kind), digits, 2 + digits % 3, flags & 1 > 0, flags & 2 > 0, flags & 4 > 0
        )
        assert [printing.printed(float(x), told).encode() for x in values] == printed(values, own)


def test_float32_is_printed_alike() -> None:
    random = np.random.default_rng(0)
    bits = np.concatenate([random.integers(1, 0x7F800000, 3000), np.arange(1, 255) << 23])
    values = bits.astype("<u4").view("<f4").astype(np.float64)
    told = [printing.printed(float(x), bytes([5, 0, 2, 0])).encode() for x in values]
    assert told == printed(values, NumberFormat(NumberKind.SHORTEST32))


def test_the_specification_names_the_data_files_that_there_are() -> None:
    format_page = (ROOT / "docs/format.md").read_text()
    ((path, digest),) = re.findall(r"the file `(\S+)`, SHA-256 `([0-9a-f]{64})`", format_page)
    assert hashlib.sha256((ROOT / path).read_bytes()).hexdigest() == digest
    for codec in ("exact", "near"):
        text = (ROOT / f"docs/format/{codec}.md").read_text()
        told = dict(re.findall(r"\| `(\w+\.txt)` \| `([0-9a-f]{64})` \|", text))
        folder = ROOT / f"core/{codec}/data"
        found = {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in folder.iterdir()}
        assert told == found
