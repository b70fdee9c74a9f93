"""The ``.mcz`` and ``.mcm`` files. Understands neither codecs nor formats."""

from mocapress.container.mcm import Mcm, pack_model, parse_model, peek_model
from mocapress.container.mcz import Kind, Mcz, pack_file, parse
from mocapress.container.packing import pack, unpack

__all__ = [
    "Kind",
    "Mcm",
    "Mcz",
    "pack",
    "pack_file",
    "pack_model",
    "parse",
    "parse_model",
    "peek_model",
    "unpack",
]
