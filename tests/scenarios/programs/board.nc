; Round and round on all three axes of board.toml.
N10 G90 G94
N12 G17
N20 G0 X0 Y0 Z0
N30 G1 X20 F3000
(RPT,99)
N40 G2 X20 Y0 I0 J0
N50 G1 Z10
N60 G1 Z0
(ERP)
N70 M2
