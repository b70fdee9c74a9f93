"""DiffMA JSON: files there and back, other writers' files, the schema, broken files."""

import contextlib
import json
import lzma
from collections.abc import Callable
from pathlib import Path
from typing import Any

import diffma_schema
import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocapress as mp
from mocapress import codecs
from mocapress.codecs.diffma import DiffMA
from mocapress.codecs.diffma.document import read_document
from mocapress.container import diffma_json
from mocapress.errors import FormatError, MocapressError, UnsupportedError
from mocapress.source import Source

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests/golden"
SCHEMA = json.loads(diffma_schema.FILE.read_text())


def listing_2() -> dict[str, Any]:
    return {
        "channels": ["x0", "x1", "x2"],
        "records": {"b": ["2222", "1ZZZ", "1ZYa"], "t": [[1], [0, 1], [0, 0.0952]]},
        "params": {
            "bits": 6,
            "window": 64,
            "bound": 2,
            "class": "DiffMA",
            "tolerance": 10,
            "roundOffset": 0,
            "encoding": "base85",
        },
    }


def text_of(document: Any) -> bytes:
    return json.dumps(document).encode()


def test_listing_2_is_read_and_its_parts_written_again() -> None:
    clip = mp.load(text_of(listing_2()))
    assert [column.name for column in clip.columns] == ["x0", "x1", "x2"]
    assert clip.values[:, :2].T.tolist() == [[1] * 5, [0, 1, 2, 3, 4]]
    again = json.loads(read_document(text_of(listing_2())).to_json())
    assert again == listing_2()
    assert b'"t":[[1],[0,1],[0,0.0952]]' in read_document(text_of(listing_2())).to_json()


def test_a_clip_of_listing_1_is_listing_2() -> None:
    values = np.array(
        [[1, 0, 0], [1, 1, 0.0952], [1, 2, 0.1904], [1, 3, 0.285599], [1, 4, 0.380799]]
    )
    columns = tuple(mp.Column(f"x{i}", 0, "") for i in range(3))
    made = mp.to_json(mp.Clip.of(values, columns), "diffma:bound=2,round_offset=0")
    assert json.loads(made) == listing_2()


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "freebvh.bvh", "mocapbank.bvh"])
@pytest.mark.parametrize(
    "codec", ["diffma", "diffma:max_error=0.01,per=channel,order=auto,levels=16"]
)
def test_files_come_back_with_the_decoded_values(samples: Path, name: str, codec: str) -> None:
    source = mp.read(samples / name)
    text = mp.to_json(samples / name, codec)
    jsonschema.validate(json.loads(text), SCHEMA, jsonschema.Draft202012Validator)
    clip = mp.load(text)
    made = codecs.codec(codec)
    assert isinstance(made, DiffMA)
    assert np.abs(clip.values - source.values).max() <= made.max_error
    assert clip.columns == source.columns
    assert clip.frame_time == source.frame_time
    assert clip.skeleton is not None
    assert source.skeleton is not None
    assert np.allclose(mp.positions(clip.with_values(source.values)), mp.positions(source))

    kind, back = diffma_json.json_to_file(Source(text))
    assert name.endswith(kind)
    assert len(back.splitlines()) == len((samples / name).read_bytes().splitlines())
    assert mp.decompress(text) == back
    assert mp.decompress(lzma.compress(text)) == back
    assert diffma_json.file_to_json(Source(back), DiffMA(bound=1e-9))[0] != text


def test_a_coarser_level_is_what_a_player_asked_for(samples: Path) -> None:
    source = samples / "freebvh.bvh"
    text = mp.to_json(source, "diffma:bound=2,levels=16/64")
    for asked, bound in ((None, 2), (10, 2), (16, 16), (63, 16), (1000, 64)):
        alone = mp.load(mp.to_json(source, f"diffma:bound={bound}"))
        found = diffma_json.json_to_clip(Source(text), bound=asked)
        assert found.values.tobytes() == alone.values.tobytes()


def test_without_layout_there_is_a_clip_but_no_file(samples: Path, tmp_path: Path) -> None:
    clip = mp.read(samples / "freebvh.bvh")
    mp.write(clip, tmp_path / "walk.diffma.json", codec="diffma:bound=4")
    mp.write(clip, tmp_path / "walk.diffma.json.xz", codec="diffma:bound=4")
    read = mp.read(tmp_path / "walk.diffma.json")
    assert read.values.tobytes() == mp.read(tmp_path / "walk.diffma.json.xz").values.tobytes()
    assert np.abs(read.values - clip.values).max() < 10
    assert [c.kind for c in read.columns] == [c.kind for c in clip.columns]
    assert read.frame_time == clip.frame_time
    with pytest.raises(UnsupportedError, match=r"\$\.layout"):
        mp.decompress(tmp_path / "walk.diffma.json")
    mp.write(read, tmp_path / "walk.bvh")
    assert np.allclose(mp.read(tmp_path / "walk.bvh").values, read.values)


def test_what_is_no_number_cannot_stand_in_json(samples: Path) -> None:
    clip = mp.read(samples / "freebvh.bvh")
    values = clip.values.copy()
    values[7, 3] = np.nan
    clip = clip.with_values(values)
    with pytest.raises(UnsupportedError, match="in frame 8 cannot stand in JSON") as caught:
        mp.to_json(clip)
    assert caught.value.found == "nan"


def set_at(*keys: Any, to: Any) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        for key in keys[:-1]:
            document = document[key]
        document[keys[-1]] = to

    return change


def skeleton(joint: dict[str, Any] | None = None, **keys: Any) -> dict[str, Any]:
    one = {"name": "a", "parent": -1, "offset": [0, 0, 0]} | (joint or {})
    return {"rotation": "moving", "joints": [one], "columns": [[0, "tx"]] * 3} | keys


BROKEN: list[tuple[str, Callable[[Any], Any]]] = [
    ("$.channels", lambda d: d.pop("channels")),
    ("$.channels[1]", set_at("channels", 1, to=7)),
    ("$.records.t", lambda d: d["channels"].pop()),
    ("$.records", lambda d: d.pop("records")),
    ("$.records.b", set_at("records", "b", to="2222")),
    ("$.records.b[1]", set_at("records", "b", 1, to=None)),
    ("$.records.b[2]", set_at("records", "b", 2, to="1ZY")),
    ("$.records.b[2]", set_at("records", "b", 2, to='1Z"a')),
    ("$.records.b[2]", set_at("records", "b", 2, to="1Zéa")),
    ("$.records.b[2]", set_at("records", "b", 2, to="1Z~a")),
    ("$.records.t[0]", set_at("records", "t", 0, to=[])),
    ("$.records.t[2]", lambda d: d["records"]["t"][2].append(1)),
    ("$.records.t[2][1]", set_at("records", "t", 2, 1, to="0")),
    ("$.records.t[2][1]", set_at("records", "t", 2, 1, to=True)),
    ("$.params.bits", set_at("params", "bits", to=0)),
    ("$.params.bits", set_at("params", "bits", to=6.5)),
    ("$.params.bits", set_at("params", "bits", to=True)),
    ("$.params.window", set_at("params", "window", to=2**40)),
    ("$.params.bound", set_at("params", "bound", to=0)),
    ("$.params.bound", lambda d: d["params"].pop("bound")),
    ("$.params.bound", set_at("params", "bound", to=[1, 2])),
    ("$.params.bound[2]", set_at("params", "bound", to=[1, 2, -1])),
    ("$.params.order", set_at("params", "order", to=8)),
    ("$.params.order[1]", set_at("params", "order", to=[0, 0.5, 0])),
    ("$.params.tolerance", set_at("params", "tolerance", to=0)),
    ("$.params.roundOffset", set_at("params", "roundOffset", to=2)),
    ("$.params.encoding", set_at("params", "encoding", to="base64")),
    ("$.params.class", set_at("params", "class", to="Other")),
    ("$.frameTime", set_at("frameTime", to=-1)),
    ("$.layout", set_at("layout", to="~")),
    ("$.levels[0].bound", set_at("levels", to=[{"bound": "x", "records": {}}])),
    ("$.levels[0].records", set_at("levels", to=[{"bound": 8}])),
    ("$.skeleton.joints", set_at("skeleton", to={"rotation": "fixed"})),
    ("$.skeleton.rotation", set_at("skeleton", to={"joints": []})),
    ("$.skeleton.rotation", set_at("skeleton", to=skeleton(rotation="turning"))),
    (
        "$.skeleton.joints[0].channels[1]",
        set_at("skeleton", to=skeleton({"channels": ["tx", "x"]})),
    ),
    ("$.skeleton.columns", set_at("skeleton", to=skeleton(columns=[[0, "tx"]]))),
    (
        "$.skeleton.columns[2][0]",
        set_at("skeleton", to=skeleton(columns=[[0, "tx"]] * 2 + [[1, "ty"]])),
    ),
    (
        "$.skeleton.joints[0].parent",
        set_at("skeleton", to=skeleton({"parent": 0})),
    ),
]


@pytest.mark.parametrize(("path", "change"), BROKEN)
def test_broken_documents_name_the_place(path: str, change: Callable[[Any], Any]) -> None:
    document = listing_2()
    change(document)
    with pytest.raises(FormatError) as caught:
        mp.load(text_of(document))
    assert caught.value.what == path
    assert caught.value.expected
    assert caught.value.found


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("$", b"{"),
        ("$", b"{\xff}"),
        ("$", b'{"a":NaN}'),
        ("$", text_of(listing_2()).replace(b"1ZYa", b"1Z\\ud800a")),
        ("$", b'{"a":' + b"[" * 200_000 + b"]" * 200_000 + b"}"),
        ("$.records.t[2][1]", text_of(listing_2()).replace(b"0.0952", b"1e999")),
        ("$.records.t[2][1]", text_of(listing_2()).replace(b"0.0952", b"1" * 5000)),
        ("$.records.b[1]", text_of(listing_2()).replace(b"[0, 1]", b"[-1.5e308, 1.5e308]")),
    ],
    ids=["open", "no UTF-8", "NaN", "half a character", "deep", "infinite", "long", "overflow"],
)
def test_broken_texts_name_the_place(path: str, text: bytes) -> None:
    with pytest.raises(FormatError) as caught:
        mp.load(text)
    assert caught.value.what == path


@given(at=st.integers(0, 10**6), byte=st.integers(0, 255), cut=st.booleans())
def test_damage_is_an_error_or_another_clip(at: int, byte: int, cut: bool) -> None:
    text = bytearray(mp.to_json(ROOT / "samples/freebvh.bvh", "diffma:levels=64"))
    at %= len(text)
    if cut:
        del text[at:]
    text[at : at + 1] = bytes([byte])
    for read in (mp.load, mp.decompress):
        with contextlib.suppress(MocapressError):
            read(bytes(text))


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.diffma.json")), ids=lambda p: p.name)
def test_golden_documents_give_the_same_file(path: Path) -> None:
    assert mp.decompress(path) == (GOLDEN / diffma_json.stem(path.name)).read_bytes()


def test_the_schema_is_that_of_the_types() -> None:
    assert diffma_schema.schema() == SCHEMA


def test_errors_say_what_was_expected_and_found() -> None:
    cases = {
        ("bits", 13): "$.params.bits; expected number <= 12.0; found 13",
        ("class", "Other"): '$.params.class; expected "DiffMA" or "DiffMAx"; found "Other"',
        ("bound", "2"): '$.params.bound; expected number or array; found "2"',
        ("window", True): "$.params.window; expected number; found true",
    }
    for (key, value), message in cases.items():
        document = listing_2()
        document["params"][key] = value
        with pytest.raises(FormatError) as caught:
            mp.load(text_of(document))
        assert str(caught.value) == message


def test_whole_numbers_may_have_a_point() -> None:
    document = listing_2()
    document["params"]["bits"] = 6.0
    assert mp.load(text_of(document)).frames == 5


def test_packed_texts_are_limited() -> None:
    bomb = lzma.compress(b" " * 2**25)
    for data in (bomb, bomb[:200], lzma.compress(b"{}")[:-9], b"\xfd7zXZ\0junk"):
        with pytest.raises(MocapressError, match="xz"):
            mp.load(data)
