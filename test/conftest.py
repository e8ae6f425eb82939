"""A clean environment for every test: a ROS domain, a recipe database and a folder of its own."""

from __future__ import annotations

import faulthandler
import os
import shutil
import signal
import tempfile
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

from support.long_files import LONG

#: The same examples in every run, and no verdict by the clock.
settings.register_profile(
    "doormill",
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
settings.load_profile("doormill")
# Hypothesis also draws constants that it finds in the modules that happen to be loaded, and so other examples when
# other tests ran before in the same process. There is no setting for it.
if hasattr(providers, "is_local_module_file"):
    providers.is_local_module_file = lambda path: False

#: Domains up to 101 keep DDS below Linux' ephemeral ports.
FIRST_DOMAIN, DOMAINS = 20, 80
#: What a phase of a test may take beyond the test's time limit [s].
PATIENCE = 60.0
STDERR = pytest.StashKey[int]()
DATA = pytest.StashKey[str]()
#: What names a site, or a part of it, and goes before the folder of the user's data.
NAMED = ("DOORMILL_SITE", "DOORMILL_DATABASE", "DOORMILL_CATALOGUE")


def pytest_configure(config: pytest.Config) -> None:
    """Choose the domain once per process, before anything imports rclpy."""
    worker = os.environ.get("PYTEST_XDIST_WORKER", "gw0")
    number = (os.getpid() * 7 + int(worker.removeprefix("gw"))) % DOMAINS
    os.environ["ROS_DOMAIN_ID"] = str(FIRST_DOMAIN + number)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # Files that are read while tests are collected, and fixtures that live longer than a module.
    config.stash[DATA] = os.environ["XDG_DATA_HOME"] = tempfile.mkdtemp(prefix="doormill-tests-")
    for name in NAMED:
        os.environ.pop(name, None)
    # While a test runs, the number 2 stands for a file that is lost with the process.
    config.stash[STDERR] = os.dup(2)
    # Handed out file by file they would go by how many tests they have: the dearest, which have few, last.
    config.option.loadscopereorder = False


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove what was written beside the folders of tests."""
    shutil.rmtree(config.stash[DATA], ignore_errors=True)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the dearest files first; all others stay as they were found."""
    place = {Path(__file__).parent / name: number for number, name in enumerate(LONG)}
    items.sort(key=lambda item: place.get(item.path, len(LONG)))


def _end_standing(item: pytest.Item) -> Generator[None, None, None]:
    """End the process with the stacks of its threads where a phase stands still.

    The time limit of a test is a signal, which reaches nobody within a call of DDS, and tears down but once: what
    waits for ever after it would hold the whole run.
    """
    marker = item.get_closest_marker("timeout")
    limit = float(marker.args[0] if marker else item.config.getini("timeout"))
    faulthandler.dump_traceback_later(limit + PATIENCE, exit=True, file=item.config.stash[STDERR])
    try:
        return (yield)
    finally:
        faulthandler.cancel_dump_traceback_later()


pytest_runtest_setup = pytest.hookimpl(wrapper=True)(_end_standing)
pytest_runtest_call = pytest.hookimpl(wrapper=True)(_end_standing)
pytest_runtest_teardown = pytest.hookimpl(wrapper=True)(_end_standing)


@pytest.fixture(autouse=True)
def _own_signals() -> Iterator[None]:
    """What runs a node in this process leaves signals ignored, and processes that later tests start inherit that."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        if signal.getsignal(number) != handler:
            signal.signal(number, handler)


@pytest.fixture(scope="module", autouse=True)
def _own_user_data_of_a_module(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Nodes that serve all tests of a file have a site that no other file has."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("user_data")))
        yield


@pytest.fixture(autouse=True)
def _own_user_data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing reads or writes the user's recipes and catalogue."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    for name in NAMED:
        monkeypatch.delenv(name, raising=False)
