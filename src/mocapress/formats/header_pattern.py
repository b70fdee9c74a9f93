"""Finding the pattern of a layout's header: what in it the skeleton says anyway."""

import re
from dataclasses import replace

from mocapress import _core
from mocapress.formats.layout import Layout
from mocapress.formats.number_formats import unpacked
from mocapress.formats.patterns import References, Style, of_header, print_header

_INDENTED = re.compile(rb"\{[ \t]*(?:\r\n|[\r\n])([ \t]+)")


def style_of(header: bytes, row: bytes, references: References) -> Style:
    """Tell line breaks, indentation and encoding from a file's beginning."""
    names = "".join((*references.joints, *references.bones))
    indented = _INDENTED.search(header)
    return Style(
        next((end for end in (b"\r\n", b"\n", b"\r") if end in header + row), b"\n"),
        indented.group(1) if indented else b"",
        "latin-1" if names.isascii() or _is_latin(names, header + row) else "utf-8",
    )


def header_pattern(
    header: bytes, rows: int, references: References, style: Style
) -> tuple[bytes, Style]:
    """Give the shortest pattern that prints the header, and the style with the formats it needs."""
    refer = of_header(references, style.encoding)
    pattern, formats = _core.header_pattern(
        header, *refer, rows, style.line_break, style.indentation
    )
    return pattern, replace(style, formats=unpacked(formats))


def pattern_of(layout: Layout, references: References) -> tuple[bytes, Style]:
    """Give the pattern of a layout's header, and the style that it needs."""
    row = b"".join(layout.templates[0].literals) if layout.templates else b""
    style = style_of(layout.header, row, references)
    return header_pattern(layout.header, len(layout.assigned), references, style)


def announcing(layout: Layout, references: References, rows: int, most: int) -> Layout:
    """Give a layout with a header, of at most so many bytes, that announces so many rows."""
    pattern, style = pattern_of(layout, references)
    return replace(layout, header=print_header(pattern, references, style, rows, most))


def _is_latin(names: str, text: bytes) -> bool:
    """Tell whether a file prints these names in ISO 8859-1."""
    try:
        names.encode("latin-1")
    except UnicodeEncodeError:
        return False
    return any(c > "\x7f" and c.encode("latin-1") in text and c.encode() not in text for c in names)
