"""Libraries: one file for a collection of clips; docs/format/library.md."""

from mocapress.library.checking import Fault
from mocapress.library.clips import StoredClip
from mocapress.library.library import Library, open_library

__all__ = ["Fault", "Library", "StoredClip", "open_library"]
