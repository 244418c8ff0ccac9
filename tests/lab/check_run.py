# SPDX-License-Identifier: Apache-2.0
"""What a run on a bus has to show: finished, as long as asked for, no alarm, no late cycle, no lost frame; and in
candump's log of it SYNC is the first frame of every cycle, at its absolute time.

A cycle of the log is what stands between two SYNC. Once the drives are operational each has every set-point once, in
their order, and every answer once. What the control sends follows SYNC at once (CONTROL); what it sent later would be a
cycle that did not begin with SYNC. The drives latch at SYNC: whether a drive, a process of its own, answers before or
after the set-points of the same cycle is no matter, before the next SYNC it must.
SYNC k is GRID or less away from t0 + k * CYCLE for one and the same t0: nothing drifts, none is left out.

Usage: check_run.py REPORT CANDUMP SECONDS"""
import json
import sys

CYCLE = 0.004
GRID = 0.0004  # s; a tenth of a cycle. Measured in the laboratory: 0.03 ms
CONTROL = 0.002  # s behind SYNC. Measured: 0.3 ms
SET_POINTS = [0x201, 0x202, 0x203]
ANSWERS = [0x181, 0x182, 0x183]
FROM_CONTROL = {0x000, 0x100, 0x200, 0x300, 0x400, 0x500, 0x600}  # function codes of NMT, TIME, RPDOs, SDO requests


def judge_report(report, seconds, problems):
    if not report["finished"]:
        problems.append("the program did not finish")
    if report["alarms"]:
        problems.append(f"alarms: {report['alarms']}")
    if report["time_s"] < seconds:
        problems.append(f"only {report['time_s']} s")
    if report["overruns"]:
        problems.append(f"{report['overruns']} late cycles")
    print(f"{report['time_s']:.1f} s, {report['overruns']} late cycles, {len(report['alarms'])} alarms")


def read_cycles(lines, problems):
    """[[stamp of SYNC, [(stamp, identifier) ...]] ...]"""
    cycles, before = [], 0.0
    for line in lines:
        stamp, _, frame = line.split()[:3]
        at, identifier = float(stamp.strip("()")), int(frame.split("#")[0], 16)
        if at < before:
            problems.append(f"{line.strip()}: earlier than the frame before it")
        before = at
        if identifier == 0x080:
            cycles.append((at, []))
        elif cycles:
            cycles[-1][1].append((at, identifier))
        elif 0x181 <= identifier <= 0x57F:
            problems.append(f"process data {identifier:03X} before the first SYNC")
    return cycles


def wrong_with(cycle, running):
    sync, frames = cycle
    order = [identifier for _, identifier in frames]
    late = [(at, i) for at, i in frames if i & 0x780 in FROM_CONTROL and at - sync > CONTROL]
    if late:
        return f"the control's {late[0][1]:03X} came {(late[0][0] - sync) * 1e3:.3f} ms behind SYNC"
    if running and [i for i in order if i in SET_POINTS] != SET_POINTS:
        return "set-points " + " ".join(f"{i:03X}" for i in order if i in SET_POINTS)
    if running and sorted(i for i in order if i in ANSWERS) != ANSWERS:
        return "answers " + " ".join(f"{i:03X}" for i in order if i in ANSWERS)
    return None


def judge_cycles(cycles, seconds, problems):
    first = next((n for n, (_, frames) in enumerate(cycles) if set(SET_POINTS) <= {i for _, i in frames}), len(cycles))
    # The control's end cuts the last cycle short.
    judged = cycles[:-1]
    wrong = [(n, why) for n, cycle in enumerate(judged) if (why := wrong_with(cycle, n > first))]
    problems += [f"cycle {n}: {why}" for n, why in wrong[:10]]
    if (len(judged) - first) * CYCLE < seconds:
        problems.append(f"only {len(judged) - first} cycles with set-points")
    off = [at - cycles[0][0] - n * CYCLE for n, (at, _) in enumerate(cycles)]
    spread = (max(off) - min(off)) if off else 0.0
    print(f"{len(cycles)} SYNC, {len(judged) - first} cycles with all set-points, {len(wrong)} wrong ones; "
          f"SYNC within {spread * 1e3:.3f} ms of its grid")
    if spread > GRID:
        worst = max(range(len(off)), key=lambda n: abs(off[n]))
        problems.append(f"SYNC {worst} is {off[worst] * 1e3:.3f} ms off its grid")


def main():
    problems, seconds = [], float(sys.argv[3])
    judge_report(json.load(open(sys.argv[1])), seconds, problems)
    judge_cycles(read_cycles(open(sys.argv[2]), problems), seconds, problems)
    sys.exit("\n".join(problems) or 0)


main()
