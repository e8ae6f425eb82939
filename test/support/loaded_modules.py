"""What a new interpreter has imported."""

from __future__ import annotations

import subprocess
import sys


def loaded(code: str) -> set[str]:
    """Names of the modules that a new interpreter holds after some lines of code."""
    script = f"import sys\n{code}\nprint(*sys.modules)"
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(told.stdout.split())
