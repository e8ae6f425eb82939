MODULE DoorLine
    ! Reads a file line by line and sums what it read. What is wrong with a line is raised with its number.

    RECORD sumpair
        num a;
        num b;
    ENDRECORD

    ! Two rolling remainders over pairs of characters. A num is exact up to 2^23, and
    ! factor*(modulus-1)+CODES*CODES stays below it.
    LOCAL CONST num FACTOR_A:=251;
    LOCAL CONST num MODULUS_A:=32749;
    LOCAL CONST num FACTOR_B:=241;
    LOCAL CONST num MODULUS_B:=32719;
    LOCAL CONST num CODES:=128;
    LOCAL CONST num LINE_FEED:=10;

    ! Why the file was refused (number of a text), and what it says there.
    VAR errnum ERR_FILE_REFUSED:=-1;
    VAR num refusal:=0;
    VAR string refusalDetail:="";

    ! The present line, or EOF.
    VAR string lineText:="";

    LOCAL VAR iodev file;
    LOCAL VAR bool fileOpen:=FALSE;
    LOCAL VAR num lineNumber:=0;
    LOCAL VAR sumpair sum;

    PROC OpenLines(string name)
        ! The first line of a file in HOME becomes lineText; the sum and the refusal begin anew.
        CloseLines;
        refusal:=0;
        refusalDetail:="";
        lineNumber:=0;
        sum:=[1,1];
        IF ERR_FILE_REFUSED=-1 THEN
            BookErrNo ERR_FILE_REFUSED;
        ENDIF
        Open "HOME:"\File:=name,file\Read;
        fileOpen:=TRUE;
        NextLine;
    ENDPROC

    PROC CloseLines()
        ! Without effect, and without an error, when none is open: error clauses call this.
        IF fileOpen THEN
            fileOpen:=FALSE;
            Close file;
        ENDIF
    ENDPROC

    PROC NextLine()
        lineText:=ReadStr(file);
        lineNumber:=lineNumber+1;
    ENDPROC

    FUNC string TextAfter(string tag)
        ! What follows the tag in the present line; goes on to the next line.
        VAR string text;

        IF lineText=EOF THEN
            Refuse TXT_CUT_SHORT;
        ENDIF
        IF NOT Begins(lineText,tag) THEN
            Refuse TXT_LINE;
        ENDIF
        text:=Rest(lineText,tag);
        AddToSum lineText;
        NextLine;
        RETURN text;
    ENDFUNC

    FUNC num NumberAfter(string tag)
        VAR num value;

        IF NOT StrToVal(TextAfter(tag),value) THEN
            Refuse TXT_NO_NUMBER;
        ENDIF
        RETURN value;
    ENDFUNC

    FUNC num CountAfter(string tag,num largest)
        VAR num value;

        value:=NumberAfter(tag);
        CheckInteger value,0,largest;
        RETURN value;
    ENDFUNC

    PROC CheckInteger(num value,num smallest,num largest)
        IF value<>Round(value) OR value<smallest OR value>largest THEN
            Refuse TXT_RANGE;
        ENDIF
    ENDPROC

    FUNC num FieldOf(string text,INOUT num at)
        ! The number from position at up to the next semicolon; at goes behind it.
        VAR num ending;
        VAR num value;

        IF at>StrLen(text) THEN
            Refuse TXT_FEW_NUMBERS;
        ENDIF
        ending:=StrFind(text,at,";");
        IF ending>StrLen(text) OR ending=at THEN
            Refuse TXT_FEW_NUMBERS;
        ENDIF
        ! StrToVal leaves value alone when the text is no number.
        IF NOT StrToVal(StrPart(text,at,ending-at),value) THEN
            Refuse TXT_NO_NUMBERS;
        ENDIF
        at:=ending+1;
        RETURN value;
    ENDFUNC

    FUNC bool Begins(string text,string start)
        ! Both sides of AND are evaluated, and StrPart must stay inside the text.
        IF StrLen(text)<StrLen(start) THEN
            RETURN FALSE;
        ENDIF
        RETURN StrPart(text,1,StrLen(start))=start;
    ENDFUNC

    LOCAL FUNC string Rest(string text,string start)
        ! The text behind its start, which it has.
        IF StrLen(text)=StrLen(start) THEN
            Refuse TXT_NO_VALUE;
        ENDIF
        RETURN StrPart(text,StrLen(start)+1,StrLen(text)-StrLen(start));
    ENDFUNC

    PROC CheckSum()
        VAR sumpair written;

        IF NOT Begins(lineText,"#sum ") THEN
            Refuse TXT_CUT_SHORT;
        ENDIF
        IF NOT StrToVal(Rest(lineText,"#sum "),written) THEN
            Refuse TXT_SUM_TEXT;
        ENDIF
        IF written<>sum THEN
            Refuse TXT_SUM;
        ENDIF
        NextLine;
        IF lineText<>EOF THEN
            Refuse TXT_GOES_ON;
        ENDIF
    ENDPROC

    PROC AddToSum(string text)
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

    PROC Refuse(num reason)
        ! The present line is at fault.
        refusalDetail:="Line "+NumToStr(lineNumber,0);
        RefuseFile reason;
    ENDPROC

    PROC RefuseFile(num reason)
        refusal:=reason;
        RAISE ERR_FILE_REFUSED;
    ENDPROC
ENDMODULE
