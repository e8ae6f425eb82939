"""The kinds of data that can be diagnosed: one line a kind, each in a folder of its own.

A kind says what its residual is and which causes can act there; search, examination, ties, words and document
are those of `core`. To add one: a folder with a problem (see `core.problem.Examined`) and what reads and runs
its sets, and a line here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from doormill_ros.diagnosis.loading.run import run_measurement_sets
from doormill_ros.diagnosis.pose.run import run_pose_sets
from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.measurement_set import SCHEMA as MEASUREMENT_SET
from doormill_ros.measurements.pose_set import SCHEMA as POSE_SET
from doormill_ros.measurements.set_document import SetDocument

#: Diagnoses sets, predicts sets to check, writes into a folder, tells of its progress; returns the verdict in a line.
Runner = Callable[[Sequence[Path], Sequence[Path], Path, Callable[[str], None]], str]

#: What to do with sets of a schema.
KINDS: dict[str, Runner] = {
    MEASUREMENT_SET: run_measurement_sets,
    POSE_SET: run_pose_sets,
}


def choose_runner(folders: Sequence[Path]) -> Runner:
    """The runner for the schema that all folders share.

    Raises:
        DataSetError: A set.yaml cannot be read, has an unknown schema, or the schemas differ.
    """
    schemas: dict[str, Path] = {}
    for folder in folders:
        document = SetDocument(folder / "set.yaml")
        schema = str(document.get("schema"))
        if schema not in KINDS:
            raise document.fail(("schema",), f"is {schema!r}, allowed are {', '.join(sorted(KINDS))}")
        schemas.setdefault(schema, folder)
    if len(schemas) > 1:
        mixed = " and ".join(f"{path / 'set.yaml'} has {schema}" for schema, path in schemas.items())
        raise SetMixError(f"{mixed}: sets given together need one schema")
    return KINDS[next(iter(schemas))]
