"""Pictures that commands write."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PIL import Image

_KINDS = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".webp": "webp"}


def check_kind(output: Path, option: str) -> None:
    """End with the exit code of wrong usage where a picture's suffix is not known."""
    from mocapress.cli.batch import usage

    if output.suffix.lower() not in _KINDS:
        usage(f"{option} {output}: no such kind of picture; expected {', '.join(_KINDS)}")


def write_picture(output: Path, picture: "Image.Image", *, force: bool) -> None:
    """Write a picture as its suffix says."""
    import io

    from mocapress.storage import write_whole

    data = io.BytesIO()
    picture.save(data, _KINDS[output.suffix.lower()])
    write_whole(output, data.getvalue(), force=force)
