# SPDX-License-Identifier: Apache-2.0
"""The first fault of `servogate alarms --json` on standard input has this number (or one of several, 2004,2010), and its words name the part; it has a remedy, and
the other alarms are its consequences. Usage: check_retrofit.py none | NUMBER WORDS"""
import json
import sys

alarms = json.load(sys.stdin)["alarms"]
faults = sorted((a for a in alarms if not a["warning"]), key=lambda a: a["sequence"])
if sys.argv[1] == "none":
    sys.exit(f"alarms: {[a['text'] for a in alarms]}" if alarms else 0)
numbers, words = [int(n) for n in sys.argv[1].split(",")], sys.argv[2]
if not faults:
    sys.exit("no alarm")
first, problems = faults[0], []
print(f"   {first['number']} {first['text']} ({first['reaction']}); {len(faults) - 1} consequences")
if first["number"] not in numbers or words not in first["text"]:
    problems.append(f"expected {sys.argv[1]} {words}")
if not first["remedy"]:
    problems.append("no remedy")
problems += [f"{a['number']} stands for itself: {a['text']}" for a in faults if a["first_fault"] != first["sequence"]]
sys.exit("; ".join(problems) or 0)
