# SPDX-License-Identifier: Apache-2.0
"""What a run of the example retrofit has to show: finished where nothing was pulled, or what is pulled must not matter; otherwise
stopped, with the alarm of the part as the first fault, its words and its reaction. Usage: check_retrofit.py REPORT PART EXIT_CODE"""
import json
import sys

SOUND = {"whole", "door-bounces"}
# number, words that name the part, reaction
PULLED = {
    "server-killed": (1207, "cabinet.vfd", "stop_on_path"),
    "line-silent": (1207, "cabinet.vfd", "stop_on_path"),
    "usb-pulled": (1207, "cabinet.vfd", "stop_on_path"),
    "limit-bounces": (1004, "X", "stop_axes"),
    "limit-sticks": (1004, "Y", "stop_axes"),
    "home-sticks": (1102, "X: the home switch did not release", "stop_axes"),
    "chip-vanishes": (None, "switches", None),
}
report = json.load(open(sys.argv[1]))
part, code = sys.argv[2], int(sys.argv[3])
problems = []
faults = sorted((a for a in report["alarms"] if a["reaction"] not in ("none", "warn")), key=lambda a: a["sequence"])
if part in SOUND:
    if not report["finished"] or code != 0:
        problems.append(f"it did not end well (exit code {code})")
    if report["alarms"]:
        problems.append(f"alarms: {[a['text'] for a in report['alarms']]}")
    print(f"{part}: finished in {report['time_s']:.1f} s, {report['overruns']} late cycles")
else:
    number, words, reaction = PULLED[part]
    if report["finished"] or code == 0:
        problems.append(f"the run ended well (exit code {code})")
    if not faults:
        sys.exit(f"{part}: no alarm")
    first = faults[0]
    if (number and first["number"] != number) or (reaction and first["reaction"] != reaction):
        problems.append(f"first fault {first['number']}, {first['reaction']}")
    if not any(words in a["text"] for a in report["alarms"]) or not first["remedy"]:
        problems.append(f"nobody names {words}: {[a['text'] for a in report['alarms']]}")
    print(f"{part}: {first['number']} {first['text']} ({first['reaction']}); {len(report['alarms']) - 1} consequences")
sys.exit("; ".join(problems) or 0)
