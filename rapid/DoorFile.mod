MODULE DoorFile
    ! Reads the target file and checks it. Nothing of a file is used before all of it was found good.
    !
    ! The file: one line x;y;z;q1;q2;q3;q4;cf1;cf4;cf6;cfx; for each target, then lines that begin
    ! with # in a fixed order, the last of them the checksum of all bytes before it.

    CONST string TARGET_FILE:="Hei2.txt";
    ! A copy of the file of the door in hand: the PC removes its own once it was accepted.
    CONST string KEPT_FILE:="Hei2.cut";
    CONST num FILE_VERSION:=2;
    ! The file's home and jposHome are the same so far [deg].
    CONST num HOME_AGREES:=0.01;
    ! So far may the tip of the file's tool be from that of toolMill along each axis, and turned [mm, deg]. Either may
    ! be off by LENGTH_LIMIT from what a tool of its place should have.
    CONST num TOOL_AGREES:=1;
    CONST num TOOL_TURN:=0.5;
    CONST num MAX_SPEED:=7000;
    CONST num MAX_CF:=4;
    CONST num MAX_CFX:=7;
    CONST num UNIT_TOLERANCE:=0.00001;
    CONST num NOT_CONNECTED:=9E9;

    FUNC bool ReadTargetFile()
        ! FALSE with the reason in refusal and refusalDetail.
        ForgetPath;
        ReadWhole TARGET_FILE;
        CheckFile CheckDoor(doorId),doorId;
        CheckFile CheckRun(runId),runId;
        CheckFile CheckOrder(runId),runId;
        RETURN TRUE;
    ERROR
        SkipWarn;
        IF ERRNO=ERR_FILEOPEN THEN
            refusal:=TXT_MISSING;
            refusalDetail:=TARGET_FILE;
        ELSEIF ERRNO<>ERR_FILE_REFUSED THEN
            refusal:=TXT_UNREADABLE;
            refusalDetail:=TARGET_FILE;
        ENDIF
        ! A file that is open closes without an error, and there must be none in here.
        CloseLines;
        ForgetPath;
        RETURN FALSE;
    ENDFUNC

    PROC KeepTargetFile()
        ! A file that cannot be kept leaves the path in memory.
        IF IsFile("HOME:/"+KEPT_FILE) THEN
            RemoveFile "HOME:/"+KEPT_FILE;
        ENDIF
        CopyFile "HOME:/"+TARGET_FILE,"HOME:/"+KEPT_FILE;
    ERROR
        SkipWarn;
        RETURN;
    ENDPROC

    FUNC bool ReadKept(string run)
        ! The path of the door in hand once more; FALSE when it is not to be had.
        ForgetPath;
        ReadWhole KEPT_FILE;
        IF runId=run THEN
            RETURN TRUE;
        ENDIF
        ForgetPath;
        RETURN FALSE;
    ERROR
        SkipWarn;
        CloseLines;
        ForgetPath;
        RETURN FALSE;
    ENDFUNC

    LOCAL PROC ReadWhole(string name)
        OpenLines name;
        ReadTargets;
        ReadTrailer;
        CloseLines;
    ENDPROC

    LOCAL PROC ReadTargets()
        WHILE NOT Begins(lineText,"#") DO
            IF targetCount=MAX_TARGETS THEN
                Refuse TXT_TOO_MANY;
            ENDIF
            targetCount:=targetCount+1;
            targets{targetCount}:=TargetOf(lineText);
            AddToSum lineText;
            NextLine;
        ENDWHILE
        IF targetCount=0 THEN
            Refuse TXT_NO_TARGET;
        ENDIF
    ENDPROC

    LOCAL FUNC robtarget TargetOf(string text)
        VAR robtarget target;
        VAR num at:=1;

        IF text=EOF THEN
            Refuse TXT_CUT_SHORT;
        ENDIF
        target.trans.x:=FieldOf(text,at);
        target.trans.y:=FieldOf(text,at);
        target.trans.z:=FieldOf(text,at);
        target.rot.q1:=FieldOf(text,at);
        target.rot.q2:=FieldOf(text,at);
        target.rot.q3:=FieldOf(text,at);
        target.rot.q4:=FieldOf(text,at);
        target.robconf.cf1:=FieldOf(text,at);
        target.robconf.cf4:=FieldOf(text,at);
        target.robconf.cf6:=FieldOf(text,at);
        target.robconf.cfx:=FieldOf(text,at);
        IF at<>StrLen(text)+1 THEN
            Refuse TXT_MORE_NUMBERS;
        ENDIF
        target.extax:=[NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED];
        CheckTarget target;
        RETURN target;
    ENDFUNC

    LOCAL PROC CheckTarget(robtarget target)
        VAR num square;

        square:=target.rot.q1*target.rot.q1+target.rot.q2*target.rot.q2;
        square:=square+target.rot.q3*target.rot.q3+target.rot.q4*target.rot.q4;
        IF Abs(square-1)>UNIT_TOLERANCE THEN
            Refuse TXT_NOT_UNIT;
        ENDIF
        CheckInteger target.robconf.cf1,-MAX_CF,MAX_CF-1;
        CheckInteger target.robconf.cf4,-MAX_CF,MAX_CF-1;
        CheckInteger target.robconf.cf6,-MAX_CF,MAX_CF-1;
        CheckInteger target.robconf.cfx,0,MAX_CFX;
    ENDPROC

    LOCAL PROC ReadTrailer()
        IF NumberAfter("#doormill ")<>FILE_VERSION THEN
            Refuse TXT_VERSION;
        ENDIF
        doorId:=TextAfter("#door ");
        runId:=TextAfter("#run ");
        recipeVersion:=NumberAfter("#recipe ");
        IF NOT NearJoints(PointAfter("#home "),jposHome,HOME_AGREES) THEN
            Refuse TXT_HOME;
        ENDIF
        ReadTool;
        IF NumberAfter("#targets ")<>targetCount THEN
            Refuse TXT_TARGET_COUNT;
        ENDIF
        featureCount:=CountAfter("#features ",MAX_FEATURES);
        ! With STEP a loop to 0 is none; without it, it counts down.
        FOR i FROM 1 TO featureCount STEP 1 DO
            features{i}:=TextAfter("#feature ");
        ENDFOR
        ReadPoints;
        moveCount:=CountAfter("#motions ",MAX_MOVES);
        IF moveCount=0 THEN
            Refuse TXT_NO_MOTION;
        ENDIF
        BeginTools;
        FOR i FROM 1 TO moveCount DO
            moves{i}:=MoveAfter("#move ");
            IF NOT ToolsFit(moves{i}) THEN
                Refuse TXT_RACK;
            ENDIF
        ENDFOR
        IF NOT ToolsEnd() THEN
            Refuse TXT_RACK;
        ENDIF
        IF moves{1}.kind<>"A" THEN
            ! From home only the axes know the way.
            Refuse TXT_FIRST_ARC;
        ENDIF
        CheckSum;
    ENDPROC

    LOCAL PROC ReadTool()
        ! A file that does not say it is of a PC that knows another form.
        VAR pose tool;

        IF NOT Begins(lineText,"#tool ") THEN
            Refuse TXT_TOOL;
        ENDIF
        IF NOT StrToVal(TextAfter("#tool "),tool) THEN
            Refuse TXT_NO_NUMBER;
        ENDIF
        IF NOT SameTool(tool,toolMill.tframe) THEN
            Refuse TXT_TOOL;
        ENDIF
    ENDPROC

    LOCAL FUNC bool SameTool(pose a,pose b)
        VAR pos off;
        VAR num turn;

        off:=a.trans-b.trans;
        ! Of one orientation q and -q; people type few decimals, and rounding takes it beyond 1.
        turn:=Abs(Product(a.rot,b.rot))/Sqrt(Product(a.rot,a.rot)*Product(b.rot,b.rot));
        IF turn>1 THEN
            turn:=1;
        ENDIF
        RETURN Abs(off.x)<=TOOL_AGREES AND Abs(off.y)<=TOOL_AGREES AND Abs(off.z)<=TOOL_AGREES AND
            2*ACos(turn)<=TOOL_TURN;
    ENDFUNC

    LOCAL FUNC num Product(orient a,orient b)
        RETURN a.q1*b.q1+a.q2*b.q2+a.q3*b.q3+a.q4*b.q4;
    ENDFUNC

    LOCAL PROC ReadPoints()
        pointCount:=CountAfter("#points ",MAX_POINTS);
        FOR i FROM 1 TO pointCount STEP 1 DO
            points{i}:=PointAfter("#point ");
        ENDFOR
        FOR i FROM 1 TO featureCount STEP 1 DO
            escapes{i}:=EscapeAfter("#escape ");
        ENDFOR
    ENDPROC

    LOCAL FUNC jointtarget PointAfter(string tag)
        VAR jointtarget point;

        IF NOT StrToVal(TextAfter(tag),point.robax) THEN
            Refuse TXT_NO_NUMBER;
        ENDIF
        point.extax:=[NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED];
        RETURN point;
    ENDFUNC

    LOCAL FUNC pointrange EscapeAfter(string tag)
        VAR pointrange range;

        IF NOT StrToVal(TextAfter(tag),range) THEN
            Refuse TXT_NO_NUMBER;
        ENDIF
        CheckInteger range.first,1,pointCount;
        CheckInteger range.last,range.first,pointCount;
        IF range.last-range.first>=MAX_ESCAPE THEN
            Refuse TXT_RANGE;
        ENDIF
        RETURN range;
    ENDFUNC

    LOCAL FUNC moverow MoveAfter(string tag)
        VAR moverow row;
        VAR zonedata known;

        IF NOT StrToVal(TextAfter(tag),row) THEN
            Refuse TXT_MOTION;
        ENDIF
        CheckInteger row.feature,0,featureCount;
        TEST row.kind
        CASE "A":
            CheckInteger row.target,1,pointCount;
            CheckInteger row.via,0,0;
        CASE "P","T","M":
            CheckInteger row.target,1,pointCount;
            CheckInteger row.via,1,RACK_PLACES;
        CASE "C":
            CheckInteger row.target,1,targetCount;
            CheckInteger row.via,1,targetCount;
        CASE "L":
            CheckInteger row.target,1,targetCount;
            CheckInteger row.via,0,0;
        DEFAULT:
            Refuse TXT_KIND;
        ENDTEST
        IF row.speed<=0 OR row.speed>MAX_SPEED THEN
            Refuse TXT_SPEED;
        ENDIF
        IF row.spindle<0 OR row.spindle>MAX_SPINDLE_SPEED THEN
            Refuse TXT_SPINDLE_SPEED;
        ENDIF
        IF row.cutting AND row.spindle=0 THEN
            Refuse TXT_RESTING;
        ENDIF
        known:=ZoneOf(row.zone);
        RETURN row;
    ENDFUNC

    LOCAL PROC CheckFile(num reason,string detail)
        IF reason<>0 THEN
            refusalDetail:=detail;
            RefuseFile reason;
        ENDIF
    ENDPROC
ENDMODULE
