"""A Debian in a folder, booted by systemd-nspawn as a machine of its own."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

PROGRAMS = {"mmdebstrap": "mmdebstrap", "systemd-nspawn": "systemd-container", "nsenter": "util-linux"}
#: What a fresh machine has to have, and what a system needs to boot.
PACKAGES = ("git", "make", "cmake", "g++", "python3", "python3-venv", "python3-dev", "ca-certificates")
SYSTEM = ("systemd", "systemd-sysv", "dbus", "procps")
#: How this machine reaches its package index, which the new one has to reach as well.
INDEX = (
    "PIP_",
    "SSL_",
    "REQUESTS_",
    "CURL_",
    "http_proxy",
    "https_proxy",
    "HTTP_PROXY",
    "HTTPS_PROXY",
    "NO_PROXY",
)
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
MADE = 1800.0  # s, for packages and wheels
BOOTED = 180.0  # s
ANSWER = 300.0  # s
REBOOT = 133  #: how systemd-nspawn ends when its system wants to be booted again


def missing() -> list[str]:
    """What hinders a boot on this machine, each a sentence; nothing where it can be tried."""
    found = [
        f"{program} is not installed: apt install {package}"
        for program, package in PROGRAMS.items()
        if shutil.which(program) is None
    ]
    if os.geteuid() != 0:
        found.append("only root can boot a machine in a folder: run it as root")
    return found


def install(root: Path, source: Path) -> None:
    """Put Debian into a folder and the repository's last commit into its /opt/doormill, built.

    Raises:
        subprocess.CalledProcessError: A package, a wheel or the build failed; its output was shown.
    """
    included = ",".join((*PACKAGES, *SYSTEM))
    debian = ["mmdebstrap", "--quiet", "--variant=minbase", f"--include={included}", "bookworm", str(root)]
    subprocess.run(debian, check=True, timeout=MADE)
    subprocess.run(["git", "clone", "--quiet", str(source), str(root / "opt" / "doormill")], check=True)
    trusted = "etc/ssl/certs/ca-certificates.crt"
    if (Path("/") / trusted).exists():
        shutil.copyfile(Path("/") / trusted, root / trusted)
    settings = {name: value for name, value in os.environ.items() if name.startswith(INDEX)}
    build = [
        *("systemd-nspawn", "--quiet", f"--directory={root}", "--register=no", "--keep-unit"),
        *("--console=pipe", "--resolv-conf=copy-host", "--chdir=/opt/doormill"),
        *(f"--setenv={name}={value}" for name, value in settings.items()),
        *("make", "setup"),
    ]
    subprocess.run(build, check=True, timeout=MADE, stdin=subprocess.DEVNULL)


class Machine:
    """A booted system, which commands are run in.

    Args:
        root: Its folder, as `install` left it.
        log: File for what it says on its console.
    """

    def __init__(self, root: Path, log: Path) -> None:
        self._root, self._log = root, log
        self._process: subprocess.Popen[bytes] | None = None

    def boot(self) -> None:
        """Boot, with a network of its own.

        Raises:
            TimeoutError: It is not up in time.
        """
        command = [
            *("systemd-nspawn", "--quiet", f"--directory={self._root}", "--boot", "--private-network"),
            *("--register=no", "--keep-unit", "--console=pipe", "--kill-signal=SIGRTMIN+3"),
        ]
        with open(self._log, "ab") as log:
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT
            )
        self.wait_for("systemctl is-system-running", "running", BOOTED)

    def reboot(self) -> None:
        """Let the system start anew, as `systemctl reboot` does.

        Raises:
            TimeoutError: It did not go down, or is not up again in time.
        """
        assert self._process is not None
        self.run("systemctl reboot", check=False)
        try:
            status = self._process.wait(BOOTED)
        except subprocess.TimeoutExpired:
            raise TimeoutError(f"the machine did not go down within {BOOTED:g} s") from None
        if status != REBOOT:
            raise TimeoutError(f"the machine went down with {status}, wanted was a reboot ({REBOOT})")
        self.boot()

    def run(self, command: str, check: bool = True) -> str:
        """Run a command of a shell in it; what it says on both outputs.

        Raises:
            RuntimeError: It failed, and `check` is set.
        """
        inside = [
            "env",
            "-i",
            "--chdir=/",
            f"PATH={PATH}",
            "LANG=C.UTF-8",
            "HOME=/root",
            "TERM=dumb",
            "PAGER=cat",
        ]
        shell = ["bash", "-eu", "-o", "pipefail", "-c", command]
        entered = ["nsenter", "--target", self._init(), "--mount", "--uts", "--ipc", "--net", "--pid"]
        done = subprocess.run(
            [*entered, "--cgroup", "--root", *inside, *shell],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=ANSWER,
            check=False,
        )
        if check and done.returncode:
            raise RuntimeError(f"{command!r} ended with {done.returncode}: {done.stdout[-2000:]}")
        return done.stdout.strip()

    def wait_for(self, command: str, answer: str, limit: float) -> None:
        """Ask until a command answers as wanted.

        Raises:
            TimeoutError: It does not within `limit` [s].
        """
        until, said = time.monotonic() + limit, ""
        while time.monotonic() < until:
            said = self.run(command, check=False) if self._init() else ""
            if said == answer:
                return
            time.sleep(0.5)
        raise TimeoutError(f"{command!r} answers {said!r} after {limit:g} s, wanted was {answer!r}")

    def power_off(self) -> None:
        """Shut the system down, and pull the plug where it does not go."""
        if self._process is None:
            return
        if self._init():
            self.run("systemctl poweroff", check=False)
        try:
            self._process.wait(BOOTED)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _init(self) -> str:
        """Process number of the system's init outside of it; empty where none runs."""
        assert self._process is not None
        path = Path(f"/proc/{self._process.pid}/task/{self._process.pid}/children")
        # Between two boots there is none; the first child is the init, others ended with the boot.
        children = path.read_text().split() if path.exists() else []
        return children[0] if children else ""


@contextlib.contextmanager
def booted(folder: Path, source: Path) -> Iterator[Machine]:
    """A machine with the repository at `source` built in it, gone afterwards."""
    root = folder / "root"
    install(root, source)
    machine = Machine(root, folder / "console.log")
    try:
        machine.boot()
        yield machine
    finally:
        machine.power_off()
