MODULE DoorPath
    ! The path of one door in memory, as DoorFile read it and DoorMill mills it.

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

    RECORD pointrange
        num first;
        num last;
    ENDRECORD

    CONST num MAX_TARGETS:=2000;
    CONST num MAX_MOVES:=2000;
    CONST num MAX_FEATURES:=40;
    CONST num MAX_POINTS:=500;

    VAR string doorId:="";
    VAR string runId:="";
    VAR num recipeVersion:=0;
    VAR num targetCount:=0;
    VAR robtarget targets{MAX_TARGETS};
    VAR num featureCount:=0;
    VAR string features{MAX_FEATURES};
    ! Points of joint space between features, and which of them lead home from each feature.
    VAR num pointCount:=0;
    VAR jointtarget points{MAX_POINTS};
    VAR pointrange escapes{MAX_FEATURES};
    VAR num moveCount:=0;
    VAR moverow moves{MAX_MOVES};

    PROC ForgetPath()
        targetCount:=0;
        featureCount:=0;
        pointCount:=0;
        moveCount:=0;
    ENDPROC

    FUNC bool CutsLeft()
        ! From the motion on that the program came to last.
        FOR i FROM pathLast TO moveCount STEP 1 DO
            IF i>0 THEN
                IF moves{i}.cutting THEN
                    RETURN TRUE;
                ENDIF
            ENDIF
        ENDFOR
        RETURN FALSE;
    ENDFUNC

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
            Refuse TXT_ZONE;
        ENDTEST
        RETURN fine;
    ENDFUNC
ENDMODULE
