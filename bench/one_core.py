"""Imported before numpy: one thread for its linear algebra, as other threads that wait for work count as work."""

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
