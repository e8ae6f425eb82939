"""Into place, and back: nothing of what was there is lost, whatever the restore dies of."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from doormill_ros.backup.archive import read_archive
from doormill_ros.backup.database import SiteDatabase
from doormill_ros.backup.errors import (
    BackupDatabaseError,
    BackupFileError,
    NewerBackupError,
    RestoreBusyError,
    TornBackupError,
)
from doormill_ros.backup.restore import WORK, restore, take_back
from doormill_ros.backup.site import alone, make_backup
from doormill_ros.models.store import ModelStore
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.tools import backup as backup_tool
from doormill_ros.tools import restore as restore_tool
from support.postgres import Server
from support.sites import fill
from support.waiting import LIMIT


def content(site: Path) -> dict[str, str]:
    """Files of the parts, and the versions of the doors in the database."""
    found = {
        str(p.relative_to(site)): p.read_text()
        for part in ("config", "models", "accepted", "audit")
        for p in (site / part).rglob("*")
        if p.is_file()
    }
    return found | {"doors": doors(str(site / "recipes.sqlite"))}


def doors(url: str) -> str:
    with RecipeDatabase(url) as database:
        return " ".join(f"{r.door_id}.{r.version}" for r in database.list())


def change(site: Path, recipe: Recipe) -> None:
    """The site moves on after its backup."""
    fill(site, "second")
    (site / "models" / "newer.yaml").write_text("newer")
    with RecipeDatabase(str(site / "recipes.sqlite")) as database:
        database.save(recipe, "bob")


def test_a_site_comes_back_and_what_was_there_is_kept(
    site: Path, recipe: Recipe, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = content(site)
    assert backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)]) == 0
    change(site, recipe)
    second = content(site)
    assert first["doors"] != second["doors"]
    assert restore_tool.main([str(tmp_path / "b.tar"), "--site", str(site)]) == 0
    assert content(site) == first
    (kept,) = (site / "replaced").iterdir()
    assert str(kept) in capsys.readouterr().out
    os.replace(kept / "database" / "recipes.sqlite", kept / "recipes.sqlite")
    assert content(kept) == second
    assert sorted(p.name for p in site.iterdir() if p.name.startswith(".")) == [".backup.lock"]


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o444, 0o755])
def test_files_are_for_whom_they_were(site: Path, tmp_path: Path, mode: int) -> None:
    private = ("config/camera.yaml", "audit/private.jsonl", "recipes.sqlite")
    (site / "audit" / "private.jsonl").write_text("{}\n")
    for name in private:
        (site / name).chmod(mode | 0o200 if name == "recipes.sqlite" else mode)
    backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)])
    assert restore_tool.main([str(tmp_path / "b.tar"), "--site", str(tmp_path / "new")]) == 0
    for name in private:
        assert (tmp_path / "new" / name).stat().st_mode == (site / name).stat().st_mode, name


def test_an_empty_machine_gets_everything(site: Path, tmp_path: Path) -> None:
    backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)])
    assert restore_tool.main([str(tmp_path / "b.tar"), "--site", str(tmp_path / "new")]) == 0
    assert content(tmp_path / "new") == content(site)


def test_a_check_changes_nothing(site: Path, tmp_path: Path) -> None:
    backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)])
    assert restore_tool.main([str(tmp_path / "b.tar"), "--check", "--site", str(tmp_path / "new")]) == 0
    assert not (tmp_path / "new").exists()


def backed_up(site: Path, archive: Path) -> Path:
    """A backup made now, its content in a folder beside it."""
    make_backup(site, SiteDatabase(str(site / "recipes.sqlite")), archive)
    folder = archive.with_suffix("")
    folder.mkdir()
    read_archive(archive).extract(folder)
    return folder


def test_a_backup_of_a_store_in_use_is_of_one_moment(site: Path, tmp_path: Path) -> None:
    """Each proposal takes the folder of the one before away; every copy names only what it holds."""
    ended = threading.Event()

    def propose() -> None:
        number = 0
        while not ended.is_set():
            number += 1
            ModelStore(site / "models").propose(b"%d" % number, "doors")

    proposer = threading.Thread(target=propose)
    proposer.start()
    try:
        for number in range(10):
            folder = backed_up(site, tmp_path / f"{number}.tar")
            copy = ModelStore(folder / "models")
            versions = copy.record().versions
            assert [copy.model(one.number).version for one in versions] == [one.number for one in versions]
    finally:
        ended.set()
        proposer.join()


def test_a_backup_of_a_database_in_use_is_of_one_moment(site: Path, recipe: Recipe, tmp_path: Path) -> None:
    """Versions count up without a gap while it is copied again and again."""
    ended = threading.Event()

    def save() -> None:
        with RecipeDatabase(str(site / "recipes.sqlite")) as database:
            while not ended.is_set():
                database.save(recipe, "cell")

    saver = threading.Thread(target=save)
    saver.start()
    seen = []
    try:
        for number in range(5):
            folder = backed_up(site, tmp_path / f"{number}.tar")
            with RecipeDatabase(str(folder / "database" / "recipes.sqlite")) as copy:
                history = [record.version for record in copy.history(recipe.door_id)]
                assert history == list(range(1, copy.get(recipe.door_id).version + 1))
                seen.append(len(history))
    finally:
        ended.set()
        saver.join()
    assert seen == sorted(seen)
    assert seen[-1] > 1


def test_cells_that_have_the_database_open_go_on_with_the_restored_one(
    site: Path, recipe: Recipe, tmp_path: Path
) -> None:
    url = str(site / "recipes.sqlite")
    make_backup(site, SiteDatabase(url), tmp_path / "b.tar")
    with RecipeDatabase(url) as cell:
        cell.save(recipe, "bob")
        restore(read_archive(tmp_path / "b.tar"), site, SiteDatabase(url))
        assert cell.get(recipe.door_id).version == 1
        assert cell.save(recipe, "bob").version == 2


def test_a_damaged_database_is_replaced_and_kept(site: Path, tmp_path: Path) -> None:
    url = str(site / "recipes.sqlite")
    make_backup(site, SiteDatabase(url), tmp_path / "b.tar")
    first = doors(url)
    SiteDatabase(url).remove()
    (site / "recipes.sqlite").write_bytes(b"no database any more " * 500)
    kept = restore(read_archive(tmp_path / "b.tar"), site, SiteDatabase(url))
    assert doors(url) == first
    assert (kept / "database" / "recipes.sqlite").read_bytes().startswith(b"no database any more")


def alter(path: Path, site: Path, statement: str) -> None:
    """A backup whose database somebody changed by hand; the archive itself is whole."""
    with sqlite3.connect(site / "recipes.sqlite") as connection:
        connection.execute(statement)
    connection.close()
    make_backup(site, SiteDatabase(str(site / "recipes.sqlite")), path)


def test_a_database_of_a_later_release_is_left_alone(site: Path, tmp_path: Path) -> None:
    alter(tmp_path / "b.tar", site, "UPDATE alembic_version SET version_num = '0999'")
    other = tmp_path / "other"
    fill(other, "mine")
    with pytest.raises(NewerBackupError, match="'0999'"):
        restore(read_archive(tmp_path / "b.tar"), other, SiteDatabase(str(other / "recipes.sqlite")))
    assert (other / "config" / "camera.yaml").read_text() == "mine config/camera.yaml\n"
    assert sorted(p.name for p in other.iterdir()) == ["accepted", "audit", "config", "models"]


def test_a_torn_backup_changes_nothing(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)])
    data = (tmp_path / "b.tar").read_bytes()
    (tmp_path / "torn.tar").write_bytes(data[: len(data) // 2])
    before = content(site)
    assert restore_tool.main([str(tmp_path / "torn.tar"), "--site", str(site)]) == 2
    assert "no whole backup" in capsys.readouterr().err
    assert content(site) == before
    assert not (site / "replaced").exists()


def test_an_archive_that_changes_under_the_restore_is_taken_back(site: Path, tmp_path: Path) -> None:
    database = SiteDatabase(str(site / "recipes.sqlite"))
    make_backup(site, database, tmp_path / "b.tar")
    found = read_archive(tmp_path / "b.tar")
    data = (tmp_path / "b.tar").read_bytes()
    (tmp_path / "b.tar").write_bytes(data.replace(b"first config", b"worst config"))
    before = content(site)
    with pytest.raises(TornBackupError, match="changed while"):
        restore(found, site, database)
    assert content(site) == before
    assert not (site / WORK).exists()


DIES = """
import os, sys
from pathlib import Path
import doormill_ros.backup.restore as room
from doormill_ros.backup.archive import read_archive
from doormill_ros.backup.database import SiteDatabase
archive, site, steps = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
replace, put = os.replace, SiteDatabase.put
def counted(step):
    def call(*arguments):
        global steps
        if steps == 0:
            os._exit(9)
        steps -= 1
        return step(*arguments)
    return call
os.replace, SiteDatabase.put = counted(replace), counted(put)
room.restore(read_archive(archive), site, SiteDatabase(str(site / "recipes.sqlite")))
os._exit(0)
"""


def test_a_restore_killed_at_any_step_is_taken_back_or_done(
    site: Path, recipe: Recipe, tmp_path: Path
) -> None:
    """The process ends without a word before the n-th move; the next tool finds one state or the other."""
    url = str(site / "recipes.sqlite")
    make_backup(site, SiteDatabase(url), tmp_path / "b.tar")
    first = content(site)
    change(site, recipe)
    second = content(site)
    outcomes = []
    for step in range(14):
        command = [sys.executable, "-c", DIES, str(tmp_path / "b.tar"), str(site), str(step)]
        status = subprocess.run(command, timeout=LIMIT).returncode
        assert status in (0, 9)
        taken_back = take_back(site, SiteDatabase(url))
        assert content(site) == (second if taken_back else first), f"step {step}"
        outcomes.append((status, taken_back))
        if not taken_back:
            break
    # The mark, four times old out and new in, the database, and the rename with which it is done.
    assert outcomes == [(9, True)] * 11 + [(9, False)]


KILLED = """
import os, sys
from pathlib import Path
import doormill_ros.backup.archive as room
from doormill_ros.tools.backup import main
room.read_archive = lambda path: os._exit(9)
main([sys.argv[1], "--site", sys.argv[2]])
"""


def test_what_a_killed_backup_left_is_swept_by_the_next(site: Path, tmp_path: Path) -> None:
    target = tmp_path / "backups" / "b.tar"
    command = [sys.executable, "-c", KILLED, str(target), str(site)]
    assert subprocess.run(command, timeout=LIMIT).returncode == 9
    assert len(list(site.glob(".backup-*"))) == 1
    assert len(list(target.parent.iterdir())) == 1
    # Whatever else lies there is somebody's.
    for name in (".c.tar.0123456789ab.part", ".b.tar.part", "b.tar.0123456789ab.part"):
        (target.parent / name).write_text("mine")
    old = target.parent / ".d.tar.0123456789ab.part"
    old.write_text("of a backup that was killed the day before yesterday")
    os.utime(old, (time.time() - 2 * 86400,) * 2)
    assert backup_tool.main([str(target), "--site", str(site)]) == 0
    assert list(site.glob(".backup-*")) == []
    assert sorted(path.name for path in target.parent.iterdir()) == [
        ".b.tar.part",
        ".c.tar.0123456789ab.part",
        "b.tar",
        "b.tar.0123456789ab.part",
    ]


def test_one_at_a_time(site: Path, tmp_path: Path) -> None:
    with alone(site), pytest.raises(RestoreBusyError), alone(site):
        pass
    assert backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)]) == 0


def test_links_are_followed_and_circles_refused(site: Path, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "bag.mcap").write_text("far")
    (site / "accepted" / "far").symlink_to(tmp_path / "elsewhere")
    database = SiteDatabase(str(site / "recipes.sqlite"))
    assert "accepted/far/bag.mcap" in make_backup(site, database, tmp_path / "b.tar").digests
    (site / "models" / "circle").symlink_to(site / "models")
    with pytest.raises(BackupFileError, match="leads back"):
        make_backup(site, database, tmp_path / "c.tar")
    (site / "models" / "circle").unlink()
    (site / "models" / "nowhere").symlink_to(tmp_path / "nowhere")
    with pytest.raises(BackupFileError, match="leads nowhere"):
        make_backup(site, database, tmp_path / "c.tar")
    assert not (tmp_path / "c.tar").exists()


def test_postgresql_goes_out_and_comes_back(
    server: Server, site: Path, recipe: Recipe, tmp_path: Path
) -> None:
    url = server.empty_database()
    with RecipeDatabase(url) as database:
        database.save(recipe, "anna")
    arguments = ["--site", str(site), "--database", url]
    assert backup_tool.main([str(tmp_path / "b.tar"), *arguments]) == 0
    with RecipeDatabase(url) as cell:
        cell.save(recipe, "bob")
        assert restore_tool.main([str(tmp_path / "b.tar"), *arguments]) == 0
        assert cell.get(recipe.door_id).version == 1
        # The database still refuses to change a version, and still counts.
        assert cell.save(recipe, "bob").version == 2
    (kept,) = (site / "replaced").iterdir()
    assert (kept / "database" / "recipes.pgdump").stat().st_size > 1000


def test_postgresql_that_does_not_answer_or_has_no_program_is_told(
    server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    away = f"postgresql://doormill:secret-word@127.0.0.1:{server.port}/nowhere"
    assert backup_tool.main([str(tmp_path / "b.tar"), "--site", str(tmp_path), "--database", away]) == 2
    said = capsys.readouterr().err
    assert said.startswith("backup: the database does not answer")
    assert "secret-word" not in said
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BackupDatabaseError, match="pg_dump is not installed"):
        SiteDatabase(server.url("postgres")).take(tmp_path / "copy")


def test_a_backup_of_the_other_kind_of_database_is_refused(
    server: Server, site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)])
    arguments = ["--site", str(site), "--database", server.empty_database()]
    before = content(site)
    assert restore_tool.main([str(tmp_path / "b.tar"), *arguments]) == 2
    assert "'sqlite', the one in use is 'postgresql'" in capsys.readouterr().err
    assert content(site) == before


def test_a_database_in_memory_is_refused() -> None:
    with pytest.raises(BackupDatabaseError, match="in memory"):
        SiteDatabase("sqlite://")
