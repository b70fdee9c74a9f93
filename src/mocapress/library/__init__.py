"""Libraries: one file for a collection of clips; docs/format/library.md."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mocapress.library.checking import Fault
    from mocapress.library.clips import StoredClip
    from mocapress.library.library import Library, open_library
    from mocapress.library.searching import SearchHit

__all__ = ["Fault", "Library", "SearchHit", "StoredClip", "open_library"]

# Loaded when they are needed: a list of clips takes neither NumPy nor codecs.
_LAZY = {
    "Fault": "mocapress.library.checking",
    "SearchHit": "mocapress.library.searching",
    "StoredClip": "mocapress.library.clips",
    **dict.fromkeys(("Library", "open_library"), "mocapress.library.library"),
}


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        msg = f"module 'mocapress.library' has no attribute {name!r}"
        raise AttributeError(msg)
    return getattr(import_module(_LAZY[name]), name)
