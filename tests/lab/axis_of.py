# SPDX-License-Identifier: Apache-2.0
"""The position of an axis in `servogate status --json` on standard input. With the position before: it rests, and is LEAST to MOST away from there.
Usage: axis_of.py LETTER [BEFORE LEAST MOST]"""
import json
import sys

axis = next(a for a in json.load(sys.stdin)["axes"] if a["letter"] == sys.argv[1])
if len(sys.argv) == 2:
    print(axis["position"])
    sys.exit()
before, least, most = map(float, sys.argv[2:])
way = abs(axis["position"] - before)
print(f"   {way:.3f} mm by the pendant")
sys.exit(0 if not axis["moving"] and least <= way <= most else f"moved by {way} mm, moving: {axis['moving']}")
