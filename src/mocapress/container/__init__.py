"""The ``.mcz`` file. Understands neither codecs nor formats."""

from mocapress.container.mcz import Kind, Mcz, pack_file, parse
from mocapress.container.packing import pack, unpack

__all__ = ["Kind", "Mcz", "pack", "pack_file", "parse", "unpack"]
