"""Where many things are asked: processes that are started for it, or the workers of a scheduler."""

from __future__ import annotations

import logging
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from distributed import Client, LocalCluster, Security

from doormill_ros.parallel.errors import NoSchedulerError, NoWorkerError

CONNECTING = 10.0  #: s that a scheduler has to answer
RETRIES = 1  #: of what a worker of this machine died with; what is suspected is asked once more, alone
JOINING = 30.0  #: s that its first worker has to join


@dataclass(frozen=True)
class Workplace:
    """Where to ask.

    Attributes:
        scheduler: Address of a Dask scheduler, such as `tcp://10.0.0.5:8786`; empty for processes of this machine.
        workers: How many of those; 0 for one a core.
    """

    scheduler: str = ""
    workers: int = 0

    @contextmanager
    def client(self) -> Iterator[Client]:
        """A connection to it; processes are ended with it.

        Raises:
            NoSchedulerError: The scheduler cannot be reached.
            NoWorkerError: It has no worker.
        """
        if self.scheduler:
            with _connected(self.scheduler) as client:
                yield client
            return
        count = self.workers or len(os.sched_getaffinity(0))
        # Encrypted, with a certificate for this one run: a worker does what it is told, and other users of the
        # machine reach the loopback interface too.
        with (
            tempfile.TemporaryDirectory(prefix="doormill_workers_") as folder,
            LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",  # of its status pages; a fixed port on every interface otherwise
                local_directory=folder,
                scheduler_kwargs={"allowed_failures": RETRIES},
                silence_logs=logging.CRITICAL,
                security=Security.temporary(),
            ) as cluster,
            Client(cluster) as client,
        ):
            yield client


@contextmanager
def _connected(address: str) -> Iterator[Client]:
    # The library tells of broken connections in its own words, with tracebacks; ours follow. Some of its parts have
    # levels of their own.
    for name in ("distributed", *logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=CONNECTING)
    except (OSError, TimeoutError, ValueError) as error:
        raise NoSchedulerError(
            f"no Dask scheduler answers at {address}: {error}; start one with dask scheduler, or correct the address",
            address=address,
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=JOINING)
        except TimeoutError as error:
            raise NoWorkerError(
                f"the scheduler at {address} has no worker; start some with dask worker {address}",
                address=address,
            ) from error
        yield client
