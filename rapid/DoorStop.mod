MODULE DoorStop
    ! What ends a door before its time, and the way back to home.
    !
    ! Whatever happens while a door is in hand, the robot stops, the spindle is switched off, and main begins
    ! anew: nothing of the path that is left is ever moved on. Traps see spindle, clamp and guard; the event
    ! routines (SYS.cfg) see stops, emergency stops and power failures.

    CONST num MAX_ESCAPE:=20;

    ! From the acceptance of a path until the robot is home again.
    PERS bool doorInHand:=FALSE;
    ! From the acceptance until the clamp opened: this door is never asked for again. So is one that a program without
    ! a memory finds in the clamp: it may be half milled.
    PERS bool doorSpent:=TRUE;
    ! Number of the text that says why the door in hand ended, 0 while it goes on.
    PERS num stopReason:=0;
    VAR string stopDetail:="";
    ! The program moves the robot along a way that was planned; where it stands then is where it stopped.
    PERS bool underWay:=FALSE;
    ! Where the robot stood then, and whether that is known.
    PERS jointtarget stoppedAt:=[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    PERS bool stoppedKnown:=FALSE;

    ! The way home from where the robot is: first the points from escapeNext on, then home. With escapeNext 0
    ! it is at a feature: back along its path (DoorBack), on to the first point, then as before.
    PERS jointtarget escape{MAX_ESCAPE}:=[
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]];
    PERS num escapeCount:=0;
    PERS num escapeNext:=0;
    PERS bool escapeKnown:=FALSE;

    ! The clamp opened since WatchLeaving: whatever it holds now is another door than the one that was named.
    VAR bool doorChanged:=FALSE;

    ! A robot that stands farther from where it stopped was jogged [deg].
    LOCAL CONST num STOPPED_TOLERANCE:=0.5;

    ! Motions of a door are left in the program.
    LOCAL VAR bool motionsLeft:=FALSE;
    ! They were forgotten, until main begins anew.
    LOCAL VAR bool motionsForgotten:=FALSE;
    LOCAL VAR bool escapeFits:=TRUE;
    LOCAL VAR intnum spindleLost;
    LOCAL VAR intnum doorReleased;
    LOCAL VAR intnum guardOpened;
    LOCAL VAR intnum toolLost;
    LOCAL VAR intnum doorLeft;
    LOCAL VAR intnum goneOn;

    PROC WatchRestart()
        ! For as long as the program runs.
        WatchNothing;
        IDelete goneOn;
        Reset doMillAbort;
        CONNECT goneOn WITH OnGoneOn;
        ISignalDO doMillAbort,1,goneOn;
        motionsLeft:=FALSE;
        motionsForgotten:=FALSE;
        ! A start at main comes out of DoorRestarted too.
        StartMove;
    ENDPROC

    PROC WatchNothing()
        IDelete spindleLost;
        IDelete doorReleased;
        IDelete guardOpened;
        IDelete toolLost;
    ENDPROC

    PROC WatchLeaving()
        ! From the clamping on: a door that is changed for another while the PC works or the file is read.
        IDelete doorLeft;
        doorChanged:=FALSE;
        CONNECT doorLeft WITH OnDoorLeft;
        ISignalDI diDoorClamped,0,doorLeft;
        IF diDoorClamped=0 THEN
            doorChanged:=TRUE;
        ENDIF
    ENDPROC

    PROC WatchDoor()
        CONNECT spindleLost WITH OnSpindleLost;
        ISignalDI diSpindleAtSpeed,0,spindleLost;
        ISleep spindleLost;
        CONNECT doorReleased WITH OnDoorReleased;
        ISignalDI diDoorClamped,0,doorReleased;
        IF NOT dryDoor THEN
            CONNECT guardOpened WITH OnGuardOpened;
            ISignalDI diGuardClosed,0,guardOpened;
        ENDIF
        ! The drawbar opens at the rack, where the spindle stands.
        CONNECT toolLost WITH OnToolLost;
        ISignalDI diToolClamped,0,toolLost;
        ISleep toolLost;
        IDelete doorLeft;
        ! An interrupt comes with the change: what was so before is looked at here.
        IF diDoorClamped=0 OR doorChanged THEN
            EndDoor TXT_RELEASED,"";
        ENDIF
    ENDPROC

    PROC SetSpindle(num speed)
        ! Another speed for the spindle, watched from then on.
        VAR num reason;

        IF dryDoor THEN
            IF OpMode()=OP_AUTO THEN
                EndDoor TXT_DRY_RUN,"";
            ENDIF
            RETURN;
        ENDIF
        ISleep spindleLost;
        ISleep toolLost;
        IF speed>0 THEN
            IF diGuardClosed=0 THEN
                Show TXT_WAIT_GUARD;
                WaitDI diGuardClosed,1;
            ENDIF
            IWatch toolLost;
            IF diToolClamped=0 THEN
                EndDoor TXT_TOOL_LOOSE,"";
            ENDIF
        ENDIF
        reason:=RunSpindle(speed);
        IF reason<>0 THEN
            EndDoor reason,"";
        ENDIF
        IF speed>0 THEN
            IWatch spindleLost;
            IF diSpindleAtSpeed=0 THEN
                EndDoor TXT_SPINDLE_LOST,"";
            ENDIF
        ENDIF
    ENDPROC

    PROC EndDoor(num reason,string detail)
        ! Ends the door from wherever the program is; main begins anew and leads back.
        WatchNothing;
        ! Of several reasons the first one ends the door; none is left for the next cycle.
        IDelete goneOn;
        Reset doMillAbort;
        ! The robot first, then the spindle: a tool at rest in moving contact breaks.
        StopMove;
        WaitRob\ZeroSpeed;
        StopSpindle;
        stopDetail:=detail;
        IF stopReason=0 THEN
            TellRefused reason,detail;
        ENDIF
        NoteStop reason;
        ClearPath;
        motionsLeft:=FALSE;
        ! Until main begins, which lets the robot move again: in a trap that runs within an event routine ExitCycle
        ! may end that routine alone.
        motionsForgotten:=TRUE;
        ExitCycle;
    ENDPROC

    PROC StayWhenForgotten()
        ! Behind each motion and before what follows from it: one that was forgotten is at its end at once, and the
        ! trap that ends the door may come later than that.
        IF motionsForgotten THEN
            EndDoor TXT_STOPPED,"";
        ENDIF
    ENDPROC

    PROC SetOff()
        ! From here on the robot is on its way.
        ForbidClamp;
        stoppedKnown:=FALSE;
        underWay:=TRUE;
        motionsLeft:=TRUE;
    ENDPROC

    PROC ForgetDoor()
        ! Nobody knows what is in the clamp, nor a way home.
        doorSpent:=TRUE;
        nameTaken:=TRUE;
        ForgetName;
        escapeKnown:=FALSE;
        stoppedKnown:=FALSE;
    ENDPROC

    LOCAL PROC NoteStop(num reason)
        IF stopReason=0 THEN
            stopReason:=reason;
        ENDIF
        ! A robot that was not on its way was jogged, maybe: from there no way was looked at.
        IF underWay THEN
            stoppedAt:=CJointT();
            stoppedKnown:=TRUE;
        ENDIF
        underWay:=FALSE;
        ! Busy stays: the tool may stand in the door, which must not be taken out.
        Set doPathFault;
        Reset doPathRequest;
        ShutDrawbar;
    ENDPROC

    LOCAL TRAP OnSpindleLost
        EndDoor WhySpindleLost(),"";
    ENDTRAP

    LOCAL FUNC num WhySpindleLost()
        ! What took the drive's enable away, see EIO.cfg.
        IF diToolClamped=0 THEN
            RETURN TXT_TOOL_LOOSE;
        ENDIF
        IF diGuardClosed=0 THEN
            RETURN TXT_GUARD_OPEN;
        ENDIF
        RETURN TXT_SPINDLE_LOST;
    ERROR
        SkipWarn;
        RETURN TXT_SPINDLE_LOST;
    ENDFUNC

    LOCAL TRAP OnDoorReleased
        EndDoor TXT_RELEASED,"";
    ENDTRAP

    LOCAL TRAP OnToolLost
        EndDoor TXT_TOOL_LOOSE,"";
    ENDTRAP

    LOCAL TRAP OnDoorLeft
        DoorExchanged;
    ENDTRAP

    LOCAL PROC DoorExchanged()
        ! The next one is named once it is being loaded.
        doorChanged:=TRUE;
        nameTaken:=TRUE;
        ForgetName;
        DropName;
    ENDPROC

    LOCAL TRAP OnGuardOpened
        EndDoor TXT_GUARD_OPEN,"";
    ENDTRAP

    LOCAL TRAP OnGoneOn
        ! Started again after a stop with the spindle on: DoorRestarted holds the robot.
        EndDoor TXT_STOPPED,"";
    ENDTRAP

    ! Event routines, see SYS.cfg. None of them moves the robot or asks anything.

    PROC DoorStopped()
        ! STOP, QSTOP: the robot stands, and may be jogged. Once all is cut a stop is no reason to give the door up.
        ! Before, it is: nobody sees what the clamp does until the next start. At the rack it always is.
        ForbidClamp;
        IF GivenUp() THEN
            NoteStop TXT_STOPPED;
        ENDIF
        StopSpindle;
    ENDPROC

    LOCAL FUNC bool GivenUp()
        ! Whether a stop ends what the robot is doing.
        RETURN doorInHand AND (stopReason<>0 OR spindleSpeed<>0 OR atRack OR CutsLeft());
    ENDFUNC

    PROC DoorPowered()
        ! POWERON: the outputs fell with the power, what the program knows of spindle and door did not.
        IF doorInHand THEN
            Set doPathBusy;
        ENDIF
        DoorStopped;
    ENDPROC

    PROC DoorRestarted()
        ! START, STEP, RESTART: before anything moves on. Interrupts are lost while the program stands: the door may be
        ! another one by now, and has to be named anew, whoever named which one meanwhile. Of errors no event told.
        ForbidClamp;
        IF NOT doorInHand THEN
            DoorExchanged;
        ENDIF
        IF GivenUp() THEN
            ! Where no event told of the stop, as after errors, nobody knows whether the robot was jogged since.
            underWay:=FALSE;
            NoteStop TXT_STOPPED;
            StopSpindle;
        ENDIF
        ! What is left of the path of a door that ended stays unmoved. With none left people move it.
        IF stopReason<>0 AND motionsLeft THEN
            StopMove;
            ! No way back to the path either: the tool stands in the wood.
            ClearPath;
            motionsForgotten:=TRUE;
            ! It is high still when the program was stopped before its trap had run.
            Reset doMillAbort;
            Set doMillAbort;
        ENDIF
    ENDPROC

    PROC DoorReset()
        ! RESET: the program is at main, its variables are new.
        ForbidClamp;
        StopSpindle;
    ENDPROC

    ! The way back.

    PROC BeginEscape(num next)
        ! From now on the robot is at a feature (0) or on its way to the first point that is added (1).
        escapeKnown:=FALSE;
        escapeFits:=TRUE;
        escapeCount:=0;
        escapeNext:=next;
        NotePath 0,0;
    ENDPROC

    PROC EscapeOver(jointtarget point,bool straight)
        ! From now on the robot is on its way from a point, from where it gets home as it did so far.
        FOR i FROM escapeCount TO 1 STEP -1 DO
            IF i<MAX_ESCAPE THEN
                escape{i+1}:=escape{i};
            ENDIF
        ENDFOR
        escape{1}:=point;
        escapeKnown:=escapeKnown AND escapeCount<MAX_ESCAPE;
        IF escapeCount<MAX_ESCAPE THEN
            escapeCount:=escapeCount+1;
        ENDIF
        NotePath 0,0;
        escapeNext:=1;
        IF straight THEN
            escapeNext:=0;
        ENDIF
    ENDPROC

    PROC EndEscape(bool known)
        escapeKnown:=known AND escapeFits;
    ENDPROC

    PROC AddToEscape(jointtarget point)
        IF escapeCount=MAX_ESCAPE THEN
            escapeFits:=FALSE;
            RETURN;
        ENDIF
        escapeCount:=escapeCount+1;
        escape{escapeCount}:=point;
    ENDPROC

    PROC LeadBack()
        ! Returns with the robot at home and no door in hand. Until then it asks, again and again.
        VAR num reason;
        VAR num answer;

        IF doorInHand AND stopReason=0 THEN
            ! The program pointer was moved to main after a stop that no event told of.
            underWay:=FALSE;
            NoteStop TXT_STOPPED;
        ENDIF
        IF doorInHand THEN
            ! Outputs may have fallen.
            Set doPathBusy;
        ENDIF
        reason:=stopReason;
        IF reason<>0 THEN
            Report reason,stopDetail;
            TellRefused reason,stopDetail;
        ELSE
            reason:=TXT_NOT_HOME;
        ENDIF
        WHILE NOT AtHome() DO
            IF NOT WayKnown() THEN
                answer:=Ask(reason,TXT_BY_HAND,TXT_OK,0);
            ELSEIF NOT StandsOnWay() THEN
                answer:=Ask(TXT_MOVED,TXT_BY_HAND,TXT_OK,0);
            ELSE
                answer:=Ask(reason,TXT_ASK_RETRACT,TXT_RETRACT,TXT_JOG);
                IF answer=1 THEN
                    Retract;
                ENDIF
            ENDIF
        ENDWHILE
        WaitForRest;
        Reset doPathBusy;
        AllowClamp;
        IF doorInHand THEN
            answer:=Ask(reason,TXT_ASK_NEXT,TXT_OK,0);
        ELSEIF stopReason<>0 THEN
            answer:=Ask(reason,TXT_ASK_GO_ON,TXT_OK,0);
        ENDIF
        doorInHand:=FALSE;
        stopReason:=0;
        stopDetail:="";
        escapeKnown:=FALSE;
    ENDPROC

    LOCAL FUNC bool WayKnown()
        IF NOT (doorInHand AND escapeKnown) THEN
            RETURN FALSE;
        ENDIF
        IF escapeNext=0 THEN
            RETURN BackKnown(CalcRobT(escape{1},toolMill\WObj:=wobjDoor));
        ENDIF
        RETURN TRUE;
    ENDFUNC

    LOCAL FUNC bool StandsOnWay()
        ! Where it stopped. Where nobody saw that, its place on the path itself tells; no way tells as much.
        IF stoppedKnown THEN
            RETURN NearJoints(CJointT(),stoppedAt,STOPPED_TOLERANCE);
        ENDIF
        RETURN escapeNext=0 AND OnPath();
    ENDFUNC

    LOCAL PROC Retract()
        VAR robtarget there;

        SetOff;
        IF escapeNext=0 THEN
            there:=CalcRobT(escape{1},toolMill\WObj:=wobjDoor);
            BackOut there;
            MoveL there,SPEED_CLEAR,fine,toolMill\WObj:=wobjDoor;
            StayWhenForgotten;
            escapeNext:=1;
        ENDIF
        WHILE escapeNext<=escapeCount DO
            MoveAbsJ escape{escapeNext},v500,fine,toolMill\WObj:=wobjDoor;
            StayWhenForgotten;
            escapeNext:=escapeNext+1;
        ENDWHILE
        GoHome;
        StayWhenForgotten;
        motionsLeft:=FALSE;
    ENDPROC
ENDMODULE
