"""Questions on the pendant: message boxes, lists, numbers and function keys.

Names of instructions, arguments, predefined data and errors: keyword lists of RAPID, github.com
KnoP/rapid-for-vim. Numbers of buttons and results, and the widths of the texts are [?].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import ERROR_NUMBERS, RapidFault, RapidStop
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.machine import Dialog, DialogAnswer, NumberField
from doormill_ros.simulation.controller.rapid.scope import Reference
from doormill_ros.simulation.controller.rapid.types import Value

#: buttondata: the texts and results of each set.
BUTTONS: dict[float, tuple[tuple[str, float], ...]] = {
    -1.0: (),
    0.0: (("OK", 1.0),),
    1.0: (("Abort", 2.0), ("Retry", 3.0), ("Ignore", 4.0)),
    2.0: (("OK", 1.0), ("Cancel", 5.0)),
    3.0: (("Retry", 3.0), ("Cancel", 5.0)),
    4.0: (("Yes", 6.0), ("No", 7.0)),
    5.0: (("Yes", 6.0), ("No", 7.0), ("Cancel", 5.0)),
}
#: Characters that are shown of a header, a line of text, a button and a list's item.
HEADER, LINE, BUTTON, ITEM = 40, 55, 42, 75
_LINES = 11
#: The keys of a question for a number take the room beside its text.
ENTRY_LINE, _ENTRY_LINES = 40, 9
_LIST_LINES = 512

_BREAKS = (
    "\\num MaxTime \\signaldi DIBreak \\switch DIPassive \\signaldo DOBreak \\switch DOPassive "
    "\\PERS bool PersBoolBreak \\switch PersBoolPassive \\VAR errnum BreakFlag"
)


@dataclass(frozen=True)
class _Breaks:
    """What ends a question without an answer; the arguments behind `_BREAKS`."""

    seconds: float | None
    input: str | None
    input_passive: bool
    output: str | None
    output_passive: bool
    data: Reference | None
    data_passive: bool
    flag: Reference | None

    @property
    def any(self) -> bool:
        """Whether there is one."""
        return not (self.seconds is None and self.input is None and self.output is None and self.data is None)

    def tests(self, context: Context) -> list[tuple[str, Callable[[], bool]]]:
        """Error and condition of each."""
        read = context.machine.read_signal
        found: list[tuple[str, Callable[[], bool]]] = []
        if self.input is not None:
            name, level = self.input, float(not self.input_passive)
            found.append(("ERR_TP_DIBREAK", lambda: read(name) == level))
        if self.output is not None:
            out, out_level = self.output, float(not self.output_passive)
            found.append(("ERR_TP_DOBREAK", lambda: read(out) == out_level))
        if self.data is not None:
            (container, index), wanted = self.data, not self.data_passive
            found.append(("ERR_TP_PERSBOOLBREAK", lambda: container[index] == wanted))
        return found


def _ask(context: Context, dialog: Dialog, breaks: _Breaks) -> DialogAnswer | None:
    """Show a question until it is answered; None when it was broken off and the flag took the reason."""
    machine = context.machine
    if breaks.flag is not None:
        breaks.flag[0][breaks.flag[1]] = 0.0
    if not dialog.buttons and not dialog.items and not breaks.any:
        raise RapidStop(f"{dialog.kind}: a question without buttons that nothing breaks off would never end")
    tests = breaks.tests(context)
    try:
        machine.show_dialog(dialog)
        done = machine.wait(
            lambda: machine.dialog_answer() is not None or any(test() for _, test in tests), breaks.seconds
        )
        answer = machine.dialog_answer()
    finally:
        machine.show_dialog(None)
    if answer is not None:
        return answer
    reason = next((name for name, test in tests if test()), tests[0][0]) if done else "ERR_TP_MAXTIME"
    if breaks.flag is None:
        raise RapidFault(reason, f"{dialog.kind} was broken off before it was answered")
    breaks.flag[0][breaks.flag[1]] = float(ERROR_NUMBERS[reason])
    return None


def _texts(
    what: str, header: str | None, lines: list[str], width: int = LINE, most: int = _LINES
) -> tuple[str, tuple[str, ...]]:
    """Header and lines, when the pendant has room for them."""
    if header is not None and len(header) > HEADER:
        raise RapidFault("ERR_STRTOOLNG", f"{what}: header of {len(header)} characters, allowed are {HEADER}")
    for line in lines:
        if len(line) > width:
            raise RapidFault("ERR_STRTOOLNG", f"{what}: line of {len(line)} characters, allowed are {width}")
    if len(lines) > most:
        raise RapidFault("ERR_ARGVALERR", f"{what}: {len(lines)} lines, allowed are {most}")
    return header or "", tuple(lines)


def _buttons(
    what: str, known: float | None, own: list[str] | None, otherwise: float
) -> tuple[tuple[str, float], ...]:
    """A set of buttons by its number, or texts of the program's own, numbered from 1."""
    if own is not None:
        if not 1 <= len(own) <= 5 or any(len(text) > BUTTON for text in own):
            raise RapidFault("ERR_UI_BUTTONS", f"{what}: {len(own)} buttons, allowed are 1 to 5 of {BUTTON}")
        return tuple((text, float(number)) for number, text in enumerate(own, 1) if text)
    number = otherwise if known is None else known
    if number not in BUTTONS:
        raise RapidFault("ERR_UI_BUTTONS", f"{what}: \\Buttons {number:g}, allowed are the constants btn...")
    return BUTTONS[number]


def _check_icon(what: str, icon: float | None) -> None:
    if icon is not None and icon not in (0.0, 1.0, 2.0, 3.0):
        raise RapidFault("ERR_UI_ICON", f"{what}: \\Icon {icon:g}, allowed are the constants icon...")


@predefined(
    "PROC UIMsgBox(\\string Header, string MsgLine1 \\string MsgLine2 \\string MsgLine3 \\string MsgLine4 "
    "\\string MsgLine5 \\switch Wrap \\buttondata Buttons \\icondata Icon \\string Image "
    f"\\INOUT btnres Result {_BREAKS})"
)
def ui_msg_box(context: Context, header: str | None, *arguments: Value) -> None:
    """Show a message with buttons; the button that was pressed is in Result."""
    given, (_wrap, buttons, icon, _image, result), breaks = arguments[:5], arguments[5:10], arguments[10:]
    _check_icon("UIMsgBox", icon)
    shown, lines = _texts("UIMsgBox", header, [line for line in given if line is not None])
    dialog = Dialog("UIMsgBox", shown, lines, _buttons("UIMsgBox", buttons, None, 0.0))
    answer = _ask(context, dialog, _Breaks(*breaks))
    if result is not None:
        result[0][result[1]] = answer.button if answer is not None else 0.0


@predefined(
    "FUNC num UIMessageBox(\\string Header \\string Message | string MsgArray{*} \\switch Wrap "
    "\\buttondata Buttons | string BtnArray{*} \\num DefaultBtn \\icondata Icon \\string Image "
    f"{_BREAKS})"
)
def ui_message_box(
    context: Context,
    header: str | None,
    message: str | None,
    several: list[str] | None,
    _wrap: bool,
    buttons: float | None,
    own: list[str] | None,
    default: float | None,
    icon: float | None,
    _image: str | None,
    *breaks: Value,
) -> float:
    """Show a message with buttons; gives the one that was pressed, or DefaultBtn when it was broken off."""
    _check_icon("UIMessageBox", icon)
    shown, lines = _texts("UIMessageBox", header, several or [message or ""])
    dialog = Dialog("UIMessageBox", shown, lines, _buttons("UIMessageBox", buttons, own, 0.0))
    answer = _ask(context, dialog, _Breaks(*breaks))
    return answer.button if answer is not None else default or 0.0


@predefined(
    "FUNC num UIListView(\\INOUT btnres Result \\string Header, listitem ListItems{*} "
    "\\buttondata Buttons | string BtnArray{*} \\icondata Icon \\num DefaultIndex "
    f"{_BREAKS})"
)
def ui_list_view(
    context: Context,
    result: Reference | None,
    header: str | None,
    items: list[Value],
    buttons: float | None,
    own: list[str] | None,
    icon: float | None,
    default: float | None,
    *breaks: Value,
) -> float:
    """Show a list; gives the number of the item that was chosen, 0 for none."""
    _check_icon("UIListView", icon)
    shown, _ = _texts("UIListView", header, [])
    texts = tuple(item[1] for item in items)
    if not 1 <= len(texts) <= _LIST_LINES or any(len(text) > ITEM for text in texts):
        raise RapidFault(
            "ERR_ARGVALERR", f"UIListView: {len(texts)} items, allowed are 1 to {_LIST_LINES} of {ITEM}"
        )
    dialog = Dialog(
        "UIListView", shown, (), _buttons("UIListView", buttons, own, -1.0), texts, int(default or 0)
    )
    answer = _ask(context, dialog, _Breaks(*breaks))
    if result is not None:
        result[0][result[1]] = answer.button if answer is not None else 0.0
    return float(answer.item if answer is not None else default or 0.0)


def _number_field(
    initial: float | None, least: float | None, largest: float | None, integer: bool
) -> NumberField:
    """The field of a question for a number, when its limits and what stands in it agree.

    Without an initial value 0 stands in it, and has to be within the limits too: the harsher reading [?].
    """
    field = NumberField(initial or 0.0, least, largest, integer)
    if least is not None and largest is not None and least > largest:
        raise RapidFault("ERR_UI_MAXMIN", f"UINumEntry: \\MinValue {least:g} above \\MaxValue {largest:g}")
    given = (field.initial, *(limit for limit in (least, largest) if limit is not None))
    if integer and not all(number.is_integer() for number in given):
        raise RapidFault("ERR_UI_NOTINT", f"UINumEntry: {given} with \\AsInteger, allowed are whole numbers")
    if not field.takes(field.initial):
        raise RapidFault("ERR_UI_INITVALUE", f"UINumEntry: \\InitValue {field.initial:g} beyond the limits")
    return field


@predefined(
    "FUNC num UINumEntry(\\string Header \\string Message | string MsgArray{*} \\switch Wrap \\icondata Icon "
    f"\\num InitValue \\num MinValue \\num MaxValue \\switch AsInteger {_BREAKS})"
)
def ui_num_entry(
    context: Context,
    header: str | None,
    message: str | None,
    several: list[str] | None,
    _wrap: bool,
    icon: float | None,
    *arguments: Value,
) -> float:
    """Ask for a number; gives the one that was confirmed, or InitValue when it was broken off."""
    (initial, least, largest, integer), breaks = arguments[:4], arguments[4:]
    _check_icon("UINumEntry", icon)
    shown, lines = _texts("UINumEntry", header, several or [message or ""], ENTRY_LINE, _ENTRY_LINES)
    field = _number_field(initial, least, largest, integer)
    answer = _ask(context, Dialog("UINumEntry", shown, lines, BUTTONS[0.0], field=field), _Breaks(*breaks))
    return answer.typed if answer is not None else field.initial


@predefined(
    "PROC TPReadFK(INOUT num TPAnswer, string TPText, string TPFK1, string TPFK2, string TPFK3, string TPFK4, "
    f"string TPFK5 {_BREAKS})"
)
def tp_read_fk(context: Context, place: Reference, text: str, *arguments: Value) -> None:
    """Ask for one of five function keys."""
    keys, breaks = arguments[:5], arguments[5:]
    buttons = tuple((key, float(number)) for number, key in enumerate(keys, 1) if key)
    context.machine.pendant(text)
    answer = _ask(context, Dialog("TPReadFK", "", (text,), buttons), _Breaks(*breaks))
    if answer is not None:
        place[0][place[1]] = answer.button
