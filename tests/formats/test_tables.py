"""Tables of numbers come back byte for byte in every dialect, and say what they hold."""

import random
import re
import warnings
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from table_files import markers, odd_table, trc

import mocapress as mp
from mocapress.formats import printed_floats
from mocapress.formats.table_layout import NUMBERS, SERIES, TableLayout, read_layout
from mocapress.source import Source

SAMPLE = Path(__file__).parents[2] / "samples/cmu_01_01.amc"


def layout_of(data: bytes, name: str = "a.csv") -> TableLayout:
    """Take a table apart, and see that it comes back, by way of the stored layout."""
    parts = Source(data, name).split()
    assert isinstance(parts.stored, TableLayout)
    again = read_layout(parts.stored.record(), parts.stored.format)
    assert again.join([parts.clip.values]) == data
    return parts.stored


@pytest.mark.parametrize("delimiter", ["\t", ",", ";"])
@pytest.mark.parametrize("line_break", ["\n", "\r\n"])
@pytest.mark.parametrize("missing", ["", "NaN", "nan"])
def test_markers_of_every_dialect(delimiter: str, line_break: str, missing: str) -> None:
    places = markers()
    data = trc(places, delimiter=delimiter, line_break=line_break, missing=missing)
    layout_of(data, "walk.trc")
    blob = mp.compress(data)
    assert mp.decompress(blob) == data
    for clip in (mp.read(data), mp.load(blob)):
        found = clip.streams["points"]
        assert np.allclose(found.values, np.round(places, 5), equal_nan=True)
        assert [column.name for column in found.columns[:4]] == ["M0.x", "M0.y", "M0.z", "M1.x"]
        assert {column.unit for column in found.columns} == {"mm"}
        assert found.frame_time == Fraction(1, 120)


@pytest.mark.parametrize("number", ["{!r}", "{:.3f}", "{:.6g}", "{:.4e}", "{:.17g}", "{:.0f}"])
def test_numbers_of_every_format(number: str) -> None:
    places = markers()
    data = trc(places, number=number)
    layout = layout_of(data, "walk.trc")
    assert sum(column.others.number for column in layout.columns) == 0
    assert mp.decompress(mp.compress(data)) == data


@pytest.mark.parametrize("number", ["{:.16g}", "{:.6f}", "{:.9f}"])
def test_float32_printed_as_decimals_are_coded_as_floats_and_read_as_printed(number: str) -> None:
    places = markers(300).astype(np.float32).astype(np.float64)
    floats, decimals = trc(places, number="{!r}"), trc(places, number=number)
    sizes = [len(mp.compress(data, "exact:level=3")) for data in (floats, decimals)]
    assert sizes[1] < 1.02 * sizes[0]
    blob = mp.compress(decimals)
    assert mp.decompress(blob) == decimals
    expected = [[float(number.format(x)) for x in row] for row in places]
    assert not np.array_equal(np.array(expected), places, equal_nan=True)
    for clip in (mp.read(decimals), mp.load(blob)):
        assert np.array_equal(clip.values, np.array(expected), equal_nan=True)
    part = mp.load(blob, frames=slice(30, 33)).values  # so few that they could be anything
    assert np.array_equal(part, np.array(expected)[30:33], equal_nan=True)


def test_each_column_is_judged_alone_whether_it_was_float32(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(printed_floats, "_TOGETHER", 100)  # two columns at a time
    numbers = np.random.default_rng(2).normal(scale=300, size=(40, 6))
    numbers[:, 2] = numbers[:, 2].round(2)
    numbers[:, 3] = numbers[:, 3].round()
    numbers[:, 4] *= 1e60
    numbers[5, :2] = np.nan
    printed = ["{:.9f}", "{:.9f}", "{:.2f}", "{:.9f}", "{:.9f}", "{:.17g}"]
    numbers[:, :2] = numbers[:, :2].astype(np.float32)
    rows = [[f.format(x) for f, x in zip(printed, row, strict=True)] for row in numbers.tolist()]
    data = ("a,b,c,d,e,f\n" + "\n".join(map(",".join, rows)) + "\n").encode()
    stored = Source(data, "a.csv").split().clip.values
    assert np.array_equal(stored, numbers, equal_nan=True)
    read = np.array(rows, np.float64)
    assert not np.array_equal(read, numbers, equal_nan=True)
    assert np.array_equal(mp.read(data).values, read, equal_nan=True)
    layout_of(data)


def test_counters_and_times_are_no_numbers_to_code() -> None:
    layout = layout_of(trc(markers()), "walk.trc")
    assert [column.kind for column in layout.columns[:3]] == [SERIES, SERIES, NUMBERS]
    for start, rate, decimals in ((0, 100, 3), (17, 59.94, 6), (2000, 250, 5)):
        rows = [f"{(start + i) / rate:.{decimals}f}\t{i % 7}.5\t{i % 3}.1" for i in range(200)]
        layout = layout_of("\n".join(["time\ta\tb", *rows]).encode())
        assert layout.columns[0].kind == SERIES
        assert not layout.columns[0].others.number


def test_a_table_of_all_sorts_of_columns() -> None:
    data = odd_table()
    layout = layout_of(data)
    assert layout.verbatim == (1, b"\x3d\x0abroken,row")
    with pytest.warns(mp.MotionWarning, match="line 64: a row of another length"):
        clip = mp.read(Path(__file__).parents[1] / "golden/v1_odd.csv", strict=False)
    assert clip.frame_time == Fraction(1, 50)
    assert np.isnan(clip.values[50]).any()
    assert mp.decompress(mp.compress(data)) == data


def test_the_same_numbers_cost_the_same_in_a_table() -> None:
    clip = mp.read(SAMPLE)[:1024]
    rows = "".join("\t".join(f"{x:.6g}" for x in row) + "\n" for row in clip.values)
    own = len(mp.compress(clip))
    assert len(mp.compress(rows.encode())) < 1.03 * own


def test_frames_that_are_missing_are_named() -> None:
    data = trc(markers(), declared=200)
    with pytest.raises(mp.FormatError, match="fewer rows than declared; expected 200; found 150"):
        mp.read(data)
    with pytest.warns(mp.MotionWarning, match="fewer rows"):
        assert mp.read(data, strict=False).frames == 150
    assert mp.decompress(mp.compress(data)) == data


def test_columns_and_rates_of_a_table_without_a_suffix() -> None:
    rows = [f"{i / 200:.3f}\t{i * i % 91}.25\t{i % 13}" for i in range(100)]
    clip = mp.read("\n".join(["time\tforce\tcount", *rows]).encode())
    assert [column.name for column in clip.columns] == ["time", "force", "count"]
    assert clip.frame_time == Fraction(1, 200)
    assert clip.values[10].tolist() == [0.05, 9.25, 10]


def test_what_is_no_table_of_numbers_goes_the_general_way() -> None:
    for data in (b"name,town\nA,B\nC,D\n", b"1 2 3", b"", b"\n\n", b"1\t2\n" * 2, b"a\tb\tc"):
        assert mp.decompress(mp.compress(data)) == data
        if b"\t2" not in data:
            with pytest.raises(mp.FormatError):
                mp.read(data)


def test_damaged_tables_come_back() -> None:
    whole = trc(markers(40))
    chosen = random.Random(1)
    for _ in range(60):
        data = bytearray(whole)
        for _ in range(chosen.randrange(1, 6)):
            data[chosen.randrange(len(data))] = chosen.choice(b"\t\n\r x-9.\0\xff")
        cut = bytes(data[: chosen.randrange(len(data))])
        assert mp.decompress(mp.compress(cut)) == cut


def test_markers_are_written(tmp_path: Path) -> None:
    clip = mp.read(trc(markers()))
    mp.write(clip, tmp_path / "again.trc")
    again = mp.read(tmp_path / "again.trc")
    assert np.array_equal(again.values, clip.values, equal_nan=True)
    assert again.columns == clip.columns
    assert again.frame_time == clip.frame_time
    mp.write(clip, tmp_path / "again.c3d")
    floats = mp.read(tmp_path / "again.c3d").streams["points"].values
    assert np.allclose(floats, clip.values, equal_nan=True, rtol=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        (b"\n30\t", b"\n30\t1.5\t", "line 36: a row of another length.*14 cells; found 15"),
        (b"\n30\t", b"\nabc\r\n30\t", "line 36: a row of another length.*14 cells; found 1"),
        (b"\n30\t0.242\t", b"\n30\t0.242\tx", "line 36: a cell that is no number"),
    ],
)
def test_rows_that_are_broken_are_named_and_cost_no_others(
    old: bytes, new: bytes, fault: str
) -> None:
    places = markers()
    data = trc(places).replace(old, new, 1)
    assert data != trc(places)
    assert mp.decompress(mp.compress(data)) == data
    for read in (mp.read, mp.load):
        source = data if read is mp.read else mp.compress(data)
        with pytest.raises(mp.FormatError, match=fault):
            read(source)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", mp.MotionWarning)
            clip = read(source, strict=False)
        assert clip.frames in (149, 150)
        assert np.allclose(clip.values[:28], np.round(places[:28], 5), equal_nan=True)
        assert np.allclose(clip.values[-9:], np.round(places[-9:], 5), equal_nan=True)


@pytest.mark.parametrize("rate", ["1e999999999", "1e-999999999", "9" * 100_000, "nan", "-1", "x"])
def test_an_absurd_rate_is_no_rate(rate: str, tmp_path: Path) -> None:
    data = trc(markers(), rate=rate)
    assert mp.read(data).frame_time is None
    assert mp.decompress(mp.compress(data, "exact:level=1")) == data
    (tmp_path / "a_motion.tsv").write_text("1.5\t2\n2.5\t7\n4\t1\n")
    (tmp_path / "a_motion.json").write_text(f'{{"SamplingFrequency": "{rate}"}}')
    assert mp.read(tmp_path / "a_motion.tsv").frame_time is None


def test_what_stands_behind_a_table_is_named() -> None:
    with pytest.warns(mp.MotionWarning, match="something behind the last row"):
        assert mp.read(trc(markers()) + b"end of file\r\n").frames == 150


@pytest.mark.parametrize(
    ("sizes", "told"),
    [
        ((200, 20), "line 203: rows of another table behind.*lines 3 to 202 are read"),
        ((20, 200), "line 3: rows of another table before.*lines 26 to 225 are read"),
    ],
)
def test_of_several_tables_it_is_said_which_was_read(sizes: tuple[int, int], told: str) -> None:
    numbers = np.random.default_rng(1).normal(size=(200, 7)).round(3)
    tables = [numbers[: sizes[0], :4], numbers[: sizes[1]]]
    data = "\n".join(
        f"table {i}\n" + "".join(",".join(map(str, row)) + "\n" for row in [[*"abcdefg"], *rows])
        for i, rows in enumerate(table.tolist() for table in tables)
    ).encode()
    with pytest.raises(mp.FormatError, match=told):
        mp.read(data)
    with pytest.warns(mp.MotionWarning, match=told):
        clip = mp.read(data, strict=False)
    assert np.array_equal(clip.values, tables[int(np.argmax(sizes))])
    first, last = map(int, re.findall(r"lines (\d+) to (\d+)", told)[0])
    alone = b"".join(data.splitlines(keepends=True)[first - 1 : last])
    assert np.array_equal(mp.read(alone).values, clip.values)


@pytest.mark.parametrize("size", [4, 6])
def test_a_matrix_in_a_header_is_no_other_table(size: int) -> None:
    rows = "".join(f"{i * i}.5;{i**3}\n" for i in range(30))
    matrix = "".join(";".join(map(str, row)) + "\n" for row in np.eye(size, dtype=int).tolist())
    assert mp.read(f"offsets\n{matrix}x;y\n{rows}".encode()).frames == 30


def test_two_columns_with_decimal_commas_are_two_numbers() -> None:
    numbers = np.random.default_rng(5).normal(size=(30, 2)).round(3)
    rows = "".join(f"{x:.3f};{y:.3f}\n".replace(".", ",") for x, y in numbers.tolist())
    assert np.array_equal(mp.read(f"x;y\n{rows}".encode()).values, numbers)


def test_a_cell_that_is_no_number_is_told_as_it_stands_in_the_file() -> None:
    rows = "".join(f"{i * i},25;{i**3},5\n" for i in range(40)).replace(";1000,", ";1.000,")
    with pytest.raises(mp.FormatError, match=r"line 12: .*found '1\.000,5'"):
        mp.read(f"x;y\n{rows}".encode())


@pytest.mark.parametrize("codec", ["patterns:arms=5mm", "diffma:bound=1"])
def test_decoded_numbers_may_have_more_digits_than_those_of_the_file(
    samples: Path, codec: str
) -> None:
    original = (samples / "markers.trc").read_bytes()
    blob = mp.compress(samples / "markers.trc", codec)
    assert len(blob) < len(original) / 5
    back = mp.decompress(blob)
    assert back.splitlines()[:5] == original.splitlines()[:5]
    read = mp.read(back).values
    np.testing.assert_allclose(read, mp.load(blob).values, rtol=1e-5, atol=1e-3)
