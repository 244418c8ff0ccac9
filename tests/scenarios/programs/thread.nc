; A thread of 1.5 mm on the example lathe; X is a diameter.
S600 M3
G0 X30 Z308
G33 Z150 K1.5
M30
