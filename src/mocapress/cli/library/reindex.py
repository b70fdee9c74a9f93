"""``library reindex``."""

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Models


def reindex(file: File, models: Models = None, debug: Debug = False) -> None:
    """Make the index for search anew, of all clips; what is damaged of it is mended so."""
    import typer

    from mocapress.cli.models import open_models
    from mocapress.cli.report import message, say

    with opened(file, "a", debug=debug, models=open_models(models or [])) as library:
        done = library.reindex()
    for error in done.failed:
        say(message(error, error.file or file))
    without = f", {done.without} without a body to be searched" if done.without else ""
    print(f"{file}: {done.clips} clips indexed{without}")
    if done.failed:
        raise typer.Exit(1)
