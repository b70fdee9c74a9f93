"""Names of joints in text files: escaped where a format cannot hold them.

A character is escaped as the bytes of its UTF-8, ``%20`` for a blank; ``%.`` with digits behind it
stands for nothing and makes an empty or a repeated name a word of its own. Letters of any script,
digits and usual signs stay as they are. The core reads them back.
"""

from collections.abc import Sequence


def escaped(name: str, forbidden: str = "") -> str:
    """Escape what is not printable, ``%``, blanks at the ends, and the forbidden characters."""
    body = name.strip(" ")
    before, after = name[: len(name) - len(name.lstrip(" "))], name[len(name.rstrip(" ")) :]
    kept = (c if c.isprintable() and c not in "%" + forbidden else escape(c) for c in body)
    return escape(before) + "".join(kept) + escape(after if body else "") or "%."


def escape(text: str) -> str:
    """Escape every byte."""
    return "".join(f"%{byte:02X}" for byte in text.encode("utf-8", "surrogatepass"))


def words(names: Sequence[str], reserved: frozenset[str]) -> list[str]:
    """Give a word of its own for each name, as ASF and AMC need them.

    Words that are reserved, whatever their case, numbers, and those that begin like a section or a
    limit have their first character escaped.
    """
    made: list[str] = []
    seen: dict[str, int] = {}
    for name in names:
        word = escaped(name, " #{}")
        if word.lower() in reserved or word[0] in ":(" or word.lstrip("+-").isdigit():
            word = escape(word[0]) + word[1:]
        count = seen[word] = seen.get(word, 0) + 1
        made.append(word if count == 1 else f"{word}%.{count}")
    return made
