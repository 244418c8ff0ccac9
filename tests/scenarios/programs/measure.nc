; A measuring motion from where the machine stands.
(DPT,60,5,300)
G72 Z-20 E30
M30
