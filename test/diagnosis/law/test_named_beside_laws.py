"""A cause that an unknown effect elsewhere had hidden is named beside the law of that; a law alone lends no name."""

import pytest

from doormill_ros.diagnosis.core.diagnosis import diagnose_problem
from doormill_ros.diagnosis.loading import laws as loading_laws
from doormill_ros.diagnosis.loading.beside_laws import needless
from doormill_ros.diagnosis.loading.laws import with_laws
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from support.law_worlds.world import draw


def diagnosed(folder, seed):
    """What was hidden in a lab, and what its causes say."""
    world = draw(seed)
    world.write(folder)
    return world.truth, diagnose_problem(LoadingProblem(read_measurement_set(folder)))


def names(diagnosis):
    return [cause.key for cause in diagnosis.examination.named]


@pytest.mark.parametrize(
    "seed",
    [
        # Friction of joint 1 of which a pattern of joint 4 is a part, as long as nothing couples the two.
        40151,
        # Play of joint 2 that a dead zone and a shift with the direction describe together.
        40216,
    ],
)
def test_a_cause_hidden_by_an_effect_elsewhere_is_named_beside_its_law(tmp_path, seed):
    truth, before = diagnosed(tmp_path, seed)
    hidden = truth["named"]["cause"], truth["named"]["where"]
    assert (before.verdict, names(before)) == ("unexplained", [])
    after = with_laws(before)
    assert (after.verdict, names(after)) == ("partly_explained", [hidden])
    assert {law.where for law in after.characterised.laws} == {truth["where"]}
    (finding,) = after.findings
    (name,) = {"gap", "torque", "stiffness"} & {one.name for one in finding.cause.parameters}
    at = [one.name for one in finding.cause.parameters].index(name)
    assert abs(finding.values[at] - truth["named"]["parameters"][name]) < 4.0 * finding.std[at]
    # The one model that is told holds both.
    assert finding.cause in after.characterised.fit.members
    assert needless(after, (), lambda line: None) == []


@pytest.mark.parametrize("seed", [200, 936])
def test_a_law_alone_takes_no_name_when_causes_are_asked_for_again(tmp_path, seed, monkeypatch):
    truth, before = diagnosed(tmp_path, seed)
    assert truth["named"] is None
    asked = []
    monkeypatch.setattr(
        loading_laws,
        "asked_beside",
        lambda *given, own=loading_laws.asked_beside: asked.append(given) or own(*given),
    )
    assert names(with_laws(before)) == []
    assert asked
