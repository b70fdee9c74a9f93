"""The general-purpose way, for what is not motion or repeats itself."""

from collections.abc import Mapping

from mocapress.api.clips import stored_name
from mocapress.container import MczWriter, Original, pack
from mocapress.source import Source


def compress_plain(source: Source, notes: Mapping[str, str]) -> bytes:
    """Compress a file, whatever it is."""
    data = source.data
    name = stored_name(source.name)
    parts: list[bytes] = []
    writer = MczWriter(parts.append)
    writer.original(Original("", name, len(data), source.digest, (), pack(data, hard=True)))
    if notes:
        writer.notes(notes)
    writer.end()
    return b"".join(parts)
