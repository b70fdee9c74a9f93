"""The codec that a command of a library was asked for."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mocapress.codecs import Codec, Model


def chosen_codec(text: str, level: int | None, model: "Model | None" = None) -> "Codec":
    """Make a codec; end with the exit code of wrong usage where there is none such."""
    from mocapress import codecs
    from mocapress.api.clips import checked_codec
    from mocapress.cli.batch import usage
    from mocapress.errors import CorruptError, ParameterError

    try:
        made = checked_codec(text, model)
        if level is not None:
            made = codecs.with_level(made, level)
    except (ParameterError, CorruptError) as error:
        usage(f"--codec: {error}")
    return made
