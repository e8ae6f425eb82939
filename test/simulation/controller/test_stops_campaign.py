"""The campaign of stops: some of its runs, and that its judge sees what the modules are there to prevent."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.resources import resource
from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES
from support.stops_campaign import DEEP, Incident, Run, draw

#: Pulled straight out along the tool's axis.
STRAIGHT = (
    "MoveL RelTool(CRobT(\\Tool:=toolMill\\WObj:=wobjDoor),0,0,-60),SPEED_OUT,fine,toolMill\\WObj:=wobjDoor;"
)


@pytest.fixture
def changed(tmp_path: Path):
    """The modules, with one text in one of them replaced."""

    def changed_(name: str, old: str, new: str) -> list[Path]:
        for module in OWN_MODULES:
            text = resource(module).read_text()
            if module.endswith(f"{name}.mod"):
                assert text.count(old) == 1
                text = text.replace(old, new)
            (tmp_path / Path(module).name).write_text(text)
        return [tmp_path / Path(module).name for module in OWN_MODULES]

    return changed_


@pytest.mark.parametrize("seed", [4, 14, 23, 24, 63, 64])
def test_a_run_ends_with_a_good_door_and_nothing_broken(seed):
    verdict = Run(draw(seed)).mill()
    assert verdict.passed, verdict


def test_a_tool_drawn_out_beside_its_path_is_seen(changed):
    modules = changed("DoorStop", "BackOut there;", STRAIGHT)
    verdict = Run(Incident(4, "emergency stop 1", 9.74, DEEP), modules=modules).mill()
    assert verdict.struck
    assert verdict.strayed


@pytest.mark.parametrize(
    "incident",
    [
        # While the PC works at the picture.
        Incident(63, "exchange at a stop", 2.2),
        Incident(5, "exchange without power", 2.2),
    ],
)
def test_a_door_cut_by_the_file_of_another_is_seen(changed, incident):
    assert not Run(incident).mill().mistaken
    modules = changed("DoorStop", "IF NOT doorInHand THEN", "IF FALSE THEN")
    verdict = Run(incident, modules=modules).mill()
    assert verdict.struck
    assert verdict.mistaken
