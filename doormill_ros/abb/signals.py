"""Names of the signals between the PC and the controller, and how they look in the simulated folder.

The PC writes READY and READY_NUMBER and nothing else; the controller writes the others. Both are virtual
outputs with access level "All", so that Robot Web Services may set them and RAPID waits for them.

    signal         who writes   meaning
    REQUEST        controller   high: the door is clamped, a target file is wanted;
                                falls when the file has been read (the acknowledgement)
    READY_NUMBER   PC           number of the request that the complete, verified file answers; 0: none.
                                The project's own program acts on nothing else: a stale number matches no request
    READY          PC           high with READY_NUMBER; all that the thesis' program knows
    FAULT          controller   high: the file was refused, or the door came to nothing; set before REQUEST
                                falls, cleared before it rises
    BUSY           controller   high: a program is being milled
    DONE           controller   high: the last program was milled to its end; held until the clamp opened,
                                cleared when REQUEST rises
    SPINDLE_LOAD   frequency    analog input: what the drive gives, percent of its nominal power;
                   converter    a controller may be without it

In the simulated folder each signal is a file `<folder>/io/<signal>` that holds "0" or "1", a group its decimal
number, an analog input a decimal fraction, and is replaced atomically; a missing file reads as low, and as no such
analog input.
"""

from __future__ import annotations

from typing import Final

REQUEST: Final = "doPathRequest"
READY: Final = "doPathReady"
FAULT: Final = "doPathFault"
BUSY: Final = "doPathBusy"
DONE: Final = "doPathDone"
READY_NUMBER: Final = "goPathReady"

CONTROLLER_SIGNALS: Final = (REQUEST, FAULT, BUSY, DONE)
PC_SIGNALS: Final = (READY,)
ALL_SIGNALS: Final = CONTROLLER_SIGNALS + PC_SIGNALS
#: Groups of 16 signals; the others are digital.
GROUP_SIGNALS: Final = (READY_NUMBER,)
LARGEST_NUMBER: Final = 65535
#: Not of the handshake, which knows nothing of it.
SPINDLE_LOAD: Final = "aiSpindleLoad"

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
#: Written by the robot program before REQUEST falls: the run id it accepted and the number of the request.
ACCEPTED_FILE: Final = "Hei2.ack"
#: Written by the robot program before FAULT rises where it can: number of the request, reason, detail.
REFUSED_FILE: Final = "Hei2.err"
#: Written by the robot program before DONE rises: the run that it milled to its end last.
MILLED_FILE: Final = "Hei2.end"
#: Written by whoever knows which door is being loaded (`abb/expect_door`); the robot program reads it once the door
#: is clamped, and removes it. Its last line says that the first one is whole: some transports write in place.
EXPECTED_FILE: Final = "Hei2.exp"
EXPECTED_END: Final = "#end"
