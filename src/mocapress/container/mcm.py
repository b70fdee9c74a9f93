"""Writing and reading ``.mcm`` files, as docs/format.md lays them down."""

from typing import NamedTuple

from mocapress.container.packing import pack, unpack
from mocapress.container.sections import read_magic, read_section, section
from mocapress.errors import UnsupportedError
from mocapress.records import Reader, Writer

MAGIC = b"\x89MCM"
VERSION = 1
LARGEST_PAYLOAD = 2**23
LONGEST_HEADER = 2**12
"""No header reaches further into a file."""
LONGEST_FILE = LARGEST_PAYLOAD + 2 * LONGEST_HEADER
_HEADER, _PAYLOAD = range(1, 3)
_LONGEST_ID = 255


class Mcm(NamedTuple):
    """A file's header."""

    codec: str
    """Id of the codec that learned the model."""
    digest: bytes
    """What files name the model by."""


def pack_model(header: Mcm, payload: bytes) -> bytes:
    """Make a file.

    Raises
    ------
    UnsupportedError
        When the payload is larger than readers take.

    """
    if len(payload) > LARGEST_PAYLOAD:
        raise UnsupportedError(
            "size of the model",
            expected=f"at most {LARGEST_PAYLOAD} bytes",
            found=f"{len(payload)}",
        )
    writer = Writer()
    writer.bytes(header.codec.encode())
    writer.data += header.digest
    parts = [MAGIC, bytes([VERSION]), section(_HEADER, bytes(writer.data))]
    return b"".join([*parts, section(_PAYLOAD, pack(payload))])


def parse_model(data: bytes | memoryview) -> tuple[Mcm, bytes]:
    """Read a file: its header and the model's payload.

    Raises
    ------
    CorruptError
        When the data is not an ``.mcm`` file, or a damaged one.
    UnsupportedError
        When it is of a later version.

    """
    reader = Reader(data, "file")
    header = _read_header(reader)
    packed = read_section(reader, _PAYLOAD, "payload")
    reader.end()
    return header, unpack(packed, "model", LARGEST_PAYLOAD)


def peek_model(data: bytes | memoryview) -> Mcm:
    """Read the header from a file's first ``LONGEST_HEADER`` bytes, to see which model it is."""
    return _read_header(Reader(data, "file"))


def _read_header(reader: Reader) -> Mcm:
    read_magic(reader, MAGIC, VERSION, "not a model of mocapress")
    header = Reader(read_section(reader, _HEADER, "header"), "header")
    try:
        codec = header.raw(header.integer(_LONGEST_ID)).decode()
    except UnicodeDecodeError:
        raise header.fail("codec is not text") from None
    digest = header.raw(32)
    header.end()
    return Mcm(codec, digest)
