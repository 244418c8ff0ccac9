; A thread on the example lathe whose spindle has been stopped.
S600 M3
M5
G0 X30 Z308
G33 Z150 K1.5
M30
