"""The store of models: one folder with a record and a file for each version, shared by whoever has to do with it.

The record is replaced in one step and says alone what is in use; a model's file is there before the record names it
and is never written again. Writers take turns by a lock, readers need none.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from doormill_ros.errors import DoormillError
from doormill_ros.files import write_atomically
from doormill_ros.models.errors import (
    MillingStoppedError,
    ModelStoreError,
    OrderNotSignedError,
    UnknownVersionError,
    VersionInUseError,
)
from doormill_ros.models.record import ACCEPT, REVERT, MillingStop, ModelOrder, ModelVersion, StoreRecord
from doormill_ros.resources import MODELS, site_folder
from doormill_ros.robot_model.model_file import MODEL_FILE

RECORD, LOCK = "models.json", ".lock"
LONGEST = 500  # characters of who and why


@dataclass(frozen=True)
class ModelInUse:
    """A model and its version; 0 and "" for the one that the path generator was started with."""

    version: int = 0
    path: str = ""


def store_folder(named: str) -> Path:
    """The folder of a cell's store of models: the one that is named, else that of the site."""
    return Path(named) if named else site_folder() / MODELS


class ModelStore:
    """The models of a cell.

    Args:
        folder: Made when something is written first.
        now: What time it is.
    """

    def __init__(self, folder: Path, now: Callable[[], datetime] = lambda: datetime.now(UTC)) -> None:
        self.folder = Path(folder)
        self._now = now

    def record(self) -> StoreRecord:
        """Versions, orders and what stops milling; an empty record where nothing was written yet.

        Raises:
            ModelStoreError: The record cannot be read.
        """
        try:
            if (found := self._read()) is None and any(self.folder.glob(f"v*/{MODEL_FILE}")):
                found = self._read()  # of a writer that began meanwhile: its record came before the model
                if found is None:
                    raise self._useless("it is gone, and models are there")
            return found or StoreRecord()
        except RecursionError as error:
            raise self._useless("it is nested too deeply") from error
        except (OSError, ValueError) as error:
            raise self._useless(str(error)) from error

    def model(self, version: int) -> ModelInUse:
        """A version's model as it was proposed.

        Raises:
            ModelStoreError: The record or the model cannot be read, or the model was changed since.
            UnknownVersionError: No version has that number.
        """
        return self._model(self.record(), version)

    def for_next_run(self) -> ModelInUse:
        """The model that the next door is milled with.

        Raises:
            ModelStoreError: As `model`.
            MillingStoppedError: No door is to be milled.
        """
        record = self.record()
        if record.stop is not None and record.stop.version == record.in_use:
            raise MillingStoppedError(record.stop.message)
        return self._model(record, record.in_use)

    def propose(self, model: bytes, source: str) -> int:
        """Keep a model under a new version, for somebody to accept; puts nothing in use.

        Args:
            model: Content of its model.yaml.
            source: What proposes it.

        Returns:
            The version; one that is there already where it is the same model.

        Raises:
            ModelStoreError: It cannot be kept.
        """
        digest = hashlib.sha256(model).hexdigest()
        with self._writing() as record:
            last = record.version(record.proposed)
            known = next((one.number for one in record.versions if one.sha256 == digest), None)
            if known is not None:
                return known
            number = record.issued + 1
            folder = self._folder(number)
            # Of a writer that was killed before it wrote the record.
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            write_atomically(folder / MODEL_FILE, model, durable=True)
            self._write(record.with_proposal(ModelVersion(number, self._stamp(), source, digest)))
            if last is not None:
                shutil.rmtree(self._folder(last.number), ignore_errors=True)
        return number

    def withdraw(self) -> None:
        """Propose nothing any more.

        Raises:
            ModelStoreError: It cannot be written.
        """
        with self._writing() as record:
            if record.proposed:
                self._write(record.without_proposal())
                shutil.rmtree(self._folder(record.proposed), ignore_errors=True)

    def accept(self, version: int, who: str, why: str) -> int:
        """Put a model in use, from the next run on; returns its version.

        Raises:
            OrderNotSignedError: Who or why is empty.
            UnknownVersionError: No version has that number, or its proposal is outdated.
            VersionInUseError: It is in use already.
            ModelStoreError: The store cannot be read or written, or the model was changed since it was proposed.
        """
        who, why = _signed(who, why, "accept")
        with self._writing() as record:
            if version == 0:
                raise UnknownVersionError(
                    "version 0 was never proposed; take the model in use back to get there"
                )
            if version == record.in_use:
                raise VersionInUseError(f"version {version} is in use already; nothing is left to accept")
            self._model(record, version)
            self._write(
                record.with_order(ModelOrder(ACCEPT, version, record.in_use, self._stamp(), who, why))
            )
        return version

    def revert(self, version: int, who: str, why: str) -> int:
        """Take the model in use back, from the next run on; returns the version that is in use then.

        Raises:
            OrderNotSignedError: Who or why is empty.
            VersionInUseError: That version is not in use, or is the one that the path generator was started with.
            ModelStoreError: As `accept`.
        """
        who, why = _signed(who, why, "revert")
        with self._writing() as record:
            if version != record.in_use or version == 0:
                raise VersionInUseError(
                    f"version {version} cannot be taken back: version {record.in_use} is in use"
                    + (
                        "; name that one"
                        if record.in_use
                        else ", which is the model of before any acceptance"
                    )
                )
            before = record.before(version)
            self._model(record, before)
            self._write(record.with_order(ModelOrder(REVERT, before, version, self._stamp(), who, why)))
        return before

    def stop(self, message: str) -> None:
        """Let no door be milled with the model in use; an empty message lets them be milled again.

        Raises:
            ModelStoreError: It cannot be written.
        """
        with self._writing() as record:
            wanted = MillingStop(record.in_use, message) if message else None
            if record.stop != wanted:
                self._write(replace(record, stop=wanted))

    def _read(self) -> StoreRecord | None:
        try:
            text = (self.folder / RECORD).read_text(encoding="utf-8-sig")
        except FileNotFoundError:
            return None
        return StoreRecord.from_document(json.loads(text))

    def _model(self, record: StoreRecord, version: int) -> ModelInUse:
        if version == 0:
            return ModelInUse()
        known = record.version(version)
        if known is None:
            said = (
                "was outdated by a later proposal" if 0 < version <= record.issued else "was never proposed"
            )
            there = ", ".join(str(one.number) for one in record.versions) or "none"
            raise UnknownVersionError(
                f"version {version} of the model {said}; there are {there}: look at model/verdict and name one of them"
            )
        path = self._folder(version) / MODEL_FILE
        try:
            digest = hashlib.sha256(path.read_bytes()).hexdigest()
        except OSError as error:
            raise ModelStoreError(
                f"version {version} of the model cannot be read: {path}: {error.strerror}; revert it, or bring the "
                "file back",
                path=str(path),
            ) from error
        if digest != known.sha256:
            raise ModelStoreError(
                f"{path} is not what was proposed as version {version}: its sha256 is {digest[:12]}..., recorded is "
                f"{known.sha256[:12]}...; bring the file back, or revert the version",
                path=str(path),
            )
        return ModelInUse(version, str(path.resolve()))

    @contextmanager
    def held(self) -> Iterator[None]:
        """Let nobody change anything meanwhile, for who copies the folder, whatever state it is in."""
        try:
            lock = (self.folder / LOCK).open("rb")
        except FileNotFoundError:  # no writer was ever there
            yield
            return
        with lock:
            fcntl.flock(lock, fcntl.LOCK_SH)
            yield

    @contextmanager
    def _writing(self) -> Iterator[StoreRecord]:
        """The record while no other writer changes it."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with (self.folder / LOCK).open("w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                record = self.record()
                if not (self.folder / RECORD).exists():
                    self._write(record)  # before any model, so that a model without a record tells of a loss
                yield record
        except OSError as error:
            raise ModelStoreError(
                f"the store of models {self.folder} cannot be written: {error.strerror or error}; nothing was "
                "changed: make room there, or let its folder be written",
                path=str(self.folder),
            ) from error

    def _write(self, record: StoreRecord) -> None:
        text = json.dumps(record.document(), indent=2) + "\n"
        write_atomically(self.folder / RECORD, text, durable=True)

    def _folder(self, version: int) -> Path:
        return self.folder / f"v{version:04d}"

    def _stamp(self) -> str:
        return self._now().isoformat(timespec="seconds")

    def _useless(self, why: str) -> DoormillError:
        path = self.folder / RECORD
        return ModelStoreError(
            f"{path} cannot be used: {why}; bring it back from a copy, or move the whole folder away to begin with "
            "the model that the path generator is started with",
            path=str(path),
        )


def _signed(who: str, why: str, order: str) -> tuple[str, str]:
    who, why = who.strip()[:LONGEST], why.strip()[:LONGEST]
    if not who or not why:
        raise OrderNotSignedError(f"who is {who!r} and why {why!r}; to {order} a model both are wanted")
    return who, why
