"""Every exchange format gives back what was written, for recipes over the whole range."""

import pytest
from hypothesis import HealthCheck, given, settings

from doormill_ros.recipes.documents import parse_json, parse_yaml, to_json, to_yaml
from doormill_ros.recipes.exchange.csv_file import format_csv, parse_csv
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.exchange.thesis_text import format_thesis_text, parse_thesis_text
from doormill_ros.recipes.recipe import Recipe
from support import recipe_strategies as strategies

CHECKS = [HealthCheck.too_slow, HealthCheck.function_scoped_fixture, HealthCheck.data_too_large]


@settings(max_examples=60, deadline=None, suppress_health_check=CHECKS)
@given(strategies.documents())
def test_document_round_trip_is_exact(document):
    recipe = Recipe.from_document(document)
    assert Recipe.from_document(recipe.to_document()) == recipe
    assert Recipe.from_document(parse_json(to_json(recipe))) == recipe
    assert Recipe.from_document(parse_yaml(to_yaml(recipe))) == recipe


@settings(max_examples=60, deadline=None, suppress_health_check=CHECKS)
@given(strategies.documents())
def test_what_was_checked_reads_the_same_without_the_checks(document):
    recipe = Recipe.from_document(document)
    assert Recipe.from_checked(parse_json(to_json(recipe))) == recipe


@settings(max_examples=60, deadline=None, suppress_health_check=CHECKS)
@given(strategies.documents())
def test_document_gives_back_every_value(document):
    """Nothing that was given is lost or changed on the way to the document again."""

    def check(given_part, kept_part, path=""):
        for key, value in given_part.items():
            if isinstance(value, dict):
                check(value, kept_part[key], f"{path}.{key}")
            elif key == "created":
                assert kept_part[key] == value
            else:
                assert kept_part[key] == value, f"{path}.{key}"

    kept = Recipe.from_document(document).to_document()
    assert kept["features"]
    check({k: v for k, v in document.items() if k not in ("features", "tools")}, kept)
    for feature, kept_feature in zip(document["features"], kept["features"], strict=True):
        check(feature, kept_feature)
        check(document["tools"][feature["tool"]], kept["tools"][feature["tool"]])


@settings(max_examples=30, deadline=None, suppress_health_check=CHECKS)
@given(strategies.documents("door_a"), strategies.documents("door_b"))
def test_csv_round_trip(first, second):
    recipes = [Recipe.from_document(first), Recipe.from_document(second)]
    assert parse_csv(format_csv(recipes), "x.csv") == recipes


@settings(max_examples=12, deadline=None, suppress_health_check=CHECKS)
@given(strategies.documents("door_a"), strategies.documents("door_b"))
def test_file_round_trip(tmp_path, first, second):
    recipes = [Recipe.from_document(first), Recipe.from_document(second)]
    for ending in ("xlsx", "csv", "json", "yaml"):
        path = tmp_path / f"recipes.{ending}"
        write_file(path, recipes)
        assert read_file(path) == recipes


@settings(max_examples=50, deadline=None, suppress_health_check=CHECKS)
@given(strategies.thesis_documents())
def test_thesis_text_round_trip(document):
    recipe = Recipe.from_document(document)
    assert parse_thesis_text(format_thesis_text(recipe), "x.txt", "x") == recipe


@pytest.mark.parametrize(
    "code", ["=1+2", "007", "1e5", "7040000000017", "+47", "@a", "'x", "_x0041_", '"', ";,"]
)
def test_odd_bar_codes_survive_spreadsheets(code, tmp_path, document):
    recipe = Recipe.from_document({**document, "bar_code": code})
    for ending in ("xlsx", "csv", "json", "yaml"):
        path = tmp_path / f"recipe.{ending}"
        write_file(path, [recipe])
        assert read_file(path)[0].bar_code == code
