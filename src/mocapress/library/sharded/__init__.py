"""Sharded libraries: a folder of shards and a manifest; docs/format/sharded.md."""

from collections.abc import Sequence

from mocapress.library.database import WAIT
from mocapress.library.reading import APPEND, READ
from mocapress.library.sharded import manifest
from mocapress.library.sharded.library import ShardedLibrary, create
from mocapress.library.sharded.store import Store
from mocapress.models import Place
from mocapress.source import LIMIT

__all__ = ["ShardedLibrary", "create", "open_sharded"]


def open_sharded(
    url: str,
    mode: str = READ,
    *,
    wait: float = WAIT,
    models: Sequence[Place] = (),
    limit: int | None = LIMIT,
) -> ShardedLibrary:
    """Open a sharded library; see ``open_library``."""
    if mode == APPEND and not manifest.newest(Store(url)):
        create(url)
    return ShardedLibrary(url, mode, wait=wait, models=models, limit=limit)
