"""The catalogue as a Parquet file, read by those it is meant for."""

from __future__ import annotations

from dataclasses import fields
from datetime import UTC, datetime
from pathlib import Path

import duckdb
import pandas as pd
import pytest

from doormill_ros.catalogue import columns
from doormill_ros.catalogue.columns import write_columns
from doormill_ros.catalogue.errors import ColumnsFileError
from doormill_ros.catalogue.run import CataloguedInspection, CataloguedRun, CatalogueRow

ROWS = [
    CatalogueRow(
        CataloguedRun(
            f"run_{number}",
            f"door_{number % 3}",
            begun_ns=1_795_350_600_123_456_789 + number,
            success=(True, False, None)[number % 3],
            deviation=None if number % 2 else number * 1e-5,
            bag_bytes=2**40 + number,
        ),
        CataloguedInspection(f"run_{number}", "/gauge", 10**18) if number == 4 else None,
        "asked for" if number == 5 else "",
    )
    for number in range(7)
]


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(columns, "GROUP", 3)  # several groups
    path = tmp_path / "runs.parquet"
    assert write_columns(path, ROWS) == 7
    return path


def test_duckdb_answers_questions_about_them(file: Path) -> None:
    worst = duckdb.sql(
        f"SELECT door_id, max(deviation) FROM '{file}' GROUP BY door_id ORDER BY door_id"
    ).fetchall()
    assert worst == [("door_0", 6 * 1e-5), ("door_1", 4 * 1e-5), ("door_2", 2 * 1e-5)]
    (refused,) = duckdb.sql(f"SELECT count(*) FROM '{file}' WHERE success IS NOT TRUE").fetchall()
    assert refused == (4,)
    begun = duckdb.sql(f"SELECT epoch_ns(begun) FROM '{file}' ORDER BY run_id").fetchall()
    assert [ns for (ns,) in begun] == [row.run.begun_ns for row in ROWS]


def test_pandas_reads_every_field(file: Path) -> None:
    frame = pd.read_parquet(file)
    named = [field.name.removesuffix("_ns") for field in fields(CataloguedRun)]
    assert list(frame.columns) == [*named, "inspection", "inspected", "kept"]
    assert frame["begun"].iloc[0] == pd.Timestamp(ROWS[0].run.begun_ns, tz="UTC")
    assert frame["deviation"].isna().tolist() == [False, True] * 3 + [False]
    assert frame["inspection"].notna().tolist() == [number == 4 for number in range(7)]
    assert frame["inspected"].iloc[4] == datetime(2001, 9, 9, 1, 46, 40, tzinfo=UTC)
    assert frame["kept"].tolist() == [""] * 5 + ["asked for", ""]
    assert frame["bag_bytes"].tolist() == [row.run.bag_bytes for row in ROWS]


def test_no_runs_are_columns_too(tmp_path: Path) -> None:
    assert write_columns(tmp_path / "none.parquet", []) == 0
    assert duckdb.sql(f"SELECT count(*), max(deviation) FROM '{tmp_path}/none.parquet'").fetchall() == [
        (0, None)
    ]


def test_where_nothing_can_be_written_nothing_is(tmp_path: Path) -> None:
    with pytest.raises(ColumnsFileError, match=r"runs\.parquet cannot be written"):
        write_columns(tmp_path / "nowhere" / "runs.parquet", ROWS)
    assert list(tmp_path.glob("**/*.parquet")) == []
