"""Where the bag of a run lies, for who knows the run alone."""

from __future__ import annotations

from pathlib import Path

from doormill_ros.catalogue.database import ENVIRONMENT, FILE, Catalogue, Selection
from doormill_ros.errors import DoormillError
from doormill_ros.recipes.store.engine import check_file, default_url


def known_bag(run_id: str) -> Path | None:
    """The folder of the bag of a run, by the catalogue; None where there is none or the bag is gone.

    Args:
        run_id: Of the run.
    """
    url = default_url(ENVIRONMENT, FILE)
    try:
        check_file(url)
        with Catalogue(url) as catalogue:
            bags = [Path(row.run.bag) for row in catalogue.rows(Selection(run_id=run_id)) if row.run.bag]
    except DoormillError:
        return None
    return next((bag for bag in bags if bag.is_dir()), None)
