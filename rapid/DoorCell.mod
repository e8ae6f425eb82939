MODULE DoorCell
    ! The cell: tool, work object, home position, spindle.
    ! Measure toolMill and jposHome on the cell before the first door.

    ! Tool centre point 250 mm in front of the flange, z along the spindle axis (config/cell.yaml).
    PERS tooldata toolMill:=[TRUE,[[0,0,250],[1,0,0,0]],[20.12,[0,0,120],[1,0,0,0],0,0,0]];
    ! Targets are given in the robot's base frame: the PC has put the door's place into them.
    PERS wobjdata wobjDoor:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
    ! Tool tip more than 300 mm in front of any door, axis 5 away from straight.
    CONST jointtarget jposHome:=[[0,-40,30,0,10,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    ! Axes this close to jposHome count as home [deg].
    CONST num HOME_TOLERANCE:=1;

    CONST num MAX_SPINDLE_SPEED:=24000;
    CONST num SPINDLE_TIMEOUT:=10;
    CONST num CLAMP_TIMEOUT:=600;

    ! Speed of the spindle as it was set last [rev/min].
    VAR num spindleSpeed:=0;

    PROC MoveHome()
        ! Also for the operator, once the tool is clear of the door.
        MoveAbsJ jposHome,v500,fine,toolMill\WObj:=wobjDoor;
    ENDPROC

    FUNC bool AtHome()
        VAR jointtarget here;

        here:=CJointT();
        RETURN Near(here.robax.rax_1,jposHome.robax.rax_1) AND Near(here.robax.rax_2,jposHome.robax.rax_2) AND
            Near(here.robax.rax_3,jposHome.robax.rax_3) AND Near(here.robax.rax_4,jposHome.robax.rax_4) AND
            Near(here.robax.rax_5,jposHome.robax.rax_5) AND Near(here.robax.rax_6,jposHome.robax.rax_6);
    ENDFUNC

    LOCAL FUNC bool Near(num angle,num wanted)
        RETURN Abs(angle-wanted)<HOME_TOLERANCE;
    ENDFUNC

    PROC RunSpindle(num speed)
        ! Returns when the spindle has its speed. The robot must stand still.
        IF speed=0 THEN
            StopSpindle;
        ELSE
            SetAO aoSpindleSpeed,speed;
            Set doSpindleOn;
            Set doBlowOff;
            WaitDI diSpindleAtSpeed,1\MaxTime:=SPINDLE_TIMEOUT;
        ENDIF
        spindleSpeed:=speed;
    ENDPROC

    PROC StopSpindle()
        Reset doSpindleOn;
        Reset doBlowOff;
        SetAO aoSpindleSpeed,0;
        spindleSpeed:=0;
    ENDPROC
ENDMODULE
