"""No test passes because it asserted nothing: none without assertions, none with all of them in an empty loop."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.assertions import Function, asserts, collected, names_of, surely_asserts
from support.long_files import LONG
from support.source_tree import ROOT

TESTS = ROOT / "test"
FILES = sorted(TESTS.rglob("test_*.py"))
#: What these call must raise nothing, or nothing else than what they catch; the docstring says so.
RAISE_NOTHING_ELSE = {
    "recipes/test_bad_recipes.py::test_recipe_at_the_limit",
    "simulation/controller/test_rapid_library.py::test_no_text_crashes_the_reading_of_literals",
    "measurements/test_measurement_set.py::test_a_damaged_file_never_ends_in_another_error",
    "test_config.py::test_no_text_raises_anything_else",
}


def name_of(path: Path, test: Function) -> str:
    return f"{path.relative_to(TESTS).as_posix()}::{test.name}"


def test_there_are_tests_to_check() -> None:
    assert len(FILES) > 150
    assert sum(len(collected(path)) for path in FILES) > 1000


def test_the_files_that_are_begun_first_are_there(request: pytest.FixtureRequest) -> None:
    assert [name for name in LONG if TESTS / name not in FILES] == []
    assert len(set(LONG)) == len(LONG)
    assert request.config.option.loadscopereorder is False


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.relative_to(TESTS).as_posix())
def test_every_test_is_sure_to_assert(path: Path) -> None:
    """Count what is looped over, or make the loop a parametrisation, where this fails."""
    names = names_of(path, TESTS)
    judged = [test for test in collected(path) if name_of(path, test) not in RAISE_NOTHING_ELSE]
    assert [test.name for test in judged if not asserts(test, names)] == [], "nothing is asserted"
    assert [test.name for test in judged if not surely_asserts(test, names)] == [], "a loop may run empty"


@pytest.mark.parametrize("name", sorted(RAISE_NOTHING_ELSE))
def test_what_only_must_not_raise_is_there_needs_it_and_says_so(name: str) -> None:
    path = TESTS / name.split("::")[0]
    (test,) = (test for test in collected(path) if name_of(path, test) == name)
    assert not surely_asserts(test, names_of(path, TESTS))
    assert isinstance(test.body[0].value.value, str)


SURE = {
    "plain": "assert f()",
    "a count": "rows = f()\nassert len(rows) == 4\nfor row in rows:\n    assert row",
    "a literal": "for x in (1, 2):\n    assert x",
    "a named literal": "cases = {'a': 1}\nfor x, y in cases.items():\n    assert f(x) == y",
    "a constant": "for x in CASES:\n    assert x",
    "a constant of another place": "for x, y in enumerate(OTHER.values()):\n    assert x",
    "a range": "for x in range(1, 3):\n    assert x",
    "one length of several": "for x, y in zip((1, 2), f(), strict=True):\n    assert x == y",
    "a list of a known length": "for x in [f(n) for n in range(3)]:\n    assert x",
    "drawn numbers": "for x in rng.uniform(low, high, (20, 6)):\n    assert x > 0",
    "an error": "with pytest.raises(ValueError):\n    f()",
    "arrays": "np.testing.assert_allclose(f(), 1.0)",
    "a helper by its name": "check_line(f())",
    "a helper by its source": "judged(f())",
    "a helper's method": "robot.to_ready()",
    "both branches": "if f():\n    assert g()\nelse:\n    assert h()",
    "a branch that leaves": "if f():\n    assert g()\n    return\nassert h()",
    "a function of the test": "def look(x):\n    assert x\nlook(f())",
}
UNSURE = {
    "a loop": "for row in f():\n    assert row",
    "a loop within a literal's": "for x in (1, 2):\n    for row in f(x):\n        assert row",
    "a loop in an if": "if f():\n    for row in f():\n        assert row\nelse:\n    assert f()",
    "a loop in a with": "with f() as rows:\n    for row in rows:\n        assert row",
    "a while": "while f():\n    assert g()",
    "an empty literal": "for x in ():\n    assert x",
    "an empty range": "for x in range(3, 3):\n    assert x",
    "a range of what was found": "for x in range(len(f())):\n    assert x",
    "the shorter of two": "for x, y in zip((1, 2), f()):\n    assert x == y",
    "the part that fits": "for x in [n for n in range(3) if f(n)]:\n    assert x",
    "what was searched": "for x in FOUND:\n    assert x",
    "errors in a loop": "for x in f():\n    with pytest.raises(ValueError):\n        x()",
    "arrays in a loop": "for x in f():\n    np.testing.assert_allclose(x, 1.0)",
    "a helper that loops": "unjudged(f())",
    "one branch": "if f():\n    assert g()",
    "a way out": "if f():\n    return\nassert h()",
    "rounds left out": "for x in (1, 2):\n    if f(x):\n        continue\n    assert x",
    "a function that nobody calls": "def look(x):\n    assert x\nf()",
}
NOTHING = {"a call": "f()", "a variable": "x = f()", "a helper without assertions": "silent(f())"}
HEAD = """
CASES = [1, 2]
FOUND = sorted(folder.glob("*"))

def judged(found):
    assert found

def unjudged(found):
    for item in found:
        assert item

def silent(found):
    return found

class Robot:
    def to_ready(self):
        assert self.step()

def test_it(rng, low, high, robot):
    """


def read(folder: Path, body: str) -> tuple[bool, bool]:
    """Whether a test with this body asserts anything, and whether it surely does."""
    path = folder / "test_sample.py"
    path.write_text(HEAD + body.replace("\n", "\n    ") + "\n", encoding="utf-8")
    (test,) = collected(path)
    names = names_of(path, folder)
    return asserts(test, names), surely_asserts(test, names)


@pytest.mark.parametrize("body", SURE.values(), ids=SURE)
def test_a_sure_assertion_is_seen(tmp_path: Path, body: str) -> None:
    assert read(tmp_path, body) == (True, True)


@pytest.mark.parametrize("body", UNSURE.values(), ids=UNSURE)
def test_an_assertion_that_may_not_be_met_is_seen(tmp_path: Path, body: str) -> None:
    assert read(tmp_path, body)[1] is False


@pytest.mark.parametrize("body", NOTHING.values(), ids=NOTHING)
def test_a_test_without_assertions_is_seen(tmp_path: Path, body: str) -> None:
    assert read(tmp_path, body) == (False, False)


def test_helpers_and_values_are_followed_into_the_files_they_come_from(tmp_path: Path) -> None:
    (tmp_path / "support").mkdir()
    (tmp_path / "support" / "sets.py").write_text(
        "FOUND = sorted(search())\nSIZES = (1, 2)\ndef judged(x):\n    assert x\n", encoding="utf-8"
    )
    path = tmp_path / "test_sample.py"
    path.write_text(
        "from support.sets import FOUND, SIZES, judged as look\n"
        "def test_a():\n    look(f())\n"
        "def test_b():\n    for x in SIZES:\n        assert x\n"
        "def test_c():\n    for x in FOUND:\n        assert x\n",
        encoding="utf-8",
    )
    names = names_of(path, tmp_path)
    assert [surely_asserts(test, names) for test in collected(path)] == [True, True, False]


def test_a_parametrisation_without_cases_is_an_error(pytestconfig: pytest.Config) -> None:
    assert pytestconfig.getini("empty_parameter_set_mark") == "fail_at_collect"
