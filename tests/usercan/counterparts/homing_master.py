# SPDX-License-Identifier: Apache-2.0
"""Homes a drive with every method of CiA 402-2 that its switches are made for, and then looks where it stands: from the zero that the
homing gave it moves to both sides of a switch's edge and reads the input (60FDh). The first wrong place ends it with exit code 1.
Usage: homing_master.py NODE COUNTS MARK NEGATIVE POSITIVE HOME_FROM HOME_TO INTERFACE CHANNEL [KEY=VALUE...]
Places in counts from the plant's zero; HOME_FROM or HOME_TO may be - (the switch is active up to that end)."""
import sys

from node import Node

number, turn, mark, negative, positive = (int(a) for a in sys.argv[1:6])
home_from, home_to = (None if a == "-" else int(a) for a in sys.argv[6:8])
drive = Node(number, sys.argv[8], sys.argv[9], sys.argv[10:])
NEGATIVE, POSITIVE, HOME = 0x1, 0x2, 0x4
CLOSE = 60  # counts that the shaft may stand beside its target


def mark_above(place):
    return mark + ((place - mark) // turn + 1) * turn


def mark_below(place):
    return mark + (-((mark - place) // turn) - 1) * turn


def edge_of(base):
    """Place of the edge, and the direction in which it is crossed; as drawn in CiA 402-2, figures of the homing methods."""
    if base == 1:
        return negative, +1
    if base == 2:
        return positive, -1
    left = base in (3, 4, 7, 8, 13, 14)
    return home_from if left else home_to, +1 if base in (4, 5, 8, 10, 11, 13) else -1


def expected(method):
    """Where home has to be; of 33 and 34 any mark, of 35 and 37 no place."""
    if method >= 33:
        return None
    place, direction = edge_of(method if method <= 14 else method - 16)
    if method > 14:
        return place
    return mark_above(place) if direction > 0 else mark_below(place)


def control(word):
    drive.write(0x6040, word, 2)


def mode(value):
    drive.write(0x6060, value, 1)
    drive.until(lambda: drive.read(0x6061, size=1) == value, f"does not show mode {value}")


def move_to(place):
    """In the drive's own counts, by profile position."""
    mode(1)
    control(0x0F)
    drive.bits(0x1000, 0, "acknowledge stays")
    drive.write(0x607A, place, 4)
    control(0x3F)
    drive.bits(0x1000, 0x1000, "set-point not acknowledged")
    control(0x0F)
    drive.bits(0x1400, 0x0400, f"{place} not reached")
    drive.until(lambda: abs(drive.read(0x6064, signed=True) - place) <= CLOSE // 2, f"not at {place}")


def home(method):
    mode(6)
    drive.write(0x6098, method, 1)
    control(0x0F)
    control(0x1F)
    drive.until(lambda: drive.status() & 0x3000, f"method {method} does not end")
    drive.bits(0x3400, 0x1400, f"method {method} not attained")
    control(0x0F)


def look(method, zero, place, bit, on_above):
    """The edge at `place` lies where the drive's zero says: one side has the input, the other not."""
    for side in (-1, +1):
        move_to(place - zero + side * CLOSE)
        if bool(drive.read(0x60FD) & bit) != (on_above == (side > 0)):
            sys.exit(f"method {method}: at {place + side * CLOSE} by its own zero, inputs {drive.read(0x60FD):08X}h")


bump = home_from is not None and home_to is not None
if bump:
    methods = [1, 2, *range(7, 15), 17, 18, *range(23, 31), 33, 34, 35, 37]
else:
    methods = [3, 4, 19, 20] if home_to is None else [5, 6, 21, 22]
listed = [drive.read(0x60E3, i + 1, 2) for i in range(drive.read(0x60E3, 0, 1))]
if missing := sorted(set(methods) - set(listed)):
    sys.exit(f"60E3h does not list {missing}")
for index, value in ((0x6081, 12 * turn), (0x6083, 300 * turn), (0x6084, 300 * turn), (0x609A, 300 * turn)):
    drive.write(index, value, 4)
drive.write(0x6099, 8 * turn, 4, 1)
drive.write(0x6099, 2 * turn, 4, 2)
drive.write(0x607C, 0, 4)
drive.write(0x605A, 2, 2)
for word, code in ((0x06, 0x21), (0x07, 0x23), (0x0F, 0x27)):
    control(word)
    drive.bits(0x6F, code, f"no state {code:02X}h by {word:02X}h")
edge, bit, on_above = (home_from, HOME, True) if home_from is not None else (home_to, HOME, False)
zero = None
for number, method in enumerate(methods):
    if zero is not None and method < 33:
        # From the left of the switch, from on it and from its right in turn.
        place = (edge - turn // 2, edge + (turn // 8 if on_above else -turn // 8), edge + turn)[number % 3]
        move_to(place - zero)
    before = drive.read(0x6064, signed=True)
    home(method)
    if method in (35, 37):
        # Here is home: the zero moves to where the shaft stands.
        if abs(drive.read(0x6064, signed=True)) > CLOSE:
            sys.exit(f"method {method}: {drive.read(0x6064, signed=True)} is not zero")
        zero += before
    elif method in (33, 34):
        zero = mark_below(zero + before) if method == 33 else mark_above(zero + before)
    else:
        zero = expected(method)
    look(method, zero, edge, bit, on_above)
    if method < 3:
        limit, switch, above = (negative, NEGATIVE, False) if method == 1 else (positive, POSITIVE, True)
        # The drive stops at its limit switch by itself; up to it there is no input.
        move_to(limit - zero + (CLOSE if method == 1 else -CLOSE))
        if drive.read(0x60FD) & switch:
            sys.exit(f"method {method}: the limit switch is on before its edge")
control(0x00)
drive.bus.shutdown()
print(f"node {sys.argv[1]}: homed by {len(methods)} methods: {' '.join(str(m) for m in methods)}")
