MODULE DoorTool
    ! The rack: puts the tool of the spindle into its place, takes another one out, measures how far it stands out.
    !
    ! Each begins and ends with the robot in front of the place, where the file's ways lead; in between nobody knows a
    ! way home but back along the spindle's axis, so that what stops there is jogged out by hand. A door begins and
    ! ends with the tool of the first place, and measured. RestoreTool asks for both after a door that ended otherwise.

    CONST num MAX_PLACES:=8;
    ! Places of this cell, and how far the spindle goes into one along its axis [mm] (rack in config/cell.yaml).
    CONST num RACK_PLACES:=2;
    CONST num RACK_DEPTH:=250;
    CONST jointtarget rackFronts{MAX_PLACES}:=[
        [[-100,0,30,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[-90,0,30,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
        [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]];
    ! How far the tool of each place shall stand out of the spindle, and how much longer or shorter it may be [mm].
    PERS num toolLengths{MAX_PLACES}:=[120,120,0,0,0,0,0,0];
    CONST num LENGTH_LIMIT:=0.5;
    ! From the flange to the spindle's nose [mm].
    CONST num NOSE:=130;
    ! The gauge is pressed by so much at the end of the way to it where the length is right [mm].
    CONST jointtarget gaugeFront:=[[-80,0,30,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST num GAUGE_DEPTH:=150;
    CONST num GAUGE_PRESSED:=10;
    CONST num GAUGE_SETTLES:=0.2;
    CONST speeddata SPEED_RACK:=[200,100,5000,1000];
    ! Pressed by more while nothing stands in front of it, it is stuck [mm].
    CONST num GAUGE_REST:=0.5;
    ! Longest time for the drawbar to open or close [s].
    CONST num DRAWBAR_TIMEOUT:=3;

    CONST num CELL_TOOL:=1;
    CONST num NO_TOOL:=0;
    CONST num TOOL_UNKNOWN:=-1;
    ! Place of the tool in the spindle. Modules that were just loaded know neither it nor its length.
    PERS num toolPlace:=-1;
    ! Its length was measured, and toolMill holds it.
    PERS bool toolMeasured:=FALSE;
    ! Between the front of a place and its seat.
    PERS bool atRack:=FALSE;

    ! What the motions of a file do with the tools, while it is read.
    LOCAL VAR num plannedTool:=0;
    LOCAL VAR num plannedPoint:=0;
    LOCAL VAR bool plannedMeasured:=FALSE;

    PROC ForgetTool()
        toolPlace:=TOOL_UNKNOWN;
        toolMeasured:=FALSE;
    ENDPROC

    FUNC bool IsRackWork(string kind)
        RETURN kind="P" OR kind="T" OR kind="M";
    ENDFUNC

    PROC BeginTools()
        plannedTool:=CELL_TOOL;
        plannedPoint:=0;
        plannedMeasured:=TRUE;
    ENDPROC

    FUNC bool ToolsFit(moverow row)
        ! Whether a motion may follow those that were read since BeginTools. Its numbers are within the arrays.
        IF IsRackWork(row.kind) THEN
            IF row.target<>plannedPoint OR row.spindle<>0 THEN
                RETURN FALSE;
            ENDIF
            RETURN RackWorkFits(row);
        ENDIF
        plannedPoint:=0;
        IF row.kind="A" THEN
            plannedPoint:=row.target;
        ENDIF
        RETURN NOT row.cutting OR (plannedTool<>NO_TOOL AND plannedMeasured);
    ENDFUNC

    LOCAL FUNC bool RackWorkFits(moverow row)
        TEST row.kind
        CASE "P":
            IF row.via<>plannedTool THEN
                RETURN FALSE;
            ENDIF
            plannedTool:=NO_TOOL;
        CASE "T":
            IF plannedTool<>NO_TOOL THEN
                RETURN FALSE;
            ENDIF
            plannedTool:=row.via;
            plannedMeasured:=FALSE;
        DEFAULT:
            plannedMeasured:=TRUE;
            RETURN row.via=plannedTool AND NearJoints(points{row.target},gaugeFront,HOME_AGREES);
        ENDTEST
        RETURN NearJoints(points{row.target},rackFronts{row.via},HOME_AGREES);
    ENDFUNC

    FUNC bool ToolsEnd()
        ! The tool that the next door finds is the one that this one began with.
        RETURN plannedTool=CELL_TOOL AND plannedMeasured;
    ENDFUNC

    PROC WorkAtRack(moverow row)
        ! The spindle is switched off and the robot stands in front of the place.
        VAR bool late;

        WaitDI diSpindleStopped,1\MaxTime:=REST_TIMEOUT\TimeFlag:=late;
        IF late THEN
            EndDoor TXT_SPINDLE_TURNS,"";
        ENDIF
        atRack:=TRUE;
        EndEscape FALSE;
        TEST row.kind
        CASE "P":
            PutTool;
        CASE "T":
            TakeTool row.via;
        DEFAULT:
            MeasureTool row.via;
        ENDTEST
    ENDPROC

    LOCAL PROC LeaveRack()
        ! In front of the place again: the way home is known.
        StayWhenForgotten;
        EndEscape TRUE;
        atRack:=FALSE;
    ENDPROC

    LOCAL PROC PutTool()
        VAR robtarget front;

        front:=CRobT(\Tool:=toolMill\WObj:=wobjDoor);
        MoveL RelTool(front,0,0,RACK_DEPTH),SPEED_RACK,fine,toolMill\WObj:=wobjDoor;
        toolPlace:=TOOL_UNKNOWN;
        OpenDrawbar;
        MoveL front,SPEED_RACK,fine,toolMill\WObj:=wobjDoor;
        CloseDrawbar;
        IF diToolClamped=1 THEN
            EndDoor TXT_TOOL_STUCK,"";
        ENDIF
        toolPlace:=NO_TOOL;
        LeaveRack;
    ENDPROC

    LOCAL PROC TakeTool(num place)
        VAR robtarget front;
        VAR bool late;

        front:=CRobT(\Tool:=toolMill\WObj:=wobjDoor);
        toolMeasured:=FALSE;
        OpenDrawbar;
        MoveL RelTool(front,0,0,RACK_DEPTH),SPEED_RACK,fine,toolMill\WObj:=wobjDoor;
        toolPlace:=TOOL_UNKNOWN;
        CloseDrawbar;
        WaitDI diToolClamped,1\MaxTime:=DRAWBAR_TIMEOUT\TimeFlag:=late;
        IF late THEN
            EndDoor TXT_TOOL_MISSING,NumToStr(place,0);
        ENDIF
        MoveL front,SPEED_RACK,fine,toolMill\WObj:=wobjDoor;
        IF diToolClamped=0 THEN
            EndDoor TXT_TOOL_MISSING,NumToStr(place,0);
        ENDIF
        toolPlace:=place;
        LeaveRack;
    ENDPROC

    LOCAL PROC MeasureTool(num place)
        ! What stands out by another length is no tool of this place, or sits badly; else its tip is where it was found.
        VAR robtarget front;
        VAR num off;

        toolMeasured:=FALSE;
        CheckGauge;
        front:=CRobT(\Tool:=toolMill\WObj:=wobjDoor);
        MoveL RelTool(front,0,0,GAUGE_DEPTH),SPEED_RACK,fine,toolMill\WObj:=wobjDoor;
        WaitTime\InPos,GAUGE_SETTLES;
        off:=aiToolGauge-GAUGE_PRESSED;
        MoveL front,SPEED_RACK,fine,toolMill\WObj:=wobjDoor;
        WaitRob\InPos;
        CheckGauge;
        LeaveRack;
        IF NOT KeepLength(place,toolLengths{place}+off) THEN
            EndDoor TXT_TOOL_LENGTH,NumToStr(toolLengths{place}+off,2);
        ENDIF
    ENDPROC

    LOCAL PROC CheckGauge()
        ! In front of it: one that is stuck reads the same with every tool.
        IF Abs(aiToolGauge)>GAUGE_REST THEN
            LeaveRack;
            EndDoor TXT_GAUGE,NumToStr(aiToolGauge,2);
        ENDIF
    ENDPROC

    LOCAL FUNC bool KeepLength(num place,num length)
        ! Whether the tool in the spindle may be that of the place.
        IF Abs(length-toolLengths{place})>LENGTH_LIMIT THEN
            toolPlace:=TOOL_UNKNOWN;
            RETURN FALSE;
        ENDIF
        toolMill.tframe.trans.z:=NOSE+length;
        toolMeasured:=TRUE;
        RETURN TRUE;
    ENDFUNC

    LOCAL PROC OpenDrawbar()
        VAR bool late;

        StayWhenForgotten;
        Set doDrawbarOpen;
        WaitDI diToolReleased,1\MaxTime:=DRAWBAR_TIMEOUT\TimeFlag:=late;
        IF late THEN
            EndDoor TXT_DRAWBAR,"";
        ENDIF
    ENDPROC

    LOCAL PROC CloseDrawbar()
        VAR bool late;

        Reset doDrawbarOpen;
        WaitDI diToolReleased,0\MaxTime:=DRAWBAR_TIMEOUT\TimeFlag:=late;
        IF late THEN
            EndDoor TXT_DRAWBAR,"";
        ENDIF
    ENDPROC

    PROC ShutDrawbar()
        ! What the drawbar let go of a tool it holds again.
        Reset doDrawbarOpen;
    ERROR
        SkipWarn;
        TRYNEXT;
    ENDPROC

    PROC RestoreTool()
        ! Returns with the tool of the first place in the spindle and its length known; after a door that ended early
        ! people put it there and measure it: no way of the file leads to the gauge before the first cut.
        VAR num answer;

        atRack:=FALSE;
        WHILE toolPlace<>CELL_TOOL OR (NOT toolMeasured) DO
            IF toolPlace=CELL_TOOL THEN
                MeasuredByHand;
            ELSE
                answer:=Ask(TXT_OTHER_TOOL,TXT_ASK_TOOL,TXT_OK,0);
                IF diToolClamped=1 THEN
                    toolMeasured:=FALSE;
                    toolPlace:=CELL_TOOL;
                ENDIF
            ENDIF
        ENDWHILE
    ENDPROC

    LOCAL PROC MeasuredByHand()
        VAR num length;

        length:=AskNumber(TXT_MEASURE_TOOL,TXT_ASK_LENGTH);
        IF diToolClamped=0 THEN
            toolPlace:=TOOL_UNKNOWN;
        ELSEIF NOT KeepLength(CELL_TOOL,length) THEN
            Report TXT_TOOL_LENGTH,NumToStr(length,2);
        ENDIF
    ENDPROC
ENDMODULE
