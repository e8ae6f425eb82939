"""Answers of the web services that are JSON and no use."""

import json

import pytest

from doormill_ros.abb.link_errors import ControllerReplyError
from doormill_ros.abb.transports.rws_dialect import RWS1, RWS2


def answer(dialect, states):
    return json.dumps({"_embedded": {"_state": states}} if dialect is RWS1 else {"state": states}).encode()


@pytest.mark.parametrize("dialect", [RWS1, RWS2])
def test_a_list_of_states_is_taken(dialect):
    states = [{"title": "Überlast \u2013 Achse 2 \U0001f6d1"}]
    assert dialect.items(answer(dialect, states)) == states


@pytest.mark.parametrize("dialect", [RWS1, RWS2])
@pytest.mark.parametrize("states", [[{"title": "a\ud800b"}], [{"\udfff": "1"}], [{"opmode": ["\ud800"]}]])
def test_halves_of_characters_are_no_answer(dialect, states):
    with pytest.raises(ControllerReplyError, match="no list of states"):
        dialect.items(answer(dialect, states))
