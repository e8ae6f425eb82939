MODULE DoorCell
    ! The cell: tool, work object, home position, doors by number, spindle, clamp.
    ! Measure toolMill and jposHome on the cell before the first door.

    ! Tool centre point 250 mm in front of the flange, z along the spindle axis (config/cell.yaml).
    PERS tooldata toolMill:=[TRUE,[[0,0,250],[1,0,0,0]],[20.12,[0,0,120],[1,0,0,0],0,0,0]];
    ! Targets are given in the robot's base frame: the PC has put the door's place into them.
    PERS wobjdata wobjDoor:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
    ! Tool tip more than 300 mm in front of any door, axis 5 away from straight.
    CONST jointtarget jposHome:=[[0,-40,30,0,10,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    ! Axes this close to jposHome count as home [deg]; a path begins at jposHome itself.
    CONST num HOME_TOLERANCE:=1;
    ! FALSE for a PC that raises doPathReady and announces no run: a file is then known by its door alone.
    CONST bool ORDER_REQUIRED:=TRUE;
    ! TRUE for the path without the spindle, in manual mode and with an open guard: no door is milled by it.
    PERS bool dryRun:=FALSE;
    ! What it was when the path in hand was accepted.
    VAR bool dryDoor:=FALSE;
    ! What giDoorNumber means, for a line control that names the door by a number from 1.
    PERS string doorNumbers{32}:=["","","","","","","","","","","","","","","","",
        "","","","","","","","","","","","","","","",""];

    CONST num MAX_SPINDLE_SPEED:=24000;
    ! Longest time to come to speed, and for diSpindleAtSpeed to fall after another speed was set [s].
    CONST num SPINDLE_TIMEOUT:=10;
    CONST num SPINDLE_FALL_TIMEOUT:=2;
    ! Longest time for the spindle to come to rest [s]: one without a brake coasts. Measure it and add a half.
    CONST num REST_TIMEOUT:=90;
    ! Speeds of the way back: out of the wood, in front of the feature, home [mm/s].
    CONST speeddata SPEED_OUT:=[20,100,5000,1000];
    CONST speeddata SPEED_CLEAR:=[100,100,5000,1000];

    ! Speed of the spindle as it was set last [rev/min].
    VAR num spindleSpeed:=0;

    PROC MoveHome()
        ! For the operator, once the tool is clear of the door. What was left of a path is forgotten; a start after a
        ! door that ended holds the robot.
        StopSpindle;
        StartMove;
        GoHome;
    ENDPROC

    PROC GoHome()
        MoveAbsJ jposHome,v500,fine,toolMill\WObj:=wobjDoor;
    ENDPROC

    PROC BeginAtHome()
        ! From a place that counts as home to where the first way was planned from: a degree is more than its clearance.
        IF NOT NearJoints(CJointT(),jposHome,HOME_AGREES) THEN
            MoveAbsJ jposHome,SPEED_CLEAR,fine,toolMill\WObj:=wobjDoor;
        ENDIF
    ENDPROC

    FUNC bool AtHome()
        RETURN NearJoints(CJointT(),jposHome,HOME_TOLERANCE);
    ENDFUNC

    FUNC bool NearJoints(jointtarget a,jointtarget b,num tolerance)
        RETURN Abs(a.robax.rax_1-b.robax.rax_1)<=tolerance AND Abs(a.robax.rax_2-b.robax.rax_2)<=tolerance AND
            Abs(a.robax.rax_3-b.robax.rax_3)<=tolerance AND Abs(a.robax.rax_4-b.robax.rax_4)<=tolerance AND
            Abs(a.robax.rax_5-b.robax.rax_5)<=tolerance AND Abs(a.robax.rax_6-b.robax.rax_6)<=tolerance;
    ENDFUNC

    FUNC num RunSpindle(num speed)
        ! Returns 0 when the spindle has its speed, else the number of the text that says why not.
        ! The robot must stand still.
        VAR bool late;

        IF speed=0 THEN
            StopSpindle;
            RETURN 0;
        ENDIF
        IF spindleSpeed<>0 THEN
            ! At speed is believed only after it fell.
            SetAO aoSpindleSpeed,speed;
            WaitDI diSpindleAtSpeed,0\MaxTime:=SPINDLE_FALL_TIMEOUT\TimeFlag:=late;
            IF late THEN
                ! The step was too small for the drive to signal it: from rest it must.
                StopSpindle;
            ENDIF
        ENDIF
        WaitDI diSpindleAtSpeed,0\MaxTime:=SPINDLE_TIMEOUT\TimeFlag:=late;
        IF late THEN
            StopSpindle;
            RETURN TXT_SPINDLE_STUCK;
        ENDIF
        SetAO aoSpindleSpeed,speed;
        Set doSpindleOn;
        Set doBlowOff;
        spindleSpeed:=speed;
        WaitDI diSpindleAtSpeed,1\MaxTime:=SPINDLE_TIMEOUT\TimeFlag:=late;
        IF late THEN
            StopSpindle;
            RETURN TXT_SPINDLE_SLOW;
        ENDIF
        RETURN 0;
    ENDFUNC

    PROC WaitForRest()
        ! Nobody goes to a door while the mill beside it turns.
        VAR num answer;

        WHILE NOT ComesToRest() DO
            answer:=Ask(TXT_SPINDLE_TURNS,TXT_WAIT_REST,TXT_OK,0);
        ENDWHILE
    ENDPROC

    LOCAL FUNC bool ComesToRest()
        VAR bool late;

        WaitDI diSpindleStopped,1\MaxTime:=REST_TIMEOUT\TimeFlag:=late;
        RETURN NOT late;
    ERROR
        ! Its device is lost: nobody knows.
        SkipWarn;
        RETURN FALSE;
    ENDFUNC

    PROC AllowClamp()
        ! Whoever opens the clamp stands where the tool works.
        IF AtHome() AND diSpindleStopped=1 THEN
            Set doClampFree;
            ! Who stopped the program in between may have moved the robot.
            IF NOT AtHome() THEN
                Reset doClampFree;
            ENDIF
        ENDIF
    ERROR
        ! A device that is lost allows nothing.
        SkipWarn;
        RETURN;
    ENDPROC

    PROC ForbidClamp()
        Reset doClampFree;
    ERROR
        SkipWarn;
        TRYNEXT;
    ENDPROC

    PROC StopSpindle()
        spindleSpeed:=0;
        Reset doSpindleOn;
        Reset doBlowOff;
        SetAO aoSpindleSpeed,0;
    ERROR
        ! A device that is lost keeps no door from ending: its outputs fell with it.
        SkipWarn;
        TRYNEXT;
    ENDPROC
ENDMODULE
