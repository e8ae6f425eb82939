MODULE DoorLink
    ! The PC: asks it for a path, compares what it announces, tells it what became of the file.

    ! Written here before each request: its number, so that the PC knows it from the one before.
    CONST string REQUEST_FILE:="Hei2.req";
    ! Written by the PC before ready: the run it announces, and the number of the request it answers.
    CONST string ORDER_FILE:="Hei2.run";
    ! Written here: the run that was accepted; why a file was refused or a door ended; the runs that were begun.
    CONST string ACCEPTED_FILE:="Hei2.ack";
    CONST string REFUSED_FILE:="Hei2.err";
    CONST string SEEN_FILE:="Hei2.old";
    ! Written here before doPathDone: the run that was milled to its end last, for a PC that looks late.
    CONST string MILLED_FILE:="Hei2.end";
    ! Written by whoever names the door that is being loaded; read once and removed.
    CONST string EXPECTED_FILE:="Hei2.exp";
    CONST string EXPECTED_END:="#end";
    ! What a group of 16 signals holds; 0 is no request.
    CONST num MAX_REQUEST:=65535;
    CONST num READY_FALL_TIME:=30;
    CONST num NAME_TIME:=2;
    CONST num NAME_INTERVAL:=0.2;
    CONST num CLAMP_INTERVAL:=0.04;

    ! The door that stands in the cell, named anew for each: by RWS, by EXPECTED_FILE or by giDoorNumber.
    ! ANY_DOOR switches the check off for this one door.
    PERS string expectedDoor:="";
    CONST string ANY_DOOR:="*";
    ! It is the name of the door that was seen in the clamp, and of no other.
    PERS bool nameTaken:=FALSE;
    ! The last runs that were accepted; none of them is ever milled again.
    PERS string seenRuns{16}:=["","","","","","","","","","","","","","","",""];
    PERS num seenNext:=1;
    PERS num requestNumber:=0;

    LOCAL VAR num numberBefore:=0;
    LOCAL VAR bool recalled:=FALSE;
    LOCAL VAR iodev note;
    LOCAL VAR bool noteOpen:=FALSE;

    PROC RecallRuns()
        ! PERS are new after the modules were loaded anew, or as old as the files they were saved into. Doors and tools
        ! change after a request only: whose number is another one than the one in HOME has missed some.
        VAR num number:=0;
        VAR string line;
        VAR string rest;

        IF NOT recalled THEN
            recalled:=TRUE;
            IF NOT ReadNote(REQUEST_FILE,line,rest) THEN
                number:=0;
            ELSEIF NOT StrToVal(line,number) THEN
                number:=0;
            ENDIF
            IF number<>requestNumber THEN
                LoseMemory number;
            ENDIF
        ENDIF
        FOR i FROM 1 TO Dim(seenRuns,1) DO
            IF seenRuns{i}<>"" THEN
                RETURN;
            ENDIF
        ENDFOR
        ReadRuns;
    ENDPROC

    LOCAL PROC LoseMemory(num number)
        IF number>0 THEN
            requestNumber:=number;
        ELSEIF NOT WriteNote(REQUEST_FILE,NumToStr(requestNumber,0),"","") THEN
            ! Without it the next start at main loses its memory once more.
            Report TXT_NO_REQUEST,REQUEST_FILE;
        ENDIF
        ForgetDoor;
        ForgetTool;
        IF IsFile("HOME:/"+SEEN_FILE) THEN
            FOR i FROM 1 TO Dim(seenRuns,1) DO
                seenRuns{i}:="";
            ENDFOR
            seenNext:=1;
        ENDIF
    ENDPROC

    FUNC string LastRun()
        ! The one that was begun last.
        IF seenNext=1 THEN
            RETURN seenRuns{Dim(seenRuns,1)};
        ENDIF
        RETURN seenRuns{seenNext-1};
    ENDFUNC

    PROC ForgetName()
        IF nameTaken THEN
            expectedDoor:="";
        ENDIF
        nameTaken:=FALSE;
    ENDPROC

    PROC WaitUntilOut()
        ! Until the door that was begun is taken out.
        WaitUntil ClampOpened()\PollRate:=CLAMP_INTERVAL;
        doorSpent:=FALSE;
        DropName;
    ENDPROC

    LOCAL FUNC bool ClampOpened()
        ! A stop takes the permission back.
        AllowClamp;
        RETURN diDoorClamped=0;
    ENDFUNC

    PROC DropName()
        ! Written while a door was clamped it was that door's, read twice maybe: the next one is named anew.
        RemoveNote EXPECTED_FILE;
    ENDPROC

    PROC RememberRun()
        ! Before the first motion: a run that was begun is spent, however it ends.
        seenRuns{seenNext}:=runId;
        seenNext:=seenNext MOD Dim(seenRuns,1)+1;
        WriteRuns;
    ENDPROC

    PROC WaitForDoor()
        ! Returns with a door that is clamped and named, or was taken out again, however long that takes.
        VAR bool late;

        IF doorSpent THEN
            IF diDoorClamped=1 THEN
                Show TXT_WAIT_OPEN;
            ENDIF
            WaitUntilOut;
        ENDIF
        IF diDoorClamped=0 THEN
            ForgetName;
            Show TXT_WAIT_CLAMP;
            WaitDI diDoorClamped,1;
        ENDIF
        WatchLeaving;
        AllowClamp;
        numberBefore:=0;
        IF NOT NameOrChange() THEN
            WaitUntil NameOrChange()\MaxTime:=NAME_TIME\TimeFlag:=late\PollRate:=NAME_INTERVAL;
            IF late THEN
                Show TXT_WAIT_NAME;
                WaitUntil NameOrChange()\PollRate:=NAME_INTERVAL;
            ENDIF
        ENDIF
        nameTaken:=diDoorClamped=1 AND (NOT doorChanged);
    ENDPROC

    LOCAL FUNC bool NameOrChange()
        RETURN DoorNamed() OR diDoorClamped=0 OR doorChanged;
    ENDFUNC

    LOCAL FUNC bool DoorNamed()
        VAR string name;
        VAR string last:="";
        VAR num number;

        ! The file is written in place, and of door_10 door_1 may be read: it counts when its last line is there.
        IF NOT ReadNote(EXPECTED_FILE,name,last) THEN
            last:="";
        ENDIF
        IF last=EXPECTED_END AND name<>"" THEN
            RemoveNote EXPECTED_FILE;
            ! One that cannot be removed would name every door after this one.
            IF NOT IsFile("HOME:/"+EXPECTED_FILE) THEN
                expectedDoor:=name;
            ENDIF
        ENDIF
        ! The bits of a group do not change together: a number counts when it was the same before.
        number:=giDoorNumber;
        IF expectedDoor="" AND number=numberBefore AND number>0 AND number<=Dim(doorNumbers,1) THEN
            expectedDoor:=doorNumbers{number};
        ENDIF
        numberBefore:=number;
        RETURN expectedDoor<>"";
    ENDFUNC

    FUNC bool RequestPath()
        ! FALSE when there is no door to be milled, or no more.
        VAR bool late;

        IF expectedDoor="" OR diDoorClamped=0 OR doorChanged THEN
            RETURN FALSE;
        ENDIF
        ! A ready signal that is still high belongs to an earlier file.
        WaitUntil ReadyIsLow() OR doorChanged\MaxTime:=READY_FALL_TIME\TimeFlag:=late;
        IF late THEN
            Show TXT_WAIT_PC;
            WaitUntil ReadyIsLow() OR doorChanged;
        ENDIF
        IF doorChanged THEN
            RETURN FALSE;
        ENDIF
        IF NOT NumberRequest() THEN
            Report TXT_NO_REQUEST,REQUEST_FILE;
            WaitTime READY_FALL_TIME;
            RETURN FALSE;
        ENDIF
        Reset doPathFault;
        Reset doPathDone;
        Set doPathRequest;
        WaitUntil PathReady() OR diDoorClamped=0 OR doorChanged;
        IF diDoorClamped=0 OR doorChanged THEN
            Reset doPathRequest;
            Show TXT_WITHDRAWN;
            RETURN FALSE;
        ENDIF
        RETURN TRUE;
    ENDFUNC

    LOCAL FUNC bool ReadyIsLow()
        RETURN goPathReady=0 AND doPathReady=0;
    ENDFUNC

    FUNC bool PathReady()
        ! Ready carries the number of the request it answers: a stale one is none.
        IF ORDER_REQUIRED THEN
            RETURN goPathReady=requestNumber;
        ENDIF
        RETURN doPathReady=1;
    ENDFUNC

    LOCAL FUNC bool NumberRequest()
        requestNumber:=requestNumber MOD MAX_REQUEST+1;
        RemoveNote ACCEPTED_FILE;
        RemoveNote REFUSED_FILE;
        RETURN WriteNote(REQUEST_FILE,NumToStr(requestNumber,0),"","");
    ENDFUNC

    FUNC num CheckDoor(string door)
        ! 0, or the number of the text that says what is wrong.
        IF expectedDoor="" THEN
            RETURN TXT_NO_DOOR;
        ENDIF
        IF expectedDoor<>ANY_DOOR AND expectedDoor<>door THEN
            RETURN TXT_OTHER_DOOR;
        ENDIF
        RETURN 0;
    ENDFUNC

    FUNC num CheckRun(string run)
        FOR i FROM 1 TO Dim(seenRuns,1) DO
            IF seenRuns{i}=run THEN
                RETURN TXT_REPEATED;
            ENDIF
        ENDFOR
        RETURN 0;
    ENDFUNC

    FUNC num CheckOrder(string run)
        ! A file that arrived late, or that answers an earlier request, is complete and still wrong.
        VAR string announcedRun;
        VAR string announcedRequest;

        IF NOT ORDER_REQUIRED THEN
            RETURN 0;
        ENDIF
        IF NOT ReadNote(ORDER_FILE,announcedRun,announcedRequest) THEN
            RETURN TXT_NO_ORDER;
        ENDIF
        IF announcedRun<>run OR announcedRequest<>NumToStr(requestNumber,0) THEN
            RETURN TXT_OTHER_ORDER;
        ENDIF
        RETURN 0;
    ENDFUNC

    FUNC bool TellAccepted(string run)
        RETURN WriteNote(ACCEPTED_FILE,run,NumToStr(requestNumber,0),"");
    ENDFUNC

    PROC TellMilled(string run)
        ! One that cannot be written leaves doPathDone.
        VAR bool written;

        written:=WriteNote(MILLED_FILE,run,"","");
    ENDPROC

    PROC TellRefused(num reason,string detail)
        ! A reason that cannot be written is on the pendant still.
        VAR bool written;

        written:=WriteNote(REFUSED_FILE,NumToStr(requestNumber,0),EnglishText(reason),detail);
    ENDPROC

    LOCAL FUNC bool WriteNote(string name,string first,string second,string third)
        noteOpen:=FALSE;
        Open "HOME:"\File:=name,note\Write;
        noteOpen:=TRUE;
        Write note,first;
        IF second<>"" THEN
            Write note,second;
        ENDIF
        IF third<>"" THEN
            Write note,third;
        ENDIF
        CloseNote;
        RETURN TRUE;
    ERROR
        SkipWarn;
        IF noteOpen THEN
            CloseNote;
        ENDIF
        RETURN FALSE;
    ENDFUNC

    LOCAL FUNC bool ReadNote(string name,INOUT string first,INOUT string second)
        ! FALSE when there is no such file, or none that can be read; a line that it does not have is EOF.
        IF NOT IsFile("HOME:/"+name) THEN
            RETURN FALSE;
        ENDIF
        noteOpen:=FALSE;
        Open "HOME:"\File:=name,note\Read;
        noteOpen:=TRUE;
        first:=ReadStr(note);
        second:=ReadStr(note);
        CloseNote;
        RETURN TRUE;
    ERROR
        SkipWarn;
        IF noteOpen THEN
            CloseNote;
        ENDIF
        RETURN FALSE;
    ENDFUNC

    LOCAL PROC ReadRuns()
        VAR string line;

        IF NOT IsFile("HOME:/"+SEEN_FILE) THEN
            RETURN;
        ENDIF
        noteOpen:=FALSE;
        Open "HOME:"\File:=SEEN_FILE,note\Read;
        noteOpen:=TRUE;
        line:=ReadStr(note);
        WHILE line<>EOF AND seenNext<=Dim(seenRuns,1) DO
            seenRuns{seenNext}:=line;
            seenNext:=seenNext+1;
            line:=ReadStr(note);
        ENDWHILE
        CloseNote;
        IF seenNext>Dim(seenRuns,1) THEN
            seenNext:=1;
        ENDIF
    ERROR
        SkipWarn;
        IF noteOpen THEN
            CloseNote;
        ENDIF
        RETURN;
    ENDPROC

    LOCAL PROC WriteRuns()
        ! The oldest first. A file that cannot be written leaves the PERS.
        VAR num slot;

        noteOpen:=FALSE;
        Open "HOME:"\File:=SEEN_FILE,note\Write;
        noteOpen:=TRUE;
        slot:=seenNext;
        FOR i FROM 1 TO Dim(seenRuns,1) DO
            IF seenRuns{slot}<>"" THEN
                Write note,seenRuns{slot};
            ENDIF
            slot:=slot MOD Dim(seenRuns,1)+1;
        ENDFOR
        CloseNote;
    ERROR
        SkipWarn;
        IF noteOpen THEN
            CloseNote;
        ENDIF
        RETURN;
    ENDPROC

    LOCAL PROC RemoveNote(string name)
        IF IsFile("HOME:/"+name) THEN
            RemoveFile "HOME:/"+name;
        ENDIF
    ERROR
        SkipWarn;
        RETURN;
    ENDPROC

    LOCAL PROC CloseNote()
        noteOpen:=FALSE;
        Close note;
    ERROR
        SkipWarn;
        TRYNEXT;
    ENDPROC
ENDMODULE
