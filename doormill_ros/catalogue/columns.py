"""The catalogue as columns in a Parquet file, for DuckDB, pandas and whatever else asks questions of tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, fields
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from doormill_ros.catalogue.errors import ColumnsFileError
from doormill_ros.catalogue.run import CataloguedInspection, CataloguedRun, CatalogueRow
from doormill_ros.files import write_atomically

GROUP = 50_000  # rows of a group in the file
_TYPES = {"str": pa.string(), "int": pa.int64(), "float": pa.float64(), "bool": pa.bool_()}
_TIME = pa.timestamp("ns", tz="UTC")
_NS = "_ns"


def schema() -> pa.Schema:
    """A column for each field of a run and of its inspection; times without `_ns`, in UTC."""
    found = []
    for field in (*fields(CataloguedRun), *fields(CataloguedInspection)[1:]):
        name, _, optional = str(field.type).partition(" | ")
        outer = field not in fields(CataloguedRun)
        kind = _TIME if field.name.endswith(_NS) else _TYPES[name]
        found.append(pa.field(field.name.removesuffix(_NS), kind, nullable=bool(optional) or outer))
    return pa.schema([*found, pa.field("kept", pa.string(), nullable=False)])


def write_columns(path: Path, rows: Iterable[CatalogueRow]) -> int:
    """Write a Parquet file at once; returns how many rows it has.

    Raises:
        ColumnsFileError: It cannot be written.
        CatalogueError: The rows cannot be read.
    """
    columns, stream, count = schema(), pa.BufferOutputStream(), 0
    rows = iter(rows)
    with pq.ParquetWriter(stream, columns, compression="zstd") as writer:
        while group := list(islice(rows, GROUP)):
            writer.write_table(pa.Table.from_pylist([*_values(group)], columns))
            count += len(group)
    try:
        write_atomically(path, stream.getvalue().to_pybytes())
    except OSError as error:
        raise ColumnsFileError(
            f"{path} cannot be written: {error.strerror or error}; name a file in a folder that is there"
        ) from error
    return count


def _values(rows: Iterable[CatalogueRow]) -> Iterator[dict[str, Any]]:
    for row in rows:
        values = {**asdict(row.run), **(asdict(row.inspection) if row.inspection else {}), "kept": row.kept}
        yield {name.removesuffix(_NS): value for name, value in values.items()}
