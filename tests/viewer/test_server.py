"""The server answers this machine's browser, and only with the page."""

import http.client
import threading
from collections.abc import Iterator

import pytest

from mocapress.viewer.server import Answer, PageServer


@pytest.fixture
def server() -> Iterator[PageServer]:
    with PageServer("<p>page</p>", "default-src 'none'") as made:
        thread = threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        yield made
        made.shutdown()
        thread.join()


def ask(
    server: PageServer, path: str = "/", host: str | None = None, method: str = "GET"
) -> tuple[int, http.client.HTTPMessage, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=30)
    headers = {"Host": host} if host is not None else {}
    connection.request(method, path, headers=headers)
    response = connection.getresponse()
    answer = response.status, response.headers, response.read()
    connection.close()
    return answer


def test_it_listens_on_the_loopback_interface_only(server: PageServer) -> None:
    assert server.server_address[0] == "127.0.0.1"


def test_it_serves_the_page_with_its_policy(server: PageServer) -> None:
    status, headers, content = ask(server)
    assert (status, content) == (200, b"<p>page</p>")
    assert headers["Content-Security-Policy"] == "default-src 'none'; frame-ancestors 'none'"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert "Access-Control-Allow-Origin" not in headers
    assert ask(server, host=f"localhost:{server.server_port}")[0] == 200
    status, headers, content = ask(server, method="HEAD")
    assert (status, headers["Content-Length"], content) == (200, "11", b"")


@pytest.mark.parametrize("host", ["evil.example", "evil.example:{port}", "127.0.0.1", ""])
def test_other_names_for_this_machine_are_refused(server: PageServer, host: str) -> None:
    status, _, content = ask(server, host=host.format(port=server.server_port))
    assert status == 403
    assert b"<p>page</p>" not in content


@pytest.mark.parametrize("path", ["/etc/passwd", "/../pyproject.toml", "/page/main.js", "/x?/"])
def test_there_is_nothing_else(server: PageServer, path: str) -> None:
    assert ask(server, path)[0] == 404


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_it_only_gives(server: PageServer, method: str) -> None:
    assert ask(server, method=method)[0] == 501


def test_a_port_that_is_taken_is_an_error(server: PageServer) -> None:
    with pytest.raises(OSError, match="in use"):
        PageServer("", "", server.server_port)


def test_what_the_page_asks_for_is_given_to_the_page_only() -> None:
    def more(path: str) -> Answer | None:
        return Answer(b"more") if path == "/more" else None

    with PageServer("<p>page</p>", "default-src 'none'", 0, more) as made:
        thread = threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        assert ask(made, "/more")[0::2] == (200, b"more")
        assert ask(made, "/less")[0] == 404
        for site, status in (("same-origin", 200), ("cross-site", 404), ("none", 404)):
            connection = http.client.HTTPConnection("127.0.0.1", made.server_port, timeout=30)
            connection.request("GET", "/more", headers={"Sec-Fetch-Site": site})
            assert connection.getresponse().status == status
            connection.close()
        made.shutdown()
        thread.join()
