; PECK: one hole with chip removal, at the place where the tool stands, from 2 mm above the face
; E30 bottom (negative), E31 step (positive), E27 feed in mm/min; E38 and E39 are used inside
N10 G0 Z2
N20 E38=0
"STEP"N30 E39=E38+1
N40 E38=E38-E31
N50 (BGT,E38,E30,CUT)
N60 E38=E30
"CUT"N70 G0 ZE39
N80 G1 ZE38 FE27
N90 G0 Z2
N100 (BGT,E38,E30,STEP)
