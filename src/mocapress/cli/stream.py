"""``compress --stream``: frames as they come, from stdin to a ``.mcz``."""

import math
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mocapress.codecs import Codec, Model

_MOST_LINE = 2**22


def stream(output: str | None, codec: "Codec", model: "Model | None", rate: float | None) -> None:
    """Compress lines of numbers from stdin; the first names the columns.

    Cells are separated by commas, tabs or blanks, as the first line is; an empty one, which only
    commas and tabs have, is a number that is missing. To stdout, bytes are written as soon as
    frames are complete; to a file, as ``mp.writer`` does.

    Raises
    ------
    FormatError
        When a line is not as many numbers as there are names.
    ExistsError
        When the output exists.

    """
    from mocapress import api

    names, rows = _read()
    if output in (None, "-"):
        coder = api.encoder(names, rate, codec=codec, model=model)
        for row in rows:
            _send(coder.push(row))
        _send(coder.finish())
        return
    assert output is not None
    with api.writer(output, names, rate, codec=codec, model=model) as recording:
        for row in rows:
            recording.append(row)


def _send(data: bytes) -> None:
    if data:
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()


def _read() -> tuple[list[str], Iterator[list[float]]]:
    from mocapress.errors import FormatError

    head = _line(1)
    separator = next((mark for mark in (",", "\t") if mark in head), None)

    def cells(line: str) -> list[str]:
        return [cell.strip() for cell in line.strip("\r\n").split(separator)]

    names = cells(head)
    if not names or not all(names) or any(_is_number(name) for name in names):
        expected = "a first line with the names of the columns, such as C7.x,C7.y,C7.z"
        raise FormatError("no names", file="-", line=1, expected=expected, found=repr(head[:60]))

    def rows() -> Iterator[list[float]]:
        number = 1
        while line := _line(number := number + 1):
            found = cells(line)
            if len(found) != len(names) or not all(map(_is_number, filter(None, found))):
                raise FormatError(
                    "no frame",
                    file="-",
                    line=number,
                    expected=f"{len(names)} numbers",
                    found=repr(line.strip()[:60]),
                )
            yield [float(cell) if cell else math.nan for cell in found]

    return names, rows()


def _line(number: int) -> str:
    from mocapress.errors import FormatError

    line = sys.stdin.buffer.readline(_MOST_LINE)
    if len(line) == _MOST_LINE:
        raise FormatError("a line that is too long", file="-", line=number)
    return line.decode(errors="replace")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
