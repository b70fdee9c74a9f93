"""``exact``: the default lossless codec; docs/exact.md explains it."""

from mocapress.codecs.exact.codec import Exact

__all__ = ["Exact"]
