"""What programs are planned with, as it may change between runs: the store of models says which model is in use."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from doormill_ros.models.store import ModelInUse, ModelStore
from doormill_ros.pipeline.plan import MillingSetup, load_setup


@dataclass(frozen=True, eq=False)
class VersionedSetup:
    """A setup, and the version of its model; 0 for the model of the start."""

    setup: MillingSetup
    version: int


class SetupInUse:
    """The setup of the next run.

    Args:
        robot, model: As for `load_setup`; the model of version 0.
        store: Folder of the store of models; None for a cell without one.
        share: As for `load_setup`.

    Raises:
        DoormillError: What `load_setup` raises.
    """

    def __init__(self, robot: str, model: str, store: Path | None, share: str = "") -> None:
        self._robot = robot
        self._share = share
        self._model = model
        self._store = None if store is None else ModelStore(store)
        self._loaded = ModelInUse()
        self.now = VersionedSetup(load_setup(robot, model, share), 0)

    def for_next_run(self) -> VersionedSetup:
        """The setup with the model in use now; to be asked once a run.

        Raises:
            ModelStoreError: The store or the model in it cannot be used.
            MillingStoppedError: No door is to be milled.
            ExtendedModelError: The model in use is of another robot, or not of its form.
        """
        if self._store is None:
            return self.now
        wanted = self._store.for_next_run()
        if wanted != self._loaded:
            setup = load_setup(self._robot, wanted.path or self._model, self._share)
            self.now = VersionedSetup(setup, wanted.version)
            self._loaded = wanted
        return self.now
