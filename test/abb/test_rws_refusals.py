"""What the controller's web services refuse, and answers that are none, over real HTTP in both versions."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.link_errors import (
    DownloadError,
    LinkError,
    RemoveError,
    SignalAccessError,
    SignalReadError,
    SignalWriteError,
    UploadError,
)
from doormill_ros.abb.transports.rws import MASTERSHIP, RwsTransport
from doormill_ros.simulation.controller.rws_server import operations
from doormill_ros.simulation.controller.rws_server.reply import CODE_HELD, CODE_INVALID, RefusalError
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.source_tree import ROOT

Operation = Callable[[RwsTransport], object]
#: Error and what is to be done, by operation.
FILES: dict[str, tuple[Operation, type[LinkError], str]] = {
    "upload": (
        lambda link: link.write_file("Hei2.txt", b"x"),
        UploadError,
        "disk space and the user's grant",
    ),
    "download": (lambda link: link.read_file("Hei2.txt"), DownloadError, "grant to read HOME"),
    "remove": (lambda link: link.remove_file("Hei2.txt"), RemoveError, "grant to write HOME"),
}
READING: dict[str, tuple[Operation, type[LinkError], str]] = {
    "read": (lambda link: link.read_signal(signals.DONE), SignalReadError, "event log"),
    "read the request": (lambda link: link.read_request(), SignalReadError, "event log"),
    "read a number": (lambda link: link.read_number(signals.READY_NUMBER), SignalReadError, "event log"),
    "read the load": (lambda link: link.read_analog(signals.SPINDLE_LOAD), SignalReadError, "event log"),
}
WRITING: dict[str, tuple[Operation, type[LinkError], str]] = {
    "lower": (lambda link: link.set_ready(False), SignalWriteError, "event log"),
    "raise": (lambda link: link.set_ready(True), SignalWriteError, "event log"),
    "write a number": (
        lambda link: link.write_number(signals.READY_NUMBER, 7),
        SignalWriteError,
        "event log",
    ),
}
ALL = {**FILES, **READING, **WRITING}


def refuse(server: RwsServer, monkeypatch: pytest.MonkeyPatch, status: int, code: int) -> None:
    """Let the controller answer every request of a session in this way."""

    async def answer(*_: object) -> None:
        raise RefusalError(status, code, "refused")

    monkeypatch.setattr(server.services, "_answer", answer)


@pytest.mark.parametrize("status", [403, 500])
@pytest.mark.parametrize("name", ALL)
def test_what_is_refused_is_told_with_its_status_and_what_to_do(
    link: RwsTransport, server: RwsServer, monkeypatch: pytest.MonkeyPatch, name: str, status: int
) -> None:
    operation, leaf, advice = ALL[name]
    refuse(server, monkeypatch, status, CODE_INVALID)
    with pytest.raises(LinkError) as caught:
        operation(link)
    assert type(caught.value) is leaf
    assert f"status {status}" in caught.value.message
    assert advice in caught.value.message
    assert caught.value.data["status"] == status
    assert not caught.value.in_doubt  # the controller has answered
    if name not in FILES:
        assert f"code {CODE_INVALID}" in caught.value.message


@pytest.mark.parametrize("code", MASTERSHIP)
@pytest.mark.parametrize("name", [*READING, *WRITING])
def test_who_is_kept_from_a_signal_by_another_client_is_told_to_release_it(
    link: RwsTransport, server: RwsServer, monkeypatch: pytest.MonkeyPatch, name: str, code: int
) -> None:
    refuse(server, monkeypatch, 403, code)
    with pytest.raises(SignalAccessError) as caught:
        ALL[name][0](link)
    assert f"code {code}" in caught.value.message
    assert "somebody else may write on this controller now" in caught.value.message
    assert "release the write access of RobotStudio" in caught.value.message
    assert caught.value.data["controller_code"] == code


def test_the_page_names_the_codes_and_the_advice_that_the_error_tells(
    link: RwsTransport, server: RwsServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (ROOT / "docs" / "controller-link.md").read_text(encoding="utf-8")
    ((first, second, advice),) = re.findall(
        r"\*Somebody else may write \((-\d+), (-\d+)\)\*: ([^.]+)\.", page
    )
    assert (int(first), int(second)) == MASTERSHIP
    assert advice == "release RobotStudio's write access"
    refuse(server, monkeypatch, 403, CODE_HELD)
    with pytest.raises(SignalAccessError, match="release the write access of RobotStudio"):
        link.set_ready(False)


@pytest.mark.parametrize(
    ("read", "level", "advice"),
    [
        *(
            (link_read, text, "must be a digital")
            for link_read in ("signal", "request")
            for text in ("2", "", "x", "0.5")
        ),
        *(("number", text, "must be a digital or group signal") for text in ("", "-1", "1.5", "9" * 11)),
        *(("analog", text, "must be an analog signal") for text in ("", "much", "1,5", "inf")),
    ],
)
def test_an_answer_that_is_no_value_of_the_signal_says_what_it_must_be(
    link: RwsTransport, monkeypatch: pytest.MonkeyPatch, read: str, level: str, advice: str
) -> None:
    monkeypatch.setattr(operations, "level_text", lambda _value: level)
    name, call = {
        "signal": (signals.DONE, link.read_signal),
        "request": (signals.REQUEST, lambda _name: link.read_request()),
        "number": (signals.READY_NUMBER, link.read_number),
        "analog": (signals.DONE, link.read_analog),
    }[read]
    with pytest.raises(SignalReadError, match=advice) as caught:
        call(name)
    assert name in caught.value.message
    assert caught.value.data["signal"] == name
