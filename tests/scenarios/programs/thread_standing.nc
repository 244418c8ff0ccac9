; A thread on the example lathe whose spindle nobody has told to turn.
G0 X30 Z308
G33 Z150 K1.5
M30
