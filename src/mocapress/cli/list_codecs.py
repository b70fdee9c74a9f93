"""``codecs``."""

from typing import Any

from mocapress.cli.options import Json


def list_codecs(json: Json = False) -> None:
    """List all codecs, what each can do, and its parameters with their usual values."""
    import json as jsonlib

    from mocapress import codecs
    from mocapress.cli.paging import paged
    from mocapress.cli.report import say
    from mocapress.errors import MocapressError

    rows = []
    for name in codecs.codec_ids():
        try:
            rows.append(_facts(name))
        except MocapressError as error:  # a package that is broken hides none of the others
            say(str(error))
    if json:
        print(jsonlib.dumps(rows, indent=1))
        return
    with paged(True):
        for row in rows:
            print(f"{row['id']}: {row['about']}")
            print(f"    {', '.join(row['can'])}")
            for parameter, value in row["parameters"].items():
                print(f"    {parameter}={_text(value)}")


def complete_codecs(begun: str) -> list[str]:
    """Give the ids of codecs that begin so, for completion in a shell."""
    from mocapress import codecs

    return [name for name in codecs.codec_ids() if name.startswith(begun)]


def _facts(name: str) -> dict[str, Any]:
    from inspect import getdoc

    from mocapress import codecs

    made = codecs.codec(name)
    able = {"levels 1 to 9": made.can.levels, "trains models": made.can.trains}
    return {
        "id": name,
        "about": (getdoc(type(made)) or "").partition("\n")[0],
        "can": ["lossless" if made.lossless else "lossy", *(word for word in able if able[word])],
        "parameters": codecs.parameters(made),
    }


def _text(value: Any) -> str:
    """Write a parameter's value as ``--codec`` reads it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
