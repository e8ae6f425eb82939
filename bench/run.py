"""Run every `bench_*.py` beside this file and write out/bench/bench.json.

Each module has `run() -> list[Entry]`. Usage: `python bench/run.py [NAME ...]` runs those
whose file name contains one of the names. The exit code is 1 when a figure is above what is allowed.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parent / "test")]

from harness import Entry, exceeded, write  # noqa: E402


def main() -> int:
    """Run the chosen modules, print a line an entry, write the file; 1 when a limit is exceeded."""
    wanted = sys.argv[1:]
    entries: list[Entry] = []
    for path in sorted(HERE.glob("bench_*.py")):
        if wanted and not any(name in path.stem for name in wanted):
            continue
        print(f"== {path.stem}", flush=True)
        spec = importlib.util.spec_from_file_location(path.stem, path)
        module = importlib.util.module_from_spec(spec)
        sys.modules[path.stem] = module
        spec.loader.exec_module(module)
        for item in module.run():
            entries.append(item)
            print(
                f"{item.name}: {item.median:.4g} {item.unit}, {item.peer}: {item.peer_median:.4g} "
                f"{item.unit}, ratio {item.ratio:.1f} (n={item.n})"
                + (", ABOVE THE LIMIT" if exceeded(item) else ""),
                flush=True,
            )
    target = HERE.parent / "out" / "bench" / "bench.json"
    write(entries, target)
    print(target)
    above = sum(exceeded(item) for item in entries)
    if above:
        print(f"{above} of {len(entries)} figures are above what is allowed", file=sys.stderr)
    return 1 if above else 0


if __name__ == "__main__":
    sys.exit(main())
