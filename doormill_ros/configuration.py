"""Which configuration this process sees: a digest by which two machines are told apart."""

from __future__ import annotations

import hashlib

from doormill_ros.resources import CONFIG, resource, share_directory, site_folder
from doormill_ros.software import DIGITS

_ENDINGS = {".yaml", ".urdf"}


def configuration() -> str:
    """Digest of the files of config/ that count, the site's before the shipped.

    What nodes are told where they run (`nodes*.yaml`) is each machine's own business.

    Raises:
        OSError: A file cannot be read.
    """
    shipped, own = share_directory(), site_folder()
    names = {path.relative_to(shipped) for path in (shipped / CONFIG).rglob("*")}
    # What does not ship is found by its name in a folder, such as a robot of this site.
    names |= {path.relative_to(own) for path in (own / CONFIG).glob("*/**/*")}
    digest = hashlib.sha256()
    for name in sorted(name for name in names if name.suffix in _ENDINGS and not name.match("nodes*")):
        path = resource(name.as_posix())
        if path.is_file():
            digest.update(f"{name.as_posix()}\n".encode(errors="surrogateescape"))
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:DIGITS]
