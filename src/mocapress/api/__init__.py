"""The Python interface: ``import mocapress as mp``."""

from mocapress.api.checking import Checked, verify, verify_source
from mocapress.api.clips import Compressed, compress_clip
from mocapress.api.compressing import compress, compress_source
from mocapress.api.loading import columns_of, load, load_source
from mocapress.api.long import LONG, LongFile, compress_long, restored_long
from mocapress.api.opening import Opened
from mocapress.api.reading import printed, read, read_source, write
from mocapress.api.recording import Encoder, Recording, encoder, writer
from mocapress.api.restoring import Restored, decompress, restore

__all__ = [
    "LONG",
    "Checked",
    "Compressed",
    "Encoder",
    "LongFile",
    "Opened",
    "Recording",
    "Restored",
    "columns_of",
    "compress",
    "compress_clip",
    "compress_long",
    "compress_source",
    "decompress",
    "encoder",
    "load",
    "load_source",
    "printed",
    "read",
    "read_source",
    "restore",
    "restored_long",
    "verify",
    "verify_source",
    "write",
    "writer",
]
