"""Compile the statements and error handlers of a routine.

Page numbers are those of "RAPID Reference Manual, Basic Characteristics", yumpu.com 5679047.
"""

from __future__ import annotations

from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.calls import CallCompiler
from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop
from doormill_ros.simulation.controller.rapid.handlers import (
    OWN_RAISES,
    RERAISE,
    RETRY,
    RETRY_LIMIT,
    RETURN,
    TRYNEXT,
    Completion,
    Step,
    run_handler,
)
from doormill_ros.simulation.controller.rapid.operators import num
from doormill_ros.simulation.controller.rapid.scope import Frame, LocalSymbol, Names, RoutineInfo, Run
from doormill_ros.simulation.controller.rapid.types import (
    BOOL,
    NUM,
    AnyType,
    copy,
    is_composite,
    is_value,
)


class StatementCompiler(CallCompiler):
    """Compiles the body of one routine."""

    def __init__(
        self,
        file: str,
        context: Context,
        names: Names,
        routines: Names,
        types: Names,
        result: AnyType | None = None,
        slots: int = 0,
        trap: bool = False,
    ) -> None:
        """Compile for a file with what is visible in it.

        Args:
            file: The file.
            context: State of the running program.
            names: Data.
            routines: Routines.
            types: Data types.
            result: Type of what the routine returns, None for a procedure.
            slots: Slots of its frame that its parameters take.
            trap: Whether it is a trap routine.
        """
        super().__init__(file, context, names, routines, types)
        self.slots = slots
        self._result = result
        self._trap = trap
        self._in_handler = False
        self._handler: Step | None = None

    def new_slot(self) -> int:
        """One more slot of the routine's frame."""
        self.slots += 1
        return self.slots - 1

    def compile_body(self, body: s.Block, handler: s.Block | None) -> Step:
        """Code of a routine: gives the outcome RETURN, or None at its end."""
        if handler is not None:
            self._in_handler = True
            self._handler = self.block(handler)
            self._in_handler = False
        return self.block(body)

    def block(self, statements: s.Block) -> Step:
        """Code of a block; with an error handler it catches what its own statements raise."""
        compiled = [(node.line, self._statement(node)) for node in statements]
        context = self._context
        machine, file = context.machine, self._file
        interrupts = context.interrupts
        waiting = interrupts.queue

        def plain(frame: Frame) -> Completion | None:
            for line, run in compiled:
                context.line = line
                machine.statement(file, line)
                if waiting:
                    interrupts.serve()
                outcome = run(frame)
                if outcome is not None:
                    return outcome
            return None

        if self._handler is None or self._in_handler:
            return plain
        handler = self._handler

        def guarded(frame: Frame) -> Completion | None:
            for line, run in compiled:
                attempts = 0
                while True:
                    context.line = line
                    machine.statement(file, line)
                    if waiting:
                        interrupts.serve()
                    try:
                        outcome = run(frame)
                        break
                    except RapidFault as fault:
                        if fault.escaped is frame:
                            raise
                        decision = run_handler(context, handler, frame, fault)
                    if decision.word == TRYNEXT:
                        outcome = None
                        break
                    if decision.word != RETRY:
                        return decision
                    attempts += 1
                    if attempts > RETRY_LIMIT:
                        raise RapidStop(f"RETRY repeated line {line} {RETRY_LIMIT} times without success")
                if outcome is not None:
                    return outcome
            return None

        return guarded

    def _statement(self, node: s.Statement) -> Step:
        match node:
            case s.Assign():
                return self._assign(node)
            case s.Call():
                call = self.procedure(node)

                def run_call(frame: Frame) -> None:
                    call(frame)

                return run_call
            case s.If():
                return self._if(node)
            case s.For():
                return self._for(node)
            case s.While():
                return self._while(node)
            case s.Test():
                return self._test(node)
            case s.Return():
                return self._return(node)
            case s.Raise():
                return self._raise(node)
            case s.Retry() | s.TryNext():
                word = RETRY if isinstance(node, s.Retry) else TRYNEXT
                if not self._in_handler:
                    self.fail(node, f"{word} stands outside an ERROR clause: move it there")
                outcome = Completion(word)
                return lambda frame: outcome
            case s.Exit():
                return _exit
            case s.Connect():
                return self._connect(node)
        raise TypeError(f"no statement: {node!r}")

    def _assign(self, node: s.Assign) -> Step:
        kind, reference, symbol = self.reference(node.target)
        if symbol.storage in ("CONST", "LOOP", "SIGNAL"):
            what = {"CONST": "a constant", "LOOP": "a loop variable", "SIGNAL": "a signal"}[symbol.storage]
            self.fail(node, f"{symbol.name} is {what}, allowed on the left of := is VAR or PERS")
        if not is_value(kind):
            self.fail(node, f"{symbol.name} is {kind.name}, data of that type cannot be assigned")
        value = self.typed(node.value, kind, "the value")
        if is_composite(kind):

            def assign_copy(frame: Frame) -> None:
                new = copy(value(frame))
                container, index = reference(frame)
                container[index] = new

            return assign_copy

        def assign(frame: Frame) -> None:
            new = value(frame)
            container, index = reference(frame)
            container[index] = new

        return assign

    def _condition(self, node: s.Expression) -> Run:
        return self.typed(node, BOOL, "the condition")

    def _if(self, node: s.If) -> Step:
        branches = [(self._condition(condition), self.block(block)) for condition, block in node.branches]
        otherwise = self.block(node.otherwise)

        def run(frame: Frame) -> Completion | None:
            for condition, block in branches:
                if condition(frame):
                    return block(frame)
            return otherwise(frame)

        return run

    def _while(self, node: s.While) -> Step:
        condition, body = self._condition(node.condition), self.block(node.body)
        context, file, line = self._context, self._file, node.line

        def run(frame: Frame) -> Completion | None:
            while condition(frame):
                outcome = body(frame)
                if outcome is not None:
                    return outcome
                context.line = line
                context.machine.statement(file, line)
            return None

        return run

    def _for(self, node: s.For) -> Step:
        first = self.typed(node.first, NUM, "the first value")
        last = self.typed(node.last, NUM, "the last value")
        step = self.typed(node.step, NUM, "the step") if node.step is not None else None
        outer, slot = self._names, self.new_slot()
        self._names = Names(outer)
        self._names.add(node.name, LocalSymbol(node.name, NUM, "LOOP", slot))
        body = self.block(node.body)
        self._names = outer
        context, file, line = self._context, self._file, node.line

        def run(frame: Frame) -> Completion | None:
            value, end = first(frame), last(frame)
            # Without STEP the loop counts down when it has to: FROM 1 TO 0 runs twice.
            stride = step(frame) if step is not None else (1.0 if value <= end else -1.0)
            if stride == 0.0:
                raise RapidFault("ERR_ARGVALERR", "STEP 0 would never end")
            while value <= end if stride > 0.0 else value >= end:
                frame[slot] = value
                outcome = body(frame)
                if outcome is not None:
                    return outcome
                value = num(value + stride)
                context.line = line
                context.machine.statement(file, line)
            return None

        return run

    def _test(self, node: s.Test) -> Step:
        value = self.value(node.value)
        if not is_value(value.type):
            self.fail(node, f"TEST takes no {value.type.name}: use IF")
        cases = [
            ([self.typed(item, value.type, "the CASE") for item in items], self.block(block))
            for items, block in node.cases
        ]
        default, find = self.block(node.default), value.run

        def run(frame: Frame) -> Completion | None:
            found = find(frame)
            for items, block in cases:
                if any(item(frame) == found for item in items):
                    return block(frame)
            return default(frame)

        return run

    def _connect(self, node: s.Connect) -> Step:
        """An interrupt is identified by the variable, so that has to be a VAR intnum."""
        kind, reference, symbol = self.reference(node.interrupt)
        if kind != NUM or symbol.storage not in ("VAR", "INOUT"):
            self.fail(
                node, f"{symbol.name} is {symbol.storage} {kind.name}, allowed is VAR intnum: correct it"
            )
        trap = self._routines.find(node.trap)
        if not isinstance(trap, RoutineInfo) or not trap.trap:
            self.fail(node, f"{node.trap!r} is no trap routine, allowed after WITH is the name of a TRAP")
        interrupts = self._context.interrupts
        return lambda frame: interrupts.connect(reference(frame), trap)

    def _return(self, node: s.Return) -> Step:
        if node.value is None and self._result is None:
            nothing = Completion(RETURN)
            return lambda frame: nothing
        if node.value is None or self._result is None:
            allowed = "no value in a procedure" if self._result is None else f"a {self._result.name}"
            self.fail(node, f"RETURN has the wrong form, allowed is {allowed}: correct it")
        value = self.typed(node.value, self._result, "the returned value")
        if is_composite(self._result):
            return lambda frame: Completion(RETURN, copy(value(frame)))
        return lambda frame: Completion(RETURN, value(frame))

    def _raise(self, node: s.Raise) -> Step:
        if node.value is None:
            if not self._in_handler:
                self.fail(node, "RAISE without a number stands outside an ERROR clause: name the error")
            outcome = Completion(RERAISE)
            return lambda frame: outcome
        value = self.typed(node.value, NUM, "the error number")
        if self._in_handler:
            # Page 385: within the error handler the number may not be specified.
            self.fail(node, "RAISE with a number stands in an ERROR clause, allowed there is RAISE alone")
        if self._trap:
            # The system's error handler takes it, whatever ERROR clause the trap has:
            # RAPID reference manual part 1a, RAISE (yumpu.com 46511969, page 377).
            def stop(frame: Frame) -> None:
                raise RapidStop(f"RAISE {value(frame):g} in a trap routine")

            return stop

        def run(frame: Frame) -> None:
            number = value(frame)
            if number not in OWN_RAISES:
                raise RapidFault(
                    "ERR_ILLRAISE", f"RAISE {number:g}, allowed are 1 to {OWN_RAISES[-1]} and booked ones"
                )
            raise RapidFault(int(number), "raised by the program")

        return run


def _exit(_frame: Frame) -> None:
    raise RapidStop("the program ended itself with EXIT", by_program=True, pointer_lost=True)
