"""A sensor that the controller's request triggers: it reads once for each run, and again until that was used."""

from __future__ import annotations

import threading

from std_msgs.msg import Bool

from doormill_interfaces.msg import RunResult
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode


class RequestedSensor(ManagedNode):
    """Reads while the request is high; subclasses say what (`send`)."""

    def open_sensor(self, retry_period: float) -> None:
        """Subscribe; what nobody used is sent again after `retry_period` [s]."""
        self._run_id = ""
        self._wanted = self._request = False
        self._lock = threading.Lock()
        self.subscribe(topics.ABB_REQUEST, self._take_request)
        self.subscribe(topics.ABB_READY, self._take_ready)
        self.subscribe(topics.RUN_RESULT, self._take_result)
        self.every(retry_period, self.expose)

    def send(self, run_id: str) -> None:
        """Read, and publish what was read for that run."""
        raise NotImplementedError

    def is_new(self, run_id: str) -> bool:
        """Whether nothing of that run was wanted before."""
        return run_id != self._run_id

    def still_wanted(self, run_id: str) -> bool:
        """Whether a reading of that run may be sent now; one that took a while may come too late."""
        with self._lock:
            return self._wanted and self._request and run_id == self._run_id

    def want(self, run_id: str) -> None:
        """A door stands; from now on readings of it are sent when they are asked for."""
        with self._lock:
            self._run_id, self._wanted = run_id, True
        self.expose()

    def unwant(self, run_id: str) -> None:
        """No reading of that run is sent any more."""
        with self._lock:
            if run_id == self._run_id:
                self._wanted = False

    def expose(self) -> None:
        """Read once door and request are there; again until the targets are ready."""
        with self._lock:
            run_id, wanted = self._run_id, self._wanted
        if wanted and self._request:
            self.send(run_id)

    def _take_request(self, request: Bool) -> None:
        rose = request.data and not self._request
        self._request = request.data
        if rose:
            self.expose()

    def _take_ready(self, ready: Bool) -> None:
        if ready.data:
            self._forget()

    def _take_result(self, result: RunResult) -> None:
        if result.run_id == self._run_id:
            self._forget()

    def _forget(self) -> None:
        with self._lock:
            self._wanted = False
