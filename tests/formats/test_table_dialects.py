"""Tables as programs write them: cut into columns, byte for byte, with the right numbers."""

import time
import warnings
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from table_files import cells, markers, trc
from test_tables import layout_of

import mocapress as mp
from mocapress.errors import CorruptError
from mocapress.formats.table_cutting import MISSING
from mocapress.formats.table_layout import TableLayout, read_layout
from mocapress.source import Source

PLACES = np.round(markers()[:, [0, 1, 2, 6, 7]], 4)


def table(
    head: str = "a,b,c,d,e",
    sign: str = ",",
    number: str = "{:.4f}",
    line_break: str = "\n",
    ends: tuple[str, str] = ("", ""),
    end: str | None = None,
) -> str:
    rows = [ends[0] + sign.join(number.format(x) for x in row) + ends[1] for row in PLACES]
    return line_break.join([head, *rows]) + (line_break if end is None else end)


DIALECTS = {
    "decimal commas": table("a;b;c;d;e", ";").replace(".", ","),
    "decimal commas and tabs": table("a\tb\tc\td\te", "\t", line_break="\r\n").replace(".", ","),
    "quotes": table('"a","b","c","d","e"', '","', ends=('"', '"')),
    "quotes and pairs": table('"a";"b";"c";"d";"e"', '";"', line_break="\r\n", ends=('"', '"')),
    "quotes below bare names": table("a,b,c,d,e", '","', ends=('"', '"')),
    "comma and blank": table("a, b, c, d, e", ", "),
    "several blanks": table("a    b    c    d    e", "    "),
    "aligned": table("a b c d e", " ", "{:12.4f}"),
    "aligned without more blanks": table("a b c d e", "", "{:14.4e}"),
    "aligned with blanks behind": table("a b c d e", " ", "{:12.4f}", ends=("", "  ")),
    "tabs and padding": table("a\tb\tc\td\te", "\t", "{:>12.4f}"),
    "delimiters behind rows": table("a,b,c,d,e", ends=("", ",")),
    "bars": table("a|b|c|d|e", "|"),
    "returns": table(line_break="\r"),
    "a mark": "\ufeff" + table(),
    "no end": table(end=""),
    "blank lines": table(line_break="\n\n"),
}


@pytest.mark.parametrize("name", DIALECTS)
def test_dialects_are_cut_into_columns(name: str) -> None:
    data = DIALECTS[name].encode()
    layout = layout_of(data)
    # No cell is kept as a text but numbers that look otherwise.
    assert sum(column.others.number for column in layout.columns) == 0
    blob = mp.compress(data)
    assert mp.decompress(blob) == data
    for clip in (mp.read(data), mp.load(blob)):
        assert np.allclose(clip.values, PLACES, rtol=1e-3, atol=1e-4)
        assert [column.name for column in clip.columns] == list("abcde")


def test_lines_that_end_in_both_ways() -> None:
    lines = table().splitlines()
    for every in (2, 3, 40):
        data = "".join(
            line + ("\n" if i % every else "\r\n") for i, line in enumerate(lines)
        ).encode()
        assert mp.decompress(mp.compress(data)) == data
        assert np.allclose(mp.read(data).values, PLACES)


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
def test_tables_in_utf_16(encoding: str) -> None:
    text = "\ufeff" + table("Hüfte,b,c,d,eµ\U0001f3c3", line_break="\r\n")
    blob = mp.compress(text.encode(encoding))
    assert mp.decompress(blob) == text.encode(encoding)
    assert len(blob) < 1.02 * len(mp.compress(text.encode()))
    assert mp.load(blob).columns[0].name == "Hüfte"
    assert np.array_equal(mp.load(blob).values, PLACES)


@pytest.mark.parametrize("change", ["commas", "returns", "utf-16", "mark"])
def test_trc_in_other_ways(change: str) -> None:
    places = markers()
    data = trc(places)
    data = {
        "commas": data.replace(b".", b","),
        "returns": data.replace(b"\r\n", b"\r"),
        "utf-16": data.decode().encode("utf-16"),
        "mark": b"\xef\xbb\xbf" + data,
    }[change]
    blob = mp.compress(data)
    assert mp.decompress(blob) == data
    for clip in (mp.read(data), mp.load(blob)):
        found = clip.streams["points"]
        assert np.allclose(found.values, np.round(places, 5), equal_nan=True)
        assert found.frame_time == Fraction(1, 120)


def test_quaternions_in_cells() -> None:
    data = cells().replace(b"nan", b"")
    layout_of(data)
    blob = mp.compress(data)
    assert mp.decompress(blob) == data
    clip = mp.load(blob)
    quaternions = [f"{name}.{i}" for name in ("pelvis", "torso") for i in range(1, 5)]
    assert [column.name for column in clip.columns] == ["time", *quaternions]
    assert np.allclose(clip.values[:, 1:], np.round(markers()[:, :8], 5), equal_nan=True)
    assert clip.frame_time == Fraction(1, 60)


def named(*head: str, rows: str = "{0},{0}.5,{1}.1,{1}.25,{1}.75", count: int = 20) -> mp.Clip:
    data = "\n".join([*head, *(rows.format(i, i * i % 7) for i in range(1, count))]).encode()
    return mp.load(mp.compress(data))


def test_names_that_repeat_are_told_apart_by_what_stands_above() -> None:
    clip = named("scorer,net,net,net,net", "bodyparts,ear,ear,tail,tail", "coords,x,y,x,y")
    assert [c.name for c in clip.columns] == ["coords", "ear.x", "ear.y", "tail.x", "tail.y"]
    clip = named(
        "Format Version,1.2,Export Frame Rate,120.0",
        "",
        ",Name,Hip,Hip,Head",
        ',ID,"1","1","2"',
        ",,Rotation,Position,Position",
        "Frame,Time (Seconds),X,X,X",
    )
    assert [c.name for c in clip.columns] == [
        "Frame",
        "Time (Seconds)",
        "Hip.Rotation.X",
        "Hip.Position.X",
        "Head.Position.X",
    ]


def test_units_below_and_in_names() -> None:
    clip = named("Trajectories", "200", ",,M:a,,", "Frame,Sub,X,Y,Z", ",,mm,mm,mm")
    assert [(c.name, c.unit) for c in clip.columns][1:3] == [("Sub", ""), ("X", "mm")]
    assert clip.frame_time == Fraction(1, 200)
    clip = named("a,x [mm],y (deg/s),m,V", rows="{0}.5,{0}.5,{1}.1,{1}.25,{1}.75")
    assert [c.unit for c in clip.columns] == ["", "mm", "deg/s", "", ""]


@pytest.mark.parametrize(
    ("head", "first", "rate"),
    [
        ("time,a,b,c,d", "{0}", None),
        ("time (ms),a,b,c,d", "{0}0", 100),
        ("time_us,a,b,c,d", "{0}000", 1000),
        ("Time [s],a,b,c,d", "0.{0:02}", 100),
        ("X[s],a,b,c,d", "0.{0:02}", 100),
        ("// Sample rate: 60.0Hz\nn,a,b,c,d", "{0}", 60),
        ("FREQUENCY,200\nn,a,b,c,d", "{0}", 200),
    ],
)
def test_rates(head: str, first: str, rate: int | None) -> None:
    clip = named(head, rows=first + ",{1}.1,{1}.5,{1}.25,2.{1}")
    assert clip.frame_time == (rate and Fraction(1, rate))


@pytest.mark.parametrize(
    ("name", "row"),
    [
        ("a mark", "1,2,3\n"),
        ("quotes", '"1","2","3"\n'),
        ("aligned", "  1.5   2 3\n"),
        ("tabs and padding", "1\t 2\t3\n"),
        ("bars", "1|2|3\n"),
        ("returns", "1,2,3\r"),
    ],
)
def test_two_tables_in_one_file_are_no_motion_to_lose(name: str, row: str) -> None:
    end = row[-1]
    data = (DIALECTS[name] + f"{end}Trajectories{end}x,y,z{end}" + row * 9).encode()
    assert mp.decompress(mp.compress(data)) == data
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mp.MotionWarning)
        assert np.array_equal(mp.read(data, strict=False).values, PLACES)


def test_rows_longer_than_what_tells_a_format() -> None:
    rows = "\n".join(",".join(f"{i * k % 7}.25" for k in range(4000)) for i in range(4))
    assert mp.read(rows.encode()).values.shape == (4, 4000)


@pytest.mark.parametrize(
    "piece", [b"1" * 4096, b" " * 4096, b'"' * 4096, b'",' * 2048, b"time ", b"frame rate ", b"[s"]
)
def test_long_cells_and_headers_take_no_longer_than_two_seconds(piece: bytes) -> None:
    name = piece * (200_000 // len(piece))
    data = name + b"x,b [mm],c\n" + b"1,2,3\n4,5.5,6\n9,8,7\n" + name + b"x,1,2\n"
    begin = time.process_time()
    assert mp.decompress(mp.compress(data)) == data
    assert time.process_time() - begin < 2


def test_comments_before_a_hierarchy_make_no_table(samples: Path) -> None:
    data = b"# by hand\n\n// twice\n" + (samples / "freebvh.bvh").read_bytes()
    assert mp.read(data).skeleton is not None


@pytest.mark.parametrize("head", ["", "# a comment\n\n", "\n\n\n"])
def test_a_header_of_empty_lines(head: str, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(head + "\n1 2.5 3\n4 5 6\n7 8 9\n")
    assert mp.decompress(mp.compress(path)) == path.read_bytes()
    assert mp.read(path).values.shape == (3, 3)


def test_names_of_cells_that_begin_with_several_numbers() -> None:
    rows = "\n".join(f"{i},{i * i % 7}.5,3\t{i % 5}.25,5,{i % 3}" for i in range(20))
    clip = mp.read(f"hip\thead\n{rows}\n".encode())
    known = [f"{name}.{i}" for name in ("hip", "head") for i in (1, 2, 3)]
    assert {column.name for column in clip.columns} <= set(known)


@pytest.mark.parametrize("text", ["nan", "-1.#IND", "1.#QNAN", "-1.#IND00", "N/A", "-nan(ind)"])
def test_what_stands_for_no_number(text: str) -> None:
    assert MISSING.match(text.encode())
    rows = [f"{i}.5,{text if i % 3 else i * i % 11},{i % 7}" for i in range(30)]
    clip = mp.read("\n".join(["a,b,c", *rows, ""]).encode())
    assert np.isnan(clip.values).sum() == 20


def test_layouts_that_lie_are_refused() -> None:
    layout = Source(DIALECTS["decimal commas"].encode(), "a.csv").split().stored
    assert isinstance(layout, TableLayout)
    record = layout.record()
    for end in (b"\x06", b"\x10", b"\x08\x00", b"\x08\x05;;;;;", b"\x01\x00"):
        with pytest.raises(CorruptError):
            read_layout(record[:-1] + end, "csv")
    one = Source(b"a\tb\n" + b"1.5\t2\n2.25\t1\n9\t4\n" * 9, "a.tsv").split().stored
    assert isinstance(one, TableLayout)
    record = replace(one, columns=one.columns[:1]).record()
    with pytest.raises(CorruptError):
        read_layout(record + b"\x08\x00", "tsv")
