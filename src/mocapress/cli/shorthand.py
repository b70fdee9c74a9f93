"""The short ways that fingers know from zstd and xz, turned into the commands that they mean.

``mocapress -9k walk.amc`` is ``mocapress compress --level=9 walk.amc``, and
``mocapress -dc walk.amc.mcz`` is ``mocapress decompress --output=- walk.amc.mcz``.
"""

import os
from collections.abc import Callable, Sequence

_COMMANDS = {
    "z": "compress",
    "d": "decompress",
    "l": "list",
    "t": "verify",
    "--compress": "compress",
    "--decompress": "decompress",
    "--uncompress": "decompress",
    "--list": "list",
    "--test": "verify",
}
"""Options that choose a command; the last one given counts."""
_MEANT = {
    "c": "--output=-",
    "k": None,
    "r": None,
    "--stdout": "--output=-",
    "--keep": None,
    "--recursive": None,
    "--fast": "--level=1",
    "--best": "--level=9",
}
"""Options under another name; None is what happens anyway: inputs are kept, folders searched."""
_WITH_VALUE = "ojT"
"""Short options behind which the rest of a word is their value."""
_OF_ALL = ("-h", "--help", "-V", "--version", "--install-completion", "--show-completion")
"""Options that need no command."""
_SPELLED = ("compress", "decompress", "list", "verify")


def spelled(words: Sequence[str], is_command: Callable[[str], bool]) -> list[str]:
    """Give the arguments with the command in front and options by the names that it knows.

    Parameters
    ----------
    words
        What was typed behind ``mocapress``.
    is_command
        Tells whether a word is a command; a file of such a name is ``./NAME``.

    """
    before = [*words[: next((at for at, word in enumerate(words) if word != "--debug"), None)]]
    rest = [*words[len(before) :]]
    if not rest or rest[0] in _OF_ALL:
        return [*words]
    first, given = rest[0], ""
    if not (first.startswith("-") or "." in first or "/" in first):
        if is_command(first):
            given = rest.pop(0)
        if given not in _SPELLED and (given or not os.path.exists(first)):  # noqa: PTH110
            return [*words]
    chosen, options = _read(rest, given)
    return [*before, chosen, *options]


def _read(words: Sequence[str], given: str) -> tuple[str, list[str]]:
    """Give the command, which options choose if none is given, and the other arguments."""
    chosen: str = given or "compress"
    kept: list[str] = []
    for at, word in enumerate(words):
        if word == "--":
            return chosen, [*kept, *words[at:]]
        for part in [word] if word.startswith("--") else _parts(word):
            name = part if part.startswith("--") else part[1:]
            if not part.startswith("-"):
                kept.append(part)
            elif name in _COMMANDS and given in ("", _COMMANDS[name]):
                chosen = _COMMANDS[name]
            elif name in _MEANT:
                kept += filter(None, [_MEANT[name]])
            else:
                kept.append(part)
    return chosen, kept


def _parts(word: str) -> list[str]:
    """Split a bundle of short options: ``-9kofile`` is ``--level=9``, ``-k`` and ``-ofile``."""
    if not word.startswith("-") or word == "-":
        return [word]
    parts: list[str] = []
    at = 1
    while at < len(word):
        if word[at] in _WITH_VALUE:
            return [*parts, f"-{word[at:]}"]
        digits = len(word[at:]) - len(word[at:].lstrip("0123456789"))
        parts.append(f"--level={word[at : at + digits]}" if digits else f"-{word[at]}")
        at += digits or 1
    return parts
