"""``library reindex``."""

import typer

from mocapress.cli.library.opening import File, opened
from mocapress.cli.options import Debug, Joints, Models


def reindex(file: File, joints: Joints = None, models: Models = None, debug: Debug = False) -> None:
    """Make the index for search anew, of all clips; what is damaged of it is mended so.

    --joints count for clips whose skeletons have all the names in it.
    """
    from mocapress.cli.models import open_models
    from mocapress.cli.report import message, say
    from mocapress.search.joint_names import read_mapping

    with opened(file, "a", debug=debug, models=open_models(models or [])) as library:
        done = library.reindex(None if joints is None else read_mapping(joints))
    for error in done.failed:
        say(message(error, error.file or file))
    without = f", {done.without} without a body to be searched" if done.without else ""
    print(f"{file}: {done.clips} clips indexed{without}")
    if done.failed:
        raise typer.Exit(1)
