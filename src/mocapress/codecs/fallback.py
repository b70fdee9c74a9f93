"""What is done when a codec fails: another way is tried, and the user is told."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from mocapress.codecs import Codec, codec
from mocapress.errors import MocapressError, VerificationError

__all__ = ["first_that_works", "naming_faults"]

RAISE_VARIABLE = "MOCAPRESS_RAISE"
"""The environment variable that turns the fallback off, as tests do: then faults are raised."""

_PLAINEST = "exact:level=1"
"""What is tried where another codec fails: the simplest lossless way."""

T = TypeVar("T")


@contextmanager
def naming_faults(made: Codec) -> Iterator[None]:
    """Turn an exception that only a fault of a codec can raise into one that says so.

    Raises
    ------
    VerificationError
        In place of any exception but those that input, parameters, files or a lack of memory
        cause.

    """
    try:
        yield
    except (MocapressError, OSError, MemoryError):
        raise
    except Exception as fault:
        if os.environ.get(RAISE_VARIABLE):
            raise
        message = f"codec {made.id} failed ({type(fault).__name__}: {fault}); please report this"
        raise VerificationError(message) from fault


def first_that_works(made: Codec, work: Callable[[Codec], T]) -> tuple[T | None, str | None]:
    """Do some work with a codec or, where the codec fails at it, with a plain lossless one.

    Returns
    -------
    tuple
        What came of the work, None where both fail; and a warning, None where the first worked.

    """
    warning = None
    for way in (made, codec(_PLAINEST)):
        try:
            with naming_faults(way):
                return work(way), warning and f"{warning}; compressed with {_PLAINEST} instead"
        except VerificationError as error:
            if os.environ.get(RAISE_VARIABLE):
                raise
            warning = warning or str(error)
    return None, f"{warning}; stored by a general-purpose compressor"
