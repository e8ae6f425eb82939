"""Point the CMake files of the ROS 2 wheels at this machine's Python.

The wheels name the include folders of the machine that built them, and CMake stops because
they do not exist here.
"""

from __future__ import annotations

import re
import sys
import sysconfig
from pathlib import Path

import numpy

PYTHON_INCLUDE = re.compile(r"/opt/python/[^/;\"]+/include/python3\.\d+")
NUMPY_INCLUDE = re.compile(r"/opt/python/[^/;\"]+/lib/python3\.\d+/site-packages/numpy/_?core/include")


def main() -> int:
    """Rewrite share/*/cmake/*.cmake in the running environment and say how many files changed."""
    changed = 0
    for path in sorted(Path(sys.prefix, "share").glob("*/cmake/*.cmake")):
        text = path.read_text(encoding="utf-8")
        fixed = NUMPY_INCLUDE.sub(numpy.get_include(), text)
        fixed = PYTHON_INCLUDE.sub(sysconfig.get_path("include"), fixed)
        if fixed != text:
            path.write_text(fixed, encoding="utf-8")
            changed += 1
    print(f"relocated {changed} CMake files of the ROS 2 wheels", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
