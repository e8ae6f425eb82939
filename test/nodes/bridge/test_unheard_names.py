"""The name of a door that the controller, or the database, says nothing to: an error in good time, and no name left."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any

import pytest

from doormill_interfaces.srv import ExpectDoor, GetRecipe
from doormill_ros.abb.link_errors import DoorNameError, WriteTimeoutError
from doormill_ros.cell.errors import StageRefusedError
from doormill_ros.nodes.bridge import expect_door
from doormill_ros.nodes.bridge.expect_door import ExpectDoorServer

CODE = "4006381333931"


class Bridge:
    """Takes the place of the bridge's node; nobody answers it."""

    def __init__(self) -> None:
        self.told: dict[str, Future[None]] = {}
        self.asked: list[GetRecipe.Request] = []
        ExpectDoorServer(self, self.tell, None)

    def create_client(self, *_: Any, **__: Any) -> Any:
        return SimpleNamespace(call_async=self.ask)

    def destroy_client(self, client: Any) -> None:
        """Nothing to destroy."""

    def keep(self, *_: Any) -> None:
        """Nothing to keep."""

    def serve(self, _type: type, _name: str, answer: Any) -> None:
        self.answer = answer

    def ask(self, request: GetRecipe.Request) -> Future[Any]:
        self.asked.append(request)
        return Future()

    def tell(self, door_id: str) -> Future[None]:
        self.told[door_id] = Future()
        return self.told[door_id]

    def expect(self, **fields: str) -> ExpectDoor.Response:
        return self.answer(ExpectDoor.Request(**fields), ExpectDoor.Response())


@pytest.fixture
def bridge(monkeypatch: pytest.MonkeyPatch) -> Bridge:
    monkeypatch.setattr(expect_door, "LIMIT", 0.05)
    return Bridge()


def test_a_name_that_is_not_passed_on_in_time_is_withdrawn(bridge: Bridge) -> None:
    with pytest.raises(
        WriteTimeoutError, match=r"door oak was not passed on within 0\.05 s.*read the code again"
    ):
        bridge.expect(door_id="oak")
    assert bridge.told["oak"].cancelled()  # it must not reach the robot later, with another door in the clamp


def test_a_name_that_gives_way_to_another_is_told(bridge: Bridge, monkeypatch: pytest.MonkeyPatch) -> None:
    told: Future[None] = Future()
    told.cancel()
    monkeypatch.setitem(vars(bridge), "answer", ExpectDoorServer(bridge, lambda _: told, None)._expect)
    with pytest.raises(WriteTimeoutError, match="another one took its place"):
        bridge.expect(door_id="oak")


def test_a_database_that_is_silent_names_no_door(bridge: Bridge) -> None:
    with pytest.raises(
        StageRefusedError, match=rf"bar code '{CODE}'; check that /recipe_database is active"
    ) as caught:
        bridge.expect(bar_code=CODE)
    assert caught.value.code == DoorNameError.code
    assert [request.bar_code for request in bridge.asked] == [CODE]
    assert bridge.told == {}
