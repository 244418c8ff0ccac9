; An outer thread M20 x 1.5 in four passes, then a second start half a revolution behind the first.
; X is a diameter. The thread begins 8 mm before the part: the carriage runs in there.
N10 G71 G90 G94 G97 G29
N15 G18
N20 T3.3 M6
N30 S600 M3
N40 G0 X30 Z308
N50 E30=19.6
"PASS"N60 G0 XE30
N70 G33 Z262 K1.5
N80 G0 X30
N90 Z308
N100 E30=E30-0.4
N110 (BGT,E30,18.3,PASS)
; A thread of two starts on the next diameter, 3 mm a turn.
N120 G0 X40
N130 G0 X26
N140 G33 Z262 K3
N150 G0 X40
N160 Z308
N170 G0 X26
N180 G33 Z262 K3 R180
N190 G0 X40
N200 G79 G0 X110 M5
N210 M30
