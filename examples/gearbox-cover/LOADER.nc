; LOADER OF THE GEARBOX COVER, started in process 2 by cover.nc
; W0 magazine of blanks, W1200 over the vice, W1500 conveyor of finished covers.
; WAI 1: until cover.nc sends it on. SND 1: stands until cover.nc waits.
N10 G71 G90 G94 G29
N20 G0 W0
N30 M81
N40 #(SND,1)
; --- the table stands under the loader: a blank goes into the vice ---
N50 (WAI,1)
N60 G0 W1150
N70 G1 W1200 F6000
N80 M85
N90 M82
N100 G1 W1150 F6000
N110 G0 W0
N120 #(SND,1)
; --- the job is done: the cover goes to the conveyor ---
N130 (WAI,1)
N140 G0 W1150
N150 G1 W1200 F6000
N160 M83
N170 M86
N180 G1 W1250 F6000
N190 G0 W1500
N200 M84
N210 G0 W0
N220 #(SND,1)
N230 (REL)
