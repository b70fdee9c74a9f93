"""The ``.mcz`` and ``.mcm`` files. Understands neither codecs nor formats."""

from mocapress.container.chunks import CodedChunk, Entry
from mocapress.container.head import CHANNELS, CodecSpec, Head, StreamHead, is_storable_time
from mocapress.container.mcm import Mcm, pack_model, parse_model, peek_model
from mocapress.container.mcz import Damage, Mcz, open_mcz
from mocapress.container.original import Companion, Original
from mocapress.container.packing import pack, unpack
from mocapress.container.skeletons import is_storable
from mocapress.container.tags import MAGIC
from mocapress.container.writing import MczWriter

__all__ = [
    "CHANNELS",
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
    "StreamHead",
    "is_storable",
    "is_storable_time",
    "open_mcz",
    "pack",
    "pack_model",
    "parse_model",
    "peek_model",
    "unpack",
]
