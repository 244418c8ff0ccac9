# SPDX-License-Identifier: Apache-2.0
"""Every value of the option codes 605Ah to 605Eh and 6007h of CiA 402-2, each from full speed: which ramp, which state on the way,
which state at the end. Position and speed are of one SYNC, so that the deceleration is (v1^2 - v2^2) / 2 (x2 - x1), however late this
computer is. The first wrong answer ends it with exit code 1. Usage: option_codes_master.py NODE COUNTS INTERFACE CHANNEL [KEY=VALUE...]
for a drive whose shaft, without current, only friction stops: J = 0.01 kg m2, 0.002 N m, rated torque 2.4 N m."""
import math
import sys
import time

from node import Node

n, turn = int(sys.argv[1]), int(sys.argv[2])
drive = Node(n, sys.argv[3], sys.argv[4], sys.argv[5:])
RAD = turn / (2 * math.pi)  # counts
SPEED = 300_000  # counts/s
SLOW, QUICK = 400_000, 1_600_000  # 6084h, 6085h, counts/s2
PERMILLE = 300  # 6072h
LIMIT = PERMILLE * 2.4e-3 / 0.01 * RAD  # what that torque does to the inertia
COAST = 0.002 / 0.01 * RAD  # what friction alone does
NONE = 0.0
OFF, READY, ON, ENABLED, QUICK_STOP, REACTION, FAULT = (
    "Switch on disabled", "Ready to switch on", "Switched on", "Operation enabled", "Quick stop active",
    "Fault reaction active", "Fault")
CODES = {OFF: (0x4F, 0x40), READY: (0x6F, 0x21), ON: (0x6F, 0x23), ENABLED: (0x6F, 0x27), QUICK_STOP: (0x6F, 0x07),
         REACTION: (0x4F, 0x0F), FAULT: (0x4F, 0x08)}
TARGET_REACHED = 0x0400


class Sample:
    def __init__(self, first, second):
        self.word = int.from_bytes(first[0:2], "little")
        self.position = int.from_bytes(second[0:4], "little", signed=True)
        self.speed = int.from_bytes(second[4:8], "little", signed=True)
        self.state = next((s for s, (mask, code) in CODES.items() if self.word & mask == code), None)

    def __str__(self):
        return f"{self.state} ({self.word:04X}h) at {self.position}, {self.speed} counts/s"


def sample():
    """What the drive was and where, at one SYNC."""
    drive.send(0x080, [])
    first, second = drive.wait_for(0x180 + n), drive.wait_for(0x280 + n)
    if first is None or second is None:
        missing = " and ".join(f"TPDO{i + 1}" for i, content in enumerate((first, second)) if content is None)
        heard = [f"{m.arbitration_id:03X}#{bytes(m.data).hex()}" for m in drive.heard[-8:]]
        sys.exit(f"no {missing} with SYNC, heard last: {heard}; statusword by SDO {drive.status():04X}h")
    drive.heard = [m for m in drive.heard if m.arbitration_id not in (0x180 + n, 0x280 + n)]
    time.sleep(0.001)
    return Sample(first, second)


def until(met, what, seconds=60):
    end = time.monotonic() + seconds
    seen = []
    while time.monotonic() < end:
        seen.append(sample())
        if met(seen[-1]):
            return seen
    sys.exit(f"{what}: {seen[-1]}")


def nmt(command):
    drive.send(0x000, [command, n])
    time.sleep(0.01)


def control(word):
    drive.write(0x6040, word, 2)


def map_at_sync(number, entries):
    parameter, cob = 0x1800 + number - 1, 0x080 + 0x100 * number + n
    drive.write(parameter, 0xC0000000 | cob, 4, 1)
    drive.write(parameter + 0x200, 0, 1)
    for i, entry in enumerate(entries):
        drive.write(parameter + 0x200, entry, 4, i + 1)
    drive.write(parameter + 0x200, len(entries), 1)
    drive.write(parameter, 1, 1, 2)
    drive.write(parameter, 0x40000000 | cob, 4, 1)


def set_up():
    nmt(0x80)
    map_at_sync(1, [0x60410010])
    map_at_sync(2, [0x60640020, 0x606C0020])
    for index, value in ((0x6083, 2_000_000), (0x6084, SLOW), (0x6085, QUICK), (0x60C5, 2 ** 31 - 1), (0x60C6, 2 ** 31 - 1),
                         (0x6065, 0xFFFFFFFF)):  # no following error window
        drive.write(index, value, 4)
    drive.write(0x1029, 1, 1, 1)  # a lost heartbeat leaves the NMT state as it is: TPDOs go on
    nmt(0x01)


def run(mode=3):
    """Operation enabled and at full speed, from whatever is left of the trial before."""
    drive.write(0x1016, 0, 4, 1)
    nmt(0x01)
    drive.write(0x60FF, 0, 4)
    drive.write(0x6072, 3000, 2)
    control(0x00)
    until(lambda s: s.state in (OFF, FAULT), "disable voltage")
    control(0x80)
    until(lambda s: s.state == OFF, "fault reset")
    drive.write(0x6060, mode, 1)
    for word, state in ((0x06, READY), (0x07, ON), (0x0F, ENABLED)):
        control(word)
        until(lambda s: s.state == state, f"{word:02X}h")
    if mode == 2:
        drive.write(0x6042, round(SPEED / turn * 60), 2)
        control(0x7F)
    drive.write(0x60FF, SPEED, 4)
    until(lambda s: abs(s.speed - SPEED) < 0.02 * SPEED, "does not come to its speed")
    drive.write(0x6072, PERMILLE, 2)


def deceleration(seen, what):
    """From the samples on the slope; None: this computer has slept through it."""
    slope = [s for s in seen if 0.1 * SPEED < s.speed < 0.9 * SPEED]
    if len(slope) < 2 or slope[0].position == slope[-1].position:
        return None
    first, last = slope[0], slope[-1]
    for a, b in zip(seen, seen[1:]):
        if b.speed > a.speed + 0.03 * SPEED:
            sys.exit(f"{what}: becomes faster: {a}, then {b}")
    return (first.speed ** 2 - last.speed ** 2) / 2 / (last.position - first.position)


def turns_freely(what, begun):
    """Without current it loses less than a tenth of its speed within a fifth of a turn. What it has lost by friction
    since `begun` is no braking, however late this computer looks."""
    first = sample()
    if first.speed < 0.8 * SPEED - 2 * COAST * (time.monotonic() - begun):
        sys.exit(f"{what}: is braked before the power is off: {first}")
    last = until(lambda s: s.position > first.position + turn / 5, what)[-1]
    slope = (first.speed ** 2 - last.speed ** 2) / 2 / (last.position - first.position)
    if not 0.5 * COAST < slope < 2 * COAST:
        sys.exit(f"{what}: loses {slope:.0f} counts/s2 instead of {COAST:.0f}")


def trial(what, begin, ramp, on_the_way, at_end, mode=3):
    """One value: `begin` in full speed, then judged until it rests, or has no current."""
    for _ in range(5):
        run(mode)
        begun = time.monotonic()
        begin()
        if ramp == COAST:
            seen = until(lambda s: s.state == at_end, f"{what}: does not end in {at_end}")
            states = {s.state for s in seen} - {ENABLED, at_end, on_the_way}
            if states:
                sys.exit(f"{what}: was in {states} on its way to {at_end}")
            return turns_freely(what, begun)
        rests = lambda s: abs(s.speed) < 0.002 * SPEED and s.state == at_end
        seen = until(rests, f"{what}: does not rest in {at_end}")
        for s in seen:
            if s.speed > 0.1 * SPEED and s.state not in (ENABLED, on_the_way):
                sys.exit(f"{what}: {s.state} instead of {on_the_way} while it still turns: {s}")
            if not -0.02 * SPEED < s.speed < 1.05 * SPEED:
                sys.exit(f"{what}: leaves the profile: {s}")
        measured = deceleration(seen, what)
        if measured is None:
            continue
        if not 0.9 * ramp < measured < 1.1 * ramp:
            sys.exit(f"{what}: brakes with {measured:.0f} counts/s2 instead of {ramp:.0f}")
        for _ in range(5):  # and stays there
            if sample().state != at_end:
                sys.exit(f"{what}: does not stay in {at_end}")
        return None
    sys.exit(f"{what}: no two samples on the slope in five trials")


def with_value(index, value, act):
    def begin():
        drive.write(index, value, 2)
        act()
    return begin


def silence():
    """The master's heartbeat comes once and no more."""
    drive.write(0x1016, 127 << 16 | 40, 4, 1)
    drive.send(0x700 + 127, [5])


def quick_stop():
    for value, ramp, end in ((0, COAST, OFF), (1, SLOW, OFF), (2, QUICK, OFF), (3, LIMIT, OFF), (4, LIMIT, OFF),
                             (5, SLOW, QUICK_STOP), (6, QUICK, QUICK_STOP), (7, LIMIT, QUICK_STOP), (8, LIMIT, QUICK_STOP)):
        what = f"605Ah = {value}"
        trial(what, with_value(0x605A, value, lambda: control(0x02)), ramp, QUICK_STOP, end)
        if end != QUICK_STOP:
            continue
        if not sample().word & TARGET_REACHED:
            sys.exit(f"{what}: bit 10 is not set at rest")
        for word in (0x06, 0x07):  # neither leaves the state
            control(word)
            time.sleep(0.02)
            if sample().state != QUICK_STOP:
                sys.exit(f"{what}: {word:02X}h leaves {QUICK_STOP}: {sample()}")
        control(0x0F)
        until(lambda s: s.state == ENABLED and s.speed > 0.9 * SPEED, f"{what}: transition 16")
    drive.write(0x605A, 2, 2)


def quick_stop_in_vl():
    """Its ramp is 604Ah: 200 rpm in a second."""
    drive.write(0x604A, 200, 4, 1)
    drive.write(0x604A, 1, 2, 2)
    trial("605Ah = 2 in vl", with_value(0x605A, 2, lambda: control(0x02)), 200 / 60 * turn, QUICK_STOP, OFF, mode=2)


def shutdown_and_disable_operation():
    for index, word, end in ((0x605B, 0x06, READY), (0x605C, 0x07, ON)):
        for value, ramp in ((0, COAST), (1, SLOW)):
            trial(f"{index:04X}h = {value}", with_value(index, value, lambda: control(word)), ramp, ENABLED, end)
    # In velocity mode the slow down ramp is 6049h: 100 rpm in a second.
    drive.write(0x6048, 1000, 4, 1)
    drive.write(0x6049, 100, 4, 1)
    drive.write(0x6049, 1, 2, 2)
    trial("605Bh = 1 in vl", with_value(0x605B, 1, lambda: control(0x06)), 100 / 60 * turn, ENABLED, READY, mode=2)
    # Meanwhile taken back: it goes on.
    drive.write(0x605C, 1, 2)
    run()
    control(0x07)
    until(lambda s: s.speed < 0.7 * SPEED, "605Ch = 1: does not brake")
    control(0x0F)
    until(lambda s: s.speed > 0.97 * SPEED and s.state == ENABLED, "enable operation on the ramp of transition 5")


def halt():
    for value, ramp in ((1, SLOW), (2, QUICK), (3, LIMIT), (4, LIMIT)):
        what = f"605Dh = {value}"
        trial(what, with_value(0x605D, value, lambda: control(0x10F)), ramp, ENABLED, ENABLED)
        until(lambda s: s.word & TARGET_REACHED, f"{what}: bit 10 is not set at rest")
        control(0x0F)
        until(lambda s: s.speed > 0.97 * SPEED, f"{what}: does not go on")
    drive.write(0x605D, 1, 2)


def fault_reaction():
    drive.write(0x6007, 1, 2)
    for value, ramp in ((0, COAST), (1, SLOW), (2, QUICK), (3, LIMIT), (4, LIMIT)):
        what = f"605Eh = {value}"
        trial(what, with_value(0x605E, value, silence), ramp, REACTION, FAULT)
        if drive.read(0x603F, size=2) != 0x8130:
            sys.exit(f"{what}: 603Fh is {drive.read(0x603F, size=2):04X}h")
    drive.write(0x605E, 2, 2)


def abort_connection():
    """6007h: by a heartbeat that stays away, and by NMT, which takes the node out of Operational."""
    def stopped():
        nmt(0x02)
        time.sleep(0.05)
        nmt(0x01)

    for way, act in (("heartbeat", silence), ("NMT stop", stopped)):
        for value, ramp, middle, end in ((0, NONE, None, ENABLED), (1, QUICK, REACTION, FAULT), (2, COAST, OFF, OFF),
                                         (3, QUICK, QUICK_STOP, OFF)):
            what = f"6007h = {value}, {way}"
            drive.write(0x605A, 2, 2)
            if ramp == NONE:
                run()
                drive.write(0x6007, value, 2)
                act()
                start = sample().position
                until(lambda s: s.position > start + turn, what)
                if sample().state != ENABLED or abs(sample().speed - SPEED) > 0.03 * SPEED:
                    sys.exit(f"{what}: {sample()}")
                if way == "heartbeat" and not drive.read(0x1001, size=1) & 0x10:
                    sys.exit(f"{what}: the error register does not say communication")
            elif way == "heartbeat" or ramp == COAST:
                trial(what, with_value(0x6007, value, act), ramp, middle, end)
            else:  # nothing is heard of the ramp in state Stopped
                run()
                with_value(0x6007, value, act)()
                until(lambda s: s.state == end and abs(s.speed) < 0.002 * SPEED, f"{what}: does not rest in {end}")
    drive.write(0x6007, 1, 2)


set_up()
for part in (quick_stop, quick_stop_in_vl, shutdown_and_disable_operation, halt, fault_reaction, abort_connection):
    part()
control(0x00)
drive.bus.shutdown()
print("every value of 605Ah to 605Eh and 6007h")
