"""Says of work whether its time grows with the size of its input, or with the square of it.

Linear work on eight times the input takes eight times as long, quadratic work 64 times. Processor
time is measured, which other work on the machine hardly changes, of each size the least of several
runs, and the bound lies between; what fails is tried again. Fast work is not looked at: what the
largest input takes in less than 0.2 s passes.
"""

import contextlib
import time
import warnings
from collections.abc import Callable

from mocapress.errors import MocapressError, MotionWarning

Work = Callable[[], object]
_MOST = 24
_FAST = 0.2


def seconds(work: Work) -> float:
    """Give the least processor time of a few runs; errors are what hostile input may cost."""
    found = []
    for _ in range(3):
        begin = time.process_time()
        with contextlib.suppress(MocapressError), warnings.catch_warnings():
            warnings.simplefilter("ignore", MotionWarning)
            work()
        found.append(time.process_time() - begin)
        if found[-1] < _FAST / 3:
            break
    return min(found)


def is_linear(made: Callable[[int], Work], size: int, tries: int = 3) -> bool:
    """Say whether work on eight times the size takes at most 24 times as long."""
    for _ in range(tries):
        largest = seconds(made(8 * size))
        if largest < _FAST or largest <= _MOST * max(seconds(made(size)), _FAST / _MOST):
            return True
    return False
