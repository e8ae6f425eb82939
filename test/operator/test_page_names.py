"""The page answers to its own names only, also where it is served on a network or behind a server that encrypts."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import httpx
import pytest

from doormill_ros.operator.access.origin import is_named
from doormill_ros.operator.errors import PageAddressError
from doormill_ros.operator.serving.page_names import page_names
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.view_store import ViewStore
from support.waiting import LIMIT

NAME = "cell1.factory.example"


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    """A page on every network of this machine that has a name beside the machine's own."""
    with PageServer(create_app(ViewStore(), names=page_names(NAME)), "0.0.0.0", 0) as server:
        yield f"http://127.0.0.1:{httpx.URL(server.url).port}/state"


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("evil.example", 400),
        ("evil.example:8080", 400),
        (f"{NAME}.evil.example", 400),
        (f"x@{NAME}", 400),
        ("", 400),
        ("[::1", 400),
        ("localhost.evil.example", 400),
        ("127.0.0.1.evil.example", 400),
        (NAME, 200),
        (f"{NAME.upper()}:443", 200),
        ("localhost:1", 200),
        ("192.168.7.7:8080", 200),
        ("[fe80::1]:8080", 200),
        (socket.gethostname(), 200),
    ],
)
def test_a_page_on_a_network_answers_to_its_names_alone(url: str, host: str, status: int) -> None:
    answer = httpx.get(url, headers={"Host": host}, timeout=LIMIT)
    assert answer.status_code == status
    if status == 400:
        assert repr(host) in answer.json()["detail"]
        own = httpx.get(url, headers={"Host": host, "Origin": f"http://{host}"}, timeout=LIMIT)
        assert own.status_code == 400


@pytest.mark.parametrize("host", [NAME, "127.0.0.1:8080"], ids=["kept", "rewritten"])
@pytest.mark.parametrize(
    ("origin", "status"),
    [
        (f"https://{NAME}", 200),
        (f"https://{NAME}:8443", 200),
        ("https://evil.example", 403),
        (f"https://{NAME}.evil.example", 403),
        (f"https://evil@{NAME}", 403),
        ("null", 403),
    ],
)
def test_a_server_that_encrypts_may_keep_or_rewrite_the_name(
    url: str, host: str, origin: str, status: int
) -> None:
    headers = {"Host": host, "Origin": origin}
    assert httpx.get(url, headers=headers, timeout=LIMIT).status_code == status


def test_a_named_origin_may_have_any_port() -> None:
    assert is_named(f"https://{NAME}:8443", (NAME,))
    assert not is_named(f"https://{NAME}:x", (NAME,))
    assert not is_named("https://[", (NAME,))
    assert not is_named(f"https://{NAME}", ())


def test_names_are_host_names() -> None:
    assert page_names("") == ()
    assert page_names(" Cell1, millpc.local ,") == ("cell1", "millpc.local")
    for wrong in ("https://cell", "cell:8080", "a b", "*", "-cell", "cell..local", "cell/"):
        with pytest.raises(PageAddressError, match="names of /operator_page") as caught:
            page_names(f"good, {wrong}")
        assert repr(wrong) in caught.value.message
