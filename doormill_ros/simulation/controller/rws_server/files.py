"""The file service: HOME and the RAM disk, written in place as a controller does."""

from __future__ import annotations

import os
import shutil
import time
from pathlib import Path

from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_INVALID,
    CODE_NO_FILE,
    CODE_NO_RESOURCE,
    CODE_NO_VOLUME,
    Item,
    RefusalError,
)

#: Where the RAM disk lies on the controller's own file system.
RAMDISK_PATH = "/hd0a/temp"


class Files:
    """Folders and files below the volumes; `$HOME/x` in 1.0 and `HOME/x` in 2.0 are the same file."""

    def __init__(self, cabinet: Cabinet, version: int) -> None:
        self._cabinet = cabinet
        self._version = version

    def path(self, address: str) -> Path:
        """A path inside a volume; what would leave it does not exist."""
        if f"/{address.lstrip('/')}/".startswith(f"{RAMDISK_PATH}/"):
            return self._inside(self._cabinet.ramdisk, address.lstrip("/")[len(RAMDISK_PATH) - 1 :])
        volume, _, rest = address.partition("/")
        mark = "$" if self._version == 1 else ""
        if volume.lower() == f"{mark}home":
            return self._inside(self._cabinet.home, rest)
        if volume.lower() in (f"{mark}ramdisk", f"{mark}temp"):
            return self._inside(self._cabinet.ramdisk, rest)
        if self._version == 1:
            raise RefusalError(404, CODE_NO_RESOURCE, "Resource does not exist")
        raise RefusalError(400, CODE_NO_VOLUME, "Virtual root does not exist")

    def is_folder(self, address: str) -> bool:
        """Whether a folder is there."""
        return self.path(address).is_dir()

    def read(self, address: str) -> bytes:
        """A file's bytes."""
        path = self.path(address)
        if not path.is_file():
            raise self._missing()
        return path.read_bytes()

    def entries(self, address: str) -> list[Item]:
        """Entries of a folder."""
        items = []
        for entry in sorted(os.scandir(self.path(address)), key=lambda e: e.name):
            stat = entry.stat()
            date = time.strftime("%Y-%m-%d T %H:%M:%S", time.localtime(stat.st_mtime))
            kind = "fs-dir" if entry.is_dir() else "fs-file"
            values = (
                {"fs-mdate": date} if entry.is_dir() else {"fs-size": str(stat.st_size), "fs-mdate": date}
            )
            items.append(Item(kind, entry.name, entry.name, values))
        return items

    def write(self, address: str, data: bytes) -> bool:
        """Write in place, as the controller does: not atomic. True when the file is new."""
        path = self.path(address)
        if not path.parent.is_dir():
            raise self._missing()
        new = not path.exists()
        try:
            with path.open("wb") as file:
                half = len(data) // 2
                file.write(data[:half])
                file.flush()
                file.write(data[half:])
        except OSError as error:
            raise RefusalError(500, CODE_INVALID, f"write failed: {error.strerror}") from error
        return new

    def delete(self, address: str) -> None:
        """Remove a file or folder."""
        path = self.path(address)
        if not path.exists():
            raise self._missing()
        shutil.rmtree(path) if path.is_dir() else path.unlink()

    def make_folder(self, address: str, name: str) -> None:
        """Create a folder."""
        if not name or "/" in name:
            raise RefusalError(400, CODE_INVALID, "fs-newname missing")
        self.path(f"{address.rstrip('/')}/{name}").mkdir(exist_ok=True)

    def _inside(self, volume: Path, relative: str) -> Path:
        root = volume.resolve()
        path = (root / relative.lstrip("/")).resolve()
        if path != root and root not in path.parents:
            raise self._missing()
        return path

    def _missing(self) -> RefusalError:
        code = CODE_NO_RESOURCE if self._version == 1 else CODE_NO_FILE
        return RefusalError(404, code, "Resource does not exist")
