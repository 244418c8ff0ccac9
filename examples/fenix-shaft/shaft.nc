; SHAFT 40 / 32 / 24 with a collar, three grooves, a thread undercut and a bore 12, from a blank of 45 x 90
; Language of the control Fenix. X is a diameter; G54 is the finished face (tables/origins.toml).
; Tools: T1 roughing outside, T2 finishing outside and grooves, T3 drill and boring bar.
;
; --- subprograms and a cycle of its own -------------------------------------
L1
N1 G90 G27 G0 X120 Z60 ; where the turret may turn
N2 M17
L2
N1 G90 G0 Z(R1) ; a groove: R1 its flank, R2 its bottom, R3 its width
N2 G27 X(R4+2)
N3 G1 X(R2) F0.05
N4 G4(300)
N5 G27 X(R4+2) F0.2
N6 G91 Z(R3-2) ; the tool is 2 mm wide
N7 G90 G27 X(R2) F0.05
N8 G27 X(R4+2) F0.2
N9 M17
@900
N1 $d($0) $z($1) $l($2) ; a chamfer: diameter, place, leg
N2 G90 G27 G0 X($d+2) Z($z+$l+1)
N3 G90 G27 G1 X($d-2*$l) F0.2
N4 G90 Z($z+$l)
N5 G90 G27 X($d) Z($z) F0.08
N6 G91 G27 X2 F0.3
N7 $n($3)
N8 ~($n<1) N12
N9 G90 G27 G0 X($d+2)
N10 $n($n-1)
N11 ~($n>0) N10
N12 G90 G27 G0 X($d+2)
#
%
; --- T1: face and rough ------------------------------------------------------
N10 G90
N20 G54
N30 L1
N40 T1 M6
N50 S800 M3
N60 M8
N70 G0 G27 X48 Z2
N80 G96(,2500) S150
N90 G1 Z0 F0.4
N100 G27 X-1 F0.2
N110 Z1 F0.5
N120 G0 G27 X45
; the whole length to 41, in cuts of 2 mm
N130 G0 Z2
N140 G77(2) X41 Z-72 F0.3
; the neck to 33, its shoulder with a bevel
N150 G0 G27 X41
N160 G77(3,2) X33 Z-48 F0.3
; the end to 25
N170 G0 G27 X33
N180 G77(4) X25 Z-22 F0.28
; the last cuts by hand: a loop of H
N190 R1(25)
N200 G0 G27 X26 Z2
N210 H3
N220 R1(R1-0.15)
N230 G27 G0 X(R1)
N240 G1 Z-21.8 F0.25
N250 G91 G27 X2 F0.5
N260 G90 G0 Z2
N270 M20
N280 G97 S600
N290 L1
; --- T2: finish ---------------------------------------------------------------
N300 T2 M6
N310 S1200 M3
N320 M8
N330 G0 G27 X18 Z2
N340 G96(,3000) S200
N350 G1 Z0 F0.1
N360 G27 X20
N370 G27 X24 Z-2
N380 Z-18
N390 G1(-20) G27 X22.5 F0.06
N400 Z-22 F0.08
N410 G27 X28
N420 G2 G27 X32 Z-24 I0 K-2 F0.07
N430 Z-44 F0.1
N440 G3 G27 X36 Z-46 I4 K0 F0.06
N450 G27 X38 F0.1
N460 G27 X40 Z-47
N470 Z-70
N480 G27 X46 F0.3
N490 G97 S700
N500 G0 Z2
; chamfers by the cycle
N510 G900(40,-70.5,0.5,2)
N520 G900(32,-24.2,0.2)
; grooves: a tool 2 mm wide
N530 R4(40) R2(36) R3(3)
N540 R1(-52)
N550 L2
N560 R1(-58)
N570 L2
N580 R1(-64)
N590 L2
; the undercut of the thread by G75, two plunges
N600 G90 G27 G0 X26 Z-19
N610 G75(1.5) G27 X21.5 Z-20.5 F0.05
N620 G0 G27 X60
N630 L1
; --- T3: drill and bore --------------------------------------------------------
N640 T3 M6
N650 S900 M3
N660 M8
N670 G0 G27 X0 Z5
N680 G67(6,0.5)
N690 G810(2,-12,5,,,0.08)
N700 G68
N710 G812(2,-40,5,100,10,6,50,0.1,200)
N720 G67(8,1,0,50)
N730 G811(2,-14,5,200,,0.12)
N740 G68
; the bore in two widenings, the wall left by 0.2 mm before the tool comes out
N750 G90 G27 G0 X10 Z3
N760 G820(1,-30,3,-0.4,,0.08,0,1000)
N770 G90 G27 G0 X10 Z3
N780 G824(1,-30,12,1,0.2,-0.4,-0.4,3,,,0.06,0,1100)
N790 G0 Z5
; a chamfer into the bore
N800 G90 G27 G0 X15 Z1
N810 G1 G27 X14 Z0.2 F0.2
N820 G90 G27 G1 X13.6 Z-0.1 F0.06
N830 G90 G27 G1 X13.2 Z-0.2 F0.06
N840 G90 G27 G1 X12.8 Z-0.3 F0.06
N850 G90 G27 G1 X12.4 Z-0.4 F0.06
N860 G0 Z5
N870 L1
; --- T2 again: the last pass over the collar, at three speeds of its own -----------
N880 T2 M6
N890 S1000 M3
N900 G90 G27 G0 X42 Z-45
N910 G27 G1 X40 F0.3
N920 G9 Z-49 F0.12
N930 G91 G27 X2 F0.5
N940 G90 G27 G0 X42 Z-51
N950 G27 G1 X40 F0.3
N960 G9 Z-55 F0.1
N970 G91 G27 X2 F0.5
N980 G90 G27 G0 X42 Z-57
N990 G27 G1 X40 F0.3
N1000 G9 Z-61 F0.08
N1010 G91 G27 X2 F0.5
N1020 G90 G27 G0 X42 Z-65
N1030 G27 G1 X40 F0.3
N1040 G9 Z-69 F0.06
N1050 G91 G27 X2 F0.5
N1060 M10 S300
N1070 G4(500)
N1080 M10 S300
N1090 M9
N1100 M5
N1110 L1
N1120 T1 M6
N1130 M2
