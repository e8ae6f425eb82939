"""The kinds of data that can be diagnosed: one line a kind, each in a folder of its own.

A kind says what its residual is and which causes can act there; search, examination, doubles, margins, verdict, words,
document and page are those of `core`. To add one: a folder with a problem that robust least squares can fit (see
`core.problem.Examined`) and a `core.kind.SearchedKind`, and a line here. Where models are fitted and compared in
another way, the folder says just that: a `core.search.Search`, a `core.examination.Examiner` of what the members of its
models have to stand, and a `core.judgement.Question`.

What a kind needs is imported when it is made, and not to list it: all together take seconds, and a diagnosis is of one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from doormill_ros.diagnosis.listed_kind import FurtherOption, ListedKind
from doormill_ros.diagnosis.runs.limits import MOST
from doormill_ros.measurements.documents.schemas import (
    INSPECTION,
    MEASUREMENT_SET,
    MOTION_SET,
    PICTURE_SET,
    POSE_SET,
)
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.errors import SetMixError

if TYPE_CHECKING:
    from doormill_ros.diagnosis.core.kind import Kind


SPRINGS = "springs"  #: for --in-use: no model.yaml, the robot's own springs


def late_class(module: str, name: str) -> Callable[..., Kind[Any, Any]]:
    """What makes a kind by the full name of its module, imported then, and the name of its class there."""
    return lambda **told: getattr(import_module(module), name)(**told)


def _model(text: str) -> str:
    """As `Inspections` takes it."""
    return "" if text == SPRINGS else text


#: Every kind; `diagnose` takes its options from them.
KINDS = (
    ListedKind(MEASUREMENT_SET, late_class("doormill_ros.diagnosis.loading.kind", "LoadingTests")),
    ListedKind(POSE_SET, late_class("doormill_ros.diagnosis.pose.kind", "Poses")),
    ListedKind(MOTION_SET, late_class("doormill_ros.diagnosis.motion.kind", "Motions")),
    ListedKind(
        PICTURE_SET,
        late_class("doormill_ros.diagnosis.camera.kind", "Pictures"),
        "pictures",
        "pictures of a moved door",
    ),
    ListedKind(
        INSPECTION,
        late_class("doormill_ros.diagnosis.parts.kind", "Inspections"),
        "inspections",
        "one or many inspected doors",
        (
            FurtherOption(
                "in_use",
                "MODEL",
                f"model.yaml that the next door is corrected with, to tell what it leaves; {SPRINGS}: none",
                _model,
            ),
        ),
    ),
    ListedKind(
        "doormill/bags",
        late_class("doormill_ros.diagnosis.runs.kind", "Runs"),
        "runs",
        "bags of a series of runs, without a gauge",
        (
            FurtherOption(
                "last",
                "N",
                "the last runs only; bags that cannot be read are left aside and named",
                int,
                range(2, MOST + 1),
            ),
            FurtherOption("since", "RUN", "the first run that counts"),
        ),
    ),
)


def kind_of(folders: Sequence[Path]) -> ListedKind:
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
