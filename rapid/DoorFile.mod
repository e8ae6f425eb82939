MODULE DoorFile
    ! Reads the target file and checks it. Nothing of a file is used before all of it was found good.
    !
    ! The file: one line x;y;z;q1;q2;q3;q4;cf1;cf4;cf6;cfx; for each target, then lines that begin
    ! with # in a fixed order, the last of them the checksum of all bytes before it.

    RECORD moverow
        string kind;
        num target;
        num via;
        num speed;
        string zone;
        num feature;
        bool cutting;
        num spindle;
    ENDRECORD

    RECORD sumpair
        num a;
        num b;
    ENDRECORD

    CONST string TARGET_FILE:="Hei2.txt";
    ! Written here before each request: its number, so that the PC knows it from the one before.
    CONST string REQUEST_FILE:="Hei2.req";
    ! Written by the PC before ready: the run it announces, and the number of the request it answers.
    CONST string ORDER_FILE:="Hei2.run";
    CONST num MAX_REQUEST:=999999;
    CONST num FILE_VERSION:=1;
    CONST num MAX_TARGETS:=2000;
    CONST num MAX_MOVES:=2000;
    CONST num MAX_FEATURES:=40;
    CONST num MAX_SPEED:=7000;
    CONST num MAX_CF:=4;
    CONST num MAX_CFX:=7;
    CONST num UNIT_TOLERANCE:=0.00001;
    CONST num NOT_CONNECTED:=9E9;

    ! Two rolling remainders over pairs of characters. A num is exact up to 2^23, and
    ! factor*(modulus-1)+CODES*CODES stays below it.
    LOCAL CONST num FACTOR_A:=251;
    LOCAL CONST num MODULUS_A:=32749;
    LOCAL CONST num FACTOR_B:=241;
    LOCAL CONST num MODULUS_B:=32719;
    LOCAL CONST num CODES:=128;
    LOCAL CONST num LINE_FEED:=10;

    ! The door that stands in the cell, set by whoever loads it (panel, line control or RWS).
    ! ANY_DOOR switches the check off; while it is empty every file is refused.
    PERS string expectedDoor:="";
    CONST string ANY_DOOR:="*";
    ! The last runs that were accepted; none of them is ever milled again.
    PERS string seenRuns{16}:=["","","","","","","","","","","","","","","",""];
    PERS num seenNext:=1;
    PERS num requestNumber:=0;

    ! What the file says.
    VAR string doorId:="";
    VAR string runId:="";
    VAR num recipeVersion:=0;
    VAR num targetCount:=0;
    VAR robtarget targets{MAX_TARGETS};
    VAR num featureCount:=0;
    VAR string features{MAX_FEATURES};
    VAR num moveCount:=0;
    VAR moverow moves{MAX_MOVES};

    ! Why the file was refused, and what it says there.
    VAR errnum ERR_FILE_REFUSED:=-1;
    VAR string refusal:="";
    VAR string refusalDetail:="";

    LOCAL VAR iodev file;
    LOCAL VAR string lineText:="";
    LOCAL VAR num lineNumber:=0;
    LOCAL VAR sumpair sum;

    PROC ReadTargetFile()
        ! Raises ERR_FILE_REFUSED, with the reason in refusal and refusalDetail.
        VAR errnum problem;

        ForgetFile;
        CloseFile;
        Open "HOME:"\File:=TARGET_FILE,file\Read;
        NextLine;
        ReadTargets;
        ReadTrailer;
        CloseFile;
        CheckDoor;
        CheckRun;
        CheckOrder;
    ERROR
        ! CloseFile has an error handler of its own, which changes ERRNO.
        problem:=ERRNO;
        CloseFile;
        ForgetFile;
        IF problem=ERR_FILEOPEN THEN
            refusal:="The target file is missing.";
            refusalDetail:=TARGET_FILE;
        ELSEIF problem<>ERR_FILE_REFUSED THEN
            refusal:="The target file cannot be read.";
            refusalDetail:=TARGET_FILE;
        ENDIF
        RAISE ERR_FILE_REFUSED;
    ENDPROC

    PROC NumberRequest()
        requestNumber:=requestNumber MOD MAX_REQUEST+1;
        CloseFile;
        Open "HOME:"\File:=REQUEST_FILE,file\Write;
        Write file,NumToStr(requestNumber,0);
        CloseFile;
    ENDPROC

    PROC RememberRun()
        ! Before the first motion: a run that was begun is spent, however it ends.
        seenRuns{seenNext}:=runId;
        seenNext:=seenNext MOD Dim(seenRuns,1)+1;
    ENDPROC

    FUNC zonedata ZoneOf(string name)
        TEST name
        CASE "fine":
            RETURN fine;
        CASE "z0":
            RETURN z0;
        CASE "z1":
            RETURN z1;
        CASE "z5":
            RETURN z5;
        CASE "z10":
            RETURN z10;
        CASE "z15":
            RETURN z15;
        CASE "z20":
            RETURN z20;
        CASE "z30":
            RETURN z30;
        CASE "z40":
            RETURN z40;
        CASE "z50":
            RETURN z50;
        CASE "z60":
            RETURN z60;
        CASE "z80":
            RETURN z80;
        CASE "z100":
            RETURN z100;
        CASE "z150":
            RETURN z150;
        CASE "z200":
            RETURN z200;
        DEFAULT:
            Refuse "Unknown zone.";
        ENDTEST
        RETURN fine;
    ENDFUNC

    LOCAL PROC ReadTargets()
        WHILE NOT Begins(lineText,"#") DO
            IF targetCount=MAX_TARGETS THEN
                Refuse "Too many targets.";
            ENDIF
            targetCount:=targetCount+1;
            targets{targetCount}:=TargetOf(lineText);
            AddToSum lineText;
            NextLine;
        ENDWHILE
        IF targetCount=0 THEN
            Refuse "The target file holds no target.";
        ENDIF
    ENDPROC

    LOCAL FUNC robtarget TargetOf(string text)
        VAR robtarget target;
        VAR num at:=1;

        IF text=EOF THEN
            Refuse "The target file is cut short.";
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
            Refuse "A target has more than 11 numbers.";
        ENDIF
        target.extax:=[NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED,NOT_CONNECTED];
        CheckTarget target;
        RETURN target;
    ENDFUNC

    LOCAL FUNC num FieldOf(string text,INOUT num at)
        ! The number from position at up to the next semicolon; at goes behind it.
        VAR num ending;
        VAR num value;

        IF at>StrLen(text) THEN
            Refuse "A target has fewer than 11 numbers.";
        ENDIF
        ending:=StrFind(text,at,";");
        IF ending>StrLen(text) OR ending=at THEN
            Refuse "A target has fewer than 11 numbers.";
        ENDIF
        ! StrToVal leaves value alone when the text is no number.
        IF NOT StrToVal(StrPart(text,at,ending-at),value) THEN
            Refuse "A target holds something else than numbers.";
        ENDIF
        at:=ending+1;
        RETURN value;
    ENDFUNC

    LOCAL PROC CheckTarget(robtarget target)
        VAR num square;

        square:=target.rot.q1*target.rot.q1+target.rot.q2*target.rot.q2;
        square:=square+target.rot.q3*target.rot.q3+target.rot.q4*target.rot.q4;
        IF Abs(square-1)>UNIT_TOLERANCE THEN
            Refuse "The quaternion of a target is not unit.";
        ENDIF
        CheckInteger target.robconf.cf1,-MAX_CF,MAX_CF-1;
        CheckInteger target.robconf.cf4,-MAX_CF,MAX_CF-1;
        CheckInteger target.robconf.cf6,-MAX_CF,MAX_CF-1;
        CheckInteger target.robconf.cfx,0,MAX_CFX;
    ENDPROC

    LOCAL PROC ReadTrailer()
        IF NumberAfter("#doormill ")<>FILE_VERSION THEN
            Refuse "The target file has another version.";
        ENDIF
        doorId:=TextAfter("#door ");
        runId:=TextAfter("#run ");
        recipeVersion:=NumberAfter("#recipe ");
        IF NumberAfter("#targets ")<>targetCount THEN
            Refuse "The number of targets is wrong.";
        ENDIF
        featureCount:=CountAfter("#features ",MAX_FEATURES);
        IF featureCount>0 THEN
            FOR i FROM 1 TO featureCount DO
                features{i}:=TextAfter("#feature ");
            ENDFOR
        ENDIF
        moveCount:=CountAfter("#motions ",MAX_MOVES);
        IF moveCount=0 THEN
            Refuse "The target file holds no motion.";
        ENDIF
        FOR i FROM 1 TO moveCount DO
            moves{i}:=MoveAfter("#move ");
        ENDFOR
        IF moves{1}.kind="C" THEN
            Refuse "The first motion is an arc.";
        ENDIF
        CheckSum;
    ENDPROC

    LOCAL FUNC moverow MoveAfter(string tag)
        VAR moverow row;
        VAR zonedata known;

        IF NOT StrToVal(TextAfter(tag),row) THEN
            Refuse "A motion cannot be read.";
        ENDIF
        CheckInteger row.target,1,targetCount;
        CheckInteger row.feature,0,featureCount;
        TEST row.kind
        CASE "C":
            CheckInteger row.via,1,targetCount;
        CASE "J","L":
            CheckInteger row.via,0,0;
        DEFAULT:
            Refuse "A motion is of unknown kind.";
        ENDTEST
        IF row.speed<=0 OR row.speed>MAX_SPEED THEN
            Refuse "A motion has no permitted speed.";
        ENDIF
        IF row.spindle<0 OR row.spindle>MAX_SPINDLE_SPEED THEN
            Refuse "A motion has no permitted spindle speed.";
        ENDIF
        IF row.cutting AND row.spindle=0 THEN
            Refuse "A motion cuts with the spindle at rest.";
        ENDIF
        known:=ZoneOf(row.zone);
        RETURN row;
    ENDFUNC

    LOCAL PROC CheckSum()
        VAR sumpair written;

        IF NOT Begins(lineText,"#sum ") THEN
            Refuse "The target file is cut short.";
        ENDIF
        IF NOT StrToVal(Rest(lineText,"#sum "),written) THEN
            Refuse "The checksum cannot be read.";
        ENDIF
        IF written<>sum THEN
            Refuse "The checksum is wrong.";
        ENDIF
        NextLine;
        IF lineText<>EOF THEN
            Refuse "The target file goes on after its checksum.";
        ENDIF
    ENDPROC

    LOCAL PROC CheckDoor()
        IF expectedDoor="" THEN
            Refuse "No door is expected: set expectedDoor.";
        ENDIF
        IF expectedDoor<>ANY_DOOR AND expectedDoor<>doorId THEN
            refusalDetail:=doorId;
            RefuseFile "The target file is for another door:";
        ENDIF
    ENDPROC

    LOCAL PROC CheckRun()
        FOR i FROM 1 TO Dim(seenRuns,1) DO
            IF seenRuns{i}=runId THEN
                refusalDetail:=runId;
                RefuseFile "This run was milled before:";
            ENDIF
        ENDFOR
    ENDPROC

    LOCAL PROC CheckOrder()
        ! A file that arrived late, or that answers an earlier request, is complete and still wrong.
        VAR string announcedRun;
        VAR string announcedRequest;

        IF NOT IsFile("HOME:/"+ORDER_FILE) THEN
            ! A PC that announces nothing but the ready signal.
            RETURN;
        ENDIF
        Open "HOME:"\File:=ORDER_FILE,file\Read;
        announcedRun:=ReadStr(file);
        announcedRequest:=ReadStr(file);
        CloseFile;
        IF announcedRun<>runId OR announcedRequest<>NumToStr(requestNumber,0) THEN
            refusalDetail:=announcedRun;
            RefuseFile "Another run or request is announced:";
        ENDIF
    ENDPROC

    LOCAL PROC NextLine()
        lineText:=ReadStr(file);
        lineNumber:=lineNumber+1;
    ENDPROC

    LOCAL FUNC string TextAfter(string tag)
        ! What follows the tag in the present line; goes on to the next line.
        VAR string text;

        IF lineText=EOF THEN
            Refuse "The target file is cut short.";
        ENDIF
        IF NOT Begins(lineText,tag) THEN
            Refuse "A line is not what it should be.";
        ENDIF
        text:=Rest(lineText,tag);
        AddToSum lineText;
        NextLine;
        RETURN text;
    ENDFUNC

    LOCAL FUNC num NumberAfter(string tag)
        VAR num value;

        IF NOT StrToVal(TextAfter(tag),value) THEN
            Refuse "A line holds no number.";
        ENDIF
        RETURN value;
    ENDFUNC

    LOCAL FUNC num CountAfter(string tag,num largest)
        VAR num value;

        value:=NumberAfter(tag);
        CheckInteger value,0,largest;
        RETURN value;
    ENDFUNC

    LOCAL PROC CheckInteger(num value,num smallest,num largest)
        IF value<>Round(value) OR value<smallest OR value>largest THEN
            Refuse "A number is out of range.";
        ENDIF
    ENDPROC

    LOCAL FUNC bool Begins(string text,string start)
        ! Both sides of AND are evaluated, and StrPart must stay inside the text.
        IF StrLen(text)<StrLen(start) THEN
            RETURN FALSE;
        ENDIF
        RETURN StrPart(text,1,StrLen(start))=start;
    ENDFUNC

    LOCAL FUNC string Rest(string text,string start)
        ! The text behind its start, which it has.
        IF StrLen(text)=StrLen(start) THEN
            Refuse "A line holds no value.";
        ENDIF
        RETURN StrPart(text,StrLen(start)+1,StrLen(text)-StrLen(start));
    ENDFUNC

    LOCAL PROC AddToSum(string text)
        VAR num last;
        VAR num pair;
        VAR num a;
        VAR num b;

        last:=StrLen(text);
        a:=sum.a;
        b:=sum.b;
        ! Written out, without calls of own routines: this loop takes most of the reading time.
        FOR at FROM 1 TO last-1 STEP 2 DO
            pair:=StrToByte(StrPart(text,at,1)\Char)*CODES+StrToByte(StrPart(text,at+1,1)\Char);
            a:=(a*FACTOR_A+pair) MOD MODULUS_A;
            b:=(b*FACTOR_B+pair) MOD MODULUS_B;
        ENDFOR
        sum.a:=a;
        sum.b:=b;
        IF last MOD 2=1 THEN
            AddPair StrToByte(StrPart(text,last,1)\Char)*CODES;
        ENDIF
        AddPair LINE_FEED;
    ENDPROC

    LOCAL PROC AddPair(num pair)
        sum.a:=(sum.a*FACTOR_A+pair) MOD MODULUS_A;
        sum.b:=(sum.b*FACTOR_B+pair) MOD MODULUS_B;
    ENDPROC

    LOCAL PROC Refuse(string reason)
        ! The present line is at fault.
        refusalDetail:="Line "+NumToStr(lineNumber,0);
        RefuseFile reason;
    ENDPROC

    LOCAL PROC RefuseFile(string reason)
        refusal:=reason;
        RAISE ERR_FILE_REFUSED;
    ENDPROC

    LOCAL PROC ForgetFile()
        targetCount:=0;
        featureCount:=0;
        moveCount:=0;
        lineNumber:=0;
        sum:=[1,1];
        IF ERR_FILE_REFUSED=-1 THEN
            BookErrNo ERR_FILE_REFUSED;
        ENDIF
    ENDPROC

    LOCAL PROC CloseFile()
        Close file;
    ERROR
        ! It was not open.
        TRYNEXT;
    ENDPROC
ENDMODULE
