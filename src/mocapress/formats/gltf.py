"""glTF 2.0 and GLB, its form in one file: what viewers, browsers and game engines play."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from mocapress.errors import ParameterError
from mocapress.formats.contract import Format
from mocapress.formats.gltf_file import MAGIC
from mocapress.formats.gltf_reading import read
from mocapress.formats.gltf_writing import write
from mocapress.formats.table_writing import with_frames
from mocapress.motion import Clip
from mocapress.motion.units import LENGTHS, amount

_OPTIONS = ("max", "unit")


def configured(options: Mapping[str, str]) -> Format:
    """Give the format with ``max``, a length such as ``0.1cm``, and ``unit``, such as ``cm``.

    Raises
    ------
    ParameterError
        When there is no such option, or a value is none.

    """
    for name in options:
        if name not in _OPTIONS:
            raise ParameterError(
                "format glb has no such option", expected="max=0.1cm, unit=cm", found=repr(name)
            )
    most = unit = None
    if "max" in options:
        asked = amount(options["max"], "glb:max")
        if asked.unit not in LENGTHS:
            raise ParameterError("glb:max", expected="a length such as 0.1cm", found=options["max"])
        most = asked.number * LENGTHS[asked.unit]
    if "unit" in options:
        # A number is centimetres: CMU's unit is 5.644.
        text = options["unit"]
        asked = amount(text if text[:1].isdigit() else f"1{text}", "glb:unit")
        if asked.is_angle:
            raise ParameterError("glb:unit", expected="m, cm, mm, in or 5.644cm", found=text)
        unit = asked.number * LENGTHS.get(asked.unit, 1.0)
    return replace(FORMAT, write=partial(write, most=most, unit=unit))


def fit(clip: Clip) -> Clip:
    """Give the motion alone."""
    return with_frames(clip)


FORMAT = Format(
    id="glb",
    name="GLB",
    suffixes=(".glb", ".gltf"),
    recognises=lambda head: head[:4] == MAGIC,
    read=read,
    fit=fit,
    write=write,
    configured=configured,
    written=(".glb",),
)
