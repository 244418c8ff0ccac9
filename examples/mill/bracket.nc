; BRACKET 160 x 100 x 12, one setting, three tools
; Language NC-110. Machine: X Y Z, travel 300 mm to both sides of machine zero.
;
; Part origin: lower left corner of the plate, top face. Set by (UOT) from machine zero:
; the plate lies centred under the spindle, its top face 60 mm below machine zero.
;
; Places used (E parameters are free for every program):
;   SK10       1 while this program cuts, 2 in the holes, 3 when the part is finished
;   SK10.IN    parts made so far: bytes 20 and 21 of packet K, counted by the PLC
;   SA16       1 = door closed      SA18  1 = air pressure
;   SA72       air blast, free for the program
; Subprogram: PECK (one hole with chip removal: E30 depth, E31 step, E27 feed).
;
; Feed blocks run as one continuous profile (G27): M, S and T stand in G00 blocks or alone.
"START"N10 G71 G90 G94 G97 G27
N20 (UAO,0)
N30 (UOT,0,X-80,Y-50,Z-60)
;
; A closed door is a condition, not a wish: say it, then wait for it.
N40 (BEQ,SA16,1,DOOR)
N50 (DIS,"CLOSE THE DOOR")
N60 (WAI,SA16=1)
"DOOR"N70 SK10=1
N80 E10=SK10.IN
N90 (DIS,"PARTS MADE",E10)
;
; --- Tool 1: end mill of 10 mm -------------------------------------------------
; The programmed path is the path of its centre.
N100 T1.1 M6
N110 S2400 M3
N120 M8
N130 G0 X80 Y50 Z20
;
; Window of 50 mm: a helix, 2 mm a turn, six turns, then one turn to clean the floor.
N140 X100 Y50
N150 Z1
N160 G1 Z0 F900
N170 G3 I80 J50 Z-12 K2 F2400
N180 G3 I80 J50
N190 G1 X80 Y50 F3600
N200 G0 Z5
;
; Outer contour in three depths of 4 mm. Corners R15 of the part: R20 of the centre.
; The start lies outside, the way in is a quarter circle and so is the way out.
N210 E32=-4
N220 E33=0
N230 G0 X60 Y-25
N240 Z2
"DEPTH"N250 E33=E33+E32
N260 G1 ZE33 F1200
N270 G3 X80 Y-5 I60 J-5 F3000
N280 G1 X145
N290 G3 X165 Y15 I145 J15
N300 G1 Y85
N310 G3 X145 Y105 I145 J85
N320 G1 X15
N330 G3 X-5 Y85 I15 J85
N340 G1 Y15
N350 G3 X15 Y-5 I15 J15
N360 G1 X80
N370 G3 X100 Y-25 R20
N380 G0 Z2
N390 X60 Y-25
N400 (BGT,E33,-12,DEPTH)
;
; Four slots round the window: the plane is turned by 90 degrees each time.
; The origin moves to the middle of the window first, and back after the loop.
N410 G0 Z5
N420 (UIO,X80,Y50)
N430 E25=45
N440 E0=0
"SLOT"N450 (URT,E25)
N460 G0 X34 Y-3
N470 Z1
N480 G1 Z-3 F1500
N490 X42 F2400
N500 G3 X42 Y3 I42 J0
N510 G1 X34
N520 G3 X34 Y-3 I34 J0
N530 G0 Z5
N540 E25=E25+90
N550 E0=E0+1
N560 (BLT,E0,4,SLOT)
N570 (URT,0)
N580 (UIO,X-80,Y-50)
;
; Chips out of the window before the holes: half a second of air.
N590 SA72=1
N600 #(DLY,0.5)
N610 SA72=0
N620 G0 Z80 M9
N630 M5
;
; --- Tool 2: drill of 6 mm ------------------------------------------------------
N640 SK10=2
N650 T2.2 M6
N660 S3200 M3
N670 M8
N680 G0 Z20
;
; Four corner holes. The second row is the first one, shifted.
N690 E30=-14
N700 E31=5
N710 E27=900
N720 (RPT,2)
N730 G0 X15 Y15
N740 Z2
N750 (CLS,PECK)
N760 G0 X145
N770 (CLS,PECK)
N780 (UIO,Y70)
N790 (ERP)
N800 (UIO,Y-140)
;
; Four holes on a circle of 72 mm about the window; the angle is counted in E34.
N810 E34=0
N820 E35=36
"HOLE"N830 E36=80+E35*COS(E34)
N840 E37=50+E35*SIN(E34)
N850 G0 XE36 YE37
N860 (CLS,PECK)
N870 E34=E34+90
N880 (BLT,E34,360,HOLE)
N890 G0 Z80 M9
N900 M5
;
; --- Tool 3: engraving tool -----------------------------------------------------
N910 T3.3 M6
N920 S4500 M3
N930 G0 Z20
;
; A cam outline as CAM systems write it: short lines, left; its mirror image, right.
; The mirror line is the origin, so the origin stands on the middle line of the plate.
N940 (UIO,X80,Y50)
N950 E1=0
"CAM"N960 G0 X-46.400 Y0.000
N970 Z1
N980 G1 Z-0.4 F800
N990 X-46.787 Y3.163 F1800
N1000 X-47.851 Y5.910
N1010 X-49.340 Y8.000
N1020 X-50.952 Y9.462
N1030 X-52.463 Y10.558
N1040 X-53.800 Y11.639
N1050 X-55.054 Y12.952
N1060 X-56.402 Y14.496
N1070 X-58.000 Y16.000
N1080 X-59.875 Y17.017
N1090 X-61.894 Y17.118
N1100 X-63.800 Y16.073
N1110 X-65.319 Y13.955
N1120 X-66.273 Y11.107
N1130 X-66.660 Y8.000
N1140 X-66.645 Y5.035
N1150 X-66.483 Y2.393
N1160 X-66.400 Y0.000
N1170 X-66.483 Y-2.393
N1180 X-66.645 Y-5.035
N1190 X-66.660 Y-8.000
N1200 X-66.273 Y-11.107
N1210 X-65.319 Y-13.955
N1220 X-63.800 Y-16.073
N1230 X-61.894 Y-17.118
N1240 X-59.875 Y-17.017
N1250 X-58.000 Y-16.000
N1260 X-56.402 Y-14.496
N1270 X-55.054 Y-12.952
N1280 X-53.800 Y-11.639
N1290 X-52.463 Y-10.558
N1300 X-50.952 Y-9.462
N1310 X-49.340 Y-8.000
N1320 X-47.851 Y-5.910
N1330 X-46.787 Y-3.163
N1340 X-46.400 Y-0.000
N1350 G0 Z3
N1360 (BEQ,E1,1,CAMEN)
N1370 E1=1
N1380 (MIR,X)
N1390 (BNC,CAM)
"CAMEN"N1400 (MIR)
;
; An arrow, once at its size and once at half of it (the scale acts about the origin).
N1410 (UIO,X0,Y-40)
N1420 (SCF,1)
"ARROW"N1430 G0 X-12 Y-3
N1440 Z1
N1450 G1 Z-0.4 F800
N1460 X-12 Y3 F1800
N1470 X4 Y3
N1480 X4 Y6
N1490 X14 Y0
N1500 X4 Y-6
N1510 X4 Y-3
N1520 X-12 Y-3
"ARREN"N1530 G0 Z3
N1540 (UIO,Y80)
N1550 (SCF,0.5,X,Y)
N1560 (EPP,ARROW,ARREN)
N1570 (SCF)
N1580 (UAO,0)
;
; --- End: high, parked, everything off ------------------------------------------
N1590 G79 G0 Z0
N1600 G79 X0 Y200 M5
N1610 SK10=3
N1620 (DIS,"BRACKET FINISHED")
N1630 M30
