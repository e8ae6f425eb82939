"""Workers of Dask's scheduler as processes of their own, as on machines of their own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from distributed import LocalCluster


@contextmanager
def dask_workers(count: int, folder: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The address of a scheduler and its workers, which stand in a folder and are gone afterwards."""
    with LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as cluster:
        address = cluster.scheduler_address
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address]
        command = [*worker, "--no-nanny", "--nthreads", "1"]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        quiet = subprocess.DEVNULL
        processes = [
            subprocess.Popen(command, env=environment, cwd=folder, stdout=quiet, stderr=quiet)
            for _ in range(count)
        ]
        try:
            yield address, processes
        finally:
            for process in processes:
                process.kill()
                process.wait()
