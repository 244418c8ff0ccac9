; Twelve metres a minute of thread: more than the carriage of the example lathe can.
S3000 M3
G0 X30 Z308
G33 Z150 K9
M30
