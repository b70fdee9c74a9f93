"""What is kept of a clip to find it: a signature, and a record to align it with others."""

from typing import NamedTuple

from mocapress.search.features import record
from mocapress.search.signatures import VERSION, signature
from mocapress.search.standard import StandardMotion

__all__ = ["VERSION", "Entry", "entry_of"]


class Entry(NamedTuple):
    """What is kept of a clip; entries of one ``VERSION`` can be compared."""

    signature: bytes
    """64 bytes, int8."""
    features: bytes
    """See ``features.record``."""


def entry_of(motion: StandardMotion) -> Entry:
    """Make the entry of a clip, or of a query."""
    return Entry(signature(motion).tobytes(), record(motion))
