"""What happens when a codec fails: mocapress tries another way and warns."""

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
    """Turn an exception that only a defect of a codec can raise into one that says so.

    Raises
    ------
    VerificationError
        Instead of any exception that is not due to input, parameters, files or lack of memory.

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
    """Do some work with a codec or, if the codec fails, with a plain lossless one.

    Returns
    -------
    tuple
        The result, None if both fail; and a warning, None if the first worked.

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
