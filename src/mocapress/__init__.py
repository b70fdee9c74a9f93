"""Store, play and search motion capture."""

from mocapress.version import __version__

__all__ = ["__version__"]
