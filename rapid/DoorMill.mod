MODULE DoorMill
    ! Mills one door a cycle: waits for it, asks the PC for the path, reads it, mills it, waits until it is taken out.
    ! Load with DoorText, DoorCell, DoorStop, DoorBack, DoorTool, DoorLink, DoorPath, DoorLine, DoorFile and the
    ! parameters of EIO.cfg and SYS.cfg; run main in continuous cycle.

    ! What is being milled, for displays: number in the file's motions, 0 between doors.
    PERS num millingMotion:=0;
    PERS string millingFeature:="";
    PERS bool millingCutting:=FALSE;

    PROC main()
        PrepareCell;
        LeadBack;
        RestoreTool;
        WaitForDoor;
        IF RequestPath() THEN
            IF AcceptPath() THEN
                MillMoves;
                FinishDoor;
            ELSE
                RefusePath;
            ENDIF
        ENDIF
    ERROR
        EndDoor TXT_ERROR,"ERRNO "+NumToStr(ERRNO,0);
        RETURN;
    ENDPROC

    LOCAL PROC PrepareCell()
        WatchRestart;
        ! Near a border of two configurations a calibrated arm may have either: what counts are the axes. Ways go to
        ! points of joint space, and no MoveJ to the configuration of a target.
        ConfL\Off;
        millingMotion:=0;
        StopSpindle;
        ShutDrawbar;
        Reset doPathRequest;
        RecallRuns;
    ENDPROC

    LOCAL FUNC bool AcceptPath()
        IF NOT ReadTargetFile() THEN
            RETURN FALSE;
        ENDIF
        ! Reading takes a while. A PC that lowered ready meanwhile has taken the file back.
        IF NOT PathReady() THEN
            refusal:=TXT_TAKEN_BACK;
            refusalDetail:=runId;
            RETURN FALSE;
        ENDIF
        IF doorChanged THEN
            refusal:=TXT_RELEASED;
            refusalDetail:=doorId;
            RETURN FALSE;
        ENDIF
        RememberRun;
        KeepTargetFile;
        IF NOT TellAccepted(runId) THEN
            refusal:=TXT_NO_ACK;
            refusalDetail:=ACCEPTED_FILE;
            RETURN FALSE;
        ENDIF
        stopReason:=0;
        ! Whoever sets it later does so for the next path: this one moves on as it began, watched as it began.
        dryDoor:=dryRun;
        SetOff;
        BeginEscape 1;
        EndEscape TRUE;
        doorSpent:=TRUE;
        doorInHand:=TRUE;
        ! Each door is named anew.
        ForgetName;
        Set doPathBusy;
        WatchDoor;
        ! Acknowledges: the whole path is in memory, the PC may do with the file what it likes.
        Reset doPathRequest;
        Show TXT_MILLING;
        TPWrite doorId;
        RETURN TRUE;
    ENDFUNC

    LOCAL PROC RefusePath()
        TellRefused refusal,refusalDetail;
        Set doPathFault;
        Reset doPathRequest;
        Report refusal,refusalDetail;
    ENDPROC

    LOCAL PROC MillMoves()
        BeginAtHome;
        FOR i FROM 1 TO moveCount DO
            StayWhenForgotten;
            IF moves{i}.spindle<>spindleSpeed THEN
                ! The motion before ended in a stop point, see ZoneBetween.
                SetSpindle moves{i}.spindle;
            ENDIF
            IF IsRackWork(moves{i}.kind) THEN
                Announce i;
                WorkAtRack moves{i};
            ELSE
                IF i=1 THEN
                    NoteEscape i;
                ELSEIF NOT SameWay(i-1,i) THEN
                    NoteEscape i;
                ENDIF
                Announce i;
                MillMove moves{i},ZoneBetween(i);
            ENDIF
        ENDFOR
        StayWhenForgotten;
        SetSpindle 0;
    ENDPROC

    LOCAL PROC MillMove(moverow row,zonedata zone)
        VAR speeddata speed;

        IF row.cutting AND (NOT dryDoor) AND (row.spindle<>spindleSpeed OR diSpindleAtSpeed=0) THEN
            EndDoor TXT_SPINDLE_LOST,"";
        ENDIF
        StayWhenForgotten;
        ! Reorientation and axis speeds of the predefined speeds, feed from the file.
        speed:=v100;
        speed.v_tcp:=row.speed;
        TEST row.kind
        CASE "A":
            MoveAbsJ points{row.target},speed,zone,toolMill\WObj:=wobjDoor;
        CASE "L":
            MoveL targets{row.target},speed,zone,toolMill\WObj:=wobjDoor;
        CASE "C":
            MoveC targets{row.via},targets{row.target},speed,zone,toolMill\WObj:=wobjDoor;
        ENDTEST
    ENDPROC

    LOCAL FUNC zonedata ZoneBetween(num number)
        ! The program runs ahead of the robot: it has to stand wherever a signal or another way back follows.
        IF number=moveCount THEN
            RETURN fine;
        ENDIF
        IF moves{number+1}.spindle<>moves{number}.spindle THEN
            RETURN fine;
        ENDIF
        IF NOT SameWay(number,number+1) THEN
            RETURN fine;
        ENDIF
        RETURN ZoneOf(moves{number}.zone);
    ENDFUNC

    LOCAL FUNC bool SameWay(num before,num after)
        ! The way home is the same one.
        IF IsWay(before) OR IsWay(after) THEN
            RETURN FALSE;
        ENDIF
        RETURN moves{before}.feature=moves{after}.feature;
    ENDFUNC

    LOCAL PROC NoteEscape(num number)
        ! How to get home from anywhere on this motion, kept for DoorStop. The robot stands at its beginning.
        VAR num feature;

        feature:=moves{number}.feature;
        IF IsWay(number) AND AtHome() THEN
            ! Between two tools; the way of this motion leads home by itself.
            BeginEscape 1;
            EndEscape TRUE;
        ELSEIF IsWay(number) THEN
            ! Back to where it stands now, the way this motion goes, and on as from here.
            EscapeOver CJointT(),moves{number}.kind="L";
        ELSE
            BeginEscape 0;
            FOR i FROM escapes{feature}.first TO escapes{feature}.last STEP 1 DO
                AddToEscape points{i};
            ENDFOR
            NotePath number,number;
            EndEscape TRUE;
        ENDIF
    ENDPROC

    LOCAL FUNC bool IsWay(num number)
        ! Not at a feature, or on a way that only the axes know.
        RETURN moves{number}.feature=0 OR moves{number}.kind="A";
    ENDFUNC

    LOCAL PROC Announce(num number)
        millingMotion:=number;
        pathLast:=number;
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
        BeginEscape 1;
        EndEscape TRUE;
        GoHome;
        StayWhenForgotten;
        IF dryDoor THEN
            EndDoor TXT_DRY_RUN,"";
        ENDIF
        doorInHand:=FALSE;
        WatchNothing;
        WaitForRest;
        TellMilled runId;
        ! Held until the next request, which does not come before the clamp opened. Busy falls after it rose: who sees
        ! neither takes the door for one that came to nothing.
        Set doPathDone;
        Reset doPathBusy;
        AllowClamp;
        Show TXT_MILLED;
        WaitUntilOut;
    ENDPROC
ENDMODULE
