"""The CRC-32 of files in a zip archive whose bytes have changed."""

import io
import struct
import zipfile
import zlib

from mocapress.errors import CorruptError

_LOCAL = struct.Struct("<26xHH")
_CENTRAL = struct.Struct("<28xHHH12x")
"""Of the headers of a file, before it and in the directory: lengths of its name and of more."""
_LOCAL_DIGEST, _CENTRAL_DIGEST = 14, 16
"""Where the CRC-32 stands in these."""
_BEHIND = 8
"""The flag of a file whose CRC-32 stands behind it, maybe after these four bytes."""
_MARK = b"PK\x07\x08"


def with_right_digests(data: bytes) -> bytes:
    """Give an archive with the digests of the files in it that are stored as they are.

    Raises
    ------
    CorruptError
        When it is no archive.

    """
    try:
        return _mended(data)
    except (zipfile.BadZipFile, struct.error, NotImplementedError, UnicodeError) as error:
        raise CorruptError(f"what was restored is no archive: {error}") from error


def _mended(data: bytes) -> bytes:
    changed = bytearray(data)
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        entries, place = archive.infolist(), archive.start_dir
    for entry in entries:
        at = entry.header_offset
        if entry.compress_type == zipfile.ZIP_STORED and at >= 0:
            begin = at + _LOCAL.size + sum(_LOCAL.unpack_from(data, at))
            end = begin + entry.compress_size
            digest = zlib.crc32(data[begin:end])
            own = at + _LOCAL_DIGEST
            if entry.flag_bits & _BEHIND:
                own = end + (len(_MARK) if data.startswith(_MARK, end) else 0)
            for where in (own, place + _CENTRAL_DIGEST):
                struct.pack_into("<I", changed, where, digest)
        place += _CENTRAL.size + sum(_CENTRAL.unpack_from(data, place))
    return bytes(changed)
