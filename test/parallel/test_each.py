"""Many things asked by two workers: whatever happens to a worker, every thing has its answer."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from pathlib import Path

import distributed
import pytest
from distributed import LocalCluster

from doormill_ros.parallel import answer as answering
from doormill_ros.parallel import workplace
from doormill_ros.parallel.each import Answered, each
from doormill_ros.parallel.errors import NoSchedulerError, OtherSoftwareError, WorkersDiedError
from doormill_ros.parallel.workplace import Workplace
from support.waiting import LIMIT
from support.worker_tasks import Task, square

COUNT = 12
TWO = Workplace(workers=2)


def by_number(tasks: list[Task], place: Workplace = TWO) -> dict[int, Answered[Task, object]]:
    answers = list(each(square, tasks, place))
    found = {answer.thing.number: answer for answer in answers}
    assert len(found) == len(answers) == len(tasks)
    return found


def test_a_lost_worker_loses_no_answer_and_a_poisoned_thing_is_named(tmp_path: Path) -> None:
    """One kills a worker once, one every worker, three raise; which ones the seed says."""
    killer, poison, refused, broken, leaving, odd = random.Random(7).sample(range(COUNT), 6)
    deaths = {killer: 1, poison: 99}
    endings = {refused: "refused", broken: "broken", leaving: "exit", odd: "lambda"}
    tasks = [Task(n, tmp_path, deaths.get(n, 0), endings.get(n, "")) for n in range(COUNT)]
    found = by_number(tasks)
    bad = {poison, *endings}
    assert {n: answer.value for n, answer in found.items() if n not in bad} == {
        n: n * n for n in range(COUNT) if n not in bad
    }
    assert len(list((tmp_path / str(killer)).iterdir())) >= 2
    assert (found[poison].value, found[poison].error_code) == (None, WorkersDiedError.code)
    assert found[poison].reason == f"task {poison}: 2 workers died of it; look at what it holds"
    assert (found[refused].error_code, found[refused].reason) == (140, "found no such door; ask for another")
    assert (found[broken].error_code, found[broken].reason) == (
        1,
        f"task {broken}: ValueError: something else",
    )
    assert (found[leaving].error_code, found[leaving].reason) == (1, f"task {leaving}: SystemExit: 3")
    assert "pickle" in found[odd].reason


def test_a_scheduler_and_its_workers_answer_by_the_same_call(tmp_path: Path) -> None:
    tasks = [Task(n, tmp_path) for n in range(COUNT)]
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0"
    ) as cluster:
        found = by_number(tasks, Workplace(cluster.scheduler_address))
        assert {n: answer.value for n, answer in found.items()} == {n: n * n for n in range(COUNT)}
        addresses = {worker.worker_address for worker in cluster.workers.values()}
        assert {answer.worker for answer in found.values()} <= addresses
    assert len(addresses) == 2


def test_a_scheduler_that_goes_away_is_told(tmp_path: Path) -> None:
    """It goes once the first answer is there and the second one is waited for."""
    tasks = [Task(0, tmp_path), Task(1, tmp_path, ending="hang")]
    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0"
    ) as cluster:
        answers = each(square, tasks, Workplace(cluster.scheduler_address))
        assert next(answers).value == 0
        cluster.close()
        with pytest.raises(NoSchedulerError, match="1 of the answers are missing"):
            next(answers)


def test_a_worker_with_other_software_gives_no_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(answering, "software", lambda: "0.0.9+abcdefabcdef")
    (answer,) = each(square, [Task(1, tmp_path)], Workplace(workers=1))
    assert (answer.value, answer.error_code) == (None, OtherSoftwareError.code)
    assert "asked by 0.0.9+abcdefabcdef" in answer.reason
    assert list(tmp_path.iterdir()) == []


def nowhere(task: Task) -> None:
    """Of a module that no worker can import."""


def test_a_worker_that_lacks_what_it_is_asked_says_so(tmp_path: Path) -> None:
    (answer,) = each(nowhere, [Task(1, tmp_path)], Workplace(workers=1))
    assert (answer.value, answer.error_code) == (None, 1)
    assert answer.reason.startswith("task 1: ModuleNotFoundError: ")


def test_a_worker_without_our_software_says_so(tmp_path: Path) -> None:
    """It is started where the package cannot be imported."""
    with LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as cluster:
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        environment["PYTHONPATH"] = str(Path(distributed.__file__).parents[1])
        command = [
            sys.executable,
            "-m",
            "distributed.cli.dask_worker",
            cluster.scheduler_address,
            "--no-nanny",
        ]
        worker = subprocess.Popen(command, env=environment, cwd=tmp_path, stderr=subprocess.DEVNULL)
        try:
            (answer,) = each(square, [Task(1, tmp_path)], Workplace(cluster.scheduler_address))
        finally:
            worker.kill()
            worker.wait()
    assert (answer.value, answer.error_code) == (None, OtherSoftwareError.code)
    assert "No module named 'doormill_ros" in answer.reason


def test_nothing_is_started_for_nothing() -> None:
    assert list(each(square, [], Workplace("tcp://127.0.0.1:1"))) == []


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nowhere", "tcp://nowhere.invalid:8786"])
def test_where_no_scheduler_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, address: str) -> None:
    monkeypatch.setattr(workplace, "CONNECTING", 1.0)
    with pytest.raises(NoSchedulerError, match="start one with dask scheduler"):
        list(each(square, [Task(1, tmp_path)], Workplace(address)))


#: In a process of its own: a cluster closed while it was asked may leave the library's event loop waiting.
WITHOUT_WORKERS = """
import pathlib, sys
from distributed import LocalCluster
from doormill_ros.parallel import workplace
from doormill_ros.parallel.each import each
from doormill_ros.parallel.errors import NoWorkerError
from support.worker_tasks import Task, square

if __name__ == "__main__":
    workplace.JOINING = 0.1
    with LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as cluster:
        try:
            list(each(square, [Task(1, pathlib.Path(sys.argv[1]))], workplace.Workplace(cluster.scheduler_address)))
        except NoWorkerError as error:
            print(error.message)
"""


def test_a_scheduler_without_workers(tmp_path: Path) -> None:
    script = tmp_path / "without_workers.py"
    script.write_text(WITHOUT_WORKERS)
    ended = subprocess.run(
        [sys.executable, script, tmp_path],
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert ended.returncode == 0, ended.stderr
    assert "has no worker; start some with dask worker" in ended.stdout
