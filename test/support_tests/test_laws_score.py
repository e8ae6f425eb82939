"""How the bench of hidden laws judges what a diagnosis says."""

from __future__ import annotations

import importlib.util
import sys

import pytest

from support.source_tree import ROOT


@pytest.fixture(scope="module")
def bench():
    spec = importlib.util.spec_from_file_location("laws_score", ROOT / "bench" / "laws_score.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["laws_score"] = module
    spec.loader.exec_module(module)
    return module


def truth(named=None, where="joint 3", driver="path", also=("time",)):
    noise = {"floor": 1e-5, "floor_unseen": 2e-5}
    return {"where": where, "driver": driver, "also": list(also), "named": named, "noise": noise}


def document(causes=(), unnamed=(), **more):
    check = {"baseline": {"rmse": 8e-5}, "extended": {"rmse": 6e-5}}
    return {
        "verdict": "unexplained",
        "causes": list(causes),
        "unnamed": [{"law": "", **entry} for entry in unnamed],
        "extended": {"holdout_rmse": 3e-5},
        "checks": [check | more.pop("check", {})],
        **more,
    }


GAP = {"cause": "joint_backlash", "where": "joint 1"}
SOFT = {"cause": "joint_stiffness", "where": "joint 3"}


def test_the_right_place_and_driver_count(bench) -> None:
    score = bench.judge(truth(), document(unnamed=[{"where": "joint 3", "driver": "path"}]))
    assert (score.place, score.driver, score.exact, score.wrong, score.cause) == (True, True, True, (), None)


def test_a_driver_as_true_counts_but_not_as_the_very_one(bench) -> None:
    score = bench.judge(truth(), document(unnamed=[{"where": "joint 3", "driver": "time"}]))
    assert (score.place, score.driver, score.exact) == (True, True, False)


def test_the_right_driver_elsewhere_does_not_count(bench) -> None:
    entries = [{"where": "joint 2", "driver": "path"}, {"where": "joint 3", "driver": "constant"}]
    score = bench.judge(truth(), document(unnamed=entries))
    assert (score.place, score.driver, score.exact) == (True, False, False)


@pytest.mark.parametrize(
    ("said", "hidden"), [("flange", "tool"), ("ee", "reflector ee"), ("reflector ee",) * 2]
)
def test_two_words_for_one_place_are_one(bench, said, hidden) -> None:
    assert bench.judge(truth(where=hidden), document(unnamed=[{"where": said, "driver": "path"}])).place


def test_a_name_is_wrong_where_nothing_of_it_is_hidden(bench) -> None:
    score = bench.judge(truth(), document(causes=[SOFT, GAP]))
    assert score.wrong == ("joint_stiffness joint 3", "joint_backlash joint 1")
    assert score.wrong_here == ("joint_stiffness joint 3",)


def test_the_hidden_cause_is_right_also_as_confusable(bench) -> None:
    listed = {**SOFT, "confusable_with": [GAP]}
    assert bench.judge(truth(GAP), document(causes=[GAP])).cause is True
    assert bench.judge(truth(GAP), document(causes=[listed])).wrong == ()
    assert bench.judge(truth(GAP), document()).cause is False


def test_residuals_are_over_their_own_floors(bench) -> None:
    score = bench.judge(truth(), document())
    assert (score.baseline, score.extended, score.described, score.crossed) == pytest.approx((4, 3, 3, 3))
    more = document(check={"characterised": {"rmse": 2.2e-5}}, characterised={"holdout_rmse": 1.1e-5})
    score = bench.judge(truth(), more)
    assert (score.described, score.crossed) == pytest.approx((1.1, 1.1))
