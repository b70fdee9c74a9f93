"""Object storage for tests: moto's S3 on this machine, which counts what is asked of it."""

import socket
import threading
from collections.abc import Callable, Iterable
from types import TracebackType
from typing import Any, Self

from moto.moto_server.werkzeug_app import DomainDispatcherApplication, create_backend_app
from werkzeug.serving import make_server

Environ = dict[str, Any]


class Server:
    """A server, with counts of the requests for parts of files; ``on_put`` sees each upload."""

    def __init__(self) -> None:
        self.requests: list[tuple[str, str, int]] = []
        """Method, path, and bytes that were sent."""
        self.on_put: Callable[[str], bool] = bool
        """Says of an upload whether it may arrive."""
        self._app = DomainDispatcherApplication(create_backend_app)
        self._server = make_server("127.0.0.1", 0, self._answer, threaded=True)
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._server.server_port}"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def _answer(self, environ: Environ, start: Callable[..., Any]) -> Iterable[bytes]:
        method, path = environ["REQUEST_METHOD"], environ["PATH_INFO"]
        if method == "PUT" and not self.on_put(path):
            # Some of it came; then the line was cut.
            environ["wsgi.input"].read(100)
            environ["werkzeug.socket"].shutdown(socket.SHUT_RDWR)
            return []
        parts = [*self._app(environ, start)]
        self.requests.append((method, path, sum(map(len, parts))))
        return parts
