"""What stands beside a table of Motion-BIDS: names and units of its columns, and its rate.

A file ``..._motion.tsv`` has rows of numbers alone. ``..._channels.tsv`` has a row for each column,
``..._motion.json`` the sampling frequency: https://bids-specification.readthedocs.io, "Motion".
"""

import json
from fractions import Fraction
from typing import NamedTuple

from mocapress.errors import FormatError
from mocapress.formats.contract import Near
from mocapress.motion.frame_time import rate_of

_MOTION, _CHANNELS, _FACTS = "_motion", "_channels.tsv", "_motion.json"
_NONE = "n/a"


class Channels(NamedTuple):
    """What is known of the columns of a table."""

    names: list[str] | None
    units: list[str]
    """As many as names; empty where a unit is not known."""
    frame_time: Fraction | None


def channels_beside(near: Near, width: int) -> Channels | None:
    """Read what lies beside a table of so many columns; None where nothing does.

    Raises
    ------
    FormatError
        When one of the files is not what it is called, or is of another table.

    """
    listed, facts = near(_MOTION, _CHANNELS), near(_MOTION, _FACTS)
    if listed is None and facts is None:
        return None
    rate = None if facts is None else _rate(facts)
    if listed is None:
        return Channels(None, [], 1 / rate if rate else None)
    rows = _rows(listed)
    if len(rows) != width:
        raise FormatError(
            "channels of another table",
            file=_CHANNELS,
            expected=f"{width} channels",
            found=str(len(rows)),
        )
    rates = {row.get("sampling_frequency", _NONE) for row in rows}
    if rate is None and len(rates) == 1:
        rate = rate_of(rates.pop())
    units = [row.get("units", _NONE) for row in rows]
    return Channels(
        [row["name"] for row in rows],
        ["" if unit == _NONE else unit for unit in units],
        1 / rate if rate else None,
    )


def _rows(data: bytes) -> list[dict[str, str]]:
    try:
        lines = data.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise FormatError("no text", file=_CHANNELS, expected="UTF-8") from error
    head = lines[0].split("\t") if lines else []
    if "name" not in head:
        raise FormatError("no column of names", file=_CHANNELS, line=1, expected="a column 'name'")
    return [dict(zip(head, line.split("\t"), strict=False)) for line in lines[1:] if line.strip()]


def _rate(data: bytes) -> Fraction | None:
    try:
        facts = json.loads(data, parse_float=str, parse_int=str)
    except ValueError as error:
        raise FormatError("no JSON", file=_FACTS, expected="an object") from error
    return rate_of(str(facts.get("SamplingFrequency"))) if isinstance(facts, dict) else None
