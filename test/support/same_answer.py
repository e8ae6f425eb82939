"""Diagnoses folders of sets and prints what came out as JSON: run once on every kind of machine to be compared.

`python -m support.same_answer FOLDER [--noise SEED]`: FOLDER holds measurement sets (`loading/*`) and pose sets
(`poses/*`); with `--noise` every number that was measured is multiplied by 1 + 1e-12 times a normal number.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.kind import Progress, run
from doormill_ros.diagnosis.loading.kind import LoadingTests
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.measurements.sets.measurement_set import MeasurementSet
from doormill_ros.measurements.sets.pose_set import PoseSet
from doormill_ros.thesis.run import run_thesis

#: Relative size of the noise: what another machine's rounding does to a number on its way here.
NOISE = 1e-12


def kernel() -> str:
    """Name of the kernel that NumPy's own OpenBLAS took; empty for another library."""
    for library in sorted((Path(np.__file__).parents[1] / "numpy.libs").glob("*openblas*")):
        name = ctypes.CDLL(str(library)).scipy_openblas_get_corename64_
        name.restype = ctypes.c_char_p
        return str(name().decode())
    return ""


def documents(folder: Path, seed: int | None) -> Iterator[tuple[str, dict[str, Any]]]:
    """Name and diagnosis.json of every set, of all pose sets together, and of the thesis."""
    rng = None if seed is None else np.random.default_rng(seed)

    def shaken(value: FloatArray) -> FloatArray:
        return value if rng is None else value * (1.0 + NOISE * rng.normal(size=value.shape))

    class Loading(LoadingTests):
        """Loading tests with noise on what was measured."""

        def read(self, folder: Path, progress: Progress) -> list[MeasurementSet]:
            return [
                _shaken(data, ("q", "wrench", "displacement"), shaken)
                for data in super().read(folder, progress)
            ]

    class Tracked(Poses):
        """Poses with noise on what was measured."""

        def read(self, folder: Path, progress: Progress) -> list[PoseSet]:
            return [_shaken(data, ("q", "position"), shaken) for data in super().read(folder, progress)]

    with TemporaryDirectory() as out:
        for path in sorted((folder / "loading").iterdir()):
            line = run(Loading(), [path], [], Path(out))
            yield path.name, _result(Path(out), line)
        line = run(Tracked(), sorted((folder / "poses").iterdir()), [], Path(out))
        yield "poses", _result(Path(out), line)
        yield "thesis", _result(Path(out), run_thesis(Path(out)))


def _shaken(data: Any, names: Sequence[str], shaken: Callable[[FloatArray], FloatArray]) -> Any:
    return replace(data, **{name: shaken(getattr(data, name)) for name in names})


def _result(out: Path, line: str) -> dict[str, Any]:
    model = (out / "model.yaml").read_text(encoding="utf-8")
    return {"line": line, "causes in the model": model.count("cause:")} | json.loads(
        (out / "diagnosis.json").read_text()
    )


def main() -> None:
    """Print one JSON object with all documents."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--noise", type=int)
    chosen = parser.parse_args()
    json.dump({"kernel": kernel(), **dict(documents(chosen.folder, chosen.noise))}, sys.stdout)


if __name__ == "__main__":
    main()
