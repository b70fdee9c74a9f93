"""Collects the library's warnings, each for the file that caused it."""

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from mocapress.errors import MotionWarning

_of_thread = threading.local()
_show = warnings.showwarning


@contextmanager
def collecting() -> Iterator[None]:
    """Keep every ``MotionWarning`` for ``kept`` of its thread, instead of printing it."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", MotionWarning)
        warnings.showwarning = _keep
        yield


def kept() -> list[MotionWarning]:
    """Give the warnings of this thread since the last call."""
    found = getattr(_of_thread, "warnings", [])
    _of_thread.warnings = []
    return found


def say_at_once(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
    """Print a ``MotionWarning`` as commands print what they warn of."""
    if isinstance(message, MotionWarning):
        from mocapress.cli.report import say

        say(f"warning: {message}")
    else:
        _show(message, category, *place, **more)


def _keep(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
    if isinstance(message, MotionWarning):
        _of_thread.warnings = [*getattr(_of_thread, "warnings", []), message]
    else:
        _show(message, category, *place, **more)
