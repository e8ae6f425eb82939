"""The table of tools: recipes name its tools, what they cut is counted once a run, worn and broken ones are refused."""

from __future__ import annotations

import json
import threading
from dataclasses import replace

import pytest
import sqlalchemy as sa
import yaml

from doormill_ros.recipes import errors as e
from doormill_ros.recipes.documents import load_recipe, parse_yaml, to_yaml
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.exchange.tool_file import read_tool_file
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recipes.store.engine import make_engine
from doormill_ros.recipes.tool import Tool
from support.source_tree import ROOT

RACK_6 = {
    "diameter_mm": 6,
    "flutes": 1,
    "cutting_length_mm": 20,
    "max_spindle_speed_rpm": 24000,
    "length_mm": 120,
    "corner_mm": 0.5,
    "stiffness_n_mm": 85.5,
    "life_m": 100,
}


@pytest.fixture
def tool_file(tmp_path):
    def write(**tools):
        path = tmp_path / "tools.yaml"
        path.write_text(yaml.safe_dump({"schema": "doormill/tools/1", "tools": tools}))
        return path

    return write


@pytest.fixture
def stocked(database, tool_file):
    """A database with one tool, rack_6."""
    database.tools.save_all(read_tool_file(tool_file(rack_6=RACK_6)), "anna")
    return database


@pytest.fixture
def naming(document):
    """The door whose face plate is milled with rack_6, which it does not list."""
    del document["tools"]["mill_6"]
    document["features"][3]["tool"] = "rack_6"
    return document


@pytest.fixture
def door_file(tmp_path, naming):
    path = tmp_path / "door.yaml"
    path.write_text(yaml.safe_dump(naming))
    return path


def rows(url, text):
    """What the tables hold, read without the code under test."""
    engine = make_engine(url)
    with engine.connect() as connection:
        found = connection.execute(sa.text(text)).all()
    engine.dispose()
    return found


def plate_tool(recipe):
    return recipe.feature("plate").tool


def test_a_feature_takes_its_tool_from_the_table(stocked, door_file, url):
    stocked.import_file(door_file, "anna")
    tool = plate_tool(stocked.get("door_1"))
    assert (tool.diameter, tool.flutes, tool.length, tool.corner, tool.life) == (
        0.006,
        1,
        0.12,
        0.0005,
        100.0,
    )
    assert tool.stiffness == pytest.approx(85.5e3)
    assert type(stocked.get("door_1").feature("hinge_1").tool) is Tool
    # The recipe holds the name alone.
    ((text,),) = rows(url, "SELECT document FROM recipe_version")
    assert "rack_6" not in json.loads(text)["tools"]
    assert "stiffness" not in text
    assert stocked.import_file(door_file, "bob").unchanged == ("door_1",)


def test_other_figures_hold_from_the_next_look_up_on(stocked, door_file, tool_file):
    stocked.import_file(door_file, "anna")
    stocked.tools.save_all(read_tool_file(tool_file(rack_6={**RACK_6, "diameter_mm": 5.8})), "bob")
    assert plate_tool(stocked.get("door_1")).diameter == pytest.approx(0.0058)
    assert len(stocked.history("door_1")) == 1
    # A tool that no longer fits the feature: the recipe is checked against what the table has now.
    stocked.tools.save_all(read_tool_file(tool_file(rack_6={**RACK_6, "cutting_length_mm": 2.5})), "bob")
    for look_up in (lambda: stocked.get("door_1"), lambda: stocked.find_bar_code("4711")):
        with pytest.raises(e.ToolTooShort, match=r"features\.3\.tool: found 'rack_6'"):
            look_up()


def test_a_tool_of_the_recipe_s_own_stands_before_one_of_the_table(stocked, document, tool_file):
    stocked.tools.save_all(read_tool_file(tool_file(mill_6={**RACK_6, "diameter_mm": 4})), "anna")
    saved = stocked.save(Recipe.from_document(document), "anna")
    assert plate_tool(saved).diameter == 0.006
    assert stocked.get("door_1") == saved
    stocked.tools.mark_broken("mill_6", "anna")
    stocked.tools.check(stocked.get("door_1"))
    assert "tool_table" not in stocked.get("door_1").to_document()


def test_an_unknown_tool_is_refused_and_nothing_stored(run, door_file):
    status, out, err = run("import", door_file)
    assert (status, out) == (2, "")
    assert (
        "features.3.tool: found 'rack_6', which neither the recipe's tools nor the table of tools has" in err
    )
    assert run("list")[1] == ""


def test_a_tool_that_left_the_table_is_refused(stocked, door_file, url):
    stocked.import_file(door_file, "anna")
    engine = make_engine(url)
    with engine.begin() as connection:
        connection.execute(sa.text("DELETE FROM tool"))
    engine.dispose()
    with pytest.raises(e.UnknownTool, match="rack_6") as caught:
        stocked.get("door_1")
    assert (caught.value.code, caught.value.field) == (114, "features.3.tool")


def test_without_a_table_the_name_stands_for_nothing(naming, door_file):
    with pytest.raises(e.UnknownReference, match="rack_6"):
        Recipe.from_document(naming)
    with pytest.raises(e.UnknownReference, match="rack_6"):
        read_file(door_file)


def test_what_a_node_is_handed_needs_no_table(stocked, door_file):
    stocked.import_file(door_file, "anna")
    stocked.tools.expect("run", {"rack_6": 12.5})
    stocked.tools.count("run")
    recipe = stocked.get("door_1")
    handed = Recipe.from_document(parse_yaml(to_yaml(recipe)))
    assert handed == recipe
    assert plate_tool(handed).left == pytest.approx(87.5)


def test_a_name_is_no_tool_of_both(stocked, door_file):
    stocked.import_file(door_file, "anna")
    document = stocked.get("door_1").to_document()
    document["tools"]["rack_6"] = document["tools"]["mill_16"]
    with pytest.raises(e.DuplicateName, match=r"tool_table\.rack_6"):
        Recipe.from_document(document)


@pytest.mark.parametrize("ending", ["xlsx", "csv", "yaml", "json"])
def test_files_carry_the_name(stocked, door_file, tmp_path, ending):
    stocked.import_file(door_file, "anna")
    path = tmp_path / f"out.{ending}"
    stocked.export_file(path)
    assert stocked.import_file(path, "bob").unchanged == ("door_1",)
    with RecipeDatabase("sqlite://") as other, pytest.raises(e.UnknownTool, match="rack_6"):
        other.import_file(path, "bob")


def test_the_thesis_table_has_no_place_for_it(stocked, tmp_path):
    recipe = load_recipe("thesis_190_0deg")
    document = recipe.to_document()
    mill = document["tools"].pop("mill_19")
    path = tmp_path / "tools.yaml"
    figures = {**RACK_6, **mill}
    path.write_text(yaml.safe_dump({"schema": "doormill/tools/1", "tools": {"mill_19": figures}}))
    stocked.tools.save_all(read_tool_file(path), "anna")
    (tmp_path / "in.json").write_text(json.dumps(document))
    stocked.import_file(tmp_path / "in.json", "anna")
    with pytest.raises(e.NotExpressible, match="mill_19"):
        write_file(tmp_path / "out.txt", [stocked.get(recipe.door_id)])


def cut(database):
    return database.tools.get("rack_6").tool.cut


def test_a_run_counts_once(stocked, url):
    stocked.tools.expect("run_1", {"rack_6": 3.25})
    assert cut(stocked) == 0.0
    for _ in range(3):
        stocked.tools.count("run_1")
    assert cut(stocked) == 3.25
    # Targets that come late or once more change nothing, a run that nobody expected counts nothing.
    stocked.tools.expect("run_1", {"rack_6": 50.0})
    stocked.tools.count("run_1")
    stocked.tools.count("nobody's")
    assert cut(stocked) == 3.25
    # Of targets that were made twice the later ones are milled.
    stocked.tools.expect("run_2", {"rack_6": 1.0, "gone": 4.0})
    stocked.tools.expect("run_2", {"rack_6": 2.0})
    stocked.tools.count("run_2")
    assert cut(stocked) == 5.25
    with RecipeDatabase(url) as again:
        again.tools.count("run_2")
        assert cut(again) == 5.25


def test_cells_that_count_at_once_count_everything_once(stocked, url):
    for number in range(6):
        stocked.tools.expect(f"run_{number}", {"rack_6": 1.5})
    together = threading.Barrier(4)
    failed = []

    def cell():
        try:
            with RecipeDatabase(url) as own:
                together.wait()
                for number in range(6):
                    own.tools.count(f"run_{number}")
        except Exception as error:  # told by the test, not by the thread
            failed.append(error)

    threads = [threading.Thread(target=cell) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []
    assert cut(stocked) == 9.0


def test_a_worn_tool_is_refused_until_it_is_renewed(stocked, door_file):
    stocked.import_file(door_file, "anna")
    stocked.tools.expect("a", {"rack_6": 99.5})
    stocked.tools.count("a")
    stocked.tools.check(stocked.get("door_1"))
    stocked.tools.expect("b", {"rack_6": 0.5})
    stocked.tools.count("b")
    with pytest.raises(
        e.WornTool, match=r"'rack_6' after 100.0 m of cut, allowed are 100 m; .*renew rack_6"
    ) as caught:
        stocked.tools.check(stocked.get("door_1"))
    assert caught.value.code == 148
    stocked.tools.renew("rack_6", "bob")
    stocked.tools.check(stocked.get("door_1"))
    record = stocked.tools.get("rack_6")
    assert (record.tool.cut, record.author) == (0.0, "bob")


def test_a_broken_tool_is_refused_until_it_is_renewed(stocked, door_file):
    stocked.import_file(door_file, "anna")
    stocked.tools.mark_broken("rack_6", "bob")
    with pytest.raises(e.BrokenTool, match="'rack_6' marked as broken") as caught:
        stocked.tools.check(stocked.get("door_1"))
    assert caught.value.code == 149
    stocked.tools.renew("rack_6", "bob")
    stocked.tools.check(stocked.get("door_1"))
    assert not stocked.tools.get("rack_6").broken


def test_other_figures_change_nothing_of_what_it_has_cut(stocked, tool_file):
    stocked.tools.expect("a", {"rack_6": 7.0})
    stocked.tools.count("a")
    stocked.tools.mark_broken("rack_6", "anna")
    assert stocked.tools.save_all(read_tool_file(tool_file(rack_6={**RACK_6, "life_m": 50})), "bob") == (
        "rack_6",
    )
    assert stocked.tools.save_all(read_tool_file(tool_file(rack_6={**RACK_6, "life_m": 50})), "eve") == ()
    record = stocked.tools.get("rack_6")
    assert (record.tool.cut, record.tool.left, record.broken, record.author) == (7.0, 43.0, True, "bob")


def test_tools_that_differ_by_their_cut_are_one(stocked):
    tool = stocked.tools.get("rack_6").tool
    later = replace(tool, cut=5.0)
    assert later == tool
    assert hash(later) == hash(tool)
    assert replace(tool, life=5.0) != tool


@pytest.mark.parametrize("name", ["nothing", "", "a\x00b", "dør", "'; DROP TABLE tool; --"])
def test_unknown_names(stocked, name):
    for call in (
        lambda: stocked.tools.get(name),
        lambda: stocked.tools.renew(name, "anna"),
        lambda: stocked.tools.mark_broken(name, "anna"),
    ):
        with pytest.raises(e.NotInTable):
            call()
    assert stocked.tools.look_up([name, "rack_6"]).keys() == {"rack_6"}


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"life_m": None}, e.MissingField, "tools.rack_6.life_m: is missing"),
        ({"life_m": 0}, e.OutOfRange, "found 0 m, allowed are 0.1 to 1e"),
        ({"length_mm": 500}, e.OutOfRange, "tools.rack_6.length_mm"),
        ({"stiffness_n_mm": "stiff"}, e.WrongType, "tools.rack_6.stiffness_n_mm"),
        ({"cut_m": 3}, e.UnknownField, "cut_m: is counted by the database"),
        ({"colour": "red"}, e.UnknownField, "tools.rack_6.colour"),
        ({"name": "other"}, e.DuplicateName, "tools.rack_6.name"),
    ],
)
def test_a_wrong_tool_is_named_with_file_and_field(tool_file, change, error, words):
    figures = {key: value for key, value in {**RACK_6, **change}.items() if value is not None}
    with pytest.raises(error, match=r"tools\.yaml: ") as caught:
        read_tool_file(tool_file(rack_6=figures))
    assert words in caught.value.message


@pytest.mark.parametrize(
    ("content", "error"),
    [
        ("tools: {}", e.MissingField),
        ("schema: doormill/tools/1", e.MissingField),
        ("{schema: doormill/tools/9, tools: {}}", e.NotAChoice),
        ("{schema: doormill/tools/1, tools: {}, mills: {}}", e.UnknownField),
        ("[1]", e.WrongType),
        ("{schema: doormill/tools/1, tools: {.bad: {}}}", e.BadText),
        ("a: [", e.UnreadableFile),
    ],
)
def test_a_file_of_another_form(tmp_path, content, error):
    path = tmp_path / "tools.yaml"
    path.write_text(content)
    with pytest.raises(error, match=r"tools\.yaml"):
        read_tool_file(path)


def test_commands(run, tool_file, tmp_path):
    path = tool_file(rack_6=RACK_6, rack_8={**RACK_6, "diameter_mm": 8})
    assert run("tools", "import", path, "--author", "anna") == (0, "saved rack_6\nsaved rack_8\n", "")
    assert run("tools", "import", path)[1] == "unchanged rack_6\nunchanged rack_8\n"
    assert run("tools", "broken", "rack_8")[1] == "rack_8 is broken\n"
    assert [line.split("\t") for line in run("tools", "list")[1].splitlines()] == [
        ["rack_6", "6 mm wide", "120 mm long", "0.0 m of 100 m cut", "usable"],
        ["rack_8", "8 mm wide", "120 mm long", "0.0 m of 100 m cut", "broken"],
    ]
    assert run("tools", "renew", "rack_8")[1] == "rack_8 is new\n"
    assert run("tools", "list")[1].count("usable") == 2
    shown = tmp_path / "shown.yaml"
    shown.write_text(run("tools", "show", "rack_6")[1])
    (tool,) = read_tool_file(shown)
    assert tool == read_tool_file(path)[0]
    for wrong in (("show", "x"), ("renew", "x"), ("broken", "x"), ("import", tmp_path / "no.yaml")):
        status, out, err = run("tools", *wrong)
        assert (status, out, err.count("\n")) == (2, "", 1)
    assert run("tools", "renew", "rack_6", "--author", "x" * 101)[0] == 2
    assert run("tools", "import", tmp_path / "tools.xlsx")[2].endswith(
        "allowed is one of .yaml, .yml, .json\n"
    )


def test_the_shipped_tools_can_be_imported(run):
    assert run("tools", "import", ROOT / "config" / "tools.yaml") == (
        0,
        "saved rack_mill_12\nsaved rack_mill_16\n",
        "",
    )


@pytest.mark.parametrize(
    "damage",
    [
        {"document": "{"},
        {"document": "[" * 100_000},
        {"document": '{"diameter_mm": -1}'},
        {"document": "null"},
        {"changed": "yesterday"},
    ],
    ids=["cut off", "deep", "out of range", "nothing", "no time"],
)
def test_a_damaged_row_is_named_and_the_other_tools_are_usable(stocked, tool_file, run, url, damage):
    stocked.tools.save_all(read_tool_file(tool_file(rack_8={**RACK_6, "diameter_mm": 8})), "anna")
    engine = make_engine(url)
    with engine.begin() as connection:
        rows = sa.table("tool", sa.column("name"), *(sa.column(name) for name in damage))
        connection.execute(rows.update().where(rows.c.name == "rack_8").values(damage))
    engine.dispose()
    with pytest.raises(e.DamagedRecord, match="rack_8"):
        stocked.tools.get("rack_8")
    assert stocked.tools.get("rack_6").tool.name == "rack_6"
    for arguments in (("list",), ("show", "rack_8")):
        status, out, err = run("tools", *arguments)
        assert (status, out, err.count("\n")) == (2, "", 1)
        assert "rack_8" in err
