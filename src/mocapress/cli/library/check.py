"""``library check``."""

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Json, Quiet


def check(file: File, json: Json = False, quiet: Quiet = False, debug: Debug = False) -> None:
    """Read everything in a library and check its checksums, which is quick; exit code 3 if damaged.

    Names the clips that have something on a damaged page. verify decodes them, too.
    """
    import json as jsonlib

    import typer

    from mocapress.cli.report import say

    with opened(file, debug=debug) as library:
        faults = library.check()
        number = 0 if faults else len(library)
    if json:
        print(jsonlib.dumps([{"clip": name, "what": what} for name, what in faults], indent=1))
    for name, what in [] if json else faults:
        say(f"{name or file}: {what}")
    if faults:
        raise typer.Exit(3)
    if not (json or quiet):
        print(f"{file}: {number} clips, sound")
