"""Finding the pattern of a layout's header: what in it the skeleton says anyway."""

import re
from collections.abc import Iterator, Sequence

from mocapress.errors import CorruptError
from mocapress.formats.number_formats import printed
from mocapress.formats.patterns import (
    BREAK,
    CHANNELS,
    COUNT,
    MOST_FORMATS,
    NAME,
    NUMBER,
    PASS,
    TIME,
    Header,
    References,
    Style,
    encoded,
    raw,
)
from mocapress.motion.number_format import NumberFormat, NumberKind

_MARK = re.compile(
    rb"^[ \t]*(?:"
    rb"(?:ROOT|JOINT)[ \t]+(?P<name>[^\r\n]+)"
    rb"|OFFSET[ \t]+(?P<x>[^\s{}]+)[ \t]+(?P<y>[^\s{}]+)[ \t]+(?P<z>[^\s{}]+)"
    rb"|CHANNELS[ \t]+(?P<channels>[^\r\n{}]*[^\s{}])"
    rb"|Frames[ \t]*:[ \t]*(?P<rows>\d+)"
    rb"|Frame[ \t]+Time[ \t]*:[ \t]*(?P<time>\S+)"
    rb")",
    re.MULTILINE | re.IGNORECASE,
)
_INDENTED = re.compile(rb"\{[ \t]*\r?\n([ \t]+)")
_PLAIN = re.compile(rb"-?\d*(?:\.(\d*))?\Z")

Mark = tuple[int, int, int]
"""A part of the header that may be referred to: where it begins and ends, and the reference."""


def style_of(header: bytes, row: bytes, references: References) -> Style:
    """Tell line breaks, indentation and encoding from a file's beginning."""
    names = "".join((*references.joints, *references.bones))
    indented = _INDENTED.search(header)
    return Style(
        b"\r\n" if b"\r\n" in header + row else b"\n",
        indented.group(1) if indented else b"",
        "latin-1" if names.isascii() or _is_latin(names, header + row) else "utf-8",
    )


def header_pattern(
    header: bytes, rows: int, references: References, style: Style
) -> tuple[bytes, Style]:
    """Give the shortest pattern that prints the header, and the style with the formats it needs."""
    marks = list(_marks(header))
    numbers = [header[begin:end] for begin, end, code in marks if code == NUMBER]
    fitted = Style(
        style.line_break,
        style.indentation,
        style.encoding,
        _formats(numbers, references.numbers) if numbers else (),
    )
    if references.joints and len(numbers) == len(references.numbers):
        pattern = _pattern(header, marks, references, fitted, rows)
        if _prints(pattern, header, rows, references, fitted):
            return pattern, fitted
    marks = [mark for mark in marks if mark[2] in (COUNT, TIME)]
    pattern = _pattern(header, marks, references, style, rows)
    if _prints(pattern, header, rows, references, style):
        return pattern, style
    return raw(header), style


def _prints(pattern: bytes, header: bytes, rows: int, references: References, style: Style) -> bool:
    try:
        return Header(references, style, rows, len(header), printed).print(pattern) == header
    except CorruptError:
        return False


def _marks(header: bytes) -> Iterator[Mark]:
    codes = {"name": NAME, "channels": CHANNELS, "rows": COUNT, "time": TIME}
    for found in _MARK.finditer(header):
        if found.lastgroup == "z":
            for group in "xyz":
                yield (*found.span(group), NUMBER)
        elif found.lastgroup:
            yield (*found.span(found.lastgroup), codes[found.lastgroup])


def _pattern(
    header: bytes, marks: Sequence[Mark], references: References, style: Style, rows: int
) -> bytes:
    """Put a reference in the place of each mark that prints the same."""
    codes = iter(_number_codes(header, marks, references, style))
    out = bytearray()
    position = joint = 0
    depth = 0
    for begin, end, code in marks:
        text = header[begin:end]
        if code == NUMBER:
            k = next(codes)
            reference, same = (bytes([k]), True) if k != PASS else (bytes([PASS]) + raw(text), True)
        elif code == NAME:
            reference = bytes([NAME])
            names = references.joints[joint : joint + 1]
            name = encoded(names[0], style.encoding) if names else b""
            same = bool(names) and text.startswith(name)
            text, end = (name, begin + len(name)) if same else (text, end)
            joint += 1
        elif code == CHANNELS:
            reference = bytes([CHANNELS])
            same = [(words or "").encode() for words in references.channels[joint - 1 : joint]] == [
                text
            ]
        else:
            reference = bytes([code])
            same = text == (b"%d" % rows if code == COUNT else references.time.encode())
        before = header[position:begin]
        out += _broken(before, depth, style)
        depth += before.count(b"{") - before.count(b"}") + text.count(b"{") - text.count(b"}")
        out += reference if same else raw(text)
        position = end
    return bytes(out + _broken(header[position:], depth, style))


def _broken(text: bytes, depth: int, style: Style) -> bytes:
    """Give a text's pattern, with references for line breaks and the indentation behind them."""
    first, *lines = text.split(style.line_break)
    out = bytearray(raw(first))
    depth += first.count(b"{") - first.count(b"}")
    for line in lines:
        closes = line.lstrip(b" \t")[:1] == b"}"
        indented = style.indentation * max(max(depth, 0) - closes, 0)
        rest = line[len(indented) :]
        if line.startswith(indented) and (rest[:1] == b"}") == closes:
            out += bytes([BREAK]) + raw(rest)
        else:
            out += style.line_break + raw(line)
        depth += line.count(b"{") - line.count(b"}")
    return bytes(out)


def _number_codes(
    header: bytes, marks: Sequence[Mark], references: References, style: Style
) -> list[int]:
    """Choose for each number in the header the format that prints it, or that it stays a text."""
    texts = [header[begin:end] for begin, end, code in marks if code == NUMBER]
    codes = [PASS] * len(texts)
    for k, number_format in enumerate(style.formats):
        open_ = [place for place, code in enumerate(codes) if code == PASS]
        ours = printed([references.numbers[place] for place in open_], number_format)
        for place, text in zip(open_, ours, strict=True):
            if text == texts[place]:
                codes[place] = NUMBER + k
    return codes


def _formats(texts: Sequence[bytes], values: Sequence[float]) -> tuple[NumberFormat, ...]:
    """Choose the formats that print most of the numbers, the best first."""
    if len(texts) != len(values):
        return ()
    decimals = {len(found[1] or b"") for found in map(_PLAIN.match, texts) if found}
    candidates = [NumberFormat(NumberKind.FIXED, d) for d in sorted(decimals) if d <= 40]
    if len(candidates) > 2:
        candidates += [
            NumberFormat(NumberKind.TRIMMED, min(max(decimals), 40)),
            NumberFormat(NumberKind.TRIMMED, min(max(decimals), 40), point_zero=True),
            NumberFormat(NumberKind.GENERAL, 6),
            NumberFormat(NumberKind.GENERAL, 9),
            NumberFormat(NumberKind.SHORTEST),
            NumberFormat(NumberKind.SHORTEST, point_zero=True),
        ]
    left = set(range(len(texts)))
    fits = {
        candidate: {
            place for place, text in enumerate(printed(values, candidate)) if text == texts[place]
        }
        for candidate in candidates
    }
    chosen: list[NumberFormat] = []
    while left and fits and len(chosen) < MOST_FORMATS:
        best = max(fits, key=lambda candidate: len(fits[candidate] & left))
        if not fits[best] & left:
            break
        left -= fits.pop(best)
        chosen.append(best)
    return tuple(chosen)


def _is_latin(names: str, text: bytes) -> bool:
    """Tell whether a file prints these names in ISO 8859-1."""
    try:
        names.encode("latin-1")
    except UnicodeEncodeError:
        return False
    return any(c > "\x7f" and c.encode("latin-1") in text and c.encode() not in text for c in names)
