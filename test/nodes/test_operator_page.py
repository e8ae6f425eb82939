"""What the operator's page keeps of the codes that nodes give beside their words."""

from __future__ import annotations

from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.parameter import Parameter

from doormill_interfaces.msg import AbbStatus, DoorLocalization, DoorRecipe
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.operator.state import Fault


def diagnosis(values: dict[str, str], level: bytes = DiagnosticStatus.ERROR) -> DiagnosticArray:
    pairs = [KeyValue(key=key, value=value) for key, value in values.items()]
    return DiagnosticArray(
        status=[DiagnosticStatus(level=level, name="gige_camera", message="no answer", values=pairs)]
    )


@pytest.fixture
def page(context: rclpy.Context, tmp_path: Path):
    parameters = [Parameter("port", value=0)]
    parameters += [Parameter(name, value=str(tmp_path / name)) for name in ("history", "audit")]
    node = OperatorPage(parameter_overrides=parameters, context=context)
    node.bring_up()
    yield node
    node.close()
    node.destroy_node()


def test_codes_come_with_faults_refusals_and_states(page: OperatorPage) -> None:
    for values, code in (
        ({"lost": "3", "error_code": "242"}, 242),
        ({"lost": "3"}, 0),
        ({"error_code": "none"}, 0),
        ({"error_code": "9" * 5000}, 0),
    ):
        page._take_diagnostics(diagnosis(values))
        assert page.store.view.faults == {"gige_camera": Fault("no answer", code)}
    page._take_diagnostics(diagnosis({}, DiagnosticStatus.OK))
    assert page.store.view.faults == {}
    page._take_recipe(DoorRecipe(run_id="r1", door_id="oak"))
    page._take_localization(DoorLocalization(run_id="r1", door_id="oak", error_code=207, reason="dark"))
    assert (page.store.view.refusal, page.store.view.refusal_code) == ("dark", 207)
    page._take_status(AbbStatus(state="clearing", reason="no link", error_code=450))
    assert page.store.view.state_code == 450
