"""The ``.mcz`` and ``.mcm`` files. Understands neither codecs nor formats."""

from mocapress.container.chunks import CodedChunk, Entry
from mocapress.container.head import CodecSpec, Head, StreamHead
from mocapress.container.mcm import Mcm, pack_model, parse_model, peek_model
from mocapress.container.mcz import Damage, Mcz, Ranges, open_mcz
from mocapress.container.original import Companion, Original
from mocapress.container.packing import pack, unpack
from mocapress.container.tags import MAGIC
from mocapress.container.writing import MczWriter

__all__ = [
    "MAGIC",
    "CodecSpec",
    "CodedChunk",
    "Companion",
    "Damage",
    "Entry",
    "Head",
    "Mcm",
    "Mcz",
    "MczWriter",
    "Original",
    "Ranges",
    "StreamHead",
    "open_mcz",
    "pack",
    "pack_model",
    "parse_model",
    "peek_model",
    "unpack",
]
