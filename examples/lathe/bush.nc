; BUSH 40 x 30, bore 20 H7 roughed, from a blank of 45 mm with a hole of 16 mm
; Language NC-110. X is a diameter; the machine's zero of X is the spindle axis.
;
; Part origin: on the axis, finished face. Set by (UOT) 180 mm in front of machine zero.
; Places used: SK10.IN parts made so far, counted by the PLC; SA18 1 = chuck closed.
; Tools: T1 roughing outside, T2 finishing outside, T3 boring.
"START"N10 G71 G90 G94 G97 G27
N15 G18
N20 (UAO,0)
N30 (UOT,0,Z180)
N40 (BEQ,SA18,1,CLAMP)
N50 M68
"CLAMP"N60 (DIS,"BUSH")
;
; --- T1: face and rough the outside at constant cutting speed -----------------------
N70 T1.1 M6
N80 G97 S800 M3
N90 M8
N100 G0 X48 Z2
N110 G96 S150
N120 G95
N130 G1 Z0 F0.4
N140 X14 F0.2
N150 G0 X48 Z2
;
; Four cuts of 1 mm in diameter each, down to 41.
N160 E30=45
N170 (RPT,4)
N180 E30=E30-1
N190 G0 XE30
N200 G1 Z-33 F0.3
N210 G0 X48
N220 Z2
N230 (ERP)
;
; --- T2: finish: chamfer, cylinder, groove with radii ----------------------------------
N240 G97 S1200
N250 G0 X120 Z60
N260 T2.2 M6
N270 G96 S200
N280 G0 X34 Z2
N290 G1 Z0 F0.1
N300 X36
N310 X40 Z-2
N320 Z-12
N330 G2 X40 Z-18 R10 F0.08
N340 G1 Z-31 F0.1
N350 X46
N360 G0 X120 Z60
;
; --- T3: bore at a constant number of revolutions, feed per minute and per revolution --
N370 G97 S1000
N380 T3.3 M6
N390 G0 X18 Z2
N400 G94
N410 G1 Z-31 F120
N420 X17.5
N430 G0 Z2
N440 G95
N450 X22
N460 G1 Z0 F0.15
N470 X19.8 Z-1.1 F0.1
N480 Z-31
N490 X19
N500 G0 Z2
;
N510 M9
N520 M5
N530 G0 X200 Z250
N540 T1.1 M6
N550 (DIS,"READY")
N560 M30
