"""The command-line tool, run as a user runs it."""

import json
import xml.etree.ElementTree as ET

import pytest

from doormill_ros.recipes.documents import load_recipe, parse_yaml
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.engine import ENVIRONMENT
from doormill_ros.tools.recipes import main


@pytest.fixture
def file(tmp_path, document):
    path = tmp_path / "doors.csv"
    other = {**document, "door_id": "door_2", "bar_code": "4712"}
    write_file(path, [Recipe.from_document(document), Recipe.from_document(other)])
    return path


def test_import_list_show_history(run, file):
    status, out, err = run("import", file, "--author", "anna")
    assert (status, out, err) == (0, "saved door_1 version 1\nsaved door_2 version 1\n", "")
    assert run("import", file, "--author", "bob")[1] == "unchanged door_1\nunchanged door_2\n"
    rows = [line.split("\t") for line in run("list")[1].splitlines()]
    assert [row[:4] for row in rows] == [["door_1", "1", "4711", "anna"], ["door_2", "1", "4712", "anna"]]
    assert run("list", "--prefix", "door_2")[1].splitlines() == ["\t".join(rows[1])]
    shown = Recipe.from_document(parse_yaml(run("show", "door_2")[1]))
    assert (shown.door_id, shown.version, shown.author) == ("door_2", 1, "anna")
    by_code = json.loads(run("show", "4712", "--bar-code", "--json")[1])
    assert Recipe.from_document(by_code) == shown
    assert len(run("history", "door_1")[1].splitlines()) == 1


def test_old_versions_can_be_shown(run, file, document):
    run("import", file, "--author", "anna")
    write_file(file, [Recipe.from_document({**document, "mass_kg": 31})])
    assert run("import", file, "--author", "bob")[1] == "saved door_1 version 2\n"
    assert json.loads(run("show", "door_1", "--json")[1])["mass_kg"] == 31
    assert json.loads(run("show", "door_1", "--json", "--version", 1)[1])["mass_kg"] == 30
    assert [line.split("\t")[1:4:2] for line in run("history", "door_1")[1].splitlines()] == [
        ["1", "anna"],
        ["2", "bob"],
    ]


@pytest.mark.parametrize("ending", ["xlsx", "csv", "yaml", "json"])
def test_export_gives_what_the_database_holds(run, file, tmp_path, ending):
    run("import", file, "--author", "anna")
    path = tmp_path / f"out.{ending}"
    assert run("export", path) == (0, f"wrote 2 recipes to {path}\n", "")
    assert [recipe.author for recipe in read_file(path)] == ["anna", "anna"]
    assert run("export", path, "door_2")[0] == 0
    assert [recipe.door_id for recipe in read_file(path)] == ["door_2"]


def test_thesis_table_goes_in_and_out(run, tmp_path):
    path = tmp_path / "in.txt"
    write_file(path, [load_recipe("thesis_1350_2deg")])
    assert run("import", path, "--author", "anna")[0] == 0
    assert run("export", tmp_path / "out.txt", "thesis_1350_2deg")[0] == 0
    (kept,) = read_file(tmp_path / "out.txt")
    assert (kept.features, kept.author, kept.version) == (load_recipe("thesis_1350_2deg").features, "anna", 1)


def test_draw_writes_svg(run, file, tmp_path):
    run("import", file, "--author", "anna")
    path = tmp_path / "door.svg"
    assert run("draw", "door_1", "--out", path) == (0, f"{path}\n", "")
    assert ET.parse(path).getroot().tag.endswith("svg")


@pytest.fixture
def shipped(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path / "shipped.sqlite"))

    def call(*arguments):
        status = main([*map(str, arguments)])
        out, err = capsys.readouterr()
        return status, out, err

    return call


def test_draw_shows_the_path_and_exaggerates_its_corrections(shipped, tmp_path):
    pictures = {}
    for factor in (1, 50):
        path = tmp_path / f"{factor}.svg"
        arguments = ("draw", "nine_point_door", "--path", "--factor", factor, "--out", path)
        assert shipped(*arguments)[:2] == (0, f"{path}\n")
        groups = {g.get("id"): g for g in ET.parse(path).iter("{http://www.w3.org/2000/svg}g")}
        pictures[factor] = {
            name: [line.get("points") for line in groups[name]] for name in ("air", "path", "corrected")
        }
    assert pictures[1]["path"] == pictures[50]["path"]
    assert pictures[1]["corrected"] != pictures[50]["corrected"]
    assert len(pictures[1]["corrected"]) == len(pictures[50]["corrected"]) > 20


def test_draw_writes_png_too(shipped, tmp_path):
    path = tmp_path / "door.png"
    assert shipped("draw", "thesis_190_2deg", "--path", "--out", path)[:2] == (0, f"{path}\n")
    assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_check_times_a_door_against_appendix_a1(shipped):
    status, one, _ = shipped("check", "standard_door")
    assert status == 0
    assert one.splitlines()[0] == "only robot"
    for line in ("3 hinges: ", "lock case: ", "handle_hole: ", "door, with probing: "):
        assert line in one
    # One robot is too slow for it, and is told what two would need.
    assert "s of 80.0 s, EXCEEDED" in one
    assert one.splitlines()[-1].startswith("two robots: door, with probing: ")
    assert one.splitlines()[-1].endswith("s of 80.0 s, kept")
    status, two, _ = shipped("check", "standard_door", "--robots", "2")
    assert status == 0
    assert [line for line in two.splitlines() if line.endswith("robot")] == ["first robot", "second robot"]
    assert "EXCEEDED" not in two
    totals = [float(x.split()[3]) for x in two.splitlines() if x.startswith("door, with probing")]
    assert totals[2] == max(totals[:2])


def test_a_door_that_cannot_be_milled_is_said_in_one_line(shipped, tmp_path, document):
    path = tmp_path / "door.json"
    path.write_text(json.dumps(document))
    assert shipped("import", path, "--author", "anna")[0] == 0
    status, out, err = shipped("check", "door_1")
    assert (status, out) == (2, "")
    assert "recipes: hinge_1: tool 'mill_16' stands in no place of the rack" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["show", "nothing"], "found no recipe for door 'nothing'"),
        (["show", "nothing", "--bar-code"], "found no recipe for bar code 'nothing'"),
        (["show", "door_1", "--version", "9"], "found version 9"),
        (["history", "nothing"], "found no recipe"),
        (["draw", "nothing"], "found no recipe"),
        (["draw", "door_1", "--out", "x.png"], "allowed is .svg, and .png with --path"),
        (["draw", "door_1", "--path", "--out", "x.pdf"], "allowed is .svg or .png"),
        (["check", "nothing"], "found no recipe"),
        (["import", "/nothing.csv"], "cannot be read"),
        (["import", "/nothing.doc"], "found the ending '.doc'"),
        (["export", "/nothing.doc"], "found the ending '.doc'"),
        (["export", "/no/folder.csv"], "cannot be written"),
        (["export", "x.csv", "nothing"], "found no recipe"),
        (["import", "FILE", "--author", ""], "author: found ''"),
    ],
)
def test_what_goes_wrong_is_one_line_and_status_2(run, file, arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run("import", file, "--author", "anna")
    status, out, err = run(*[file if argument == "FILE" else argument for argument in arguments])
    assert (status, out) == (2, "")
    assert err.startswith("recipes: ")
    assert words in err
    assert err.count("\n") == 1


def test_bad_database_is_one_line_and_status_2(capsys):
    assert main(["--database", "mysql://a:secret@b/c", "list"]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "secret" not in err


def test_usage_errors_end_with_status_2(capsys):
    for arguments in ([], ["sell"], ["show"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 2


def test_without_a_database_the_shipped_recipes_are_there(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path / "own.sqlite"))
    assert main(["list"]) == 0
    assert "standard_door\t1\t" in capsys.readouterr().out
    assert (tmp_path / "own.sqlite").is_file()


@pytest.mark.parametrize("command", [["list"], ["show", "a"], ["history", "a"], ["tools", "list"]])
def test_a_database_that_is_not_there_is_made_by_an_import_alone(tmp_path, capsys, command):
    missing = tmp_path / "new" / "recipes.sqlite"
    for url in (str(missing), f"sqlite:///{missing}"):
        assert main(["--database", url, *command]) == 2
        assert capsys.readouterr() == ("", f"recipes: there is no database {missing}; correct its name\n")
        assert not missing.parent.exists()
