# SPDX-License-Identifier: Apache-2.0
"""Judges a log of candump -L: SYNC is the first frame of every cycle, and between one SYNC and the next every drive
answers exactly once. Usage: check_sync.py LOG NODES CYCLES"""
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
print(f"{len(times)} SYNC, {min(steps) * 1e3:.3f} to {max(steps) * 1e3:.3f} ms apart, {nodes} drives, "
      f"{len(problems)} cycles not in order")
sys.exit("\n".join(problems[:10]) or 0)
