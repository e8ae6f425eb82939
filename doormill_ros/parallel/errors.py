"""What can be wrong when workers answer; codes 866..869."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class ManyError(DoormillError):
    """Base of the errors of questions to many things."""


NoSchedulerError = ManyError.row(
    "NoSchedulerError", 866, "The Dask scheduler cannot be reached, or went away before all was answered."
)
NoWorkerError = ManyError.row("NoWorkerError", 867, "The Dask scheduler has no worker.")
OtherSoftwareError = ManyError.row(
    "OtherSoftwareError",
    868,
    "A worker runs another software than this process, or with another configuration.",
)
WorkersDiedError = ManyError.row("WorkersDiedError", 869, "Every worker that tried it died of it.")
