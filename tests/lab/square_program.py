# SPDX-License-Identifier: Apache-2.0
"""A part program that keeps three axes moving for so many seconds. Usage: square_program.py SECONDS"""
import sys

feed_mm_min, side = 6000, 100
lap_s = 4 * side / feed_mm_min * 60 * 1.25  # corners and lifts take some more
print("N1 G90 G0 X0 Y0 Z0")
number = 2
for _ in range(int(float(sys.argv[1]) / lap_s) + 1):
    for x, y, z in ((side, 0, -10), (side, side, 0), (0, side, -10), (0, 0, 0)):
        print(f"N{number} G1 X{x} Y{y} Z{z} F{feed_mm_min}")
        number += 1
print(f"N{number} M30")
