"""The pendant of the simulated controller: its lines, its dialogs, and who answers them."""

from __future__ import annotations

import threading
from collections.abc import Callable

from doormill_ros.simulation.controller.rapid.errors import SignalError
from doormill_ros.simulation.controller.rapid.literals import parse_literal
from doormill_ros.simulation.controller.rapid.machine import Dialog, DialogAnswer, NumberField
from doormill_ros.simulation.controller.rapid.types import NUM


class TeachPendant:
    """What the operator sees and chooses; safe to use from several threads.

    Attributes:
        lines: What TPWrite wrote, in the order of time.
        dialogs: Every question that was shown, in the order of time.
        operator: Asked about each question when it is shown; what it gives is pressed, None leaves the
            question open until `press` is called.
    """

    def __init__(self) -> None:
        """Show nothing; nobody answers."""
        self.lines: list[str] = []
        self.dialogs: list[Dialog] = []
        self.operator: Callable[[Dialog], str | None] | None = None
        self._lock = threading.Lock()
        self._open: Dialog | None = None
        self._answer: DialogAnswer | None = None

    @property
    def dialog(self) -> Dialog | None:
        """The question that is open."""
        with self._lock:
            return self._open if self._answer is None else None

    @property
    def answer(self) -> DialogAnswer | None:
        """What was chosen since the question was shown."""
        with self._lock:
            return self._answer

    def show(self, dialog: Dialog | None) -> None:
        """Show a question; None takes it away."""
        with self._lock:
            self._open, self._answer = dialog, None
            if dialog is not None:
                self.dialogs.append(dialog)
        if dialog is not None and self.operator is not None:
            wanted = self.operator(dialog)
            if wanted is not None:
                self.press(wanted)

    def press(self, button: str, item: int = 0) -> None:
        """Press a button by its text, with an item of the list marked; or type a number and confirm it.

        Raises:
            SignalError: No question is open, it has no such button or item, or does not take the number.
        """
        with self._lock:
            dialog = self._open
            if dialog is None or self._answer is not None:
                raise SignalError(f"no dialog is open, so {button!r} cannot be pressed: wait for the dialog")
            item = item or dialog.chosen
            numbers = dict(dialog.buttons)
            typed = 0.0
            if dialog.field is not None:
                typed = _typed(dialog.header, dialog.field, None if button in numbers else button)
                button = button if button in numbers else dialog.buttons[0][0]
            if button in dialog.items and button not in numbers:
                # Without buttons a tap on an item is the choice.
                button, item = "", dialog.items.index(button) + 1
            number = numbers.get(button) if dialog.buttons else 0.0
            if number is None or not 0 <= item <= len(dialog.items):
                raise SignalError(
                    f"the dialog {dialog.header!r} has no button {button!r} or no item {item}, allowed are "
                    f"{', '.join(numbers) or 'its items'}",
                )
            self._answer = DialogAnswer(number, item, typed)


def _typed(header: str, field: NumberField, text: str | None) -> float:
    """The number in a field when it is confirmed; None for one into which nothing was typed."""
    number = field.initial if text is None else parse_literal(text, NUM)
    if number is None or not field.takes(number):
        kind = "whole numbers" if field.integer else "numbers"
        raise SignalError(
            f"the dialog {header!r} does not take {number if text is None else text!r}, allowed are {kind} "
            f"from {_limit(field.least)} to {_limit(field.largest)}",
        )
    return float(number)


def _limit(value: float | None) -> str:
    return "any" if value is None else f"{value:g}"
