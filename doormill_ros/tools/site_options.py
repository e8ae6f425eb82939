"""The options of tools that work on a site: its folder, and its database."""

from __future__ import annotations

import argparse
from pathlib import Path

from doormill_ros.backup.database import SiteDatabase
from doormill_ros.recipes.store.engine import ENVIRONMENT, FILE
from doormill_ros.resources import SITE, site_folder
from doormill_ros.tools.command_line import add_database


def add_site(parser: argparse.ArgumentParser) -> None:
    """Both options."""
    parser.add_argument(
        "--site",
        type=Path,
        metavar="DIR",
        help=f"default is ${SITE}, else a folder in the user's data folder",
    )
    add_database(parser, ENVIRONMENT)


def chosen_site(options: argparse.Namespace) -> tuple[Path, SiteDatabase]:
    """Folder and database; a folder that was named brings its own database, unless another is named.

    Raises:
        DatabaseUnreachable: Not a URL, or of another kind of database.
        BackupDatabaseError: It is in memory only.
    """
    own = str(options.site / FILE) if options.site else None
    return options.site or site_folder(), SiteDatabase(options.database or own)
