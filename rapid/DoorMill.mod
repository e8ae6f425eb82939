MODULE DoorMill
    ! Mills one door a cycle: asks the PC for the path, reads it, mills it.
    ! Load with DoorFile.mod, DoorCell.mod and the signals of EIO.cfg; run main in continuous cycle.

    CONST num READY_FALL_TIMEOUT:=30;
    CONST num PATH_TIMEOUT:=600;

    VAR errnum ERR_DOOR_RELEASED:=-1;

    ! What is being milled, for displays: number in the file's motions, 0 between doors.
    PERS num millingMotion:=0;
    PERS string millingFeature:="";
    PERS bool millingCutting:=FALSE;

    PROC main()
        VAR errnum problem;

        PrepareCell;
        RequestPath;
        ReadTargetFile;
        ConfirmReady;
        AcceptPath;
        MillMoves;
        FinishDoor;
    ERROR
        problem:=ERRNO;
        IF problem=ERR_FILE_REFUSED THEN
            RefusePath;
            RETURN;
        ENDIF
        StopSafely;
        IF problem=ERR_WAIT_MAXTIME THEN
            Report "A signal did not come in time.","See the event log for the signal.";
        ELSEIF problem=ERR_DOOR_RELEASED THEN
            Report "The door was released while milling.","Clear the tool before going on.";
        ELSE
            Report "The program stopped with an error.","ERRNO "+NumToStr(problem,0);
        ENDIF
        ! Not to be continued from here: jog the tool clear, run MoveHome, start at main.
        EXIT;
    ENDPROC

    LOCAL PROC PrepareCell()
        IF ERR_DOOR_RELEASED=-1 THEN
            BookErrNo ERR_DOOR_RELEASED;
        ENDIF
        ConfJ\On;
        ConfL\On;
        millingMotion:=0;
        StopSpindle;
        Reset doPathRequest;
        Reset doPathBusy;
        IF NOT AtHome() THEN
            ! From anywhere else the way home may lead through a door.
            Report "The robot is not at home.","Jog it clear of the door and run MoveHome.";
            EXIT;
        ENDIF
    ENDPROC

    LOCAL PROC RequestPath()
        WaitDI diDoorClamped,1\MaxTime:=CLAMP_TIMEOUT;
        ! A ready signal that is still high belongs to an earlier file.
        WaitDO doPathReady,0\MaxTime:=READY_FALL_TIMEOUT;
        Reset doPathFault;
        Reset doPathDone;
        NumberRequest;
        Set doPathRequest;
        WaitDO doPathReady,1\MaxTime:=PATH_TIMEOUT;
    ENDPROC

    LOCAL PROC ConfirmReady()
        ! Reading takes a while. A PC that lowered ready meanwhile has taken the file back.
        IF doPathReady=0 THEN
            refusal:="The PC took the target file back.";
            refusalDetail:=runId;
            RAISE ERR_FILE_REFUSED;
        ENDIF
    ENDPROC

    LOCAL PROC AcceptPath()
        RememberRun;
        Set doPathBusy;
        ! Acknowledges: the whole path is in memory, the PC may do with the file what it likes.
        Reset doPathRequest;
        TPWrite "Milling door:";
        TPWrite doorId;
    ENDPROC

    LOCAL PROC RefusePath()
        Set doPathFault;
        Reset doPathRequest;
        Report refusal,refusalDetail;
    ENDPROC

    LOCAL PROC MillMoves()
        FOR i FROM 1 TO moveCount DO
            IF diDoorClamped=0 THEN
                RAISE ERR_DOOR_RELEASED;
            ENDIF
            IF moves{i}.spindle<>spindleSpeed THEN
                ! The motion before ended in a stop point, see ZoneBetween.
                RunSpindle moves{i}.spindle;
            ENDIF
            Announce i;
            IF i=1 THEN
                Approach targets{moves{i}.target};
            ENDIF
            MillMove moves{i},ZoneBetween(i);
        ENDFOR
        StopSpindle;
    ENDPROC

    LOCAL PROC Approach(robtarget first)
        ! The home position has another configuration than the path; only MoveJ can change it.
        MoveJ first,v500,fine,toolMill\WObj:=wobjDoor;
    ENDPROC

    LOCAL PROC MillMove(moverow row,zonedata zone)
        VAR speeddata speed;

        ! Reorientation and axis speeds of the predefined speeds, feed from the file.
        speed:=v100;
        speed.v_tcp:=row.speed;
        TEST row.kind
        CASE "J":
            MoveJ targets{row.target},speed,zone,toolMill\WObj:=wobjDoor;
        CASE "L":
            MoveL targets{row.target},speed,zone,toolMill\WObj:=wobjDoor;
        CASE "C":
            MoveC targets{row.via},targets{row.target},speed,zone,toolMill\WObj:=wobjDoor;
        ENDTEST
    ENDPROC

    LOCAL FUNC zonedata ZoneBetween(num number)
        ! The program runs ahead of the robot: it has to stand wherever a signal follows.
        IF number=moveCount THEN
            RETURN fine;
        ENDIF
        IF moves{number+1}.spindle<>moves{number}.spindle THEN
            RETURN fine;
        ENDIF
        RETURN ZoneOf(moves{number}.zone);
    ENDFUNC

    LOCAL PROC Announce(num number)
        millingMotion:=number;
        millingCutting:=moves{number}.cutting;
        IF moves{number}.feature=0 THEN
            millingFeature:="";
        ELSE
            millingFeature:=features{moves{number}.feature};
        ENDIF
    ENDPROC

    LOCAL PROC FinishDoor()
        millingMotion:=0;
        millingFeature:="";
        millingCutting:=FALSE;
        MoveHome;
        Reset doPathBusy;
        Set doPathDone;
        TPWrite "Door is milled.";
    ENDPROC

    LOCAL PROC StopSafely()
        ! The robot first, then the spindle: a tool at rest in moving contact breaks.
        StopMove\Quick;
        ClearPath;
        StopSpindle;
        Set doPathFault;
        Reset doPathRequest;
        Reset doPathBusy;
        StartMove;
    ENDPROC

    LOCAL PROC Report(string reason,string detail)
        TPWrite reason;
        TPWrite detail;
        ErrWrite "Door milling",reason\RL2:=detail;
    ENDPROC
ENDMODULE
