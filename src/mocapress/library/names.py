"""Names of clips: relative paths, and the patterns that choose some of them."""

import re
import sqlite3
from collections.abc import Sequence
from typing import Any

from mocapress.errors import ParameterError

_WILD = re.compile(r"[*?\[]")


def checked(name: str) -> str:
    """Give a name back that may be a clip's: a relative path that leads nowhere else.

    Raises
    ------
    ParameterError
        When it is none.

    """
    parts = name.split("/")
    if "\0" in name or any(part in ("", ".", "..") for part in parts):
        raise ParameterError(
            "not a name for a clip",
            expected="a relative path such as walks/01",
            found=repr(name),
        )
    return name


def stored(name: str) -> bytes:
    """Give a name as the database takes it, whose text need not be UTF-8: ``CAST(? AS TEXT)``."""
    return name.encode(errors="surrogateescape")


def condition(patterns: Sequence[str]) -> tuple[str, list[Any]]:
    """Give the SQL for names that one of the patterns chooses, and its parameters.

    A pattern is a name, a folder, or a glob in which ``*`` stands for any characters, ``?`` for one
    and ``[...]`` for one of those listed.
    """
    parts: list[str] = []
    values: list[Any] = []
    for pattern in patterns:
        plain = pattern.rstrip("/")
        parts.append("name = CAST(? AS TEXT)")
        values.append(stored(plain))
        if _WILD.search(pattern):
            parts.append("name GLOB CAST(? AS TEXT)")
            values.append(stored(pattern))
        else:
            # All that begin with the folder and a slash; the character behind "/" is "0".
            parts.append("(name > CAST(? AS TEXT) AND name < CAST(? AS TEXT))")
            values += [stored(plain + "/"), stored(plain + "0")]
    return " OR ".join(parts) or "1", values


def find(connection: sqlite3.Connection, name: str) -> int | None:
    """Give the id of the clip of this name; None where there is none."""
    row = connection.execute(
        "SELECT id FROM clips WHERE name = CAST(? AS TEXT)", [stored(name)]
    ).fetchone()
    return None if row is None else int(row[0])
