"""Credentials: found where they belong, shown nowhere."""

from __future__ import annotations

import base64
import copy
import logging
import os
import pickle
import time
import traceback
from pathlib import Path

import pytest

from doormill_ros.abb.credentials import (
    FILE_VARIABLE,
    PASSWORD_VARIABLE,
    USER_VARIABLE,
    Credentials,
    load_credentials,
)
from doormill_ros.abb.link_errors import (
    CredentialsFormatError,
    CredentialsMissingError,
    CredentialsPermissionError,
    LinkError,
    LoginError,
)
from doormill_ros.abb.transports.rws import connect_rws1, connect_rws2
from doormill_ros.simulation.controller.rws_server.app import Behaviour
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.waiting import LIMIT
from support.web_services import link_to

SECRET = "qu8-Zebra!wagon"


def write(path: Path, text: str, mode: int = 0o600) -> Path:
    path.write_text(text, encoding="utf-8")
    path.chmod(mode)
    return path


def test_from_the_environment() -> None:
    found = load_credentials({USER_VARIABLE: "mill", PASSWORD_VARIABLE: SECRET})
    assert (found.user, found.reveal()) == ("mill", SECRET)


@pytest.mark.parametrize("mode", [0o600, 0o400])
def test_from_a_private_file(tmp_path: Path, mode: int) -> None:
    path = write(tmp_path / "c.yaml", f'user: mill\npassword: "{SECRET}"\n', mode)
    assert load_credentials({}, path).reveal() == SECRET
    assert load_credentials({FILE_VARIABLE: str(path)}).user == "mill"


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o660, 0o622, 0o601, 0o777])
def test_a_file_that_others_reach_is_refused(tmp_path: Path, mode: int) -> None:
    path = write(tmp_path / "c.yaml", f"user: mill\npassword: {SECRET}\n", mode)
    with pytest.raises(CredentialsPermissionError, match="chmod 600"):
        load_credentials({}, path)


def test_a_file_of_somebody_else_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "c.yaml", f"user: mill\npassword: {SECRET}\n")
    if os.geteuid() == 0:
        os.chown(path, 12345, 12345)
    else:  # only root gives a file away; everybody can pass for somebody else
        monkeypatch.setattr(os, "geteuid", lambda: 12345)
    with pytest.raises(CredentialsPermissionError, match=f"belongs to user {path.stat().st_uid}"):
        load_credentials({}, path)


def test_a_pipe_is_refused_and_does_not_hang(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "c.yaml", 0o600)
    with pytest.raises(CredentialsPermissionError):
        load_credentials({}, tmp_path / "c.yaml")


@pytest.mark.parametrize(
    "environment", [{}, {USER_VARIABLE: "mill"}, {USER_VARIABLE: "m", PASSWORD_VARIABLE: ""}]
)
def test_nothing_given(environment: dict[str, str]) -> None:
    with pytest.raises(CredentialsMissingError, match=FILE_VARIABLE):
        load_credentials(environment)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(CredentialsMissingError):
        load_credentials({FILE_VARIABLE: str(tmp_path / "none")})


@pytest.mark.parametrize(
    "text",
    [
        "",
        SECRET,
        f"password: {SECRET}",
        "user: mill\npassword: 1234\n",
        f"user: mill\npassword: {SECRET}\nhost: x\n",
        f"user: [mill\npassword: {SECRET}\n",
        f"user: ''\npassword: {SECRET}\n",
        f"user: mill\npassword: {SECRET}\n" + "#" * 20_000,
    ],
)
def test_a_file_of_another_form_is_refused_without_quoting_it(tmp_path: Path, text: str) -> None:
    path = write(tmp_path / "c.yaml", text)
    with pytest.raises(CredentialsFormatError) as caught:
        load_credentials({}, path)
    shown = "".join(traceback.format_exception(caught.value)) + repr(caught.value.data)
    assert SECRET not in shown
    assert "1234" not in str(caught.value)


def test_the_password_shows_in_no_text_of_the_credentials() -> None:
    found = Credentials("mill", SECRET)
    for text in (repr(found), str(found), f"{found}", f"{[found]!r}", "%s" % found):  # noqa: UP031
        assert "mill" in text
        assert SECRET not in text
    for store in (pickle.dumps, copy.deepcopy):
        with pytest.raises(TypeError):
            store(found)


@pytest.mark.parametrize("version", [1, 2])
def test_the_password_is_in_no_log_record_and_no_error(
    tmp_path: Path, version: int, caplog: pytest.LogCaptureFixture
) -> None:
    """Everything of every library is logged, good and bad logins and broken connections are tried."""
    caplog.set_level(logging.DEBUG)
    for name in ("httpx", "httpcore", "websockets", "websockets.client", "asyncio", "doormill_ros"):
        caplog.set_level(logging.DEBUG, logger=name)
    errors: list[BaseException] = []
    behaviour = Behaviour(user="mill", password=SECRET)
    with RwsServer(Cabinet.create(tmp_path), version, behaviour=behaviour) as server:
        for password in (SECRET, SECRET + "x"):
            link = link_to(server, Credentials("mill", password), subscribe=True)
            try:
                link.write_file("Hei2.txt", b"x")
                link.read_request()
                limit = time.monotonic() + LIMIT
                while not link.events.live and time.monotonic() < limit:
                    link.wait(0.05)
            except LinkError as error:
                errors.append(error)
            assert SECRET not in repr(link)
            link.close()
    link = (connect_rws1 if version == 1 else connect_rws2)(
        "http://127.0.0.1:1", Credentials("mill", SECRET), **({} if version == 1 else {"insecure": True})
    )
    with pytest.raises(LinkError) as caught:
        link.read_ready()
    link.close()
    errors.append(caught.value)
    assert any(isinstance(error, LoginError) for error in errors)
    assert len(caplog.records) > 20
    basic = base64.b64encode(f"mill:{SECRET}".encode()).decode()
    texts = [record.getMessage() + repr(record.args) for record in caplog.records]
    texts += ["".join(traceback.format_exception(error)) + repr(error.data) for error in errors]
    for text in texts:
        assert SECRET not in text
        assert basic not in text
        assert "Authorization" not in text
