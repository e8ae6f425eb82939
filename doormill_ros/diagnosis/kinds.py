"""The kinds of data that can be diagnosed: one line a kind, each in a folder of its own.

A kind says what its residual is and which causes can act there; search, examination, doubles, margins, verdict, words,
document and page are those of `core`. To add one: a folder with a problem that robust least squares can fit (see
`core.problem.Examined`) and a `core.kind.SearchedKind`, and a line here. Where models are fitted and compared in
another way, the folder says just that: a `core.search.Search`, a `core.examination.Examiner` of what the members of its
models have to stand, and a `core.judgement.Question`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from doormill_ros.diagnosis.camera.kind import Pictures
from doormill_ros.diagnosis.core.kind import Kind
from doormill_ros.diagnosis.loading.kind import LoadingTests
from doormill_ros.diagnosis.motion.kind import Motions
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.diagnosis.runs.kind import Runs
from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.set_document import SetDocument

#: Every kind; `diagnose` takes its options from them.
KINDS: tuple[Kind[Any, Any], ...] = (
    LoadingTests(),
    Poses(),
    Motions(),
    Pictures(),
    Inspections(),
    Runs(),
)


def kind_of(folders: Sequence[Path]) -> Kind[Any, Any]:
    """The kind of the schema that the set.yaml of all folders share.

    Raises:
        DataSetError: A set.yaml cannot be read, has an unknown schema, or the schemas differ.
    """
    kinds = {kind.schema: kind for kind in KINDS}
    schemas: dict[str, Path] = {}
    for folder in folders:
        document = SetDocument(folder / "set.yaml")
        schema = str(document.get("schema"))
        if schema not in kinds:
            raise document.fail(("schema",), f"is {schema!r}, allowed are {', '.join(sorted(kinds))}")
        schemas.setdefault(schema, folder)
    if len(schemas) > 1:
        mixed = " and ".join(f"{path / 'set.yaml'} has {schema}" for schema, path in schemas.items())
        raise SetMixError(f"{mixed}: sets given together need one schema")
    return kinds[next(iter(schemas))]
