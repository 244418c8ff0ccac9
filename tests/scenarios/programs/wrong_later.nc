; Divides by a place of packet K that the machine may hold at 0.
N10 G71 G90
N20 G1 X10 F2000
N30 E25=10/SK30.IN
N40 G1 X20
N50 M30
