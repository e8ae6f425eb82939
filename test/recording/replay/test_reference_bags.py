"""The reference bags: as intended, readable by two libraries, and equal to what the code answers today."""

from __future__ import annotations

from collections import Counter

import pytest
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader

from bags.timeline import Scenario, load_timeline, violations
from doormill_ros.recording.replay.answer import (
    LOCALIZATION_STAGE,
    RESULT_STAGE,
    TARGET_FILE_STAGE,
    TARGETS_STAGE,
)
from doormill_ros.recording.replay.replay import replay_bag
from support.source_tree import ROOT

BAGS = ROOT / "bags"
_, SCENARIOS = load_timeline(BAGS / "timeline.yaml")
ALWAYS = {
    "/diagnostics",
    "/rosout",
    "/abb/status",
    "/abb/request",
    "/abb/ready",
    "/robot_description",
}

pytestmark = pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda s: s.name)


def ended_by_a_stage(scenario: Scenario) -> bool:
    """False for what the controller or a missing picture ended: offline there is nothing to repeat it with."""
    return scenario.error_codes[1] < 400


def expected_answers(scenario: Scenario) -> dict[str, int]:
    """How many answers a replay must have compared, from the timeline alone."""
    messages = scenario.messages
    wanted = {
        LOCALIZATION_STAGE: messages["door/localization"],
        TARGETS_STAGE: messages["path/targets"],
        TARGET_FILE_STAGE: messages["abb/target_file"],
        RESULT_STAGE: messages["run/result"] if ended_by_a_stage(scenario) else 0,
    }
    return {topic: count for topic, count in wanted.items() if count}


def test_the_bag_shows_what_the_timeline_intends(scenario: Scenario) -> None:
    assert violations(scenario, BAGS / scenario.name) == []


def test_the_timeline_notices_another_course(scenario: Scenario) -> None:
    other = next(
        s for s in SCENARIOS if s.error_codes != scenario.error_codes or s.messages != scenario.messages
    )
    assert violations(scenario, BAGS / other.name)


def test_both_libraries_count_the_same_messages(scenario: Scenario) -> None:
    folder = BAGS / scenario.name
    with Reader(folder) as reader:
        promised = {topic: info.msgcount for topic, info in reader.topics.items()}
        by_rosbags = Counter(connection.topic for connection, _, _ in reader.messages())
        types = {c.topic: (c.msgtype, c.digest) for c in reader.connections}
    by_mcap: Counter[str] = Counter()
    channels = {}
    for path in folder.glob("*.mcap"):
        with path.open("rb") as stream:
            for schema, channel, _ in make_reader(stream).iter_messages():
                by_mcap[channel.topic] += 1
                channels[channel.topic] = (schema.name, channel.metadata["topic_type_hash"])
    assert dict(by_rosbags) == dict(by_mcap) == promised
    assert channels == types
    assert by_mcap.keys() >= ALWAYS
    assert sum(by_mcap.values()) > 40


def test_replay_finds_no_difference(scenario: Scenario) -> None:
    outcome = replay_bag(BAGS / scenario.name)
    assert [str(d) for d in outcome.found] == []
    assert outcome.counts == expected_answers(scenario)
    assert len(outcome.left_out) == (0 if ended_by_a_stage(scenario) else scenario.messages["run/result"])


def test_messages_carry_the_time_at_which_they_were_sent(scenario: Scenario) -> None:
    sent = []
    for path in (BAGS / scenario.name).glob("*.mcap"):
        with path.open("rb") as stream:
            sent += [(m.publish_time, m.log_time) for _, _, m in make_reader(stream).iter_messages()]
    assert len(sent) > 40
    assert all(0 <= log - publish < 60e9 for publish, log in sent)
    assert any(publish != log for publish, log in sent)
