# SPDX-License-Identifier: Apache-2.0
"""What a run on a bus has to show: finished, as long as asked for, no alarm, no late cycle, no lost frame; and SYNC
is the first frame of every cycle: between a SYNC and the next the control's other frames follow it.
Usage: check_run.py REPORT CANDUMP SECONDS"""
import json
import sys

report = json.load(open(sys.argv[1]))
seconds = float(sys.argv[3])
problems = []
if not report["finished"]:
    problems.append("the program did not finish")
if report["alarms"]:
    problems.append(f"alarms: {report['alarms']}")
if report["time_s"] < seconds:
    problems.append(f"only {report['time_s']} s")
if report["overruns"]:
    problems.append(f"{report['overruns']} late cycles")
print(f"{report['time_s']:.1f} s, {report['overruns']} late cycles, {len(report['alarms'])} alarms")

# After each SYNC come the drives' answers, then set-points; a set-point or answer before the first SYNC, or two SYNC
# without the set-points of all drives between, would be a cycle that did not begin with it.
syncs, between, wrong, running = 0, set(), 0, False
for line in open(sys.argv[2]):
    identifier = int(line.split()[2].split("#")[0], 16)
    if identifier == 0x080:
        if running and not {0x201, 0x202, 0x203} <= between:
            wrong += 1
        syncs, between = syncs + 1, set()
    else:
        if syncs == 0 and 0x181 <= identifier <= 0x57F:
            problems.append(f"process data {identifier:03X} before the first SYNC")
        between.add(identifier)
        running = running or identifier == 0x203
print(f"{syncs} SYNC, {wrong} cycles without all set-points")
if syncs * 0.004 < seconds:
    problems.append(f"only {syncs} SYNC")
if wrong > 2:
    problems.append(f"{wrong} cycles did not go SYNC, answers, set-points")
sys.exit("; ".join(problems) or 0)
