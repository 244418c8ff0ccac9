; Full circles without an end: X and Y change their speed in every cycle.
N10 G71 G90 G94 G97 G27
N20 S2000 M3
N30 M8
N40 G0 X60 Y0 Z0
N50 (RPT,50)
N60 G3 I0 J0 X60 Y0 F6000
N70 (ERP)
N80 M5
N90 M9
N100 M30
