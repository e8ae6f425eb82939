"""Telling a change of something that is looked at again and again, without looking at all of it."""

from __future__ import annotations

from typing import Any


class Marked:
    """An object that has another mark after each change of one of its attributes; for use by several threads.

    A counter would not do: of two threads that count at the same time, one can set it back to a number that a third
    has seen already.

    Attributes:
        mark: Who takes it and then looks has seen everything, as long as `mark` is the same object.
    """

    mark: object

    def __setattr__(self, name: str, value: Any) -> None:
        """Change something first and then the mark: who has the new mark has not looked before the change."""
        super().__setattr__(name, value)
        super().__setattr__("mark", object())
