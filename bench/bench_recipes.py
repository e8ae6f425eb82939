"""Look a recipe up by its bar code among 100,000, on SQLite and on PostgreSQL."""

from __future__ import annotations

import json
import random
import sqlite3
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import psycopg

from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recipes.stored import content_of, rules, seal
from harness import Entry, entry
from support import postgres

RECIPES = 100_000
LOOKUPS = 2000
LIMIT = 5e-3  #: s, at the 99th percentile
STAMP = ("bench", "2026-01-31T12:00:00+00:00")
DOOR = "INSERT INTO door VALUES (?, ?, 1)"
VERSION = "INSERT INTO recipe_version VALUES (?, 1, ?, ?, ?, ?, ?, ?)"
PLAIN = (
    "SELECT document FROM door JOIN recipe_version USING (door_id) "
    "WHERE door.bar_code = {} AND version = latest_version"
)


def rows() -> Iterator[tuple[str, str, str, str]]:
    """Door id, bar code, document and hash; every fifth door is the standard door of six features."""
    mark = "0123456789"
    texts = []
    for name in ("standard_door", *["thesis_190_0deg"] * 4):
        recipe = replace(load_recipe(name), door_id=f"d{mark}", bar_code=f"c{mark}")
        texts.append(content_of(recipe))
    for number in range(RECIPES):
        digits = f"{number:010d}"
        content = texts[number % 5].replace(mark, digits)
        yield f"d{digits}", f"c{digits}", content, seal(content, rules())


def fill_sqlite(path: Path) -> None:
    with sqlite3.connect(path) as connection:
        connection.executemany(DOOR, ((door, code) for door, code, _, _ in rows()))
        connection.executemany(
            VERSION, ((d, c, *STAMP, content, sha, rules()) for d, c, content, sha in rows())
        )
    connection.close()


def fill_postgresql(url: str) -> None:
    with psycopg.connect(url) as connection, connection.cursor() as cursor:
        with cursor.copy("COPY door FROM STDIN") as copy:
            for door, code, _, _ in rows():
                copy.write_row((door, code, 1))
        with cursor.copy("COPY recipe_version FROM STDIN") as copy:
            for door, code, content, sha in rows():
                copy.write_row((door, 1, code, *STAMP, content, sha, rules()))
    with psycopg.connect(url, autocommit=True) as connection:
        connection.execute("ANALYZE")


def lookups(name: str, ours: Callable[[str], object], plain: Callable[[str], object]) -> list[Entry]:
    """Both ways in turn with other bar codes each time, after a warm-up."""
    chance = random.Random(5)
    times: dict[Callable, list[float]] = {ours: [], plain: []}
    for number in range(LOOKUPS + 200):
        for call, taken in times.items():
            code = f"c{chance.randrange(RECIPES):010d}"
            start = time.perf_counter()
            call(code)
            if number >= 200:
                taken.append(time.perf_counter() - start)
    p99, median = np.percentile(times[ours], 99), np.median(times[ours])
    return [
        entry(f"recipe by bar code, {name}, 100,000 recipes, p99", p99, "s", "limit", LIMIT, LOOKUPS),
        entry(
            f"recipe by bar code, {name}, 100,000 recipes",
            median,
            "s",
            "driver and json.loads alone, no seal, no recipe",
            np.median(times[plain]),
            LOOKUPS,
        ),
    ]


def run() -> list[Entry]:
    entries: list[Entry] = []
    with tempfile.TemporaryDirectory(prefix="doormill_bench_") as folder:
        path = Path(folder) / "recipes.sqlite"
        with RecipeDatabase(str(path)) as database:
            fill_sqlite(path)
            plain = sqlite3.connect(path)
            statement = PLAIN.format("?")
            entries += lookups(
                "SQLite",
                database.find_bar_code,
                lambda code: json.loads(plain.execute(statement, (code,)).fetchone()[0]),
            )
            plain.close()
    with _server() as server:
        url = server.empty_database()
        with RecipeDatabase(url) as database, psycopg.connect(url, autocommit=True) as plain:
            fill_postgresql(url)
            statement = PLAIN.format("%s")
            entries += lookups(
                "PostgreSQL",
                database.find_bar_code,
                lambda code: json.loads(plain.execute(statement, (code,)).fetchone()[0]),
            )
    return entries


def _server():
    """The tests' PostgreSQL on loopback."""
    return postgres.running_server()
