# SPDX-License-Identifier: Apache-2.0
"""Judges a log of candump -L: SYNC is the first frame of every cycle, and between one SYNC and the next every drive
answers exactly once. With GRID, SYNC k is at most so many ms away from t0 + k * PERIOD ms, too: for computers that
hold times. Usage: check_sync.py LOG NODES CYCLES [PERIOD GRID]"""
import sys

nodes, cycles = int(sys.argv[2]), int(sys.argv[3])
answers = {0x180 + n for n in range(1, nodes + 1)}
times, got, problems = [], [], []


def close():
    if len(times) == 0 or sorted(got) == sorted(answers):
        return
    missing = [f"{a:03X}" for a in sorted(answers) if a not in got]
    twice = [f"{a:03X}" for a in sorted(answers) if got.count(a) > 1]
    problems.append(f"cycle {len(times)}: missing {missing}, more than once {twice}")


for line in open(sys.argv[1]):
    stamp, _, frame = line.split()[:3]
    identifier = int(frame.split("#")[0], 16)
    if identifier == 0x080:
        close()
        times.append(float(stamp.strip("()")))
        got = []
    elif identifier in answers:
        if not times:
            problems.append(f"{identifier:03X} before the first SYNC")
        got.append(identifier)
close()
steps = [b - a for a, b in zip(times, times[1:])]
if len(times) != cycles:
    problems.append(f"{len(times)} SYNC instead of {cycles}")
if len(sys.argv) > 5:
    period, grid = float(sys.argv[4]), float(sys.argv[5])
    off = [(t - times[0]) * 1e3 - k * period for k, t in enumerate(times)]
    print(f"SYNC within {max(off) - min(off):.3f} ms of its grid")
    if max(off) - min(off) > grid:
        problems.append(f"SYNC strays {max(off) - min(off):.3f} ms from its grid, allowed {grid} ms")
print(f"{len(times)} SYNC, {min(steps) * 1e3:.3f} to {max(steps) * 1e3:.3f} ms apart, {nodes} drives, "
      f"{len(problems)} cycles not in order")
sys.exit("\n".join(problems[:10]) or 0)
