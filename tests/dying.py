"""Processes that kill themselves at a call of the system: before the n-th, for every n."""

import contextlib
import fcntl
import os
import signal
import warnings
from collections.abc import Callable, Iterator
from typing import Any

CALLS = (
    *("open", "write", "fsync", "fchmod", "fchown", "utime", "link", "replace", "rename", "unlink"),
    *("mkdir", "close"),
)


def dies_at(n: int, work: Callable[[], object]) -> bool:
    """Fork, work, and be killed before the n-th call (a write: in its middle); False: it ended."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # threads of numpy, which wait
        child = os.fork()
    if not child:
        with contextlib.suppress(BaseException):
            with counted(n):
                work()
            os._exit(0)
        os._exit(1)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        assert os.WTERMSIG(status) == signal.SIGKILL
        return True
    assert os.WEXITSTATUS(status) == 0
    return False


@contextlib.contextmanager
def counted(n: int) -> Iterator[None]:
    """Have this process killed before its n-th call."""
    seen = 0

    def counting(name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any, **kwargs: Any) -> Any:
            nonlocal seen
            seen += 1
            if seen == n:
                if name == "write":
                    real(args[0], args[1][: len(args[1]) // 2])
                os.kill(os.getpid(), signal.SIGKILL)
            return real(*args, **kwargs)

        return call

    for name in CALLS:
        setattr(os, name, counting(name, getattr(os, name)))
    fcntl.flock = counting("flock", fcntl.flock)
    yield
