"""Diagnoses folders of sets and prints what came out as JSON: run once on every kind of machine to be compared.

`python -m support.same_answer FOLDER [--noise SEED]`: FOLDER holds measurement sets (`loading/*`) and pose sets
(`poses/*`); with `--noise` every number that was measured is multiplied by 1 + 1e-12 times a normal number.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.loading import run as loading
from doormill_ros.diagnosis.pose import run as poses
from doormill_ros.measurements import measurement_set, pose_set
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

    def read_loading(path: Path) -> Any:
        data = measurement_set.read_measurement_set(path)
        return replace(
            data, **{name: shaken(getattr(data, name)) for name in ("q", "wrench", "displacement")}
        )

    def read_poses(path: Path) -> Any:
        data = pose_set.read_pose_set(path)
        return replace(data, **{name: shaken(getattr(data, name)) for name in ("q", "position")})

    loading.read_measurement_set, poses.read_pose_set = read_loading, read_poses
    with TemporaryDirectory() as out:
        for path in sorted((folder / "loading").iterdir()):
            line = loading.run_measurement_sets([path], [], Path(out), lambda text: None)
            yield path.name, _result(Path(out), line)
        line = poses.run_pose_sets(sorted((folder / "poses").iterdir()), [], Path(out), lambda text: None)
        yield "poses", _result(Path(out), line)
        yield "thesis", _result(Path(out), run_thesis(Path(out)))


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
