"""The recipe database, each test on SQLite and on a real PostgreSQL."""

import hashlib
import json
import subprocess
import sys
import threading
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest
import sqlalchemy as sa

from doormill_ros.recipes import errors as e
from doormill_ros.recipes import stored
from doormill_ros.recipes.documents import load_recipe, shipped_recipes, to_json
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store import schema
from doormill_ros.recipes.store.database import SHIPPER, RecipeDatabase
from doormill_ros.recipes.store.engine import ENVIRONMENT, WRITE, default_url, make_engine
from support.waiting import LIMIT

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def recipe(document):
    return Recipe.from_document(document)


def variant(recipe, **changes):
    return Recipe.from_document({**recipe.to_document(), **changes})


def test_versions_count_up_and_old_ones_stay(database, recipe):
    first = database.save(recipe, "anna")
    second = database.save(variant(recipe, width_mm=810), "bob")
    assert (first.version, first.author, second.version, second.author) == (1, "anna", 2, "bob")
    assert database.get("door_1") == second
    assert database.get("door_1", 1) == first
    assert database.get("door_1", 2) == second
    assert first.width == 0.8
    assert [(r.version, r.author) for r in database.history("door_1")] == [(1, "anna"), (2, "bob")]


def test_time_of_a_save_is_kept_in_utc(url, recipe):
    noon = datetime(2026, 1, 31, 12, 0, 0, 123456, tzinfo=timezone(timedelta(hours=2)))
    with RecipeDatabase(url, clock=lambda: noon) as database:
        database.save(recipe, "anna")
        stored = database.get("door_1").created
    assert stored == noon
    assert stored.utcoffset() == timedelta(0)


def test_what_is_stored_outlives_the_process(url, recipe):
    with RecipeDatabase(url) as database:
        saved = database.save(recipe, "anna")
    with RecipeDatabase(url) as database:
        assert database.get("door_1") == saved


def test_bar_code_finds_the_newest_version(database, recipe):
    database.save(recipe, "anna")
    newest = database.save(variant(recipe, mass_kg=31), "anna")
    assert database.find_bar_code("4711") == newest


def test_bar_code_may_move_on(database, recipe):
    database.save(recipe, "anna")
    database.save(variant(recipe, bar_code="4712"), "anna")
    assert database.find_bar_code("4712").version == 2
    with pytest.raises(e.UnknownBarCode):
        database.find_bar_code("4711")
    other = database.save(variant(recipe, door_id="door_2", bar_code="4711"), "anna")
    assert database.find_bar_code("4711") == other


def test_two_doors_cannot_share_a_bar_code(database, recipe):
    database.save(recipe, "anna")
    with pytest.raises(e.BarCodeTaken, match="4711"):
        database.save(variant(recipe, door_id="door_2"), "anna")
    with pytest.raises(e.UnknownDoor):
        database.get("door_2")
    assert len(database.history("door_1")) == 1


@pytest.mark.parametrize(
    "name", ["nothing", "", "door%", "a\x00b", "dør", "x" * 1000, "'; DROP TABLE door; --"]
)
def test_unknown_names(database, recipe, name):
    database.save(recipe, "anna")
    for call in (database.get, database.history):
        with pytest.raises(e.UnknownDoor):
            call(name)
    with pytest.raises(e.UnknownBarCode):
        database.find_bar_code(name)


@pytest.mark.parametrize("version", [0, 3, -1, 2**31, 10**30])
def test_unknown_versions(database, recipe, version):
    database.save(recipe, "anna")
    database.save(recipe, "anna")
    with pytest.raises(e.UnknownVersion, match="allowed are 1 to 2"):
        database.get("door_1", version)


@pytest.mark.parametrize("author", ["", "  ", "a\nb", "x" * 101])
def test_a_save_needs_an_author(database, recipe, author):
    with pytest.raises(e.BadText) as caught:
        database.save(recipe, author)
    assert caught.value.field == "author"
    assert database.list() == ()


def test_a_recipe_that_was_made_wrong_in_code_is_refused(database, recipe):
    bad = type(recipe)(**{**vars(recipe), "width": 0.1})
    with pytest.raises(e.OutOfRange) as caught:
        database.save(bad, "anna")
    assert caught.value.field == "width_mm"
    assert database.list() == ()


def test_list_has_the_newest_of_each_door_in_order(database, recipe):
    for name in ("b", "a", "B", "a_b", "a1"):
        database.save(variant(recipe, door_id=name, bar_code=name), "anna")
    database.save(variant(recipe, door_id="a", bar_code="a"), "bob")
    assert [(r.door_id, r.version, r.author) for r in database.list()] == [
        ("B", 1, "anna"),
        ("a", 2, "bob"),
        ("a1", 1, "anna"),
        ("a_b", 1, "anna"),
        ("b", 1, "anna"),
    ]
    assert [r.door_id for r in database.list(prefix="a_")] == ["a_b"]
    assert len(database.list(limit=2)) == 2


def test_save_all_is_all_or_nothing(database, recipe):
    second = variant(recipe, door_id="door_2")  # the bar code of the first
    with pytest.raises(e.BarCodeTaken):
        database.save_all([recipe, second], "anna")
    assert database.list() == ()


@pytest.mark.parametrize(
    "statement", ["UPDATE recipe_version SET author = 'x'", "DELETE FROM recipe_version"]
)
def test_the_database_itself_refuses_to_change_a_version(url, recipe, statement):
    with RecipeDatabase(url) as database:
        saved = database.save(recipe, "anna")
        engine = make_engine(url)
        with pytest.raises(sa.exc.DBAPIError, match="is final"), engine.begin() as connection:
            connection.execute(sa.text(statement))
        engine.dispose()
        assert database.get("door_1") == saved


def test_postgresql_refuses_truncate_too(postgres, recipe):
    url = postgres.empty_database()
    with RecipeDatabase(url) as database:
        database.save(recipe, "anna")
    engine = make_engine(url)
    with pytest.raises(sa.exc.DBAPIError, match="is final"), engine.begin() as connection:
        connection.execute(sa.text("TRUNCATE recipe_version"))
    engine.dispose()


def test_damaged_record_is_noticed(url, recipe):
    """Somebody with the triggers off changes one digit."""
    with RecipeDatabase(url) as database:
        database.save(recipe, "anna")
    engine = make_engine(url)
    with engine.begin() as connection:
        if connection.dialect.name == "sqlite":
            connection.execute(sa.text("DROP TRIGGER recipe_version_no_update"))
        else:
            connection.execute(sa.text("ALTER TABLE recipe_version DISABLE TRIGGER USER"))
        change = "UPDATE recipe_version SET document = replace(document, :old, :new)"
        digits = {"old": '"depth_mm":5.0', "new": '"depth_mm":6.0'}
        assert connection.execute(sa.text(change), digits).rowcount == 1
    engine.dispose()
    with RecipeDatabase(url) as database, pytest.raises(e.DamagedRecord, match="door_1"):
        database.get("door_1")


def insert(url, document, checked_by, sealed_for=None):
    """A row as some release of ours would have written it."""
    content = json.dumps({k: v for k, v in document.items() if k not in stored.STAMP})
    row = {"c": content, "s": stored.seal(content, checked_by if sealed_for is None else sealed_for)}
    engine = make_engine(url)
    with engine.begin() as connection:
        connection.execute(sa.text("INSERT INTO door VALUES ('door_1', '4711', 1)"))
        connection.execute(
            sa.text(
                "INSERT INTO recipe_version VALUES "
                "('door_1', 1, '4711', 'anna', '2026-01-31T12:00:00+00:00', :c, :s, :r)"
            ),
            {**row, "r": checked_by},
        )
    engine.dispose()


@pytest.mark.parametrize("checked_by", ["", "0123456789abcdef"])
def test_what_other_rules_have_checked_is_checked_again(url, document, checked_by):
    RecipeDatabase(url).close()
    document["features"][0]["depth_mm"] = 39.0  # leaves 1 mm of wood
    insert(url, document, checked_by)
    with RecipeDatabase(url) as database, pytest.raises(e.ThinFloor) as caught:
        database.find_bar_code("4711")
    assert caught.value.field == "features.0.depth_mm"


def test_what_other_rules_have_checked_is_read_when_it_is_right(url, document, recipe):
    RecipeDatabase(url).close()
    insert(url, document, "0123456789abcdef")
    with RecipeDatabase(url) as database:
        assert database.find_bar_code("4711").features == recipe.features


def test_rules_that_were_put_in_afterwards_break_the_seal(url, document):
    """Whoever passes a recipe off as checked has to forge its seal, too."""
    RecipeDatabase(url).close()
    document["features"][0]["depth_mm"] = 39.0
    insert(url, document, stored.rules(), sealed_for="0123456789abcdef")
    with RecipeDatabase(url) as database, pytest.raises(e.DamagedRecord, match="door_1"):
        database.find_bar_code("4711")


def test_rules_are_all_the_code_that_reads_and_checks_a_recipe():
    """Every module that a recipe is read with has a share in the name of the rules."""
    code = (
        "import sys, doormill_ros.recipes.recipe\n"
        "print(*[m.__file__ for n, m in sys.modules.items() if n.startswith('doormill_ros.recipes.')])"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    folder = Path(stored.__file__).resolve().parent
    files = {str(Path(name).resolve().relative_to(folder)) for name in loaded.stdout.split()}
    covered = {str(p.relative_to(folder)) for pattern in stored.RULE_FILES for p in folder.glob(pattern)}
    assert files - covered == {"errors.py"}


def test_a_server_that_was_started_anew_is_found_again(postgres, recipe):
    """Its end breaks the connections that the database holds open."""
    url = postgres.empty_database()
    with RecipeDatabase(url) as database:
        saved = database.save(recipe, "anna")
        assert database.find_bar_code("4711") == saved
        engine = make_engine(url)
        with engine.begin() as connection:
            ended = connection.execute(
                sa.text(
                    "SELECT pg_terminate_backend(pid, 30000) FROM pg_stat_activity "
                    "WHERE datname = current_database() AND pid <> pg_backend_pid()"
                )
            ).all()
        engine.dispose()
        assert len(ended) == 2
        assert database.find_bar_code("4711") == saved
        assert database.save(recipe, "bob").version == 2


CELLS, SAVES = 3, 15

CELL = """
import json, sys
from doormill_ros.recipes.store.database import SHIPPER, RecipeDatabase
from doormill_ros.recipes.recipe import Recipe
url, author, saves = sys.argv[1], sys.argv[2], int(sys.argv[3])
recipe = Recipe.from_document(json.loads(sys.stdin.readline()))
with RecipeDatabase(url) as database:
    print("ready", flush=True)
    sys.stdin.readline()
    print(json.dumps([database.save(recipe, author).version for _ in range(saves)]))
"""


def saved_by_threads(url, recipe):
    versions = [None] * CELLS
    start = threading.Barrier(CELLS)

    def cell(number):
        with RecipeDatabase(url) as database:
            start.wait()
            versions[number] = [database.save(recipe, f"cell {number}").version for _ in range(SAVES)]

    threads = [threading.Thread(target=cell, args=(number,)) for number in range(CELLS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(LIMIT)
    return versions


def saved_by_processes(url, recipe):
    arguments = [sys.executable, "-c", CELL, url]
    pipe = subprocess.PIPE
    cells = [
        subprocess.Popen([*arguments, f"cell {i}", str(SAVES)], stdin=pipe, stdout=pipe, text=True, cwd=ROOT)
        for i in range(CELLS)
    ]
    for cell in cells:
        cell.stdin.write(to_json(recipe) + "\n")
        cell.stdin.flush()
    for cell in cells:
        assert cell.stdout.readline() == "ready\n"
    for cell in cells:
        cell.stdin.write("go\n")
        cell.stdin.flush()
    return [json.loads(cell.communicate(timeout=LIMIT)[0]) for cell in cells]


@pytest.mark.parametrize("save", [saved_by_threads, saved_by_processes])
def test_concurrent_savers_get_distinct_versions(url, recipe, save):
    """Three cells save the same, so far unknown, door at once, 15 times each; none knows of the others."""
    versions = save(url, recipe)
    everything = list(range(1, CELLS * SAVES + 1))
    assert sorted(version for mine in versions for version in mine) == everything
    with RecipeDatabase(url) as database:
        history = {record.version: record.author for record in database.history("door_1")}
    assert list(history) == everything
    for number, mine in enumerate(versions):
        assert mine == sorted(mine)
        assert {history[version] for version in mine} == {f"cell {number}"}


def at_once(count, work):
    """Run `work(start)` in threads that meet at the barrier `start`; none may fail."""
    start = threading.Barrier(count, timeout=LIMIT)
    failures = []

    def run():
        try:
            work(start)
        except Exception as error:
            start.abort()  # the others shall not wait for this one
            failures.append(error)

    threads = [threading.Thread(target=run) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []


def test_four_cells_meet_sixty_new_doors_at_once(url, recipe):
    """The first save of a door is the risky one: both the door and its bar code are new."""
    doors = [variant(recipe, door_id=f"new_{n}", bar_code=f"code_{n}") for n in range(60)]

    def cell(start):
        with RecipeDatabase(url) as database:
            for door in doors:
                start.wait()
                database.save(door, "cell")

    at_once(4, cell)
    with RecipeDatabase(url) as database:
        for door in doors:
            assert [record.version for record in database.history(door.door_id)] == [1, 2, 3, 4]


def test_many_cells_may_open_a_new_database_at_once(url):
    def open_it(start):
        start.wait()
        with RecipeDatabase(url) as database:
            database.add_shipped()

    at_once(6, open_it)
    with RecipeDatabase(url) as database:
        assert [r.door_id for r in database.list()] == sorted(shipped_recipes())
        assert {r.version for r in database.list()} == {1}


def test_a_new_file_is_switched_to_its_log_by_many_at_once(tmp_path):
    """Without trying again one round in ten fails."""

    def connect(start, engine):
        start.wait()
        engine.connect().close()

    for number in range(100):
        url = f"sqlite:///{tmp_path / str(number)}.sqlite"
        at_once(8, lambda start, url=url: connect(start, make_engine(url)))


def raw(url):
    return make_engine(url)


def test_old_database_is_migrated_with_its_content(url, recipe):
    """A database of the first schema, filled by hand, is brought up and still gives its recipes."""
    engine = raw(url)
    document = recipe.to_document()
    stamp = [document.pop(key, None) for key in ("version", "author", "created")]
    assert stamp[0] == 0
    content = json.dumps(document)
    with engine.connect() as connection:
        connection.execution_options(**{WRITE: True})
        with connection.begin():
            schema.migrate(connection, "0001")
            connection.execute(
                sa.text("INSERT INTO door VALUES ('door_1', '4711', 1)"),
            )
            connection.execute(
                sa.text("INSERT INTO recipe_version VALUES ('door_1', 1, '4711', 'anna', :t, :c, :s)"),
                {
                    "t": "2026-01-31T12:00:00+00:00",
                    "c": content,
                    "s": hashlib.sha256(content.encode()).hexdigest(),
                },
            )
            assert schema.current_revision(connection) == "0001"
    with RecipeDatabase(url) as database:
        found = database.find_bar_code("4711")
        assert (found.version, found.author) == (1, "anna")
        assert found.features == recipe.features
        assert database.save(recipe, "bob").version == 2
    with engine.connect() as connection:
        assert schema.current_revision(connection) == schema.REVISIONS[-1]
    engine.dispose()


def test_migrations_make_exactly_the_tables_of_the_code(url):
    from alembic.autogenerate import compare_metadata
    from alembic.migration import MigrationContext

    RecipeDatabase(url).close()
    engine = raw(url)
    with engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, schema.metadata) == []
    engine.dispose()


def test_list_of_revisions_is_that_of_the_migration_files():
    from alembic.config import Config
    from alembic.script import ScriptDirectory

    config = Config()
    config.set_main_option("script_location", str(schema.MIGRATIONS))
    script = ScriptDirectory.from_config(config)
    assert tuple(r.revision for r in script.walk_revisions())[::-1] == schema.REVISIONS
    assert script.get_heads() == [schema.REVISIONS[-1]]


def test_migrations_can_be_undone(url):
    from alembic import command
    from alembic.config import Config

    RecipeDatabase(url).close()
    engine = raw(url)
    config = Config()
    config.set_main_option("script_location", str(schema.MIGRATIONS))
    with engine.connect() as connection:
        connection.execution_options(**{WRITE: True})
        with connection.begin():
            config.attributes["connection"] = connection
            command.downgrade(config, "base")
            assert set(sa.inspect(connection).get_table_names()) <= {"alembic_version"}
    engine.dispose()
    with RecipeDatabase(url) as database:
        assert database.list() == ()


def test_database_of_a_later_release_is_left_alone(url):
    RecipeDatabase(url).close()
    engine = raw(url)
    with engine.begin() as connection:
        connection.execute(sa.text("UPDATE alembic_version SET version_num = '9999'"))
    engine.dispose()
    with pytest.raises(e.SchemaTooNew, match="9999"):
        RecipeDatabase(url)


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("mysql://a:b@c/d", "mysql"),
        ("postgresql://u:secret@127.0.0.1:1/x", "cannot be used"),
        ("no such kind://", "cannot be read"),
        ("sqlite:////proc/nothing/recipes.sqlite", "cannot be made"),
    ],
)
def test_unreachable_database(url, message):
    with pytest.raises(e.DatabaseUnreachable, match=message) as caught:
        RecipeDatabase(url)
    assert "secret" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_no_database(tmp_path):
    path = tmp_path / "recipes.sqlite"
    path.write_bytes(b"this is a shopping list, not a database" * 100)
    before = path.read_bytes()
    with pytest.raises(e.DatabaseUnreachable, match="not a database"):
        RecipeDatabase(str(path))
    assert path.read_bytes() == before


def test_database_in_memory(recipe):
    with RecipeDatabase("sqlite://") as database:
        assert database.find_bar_code(database.save(recipe, "anna").bar_code).version == 1


def test_default_place_of_the_database(monkeypatch, tmp_path):
    monkeypatch.delenv(ENVIRONMENT, raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert default_url() == f"{tmp_path}/doormill_ros/recipes.sqlite"
    with RecipeDatabase() as database:
        database.add_shipped()
    assert (tmp_path / "doormill_ros" / "recipes.sqlite").is_file()
    monkeypatch.setenv(ENVIRONMENT, "postgresql://x/y")
    assert default_url() == "postgresql://x/y"


def test_shipped_recipes_are_added_once(database):
    assert {r.door_id for r in database.add_shipped()} == set(shipped_recipes())
    assert database.add_shipped() == ()
    changed = variant(load_recipe("standard_door"), mass_kg=35)
    assert database.save(changed, "anna").version == 2
    assert database.add_shipped() == ()
    assert database.get("standard_door").mass == 35


def test_shipped_recipes_follow_the_release_unless_somebody_saved_his_own(database):
    database.add_shipped()
    earlier = variant(load_recipe("standard_door"), mass_kg=35)
    database.save(earlier, SHIPPER)
    database.save(variant(load_recipe("nine_point_door"), mass_kg=13), "anna")
    (record,) = database.add_shipped()
    assert (record.door_id, record.version, record.author) == ("standard_door", 3, SHIPPER)
    assert database.get("standard_door").mass == load_recipe("standard_door").mass
    assert database.get("nine_point_door").mass == 13
    assert database.add_shipped() == ()


def test_many_cells_may_bring_a_shipped_recipe_up_at_once(url):
    with RecipeDatabase(url) as database:
        database.add_shipped()
        database.save(variant(load_recipe("standard_door"), mass_kg=35), SHIPPER)

    def open_it(start):
        with RecipeDatabase(url) as database:
            start.wait()
            database.add_shipped()

    at_once(4, open_it)
    with RecipeDatabase(url) as database:
        assert [record.version for record in database.history("standard_door")] == [1, 2, 3]


def test_import_saves_what_is_new_and_says_so(database, recipe, tmp_path):
    other = variant(recipe, door_id="door_2", bar_code="4712")
    database.save_all([recipe, other], "anna")
    for ending in ("xlsx", "csv", "json", "yaml"):
        path = tmp_path / f"all.{ending}"
        database.export_file(path)
        report = database.import_file(path, "bob")
        assert report.saved == ()
        assert report.unchanged == ("door_1", "door_2")
    database.save(variant(other, mass_kg=33), "carl")
    report = database.import_file(path, "bob")
    assert [(r.door_id, r.version, r.author) for r in report.saved] == [("door_2", 3, "bob")]
    assert report.unchanged == ("door_1",)
    assert database.get("door_2").mass == 30
    assert report.saved[0].created.tzinfo is UTC


def test_import_with_one_wrong_recipe_saves_none(database, recipe, tmp_path):
    path = tmp_path / "two.json"
    good, bad = recipe.to_document(), {**recipe.to_document(), "door_id": "door_2", "width_mm": 5}
    path.write_text(json.dumps([good, bad]))
    with pytest.raises(e.OutOfRange, match=r"two\.json document 2: width_mm: found 5 mm"):
        database.import_file(path, "anna")
    assert database.list() == ()


def test_export_of_chosen_doors(database, recipe, tmp_path):
    database.save_all([recipe, variant(recipe, door_id="door_2", bar_code="4712")], "anna")
    assert [r.door_id for r in database.export_file(tmp_path / "x.csv", ["door_2"])] == ["door_2"]
    with pytest.raises(e.UnknownDoor):
        database.export_file(tmp_path / "y.csv", ["door_9"])
    assert not (tmp_path / "y.csv").exists()
