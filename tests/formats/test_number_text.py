"""Numbers as text: read as ``float`` reads them, printed as C's ``printf`` prints them."""

import math
import re
from collections.abc import Callable
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mocapress.formats.layout import build
from mocapress.formats.number_formats import printed
from mocapress.formats.rows import read_rows
from mocapress.motion.number_format import NumberFormat, NumberKind
from mocapress.source import Source

finite = st.floats(allow_nan=False, allow_infinity=False)
motion = st.floats(-1e6, 1e6) | st.floats(-1e-3, 1e-3)


def read_one(text: str) -> float | None:
    body = read_rows(text.encode() + b"\n", 0, 1)
    return float(body.values[0, 0]) if len(body.values) == 1 else None


def print_one(value: float, number_format: NumberFormat) -> str:
    return printed(np.array([value]), number_format)[0].decode()


@given(finite, st.sampled_from(["{!r}", "{:.17g}", "{:.6f}", "{:.3e}", "{:+.9g}", "{:g}"]))
@example(0.1, "{!r}")
@example(-0.0, "{:.6f}")
@example(5e-324, "{!r}")
@example(1.7976931348623157e308, "{!r}")
def test_reading_gives_the_nearest_double(value: float, style: str) -> None:
    text = style.format(value)
    if math.isinf(float(text)):
        assert read_one(text) is None
    else:
        found = read_one(text)
        assert found is not None
        assert np.float64(found).tobytes() == np.float64(float(text)).tobytes()


@pytest.mark.parametrize(
    "text",
    ["", "nanx", "in", "1.#", "-", ".", "1e", "1e+", "0x1p3", "1,5", "--1", "1.2.3", "1e999"],
)
def test_what_is_no_number_is_not_read(text: str) -> None:
    assert read_one(text) is None


@pytest.mark.parametrize(
    "text", ["1.", ".5", "-.5e3", "+7", "007", "1E5", "1e-400", "123456789012345678901234567890"]
)
def test_what_float_reads_is_read(text: str) -> None:
    assert read_one(text) == float(text)


@given(motion, st.integers(1, 15))
def test_general_is_printfs_g(value: float, digits: int) -> None:
    value = float(f"{value:.{digits}g}")
    assert print_one(value, NumberFormat(NumberKind.GENERAL, digits)) == f"{value:.{digits}g}"


@given(finite)
def test_general_of_seventeen_digits_is_printfs(value: float) -> None:
    assert print_one(value, NumberFormat(NumberKind.GENERAL, 17)) == f"{value:.17g}"


@given(motion, st.integers(0, 9))
def test_fixed_is_printfs_f(value: float, digits: int) -> None:
    value = float(f"{value:.{digits}f}")
    assert print_one(value, NumberFormat(NumberKind.FIXED, digits)) == f"{value:.{digits}f}"


@given(finite, st.integers(0, 20))
def test_fixed_of_any_size_is_within_half_of_the_last_digit(value: float, digits: int) -> None:
    text = print_one(value, NumberFormat(NumberKind.FIXED, digits))
    assert abs(float(text) - value) <= 0.5001 * 10.0**-digits + abs(value) * 2**-52


@given(motion, st.integers(1, 9))
def test_trimmed_is_fixed_without_trailing_zeros(value: float, digits: int) -> None:
    value = float(f"{value:.{digits}f}")
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    assert print_one(value, NumberFormat(NumberKind.TRIMMED, digits)) == text


@given(finite, st.integers(0, 16))
def test_scientific_is_printfs_e(value: float, digits: int) -> None:
    assert print_one(value, NumberFormat(NumberKind.SCIENTIFIC, digits)) == f"{value:.{digits}e}"


@given(finite)
def test_shortest_is_pythons_repr(value: float) -> None:
    number_format = NumberFormat(NumberKind.SHORTEST, point_zero=True)
    text = print_one(value, number_format)
    assert float(text) == value
    if abs(value) < 1e16:
        assert text == repr(value)


def test_older_windows_libraries_print_three_exponent_digits() -> None:
    number_format = NumberFormat(NumberKind.GENERAL, 6, exponent_digits=3)
    assert print_one(-1.6201e-14, number_format) == "-1.6201e-014"
    assert print_one(1.5e-123, number_format) == "1.5e-123"
    assert print_one(0.0001, number_format) == "0.0001"
    assert print_one(0.00001, number_format) == "1e-005"


def test_flags_change_the_text() -> None:
    assert print_one(2, NumberFormat(NumberKind.TRIMMED, 3, point_zero=True)) == "2.0"
    assert print_one(-0.25, NumberFormat(NumberKind.FIXED, 4, bare_point=True)) == "-.2500"
    assert print_one(1e-9, NumberFormat(NumberKind.GENERAL, 6, upper=True)) == "1E-09"


def java(value: float) -> str:
    """Print as Java's ``Double.toString`` does."""
    digits, exponent = next(
        text.split("e") for n in range(17) if float(text := f"{value:.{n}e}") == value
    )
    if 1e-3 <= abs(value) < 1e7 or value == 0:
        plain = f"{Decimal(repr(value)):f}"
        return plain if "." in plain else plain + ".0"
    return f"{digits if '.' in digits else digits + '.0'}E{int(exponent)}"


def javascript(value: float) -> str:
    """Print as JavaScript's ``String`` does."""
    if 1e-6 <= abs(value) < 1e21 or value == 0:
        plain = f"{Decimal(repr(value)):f}"
        return plain.removesuffix(".0")
    digits, exponent = repr(value).split("e")
    return f"{digits}e{int(exponent):+d}"


STYLES: dict[str, tuple[Callable[[float], str], NumberKind]] = {
    "%.6g": (lambda v: f"{v:.6g}", NumberKind.GENERAL),
    "%.4f": (lambda v: f"{v:.4f}", NumberKind.FIXED),
    "%+.4f": (lambda v: f"{v:+.4f}", NumberKind.FIXED),
    "%010.4f": (lambda v: f"{v:010.4f}", NumberKind.FIXED),
    "trailing point": (lambda v: f"{round(v, 1):.1f}".removesuffix("0"), NumberKind.GENERAL),
    "repr": (repr, NumberKind.SHORTEST),
    "Java": (java, NumberKind.SHORTEST),
    "JavaScript": (javascript, NumberKind.SHORTEST),
    "%.5e": (lambda v: f"{v:.5e}", NumberKind.SCIENTIFIC),
}


def values_of_many_sizes() -> NDArray[np.float64]:
    values = np.random.default_rng(7).normal(0, 30, (40, 3))
    values[:, 1] *= 10.0 ** -np.arange(40.0 // 4).repeat(4)
    values[::7, 2] = np.round(values[::7, 2])
    return values


@pytest.mark.parametrize("style", STYLES)
def test_formats_are_found_from_what_is_written(style: str) -> None:
    write, kind = STYLES[style]
    texts = [[write(float(v)) for v in row] for row in values_of_many_sizes()]
    data = "".join(" ".join(row) + "\n" for row in texts).encode()
    body = read_rows(data, 0, 3)
    layout = build("", data, body, slots)
    assert {f.kind for f in layout.formats} <= {kind, NumberKind.FIXED}
    assert layout.verbatim_bytes() == 0
    assert len(layout.templates) == 1
    assert layout.join(body.values) == data


PADDED: dict[str, Callable[[float], str]] = {
    "%12.4f": lambda v: f"{v:12.4f}",
    "% .4f": lambda v: f" {v: .4f}",
    "%-12.4f": lambda v: f"{v:<12.4f}",
    "%-12g": lambda v: f"{v:<12.6g}",
    "% g": lambda v: f"\t{v: .6g}",
}


@pytest.mark.parametrize("style", PADDED)
def test_numbers_padded_in_some_way_need_one_template(style: str) -> None:
    rows = values_of_many_sizes()
    data = "".join("".join(map(PADDED[style], row)) + "\n" for row in rows.tolist()).encode()
    body = read_rows(data, 0, 3)
    layout = build("", data, body, slots)
    assert layout.verbatim_bytes() == 0
    assert len(layout.templates) == 1
    assert layout.join(body.values) == data


def test_frame_numbers_may_be_padded_with_zeros() -> None:
    data = b":DEGREES\n" + b"".join(b"%03d\nroot %d.5\n" % (i, i) for i in range(5, 1200))
    clip, layout, problems, _ = Source(data).split()
    assert not problems
    assert layout.verbatim_bytes() == 0
    assert len(layout.templates) == 1
    assert layout.join(clip.values) == data


def slots(row: bytes) -> list[tuple[int, int, int]]:
    return [(i, *word.span()) for i, word in enumerate(re.finditer(rb"\S+", row))]


@pytest.mark.parametrize(
    ("flags", "zero", "half"),
    [
        ({}, "0", "0.5"),
        ({"point_zero": True}, "0.0", "0.5"),
        ({"end_point": True}, "0.", "0.5"),
        ({"bare_point": True}, "0", ".5"),
        ({"bare_point": True, "point_zero": True}, ".0", ".5"),
        ({"bare_point": True, "end_point": True}, "0.", ".5"),
    ],
)
def test_trimmed_decimals_are_always_a_number(flags: dict[str, bool], zero: str, half: str) -> None:
    trimmed = NumberFormat(NumberKind.TRIMMED, 3, **flags)
    assert (print_one(1e-9, trimmed), print_one(0.5, trimmed)) == (zero, half)
    assert read_one(zero) == 0
