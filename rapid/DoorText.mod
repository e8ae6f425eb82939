MODULE DoorText
    ! Every text the operator sees, and the questions. Letters are ASCII: RobotWare 6 and 7 read others differently.
    ! At most 46 characters each: the event log's title holds no more. Of AskNumber at most 40, beside its keys.

    CONST num ENGLISH:=1;
    CONST num GERMAN:=2;
    CONST num NORWEGIAN:=3;
    ! The language of the cell.
    PERS num language:=1;

    CONST num TXT_HEADER:=1;
    CONST num TXT_CUT_SHORT:=2;
    CONST num TXT_MISSING:=3;
    CONST num TXT_UNREADABLE:=4;
    CONST num TXT_NO_TARGET:=5;
    CONST num TXT_TOO_MANY:=6;
    CONST num TXT_FEW_NUMBERS:=7;
    CONST num TXT_MORE_NUMBERS:=8;
    CONST num TXT_NO_NUMBERS:=9;
    CONST num TXT_NOT_UNIT:=10;
    CONST num TXT_VERSION:=11;
    CONST num TXT_TARGET_COUNT:=12;
    CONST num TXT_NO_MOTION:=13;
    CONST num TXT_FIRST_ARC:=14;
    CONST num TXT_MOTION:=15;
    CONST num TXT_KIND:=16;
    CONST num TXT_SPEED:=17;
    CONST num TXT_SPINDLE_SPEED:=18;
    CONST num TXT_RESTING:=19;
    CONST num TXT_ZONE:=20;
    CONST num TXT_SUM:=21;
    CONST num TXT_SUM_TEXT:=22;
    CONST num TXT_GOES_ON:=23;
    CONST num TXT_LINE:=24;
    CONST num TXT_NO_NUMBER:=25;
    CONST num TXT_RANGE:=26;
    CONST num TXT_NO_VALUE:=27;
    CONST num TXT_HOME:=28;
    CONST num TXT_NO_DOOR:=29;
    CONST num TXT_OTHER_DOOR:=30;
    CONST num TXT_REPEATED:=31;
    CONST num TXT_NO_ORDER:=32;
    CONST num TXT_OTHER_ORDER:=33;
    CONST num TXT_TAKEN_BACK:=34;
    CONST num TXT_NO_ACK:=35;
    CONST num TXT_NO_REQUEST:=36;
    CONST num TXT_MILLING:=37;
    CONST num TXT_MILLED:=38;
    CONST num TXT_WAIT_CLAMP:=39;
    CONST num TXT_WAIT_NAME:=40;
    CONST num TXT_WAIT_PC:=41;
    CONST num TXT_WAIT_OPEN:=42;
    CONST num TXT_WAIT_GUARD:=43;
    CONST num TXT_WITHDRAWN:=44;
    CONST num TXT_SPINDLE_LOST:=45;
    CONST num TXT_SPINDLE_SLOW:=46;
    CONST num TXT_SPINDLE_STUCK:=47;
    CONST num TXT_RELEASED:=48;
    CONST num TXT_GUARD_OPEN:=49;
    CONST num TXT_STOPPED:=50;
    CONST num TXT_ERROR:=51;
    CONST num TXT_NOT_HOME:=52;
    CONST num TXT_MOVED:=53;
    CONST num TXT_BY_HAND:=54;
    CONST num TXT_ASK_RETRACT:=55;
    CONST num TXT_ASK_NEXT:=56;
    CONST num TXT_ASK_GO_ON:=57;
    CONST num TXT_RETRACT:=58;
    CONST num TXT_JOG:=59;
    CONST num TXT_OK:=60;
    CONST num TXT_RACK:=61;
    CONST num TXT_SPINDLE_TURNS:=62;
    CONST num TXT_DRAWBAR:=63;
    CONST num TXT_TOOL_STUCK:=64;
    CONST num TXT_TOOL_MISSING:=65;
    CONST num TXT_TOOL_LENGTH:=66;
    CONST num TXT_OTHER_TOOL:=67;
    CONST num TXT_ASK_TOOL:=68;
    CONST num TXT_MEASURE_TOOL:=69;
    CONST num TXT_ASK_LENGTH:=70;
    CONST num TXT_TOOL_LOOSE:=71;
    CONST num TXT_WAIT_REST:=72;
    CONST num TXT_DRY_RUN:=73;
    CONST num TXT_TOOL:=74;
    CONST num TXT_GAUGE:=75;

    LOCAL CONST num TEXTS:=75;
    LOCAL CONST num LANGUAGES:=3;
    LOCAL CONST string TABLE{TEXTS,LANGUAGES}:=[
        ["Door milling",
        "Tuerfraesen",
        "Doerfresing"],
        ["The target file is cut short.",
        "Die Zieldatei ist unvollstaendig.",
        "Maalfilen er avkortet."],
        ["The target file is missing.",
        "Die Zieldatei fehlt.",
        "Maalfilen mangler."],
        ["The target file cannot be read.",
        "Die Zieldatei ist nicht lesbar.",
        "Maalfilen kan ikke leses."],
        ["The target file holds no target.",
        "Die Zieldatei hat kein Ziel.",
        "Maalfilen har ingen maal."],
        ["Too many targets.",
        "Zu viele Ziele.",
        "For mange maal."],
        ["A target has fewer than 11 numbers.",
        "Ein Ziel hat weniger als 11 Zahlen.",
        "Et maal har faerre enn 11 tall."],
        ["A target has more than 11 numbers.",
        "Ein Ziel hat mehr als 11 Zahlen.",
        "Et maal har mer enn 11 tall."],
        ["A target holds something else than numbers.",
        "Ein Ziel enthaelt nicht nur Zahlen.",
        "Et maal har annet enn tall."],
        ["The quaternion of a target is not unit.",
        "Das Quaternion eines Ziels ist falsch.",
        "Kvaternionen til et maal er feil."],
        ["The target file has another version.",
        "Die Zieldatei hat eine andere Version.",
        "Maalfilen har en annen versjon."],
        ["The number of targets is wrong.",
        "Die Anzahl der Ziele ist falsch.",
        "Antall maal er feil."],
        ["The target file holds no motion.",
        "Die Zieldatei hat keine Bewegung.",
        "Maalfilen har ingen bevegelse."],
        ["The first motion is none of the axes.",
        "Erste Bewegung keine der Achsen.",
        "Foerste bevegelse er ikke for aksene."],
        ["A motion cannot be read.",
        "Eine Bewegung ist nicht lesbar.",
        "En bevegelse kan ikke leses."],
        ["A motion is of unknown kind.",
        "Eine Bewegung ist unbekannter Art.",
        "En bevegelse er av ukjent type."],
        ["A motion has no permitted speed.",
        "Unzulaessige Geschwindigkeit.",
        "Ulovlig hastighet."],
        ["A motion has no permitted spindle speed.",
        "Unzulaessige Spindeldrehzahl.",
        "Ulovlig spindelturtall."],
        ["A motion cuts with the spindle at rest.",
        "Schnitt bei stehender Spindel.",
        "Fresing med stillestaaende spindel."],
        ["Unknown zone.",
        "Unbekannte Zone.",
        "Ukjent sone."],
        ["The checksum is wrong.",
        "Die Pruefsumme ist falsch.",
        "Kontrollsummen er feil."],
        ["The checksum cannot be read.",
        "Die Pruefsumme ist nicht lesbar.",
        "Kontrollsummen kan ikke leses."],
        ["The target file goes on after its checksum.",
        "Text nach der Pruefsumme.",
        "Tekst etter kontrollsummen."],
        ["A line is not what it should be.",
        "Eine Zeile ist nicht, was sie sein soll.",
        "En linje er ikke som den skal vaere."],
        ["A line holds no number.",
        "Eine Zeile hat keine Zahl.",
        "En linje har ikke noe tall."],
        ["A number is out of range.",
        "Eine Zahl ist ausserhalb der Grenzen.",
        "Et tall er utenfor grensene."],
        ["A line holds no value.",
        "Eine Zeile hat keinen Wert.",
        "En linje har ingen verdi."],
        ["The target file has another home position.",
        "Andere Grundstellung in der Zieldatei.",
        "Maalfilen har en annen hjemstilling."],
        ["No door is expected: set expectedDoor.",
        "Keine Tuer erwartet: expectedDoor setzen.",
        "Ingen doer ventet: sett expectedDoor."],
        ["The target file is for another door:",
        "Die Zieldatei ist fuer eine andere Tuer:",
        "Maalfilen er for en annen doer:"],
        ["This run was milled before:",
        "Dieser Lauf wurde schon gefraest:",
        "Denne kjoeringen er alt frest:"],
        ["No order was announced.",
        "Kein Auftrag ist angekuendigt.",
        "Ingen ordre er meldt."],
        ["Another run or request is announced:",
        "Anderer Lauf oder Auftrag angekuendigt:",
        "En annen kjoering er meldt:"],
        ["The PC took the target file back.",
        "Der PC nahm die Zieldatei zurueck.",
        "PC-en tok maalfilen tilbake."],
        ["The acceptance cannot be written.",
        "Die Annahme ist nicht schreibbar.",
        "Godkjenningen kan ikke skrives."],
        ["The request cannot be written.",
        "Die Anforderung ist nicht schreibbar.",
        "Foresporselen kan ikke skrives."],
        ["Milling door:",
        "Fraese Tuer:",
        "Freser doer:"],
        ["Door is milled.",
        "Tuer ist gefraest.",
        "Doeren er frest."],
        ["Waiting for a door in the clamp.",
        "Warte auf eine Tuer im Spanner.",
        "Venter paa en doer i klemmen."],
        ["Waiting for the name of the door.",
        "Warte auf den Namen der Tuer.",
        "Venter paa navnet til doeren."],
        ["Waiting for the PC.",
        "Warte auf den PC.",
        "Venter paa PC-en."],
        ["Take the door out.",
        "Die Tuer herausnehmen.",
        "Ta ut doeren."],
        ["Close the guard.",
        "Den Schutz schliessen.",
        "Lukk vernet."],
        ["The door was taken out before its path came.",
        "Tuer vor dem Pfad herausgenommen.",
        "Doeren ble tatt ut foer banen kom."],
        ["The spindle lost its speed.",
        "Die Spindel verlor ihre Drehzahl.",
        "Spindelen mistet turtallet."],
        ["The spindle does not reach its speed.",
        "Die Spindel erreicht die Drehzahl nicht.",
        "Spindelen naar ikke turtallet."],
        ["At speed is signalled while it cannot be.",
        "Drehzahl gemeldet, die nicht sein kann.",
        "Turtall meldt som ikke kan stemme."],
        ["The door was released while milling.",
        "Die Tuer wurde beim Fraesen geloest.",
        "Doeren ble loesnet under fresing."],
        ["The guard was opened while milling.",
        "Der Schutz wurde beim Fraesen geoeffnet.",
        "Vernet ble aapnet under fresing."],
        ["The robot was stopped while milling.",
        "Der Roboter wurde beim Fraesen gestoppt.",
        "Roboten ble stoppet under fresing."],
        ["The program stopped with an error.",
        "Das Programm hielt mit einem Fehler.",
        "Programmet stoppet med en feil."],
        ["The robot is not at home.",
        "Der Roboter ist nicht in Grundstellung.",
        "Roboten er ikke hjemme."],
        ["The robot was moved by hand.",
        "Der Roboter wurde von Hand bewegt.",
        "Roboten ble flyttet for haand."],
        ["Jog it clear of the door and run MoveHome.",
        "Freifahren, dann MoveHome starten.",
        "Kjoer fri av doeren, start saa MoveHome."],
        ["Retract and go home?",
        "Zurueckziehen und in Grundstellung?",
        "Trekke ut og kjoere hjem?"],
        ["This door is spoilt. Go on with the next.",
        "Tuer verdorben. Weiter mit der naechsten.",
        "Doeren er oedelagt. Fortsett med neste."],
        ["Go on?",
        "Weiter?",
        "Fortsette?"],
        ["Retract",
        "Zurueck",
        "Trekk ut"],
        ["By hand",
        "Von Hand",
        "For haand"],
        ["OK",
        "OK",
        "OK"],
        ["The tool changes do not fit this rack.",
        "Werkzeugwechsel passen nicht zum Magazin.",
        "Verktoeybytter passer ikke magasinet."],
        ["The spindle does not come to rest.",
        "Die Spindel kommt nicht zum Stillstand.",
        "Spindelen stanser ikke."],
        ["The drawbar does not open or close.",
        "Der Spanner oeffnet oder schliesst nicht.",
        "Spennestangen aapner eller lukker ikke."],
        ["The tool did not leave the spindle.",
        "Das Werkzeug blieb in der Spindel.",
        "Verktoeyet ble sittende i spindelen."],
        ["No tool is clamped from place:",
        "Kein Werkzeug gespannt vom Platz:",
        "Ikke noe verktoey spent fra plass:"],
        ["The tool has another length [mm]:",
        "Das Werkzeug hat eine andere Laenge [mm]:",
        "Verktoeyet har en annen lengde [mm]:"],
        ["Another tool is in the spindle.",
        "Anderes Werkzeug in der Spindel.",
        "Et annet verktoey er i spindelen."],
        ["Put tool 1 in, the others into the rack.",
        "Werkzeug 1 einsetzen, andere ins Magazin.",
        "Sett inn verktoey 1, andre i magasinet."],
        ["Tool 1: measure from the spindle's nose.",
        "Werkzeug 1 ab der Spindelnase messen.",
        "Maal verktoey 1 fra spindelnesen."],
        ["How far does it stand out [mm]?",
        "Wie weit steht es heraus [mm]?",
        "Hvor langt stikker det ut [mm]?"],
        ["The tool is not clamped in the spindle.",
        "Das Werkzeug ist nicht gespannt.",
        "Verktoeyet er ikke spent fast."],
        ["Keep the clamp shut until it stands still.",
        "Spanner zu lassen, bis sie steht.",
        "Hold spennet lukket til den staar."],
        ["Dry run in manual mode: no door is milled.",
        "Trockenlauf von Hand: nichts wird gefraest.",
        "Toerrkjoering for haand: ingen doer freses."],
        ["The target file has another tool.",
        "Anderes Werkzeug in der Zieldatei.",
        "Maalfilen har et annet verktoey."],
        ["Nothing presses the gauge, yet it reads [mm]:",
        "Messtaster ist frei und zeigt doch [mm]:",
        "Maaleren er fri, men viser [mm]:"]];

    FUNC string Text(num number)
        IF language<1 OR language>LANGUAGES THEN
            RETURN TABLE{number,ENGLISH};
        ENDIF
        RETURN TABLE{number,language};
    ENDFUNC

    FUNC string EnglishText(num number)
        ! For the PC, whose log is English.
        RETURN TABLE{number,ENGLISH};
    ENDFUNC

    PROC Show(num number)
        TPWrite Text(number);
    ENDPROC

    PROC Report(num number,string detail)
        TPWrite Text(number);
        IF detail<>"" THEN
            TPWrite detail;
        ENDIF
        ErrWrite Text(TXT_HEADER),Text(number)\RL2:=detail;
    ENDPROC

    FUNC num Ask(num reason,num question,num first,num second)
        ! Number of the button that was pressed, 1 or 2; there is no second one when second is 0.
        VAR string lines{2};
        VAR string buttons{2};

        lines{1}:=Text(reason);
        lines{2}:=Text(question);
        buttons{1}:=Text(first);
        IF second<>0 THEN
            buttons{2}:=Text(second);
        ENDIF
        RETURN UIMessageBox(\Header:=Text(TXT_HEADER)\MsgArray:=lines\BtnArray:=buttons\Icon:=iconWarning);
    ENDFUNC

    FUNC num AskNumber(num reason,num question)
        ! The number that was typed. The caller looks whether it can be: with limits the box has no way out but a number
        ! within them, be it true or not. Without an initial value it offers 0 or nothing, so 0 must not be an answer.
        VAR string lines{2};

        lines{1}:=Text(reason);
        lines{2}:=Text(question);
        RETURN UINumEntry(\Header:=Text(TXT_HEADER)\MsgArray:=lines\Icon:=iconWarning);
    ENDFUNC
ENDMODULE
