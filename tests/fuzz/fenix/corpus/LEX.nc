; title
// another
% program 1
N G90G26
NG0X10.Z-.5 // rapid
:5 X7,25;comma
N6 X (2+(1)) Z-5,5
