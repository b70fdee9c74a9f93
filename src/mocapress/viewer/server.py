"""Serve one page to the browser of this machine, and what the page asks for."""

from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import NamedTuple

from mocapress.version import __version__

ADDRESS = "127.0.0.1"
_PATIENCE = 30.0  # seconds for a client to say what it wants


class Answer(NamedTuple):
    """What the server gives beside the page."""

    content: bytes
    kind: str = "application/octet-stream"
    status: HTTPStatus = HTTPStatus.OK


def nothing(path: str) -> Answer | None:  # noqa: ARG001
    """Give nothing beside the page."""
    return None


def first_of(*ways: Callable[[str], Answer | None]) -> Callable[[str], Answer | None]:
    """Give what the first of several ways gives that knows the path."""

    def more(path: str) -> Answer | None:
        return next(filter(None, (way(path) for way in ways)), None)

    return more


class PageServer(ThreadingHTTPServer):
    """A server on the loopback interface that answers ``GET /`` with one document.

    Parameters
    ----------
    document
        The page, as HTML.
    policy
        Its content security policy.
    port
        0 takes a free one.
    more
        Gives what else there is, by its path; called by several threads.

    Raises
    ------
    OSError
        When the port is taken.

    """

    def __init__(
        self,
        document: str,
        policy: str,
        port: int = 0,
        more: Callable[[str], Answer | None] = nothing,
    ) -> None:
        super().__init__((ADDRESS, port), _Handler)
        self.more = more
        self.content = document.encode()
        self.policy = policy
        # Another site can have its name point to 127.0.0.1; its pages then come with this name.
        self.hosts = {f"{name}:{self.server_port}" for name in (ADDRESS, "localhost")}

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://{ADDRESS}:{self.server_port}/"


class _Handler(BaseHTTPRequestHandler):
    server: PageServer
    timeout = _PATIENCE
    server_version = f"mocapress/{__version__}"
    sys_version = ""

    def do_GET(self) -> None:
        self._answer(with_content=True)

    def do_HEAD(self) -> None:
        self._answer(with_content=False)

    def _answer(self, *, with_content: bool) -> None:
        if self.headers.get("Host", "") not in self.server.hosts:
            self.send_error(HTTPStatus.FORBIDDEN, "this server answers to 127.0.0.1 only")
            return
        path = self.path.partition("?")[0]
        page = Answer(self.server.content, "text/html; charset=utf-8")
        answer = page if path == "/" else self._more(path)
        if answer is None:
            self.send_error(HTTPStatus.NOT_FOUND, "there is one page here")
            return
        self.send_response(answer.status)
        headers = {
            "Content-Type": answer.kind,
            "Content-Length": str(len(answer.content)),
            "Content-Security-Policy": f"{self.server.policy}; frame-ancestors 'none'",
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "Cache-Control": "no-store",
        }
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        if with_content:
            self.wfile.write(answer.content)

    def _more(self, path: str) -> Answer | None:
        # Pages of other sites may not ask, not even without reading the answer.
        if self.headers.get("Sec-Fetch-Site", "same-origin") != "same-origin":
            return None
        return self.server.more(path)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        """Say nothing: requests are the browser's own."""
