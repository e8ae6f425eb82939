"""Names of the signals between the PC and the controller, and how they look in a shared folder.

All of them are digital. The PC writes READY and nothing else; the controller writes the others.
READY is a virtual digital output with access level "All", so that Robot Web Services may set it and
RAPID waits for it with `WaitDO`; on a real input it is cross-connected on the controller.

    signal      who writes   meaning
    REQUEST     controller   high: the door is clamped, a target file is wanted;
                             falls when the file has been read (the acknowledgement)
    READY       PC           high: the file in place is complete, verified and meant for this request
    FAULT       controller   high: the file was refused; set before REQUEST falls, cleared before it rises
    BUSY        controller   high: a program is being milled
    DONE        controller   high: the last program was milled to its end; cleared when REQUEST rises

In a shared folder each signal is a file `<folder>/io/<signal>` that holds "0" or "1" and is replaced
atomically; a missing file reads as low.
"""

from __future__ import annotations

from typing import Final

REQUEST: Final = "doPathRequest"
READY: Final = "doPathReady"
FAULT: Final = "doPathFault"
BUSY: Final = "doPathBusy"
DONE: Final = "doPathDone"

CONTROLLER_SIGNALS: Final = (REQUEST, FAULT, BUSY, DONE)
PC_SIGNALS: Final = (READY,)
ALL_SIGNALS: Final = CONTROLLER_SIGNALS + PC_SIGNALS

IO_FOLDER: Final = "io"
LOW: Final = b"0"
HIGH: Final = b"1"

#: The name the thesis' program opens (figure 3.36).
TARGET_FILE: Final = "Hei2.txt"
#: Written by the robot program before REQUEST rises: a number, another one for each request. A request
#: that falls and rises between two looks of the PC is told from the earlier one by it.
REQUEST_FILE: Final = "Hei2.req"
#: Written by the PC before READY rises: the run id that READY announces and, on a second line, the
#: number of the request it answers. The robot program compares both, so neither an upload of an
#: earlier attempt that arrives late nor an answer to an earlier request is milled.
ORDER_FILE: Final = "Hei2.run"
