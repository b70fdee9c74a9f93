"""Clips from whatever a user names: a motion file, or what was compressed."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mocapress.models import Place
    from mocapress.motion import Clip
    from mocapress.source import Source


def read_clip(
    source: "Source", asf: Path | None, models: "Sequence[Place]", *, strict: bool
) -> "Clip":
    """Read a motion file, DiffMA JSON or ``.mcz``; models are for the last."""
    from mocapress import api
    from mocapress.source import MCZ

    if source.kind == MCZ:
        return api.load_source(source, asf_path=asf, models=models, strict=strict)
    return api.read_source(source, asf, strict=strict)
