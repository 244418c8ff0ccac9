; Half a millimetre of a thread of 6 mm.
S600 M3
G0 X30 Z308
G33 Z307.5 K6
M30
