"""A headless browser for the tests of pages; Chromium is installed once where it is missing."""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Page, expect, sync_playwright

from support.waiting import LIMIT

NAMES = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
TABLET = {"viewport": {"width": 1024, "height": 768}, "has_touch": True}


def _found() -> str | None:
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def browser_path() -> str:
    """The browser's executable; root gets it from apt, everybody else a sentence that says what to do."""
    if (path := _found()) is None and os.geteuid() == 0 and shutil.which("apt-get"):
        with open(Path(tempfile.gettempdir()) / "doormill-browser.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if _found() is None:
                _install()
        path = _found()
    if path is None:
        raise RuntimeError("no browser for the tests of pages; install one with: apt-get install -y chromium")
    return path


def _install() -> None:
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (["update"], ["install", "-y", "--no-install-recommends", "chromium"]):
        subprocess.run(["apt-get", "-qq", *command], env=environment, capture_output=True, timeout=LIMIT)


@contextmanager
def open_page(url: str, **context: object) -> Iterator[tuple[Page, list[str]]]:
    """A browser that shows `url`, and the errors the page has reported so far.

    Args:
        url: http or file address.
        context: Options of the browser context, for example `viewport`.
    """
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=ARGUMENTS)
        try:
            page = browser.new_context(**context).new_page()
            errors: list[str] = []
            page.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
            page.on("pageerror", lambda e: errors.append(str(e)))
            # A loaded machine must not turn a good page into a failed one.
            page.set_default_timeout(1000 * LIMIT)
            expect.set_options(timeout=1000 * LIMIT)
            page.goto(url)
            yield page, errors
        finally:
            browser.close()
