MODULE DoorBack
    ! Out of the wood after a stop: back along the path that was cut, to where it came in.
    !
    ! A standing tool stands in its own slot and fits nowhere else. The path's own targets lead back, in plain motions.
    ! Where the path came by a place twice, the first time counts: what lies before it was cut by then, and the way
    ! back is the shorter one. So it does not matter either how far the program had run ahead of the robot.

    ! The motions at the feature that is milled, as numbers in the file: the first one, 0 for none, and the last one
    ! that the program came to.
    PERS num pathFirst:=0;
    PERS num pathLast:=0;

    ! A robot without power runs on so far beside the path at most; farther off nobody knows the wood [mm].
    LOCAL CONST num OFF_PATH:=10;
    ! So far apart two places are one [mm].
    LOCAL CONST num SAME_PLACE:=0.5;
    ! Less than this is no motion [mm], and no depth.
    LOCAL CONST num NO_WAY:=0.05;
    LOCAL CONST num NO_DEPTH:=1;
    ! A shorter arc is moved as a line: less than a tenth of a millimetre beside it [deg].
    LOCAL CONST num SHORT_ARC:=8;
    LOCAL CONST num FULL_TURN:=360;
    LOCAL CONST num UNKNOWN:=9E9;

    ! The motion that is looked at: a line, or an arc about a centre, from u towards w.
    LOCAL VAR pos begins;
    LOCAL VAR pos ends;
    LOCAL VAR bool isArc:=FALSE;
    LOCAL VAR pos centre;
    LOCAL VAR pos u;
    LOCAL VAR pos w;
    LOCAL VAR num radius:=0;
    LOCAL VAR num sweep:=0;

    PROC NotePath(num first,num last)
        ! From now on the robot is on one of these motions.
        pathFirst:=first;
        pathLast:=last;
    ENDPROC

    FUNC bool BackKnown(robtarget front)
        ! Whether BackOut gets in front of the feature from where the robot is.
        VAR robtarget here;

        here:=CRobT(\Tool:=toolMill\WObj:=wobjDoor);
        IF pathFirst=0 OR (NOT Deeper(here,front)) THEN
            RETURN TRUE;
        ENDIF
        RETURN OnPath();
    ENDFUNC

    FUNC bool OnPath()
        ! Whether the tool stands on the path at the feature.
        VAR robtarget here;

        IF pathFirst=0 THEN
            RETURN FALSE;
        ENDIF
        IF NOT PathAtHand() THEN
            RETURN FALSE;
        ENDIF
        here:=CRobT(\Tool:=toolMill\WObj:=wobjDoor);
        RETURN FromPath(here.trans)<=OFF_PATH;
    ENDFUNC

    PROC BackOut(robtarget front)
        ! Until the tool is no deeper than in front of the feature, or at the beginning of the path there.
        VAR robtarget at;
        VAR num number;
        VAR num apart;

        at:=CRobT(\Tool:=toolMill\WObj:=wobjDoor);
        IF pathFirst=0 OR (NOT Deeper(at,front)) THEN
            RETURN;
        ENDIF
        apart:=FromPath(at.trans);
        number:=FirstPast(at.trans,pathLast,apart+SAME_PLACE);
        LookAt number;
        IF apart>NO_WAY THEN
            at.trans:=Nearest(at.trans);
            MoveL at,SPEED_OUT,fine,toolMill\WObj:=wobjDoor;
        ENDIF
        WHILE number>=pathFirst AND Deeper(at,front) DO
            GoBack number,at.trans;
            at:=EndOf(number-1);
            number:=FirstPast(at.trans,number-1,SAME_PLACE);
        ENDWHILE
    ENDPROC

    LOCAL FUNC bool PathAtHand()
        ! A pointer that was moved to main took the path along.
        IF moveCount>0 AND runId=LastRun() THEN
            RETURN TRUE;
        ENDIF
        RETURN ReadKept(LastRun());
    ENDFUNC

    LOCAL FUNC bool Deeper(robtarget point,robtarget front)
        ! Along the tool's axis.
        VAR robtarget ahead;

        ahead:=RelTool(point,0,0,1);
        RETURN DotProd(point.trans-front.trans,ahead.trans-point.trans)>NO_DEPTH;
    ENDFUNC

    LOCAL PROC GoBack(num number,pos here)
        ! To the beginning of a motion from a place on it.
        VAR robtarget goal;
        VAR robtarget between;
        VAR speeddata speed;
        VAR num turn;

        LookAt number;
        goal:=EndOf(number-1);
        speed:=SPEED_CLEAR;
        IF moves{number}.cutting THEN
            speed:=SPEED_OUT;
        ENDIF
        IF Distance(here,goal.trans)<NO_WAY THEN
            RETURN;
        ENDIF
        IF isArc THEN
            turn:=TurnOf(here);
            IF turn>=SHORT_ARC AND turn<=sweep+SHORT_ARC THEN
                between:=goal;
                between.trans:=OnArc(turn/2);
                MoveC between,goal,speed,fine,toolMill\WObj:=wobjDoor;
                RETURN;
            ENDIF
        ENDIF
        MoveL goal,speed,fine,toolMill\WObj:=wobjDoor;
    ENDPROC

    LOCAL FUNC num FromPath(pos place)
        ! Distance of a place from the path [mm].
        VAR num least:=UNKNOWN;
        VAR num found;

        FOR i FROM pathFirst TO pathLast STEP 1 DO
            LookAt i;
            found:=Distance(place,Nearest(place));
            IF found<least THEN
                least:=found;
            ENDIF
        ENDFOR
        RETURN least;
    ENDFUNC

    LOCAL FUNC num FirstPast(pos place,num last,num within)
        ! The first motion that comes by a place.
        FOR i FROM pathFirst TO last STEP 1 DO
            LookAt i;
            IF Distance(place,Nearest(place))<=within THEN
                RETURN i;
            ENDIF
        ENDFOR
        RETURN last;
    ENDFUNC

    LOCAL FUNC robtarget EndOf(num number)
        IF moves{number}.kind="A" THEN
            RETURN CalcRobT(points{moves{number}.target},toolMill\WObj:=wobjDoor);
        ENDIF
        RETURN targets{moves{number}.target};
    ENDFUNC

    LOCAL PROC LookAt(num number)
        VAR robtarget before;
        VAR pos a;
        VAR pos b;
        VAR pos normal;
        VAR num size;

        before:=EndOf(number-1);
        begins:=before.trans;
        ends:=targets{moves{number}.target}.trans;
        isArc:=FALSE;
        IF moves{number}.kind<>"C" THEN
            RETURN;
        ENDIF
        a:=targets{moves{number}.via}.trans-begins;
        b:=ends-begins;
        normal:=a*b;
        size:=VectMagn(normal);
        IF size<NO_WAY*NO_WAY THEN
            RETURN;
        ENDIF
        centre:=(normal*a)*DotProd(b,b)+(b*normal)*DotProd(a,a);
        centre:=begins+centre*(1/(2*size*size));
        radius:=Distance(begins,centre);
        u:=(begins-centre)*(1/radius);
        w:=(normal*(1/size))*u;
        sweep:=TurnOf(ends);
        isArc:=TRUE;
    ENDPROC

    LOCAL FUNC num TurnOf(pos place)
        ! How far round the arc from its beginning [deg].
        VAR num angle;

        angle:=ATan2(DotProd(place-centre,w),DotProd(place-centre,u));
        IF angle<0 THEN
            RETURN angle+FULL_TURN;
        ENDIF
        RETURN angle;
    ENDFUNC

    LOCAL FUNC pos OnArc(num turn)
        RETURN centre+(u*Cos(turn)+w*Sin(turn))*radius;
    ENDFUNC

    LOCAL FUNC pos Nearest(pos place)
        VAR pos way;
        VAR num share;

        IF isArc THEN
            share:=TurnOf(place);
            IF share<=sweep THEN
                RETURN OnArc(share);
            ENDIF
            IF Distance(place,begins)<Distance(place,ends) THEN
                RETURN begins;
            ENDIF
            RETURN ends;
        ENDIF
        way:=ends-begins;
        IF VectMagn(way)<NO_WAY THEN
            RETURN begins;
        ENDIF
        share:=DotProd(place-begins,way)/DotProd(way,way);
        IF share<=0 THEN
            RETURN begins;
        ENDIF
        IF share>=1 THEN
            RETURN ends;
        ENDIF
        RETURN begins+way*share;
    ENDFUNC
ENDMODULE
