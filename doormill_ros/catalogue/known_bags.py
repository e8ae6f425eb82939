"""Where the bag of a run lies, for who knows the run alone."""

from __future__ import annotations

from pathlib import Path

import sqlalchemy as sa

from doormill_ros.catalogue.database import ENVIRONMENT, FILE, Catalogue, Selection
from doormill_ros.errors import DoormillError
from doormill_ros.recipes.store.engine import default_url


def known_bag(run_id: str) -> Path | None:
    """The folder of the bag of a run, by the catalogue; None where there is none or the bag is gone.

    Args:
        run_id: Of the run.
    """
    url = default_url(ENVIRONMENT, FILE)
    try:
        # Who only looks makes no catalogue.
        if (file := sa.make_url(url)).drivername.startswith("sqlite") and not Path(
            file.database or ""
        ).is_file():
            return None
        with Catalogue(url) as catalogue:
            bags = [Path(row.run.bag) for row in catalogue.rows(Selection(run_id=run_id)) if row.run.bag]
    except (DoormillError, sa.exc.ArgumentError):
        return None
    return next((bag for bag in bags if bag.is_dir()), None)
