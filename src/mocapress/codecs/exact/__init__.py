"""``exact``: the default lossless codec; docs/exact.md explains it."""

from mocapress.codecs.exact.codec import Exact
from mocapress.codecs.exact.header import USUAL_LEVEL

__all__ = ["USUAL_LEVEL", "Exact"]
