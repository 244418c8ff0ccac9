; The top face of the part is measured, then two M8 threads are tapped by the angle of the spindle.
; Tool 1: probe. Tool 2: tap of M8, 1.25 mm a turn.
; (DPT,approach,safety,feed): rapid to 5 mm before the nominal place, 10 mm beyond it at most, 300 mm/min.
N10 G71 G90 G94 G97 G29
N20 (UAO,0)
N30 T1.1 M6
N40 (DPT,5,10,300)
N50 G0 X0 Y0 Z-20
N60 G72 Z-60 E30
N70 (DIS,"TOP FACE",E30)
N80 G0 Z0
N90 T2.2 M6
; Programmed heights count from the face that was found.
N100 (UOT,0,ZE30)
N110 S600 M3
N120 G0 Z20
N130 G84 R3 Z-16 K1.25
N140 X20 Y15
N150 X40
N160 G80
N170 G0 Z20
N180 (UAO,0)
N190 G79 G0 Z0 M5
N200 M30
