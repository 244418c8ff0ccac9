; A measuring motion of X from where the machine stands; the part begins at 100.123 mm.
(DPT,20,10,600)
G72 X100 E30
G72 X100 E31
M30
