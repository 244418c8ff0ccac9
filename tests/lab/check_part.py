# SPDX-License-Identifier: Apache-2.0
"""What a run has to show after a part was pulled: it did not finish, its first fault stops on the path, everything else
is its consequence, and the part is named. That an interface is down the kernel may say later than process data are
missed: then the drives are named first and the bus after them. Usage: check_part.py REPORT PART EXIT_CODE"""
import json
import sys

NAMED = {"kill": ("node 1 (can.x, axis X)", {2004, 2010}), "freeze": ("node 1 (can.x, axis X)", {2004, 2010}),
         "down": ("bus can", {2017}), "bus-off": ("bus can", {2012})}
report = json.load(open(sys.argv[1]))
part, code = sys.argv[2], int(sys.argv[3])
words, numbers = NAMED[part]
problems = []
faults = [a for a in report["alarms"] if a["reaction"] not in ("none", "warn")]
if report["finished"] or code == 0:
    problems.append(f"the run ended well (exit code {code})")
if not faults:
    sys.exit(f"{part}: no alarm")
first = min(faults, key=lambda a: a["sequence"])
named = [a for a in faults if a["number"] in numbers and words in a["text"]]
if not named:
    problems.append(f"nobody names {words}: {[a['text'] for a in faults]}")
if first not in named and not (part == "down" and first["number"] == 2004):
    problems.append(f"first fault {first['number']}: {first['text']}")
if first["reaction"] != "stop_on_path" or not first["remedy"]:
    problems.append(f"reaction {first['reaction']}, remedy {first['remedy']!r}")
for other in faults:
    if other["first_fault"] != first["sequence"]:
        problems.append(f"{other['number']} stands for itself: {other['text']}")
print(f"{part}: {first['text']} ({first['reaction']}); {len(report['alarms']) - 1} consequences")
sys.exit("; ".join(problems) or 0)
