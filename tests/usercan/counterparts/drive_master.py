# SPDX-License-Identifier: Apache-2.0
"""python-can, without any CANopen package, as the master of one drive: identity, NMT, every state and transition of
CiA 402 with the fault reaction, and every mode: pp, vl, pv, pt, hm, ip, csp, csv, cst. The first wrong answer ends it
with exit code 1 and a sentence. What a busy computer does to time is no matter: places and states are judged, not
milliseconds. Usage: drive_master.py NODE INTERFACE CHANNEL [KEY=VALUE...]"""
import sys
import time

import can

node = int(sys.argv[1])
options = {k: int(v) if v.isdigit() else v for k, v in (a.split("=", 1) for a in sys.argv[4:])}
bus = can.Bus(interface=sys.argv[2], channel=sys.argv[3], **options)
PATIENCE = 60.0  # s
PERIOD = 0.01  # s between two SYNC
STATES = {"Not ready": 0x00, "Switch on disabled": 0x40, "Ready to switch on": 0x21, "Switched on": 0x23,
          "Operation enabled": 0x27, "Quick stop active": 0x07, "Fault reaction active": 0x0F, "Fault": 0x08}
DISABLE, SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP, RESET = 0x00, 0x06, 0x07, 0x0F, 0x02, 0x80
visited, modes = [], []


def send(identifier, data):
    bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))


def wait_for(identifier, what, seconds=PATIENCE):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        message = bus.recv(0.2)
        if message is not None and message.arbitration_id == identifier and not message.is_remote_frame:
            return bytes(message.data)
    sys.exit(f"no {what} from node {node}")


def sdo(command, index, subindex, data=b"\0\0\0\0"):
    send(0x600 + node, bytes([command, index & 0xFF, index >> 8, subindex]) + data)
    answer = wait_for(0x580 + node, f"answer on {index:04X}h")
    if answer[0] == 0x80:
        sys.exit(f"{index:04X}h:{subindex:02X} aborted with {int.from_bytes(answer[4:], 'little'):08X}h")
    return answer


def read(index, subindex=0, size=4):
    return int.from_bytes(sdo(0x40, index, subindex)[4:4 + size], "little")


def read_signed(index, subindex=0, size=4):
    return int.from_bytes(sdo(0x40, index, subindex)[4:4 + size], "little", signed=True)


def write(index, value, size, subindex=0):
    sdo({1: 0x2F, 2: 0x2B, 4: 0x23}[size], index, subindex, (value & 0xFFFFFFFF).to_bytes(4, "little"))


def until(met, what):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if met():
            return
        time.sleep(0.005)
    sys.exit(f"{what}: statusword {read(0x6041, size=2):04X}h, error {read(0x603F, size=2):04X}h, "
             f"mode {read_signed(0x6061, size=1)}, position {read_signed(0x6064)}, velocity {read_signed(0x606C)}")


def state():
    word = read(0x6041, size=2)
    for name, code in STATES.items():
        if word & (0x4F if code in (0x00, 0x40, 0x0F, 0x08) else 0x6F) == code:
            return name
    sys.exit(f"statusword {word:04X}h is no state")


def reach(word, name):
    write(0x6040, word, 2)
    until(lambda: state() == name, f"does not reach {name} by {word:02X}h")
    visited.append(name)


def mode(number, name):
    write(0x6060, number, 1)
    until(lambda: read_signed(0x6061, size=1) == number, f"does not show mode {name}")
    modes.append(name)


def position():
    return read_signed(0x6064)


def standing():
    until(lambda: abs(read_signed(0x606C)) < 200, "does not come to rest")


def enable():
    if state() == "Fault":
        write(0x6040, DISABLE, 2)
        reach(RESET, "Switch on disabled")
    for word, name in ((SHUTDOWN, "Ready to switch on"), (SWITCH_ON, "Switched on"), (ENABLE, "Operation enabled")):
        reach(word, name)


def bits(mask, value, what):
    until(lambda: read(0x6041, size=2) & mask == value, what)


def close_to(wanted, allowed, what):
    until(lambda: abs(position() - wanted) <= allowed, f"{what}: not at {wanted}")


# -- states ----------------------------------------------------------------------------------------------------------

def states():
    """Every transition that a controlword can ask for; numbers of CiA 402-2."""
    write(0x605A, 6, 2)  # quick stop: ramp down and stay
    if state() != "Switch on disabled":
        reach(DISABLE, "Switch on disabled")
    ready = (SHUTDOWN, "Ready to switch on")
    on, enabled = (SWITCH_ON, "Switched on"), (ENABLE, "Operation enabled")
    off, quick = (DISABLE, "Switch on disabled"), (QUICK_STOP, "Quick stop active")
    # 2 7 | 2 3 6 3 10 | 2 3 4 5 4 8 | 3 4 9 | 2 3 4 11 16 11 12
    for word, name in (ready, off, ready, on, ready, on, off, ready, on, enabled, on, enabled, ready, on, enabled, off,
                       ready, on, enabled, quick, enabled, quick, off):
        reach(word, name)
    write(0x605A, 2, 2)


def fault():
    """13, 14, 15: the master's heartbeat stays away in motion; the reaction is a slow ramp, so that it is seen."""
    write(0x6007, 1, 2)
    write(0x605E, 2, 2)  # down along the quick stop ramp
    write(0x6085, 50_000, 4)
    mode(3, "pv")
    send(0x700 + 127, b"\x05")
    write(0x1016, 127 << 16 | 3000, 4, 1)
    enable()
    write(0x6083, 2_000_000, 4)
    write(0x60FF, 200_000, 4)

    def fast():
        send(0x700 + 127, b"\x05")
        return abs(read_signed(0x606C)) > 150_000

    until(fast, "does not run before the fault")
    until(lambda: state() == "Fault reaction active", "shows no fault reaction")
    visited.append("Fault reaction active")
    until(lambda: state() == "Fault", "does not end in Fault")
    visited.append("Fault")
    if read(0x603F, size=2) != 0x8130:
        sys.exit(f"603Fh is {read(0x603F, size=2):04X}h after a lost heartbeat")
    write(0x1016, 0, 4, 1)
    write(0x60FF, 0, 4)
    write(0x6085, 2_000_000, 4)
    write(0x6040, DISABLE, 2)
    reach(RESET, "Switch on disabled")


# -- modes by service data -------------------------------------------------------------------------------------------

def profile_position():
    mode(1, "pp")
    enable()
    for index, value in ((0x6081, 200_000), (0x6083, 2_000_000), (0x6084, 2_000_000)):
        write(index, value, 4)
    start = position()
    for target, word in ((start + 50_000, 0x3F), (-20_000, 0x7F)):  # absolute, then relative to it
        write(0x607A, target, 4)
        write(0x6040, word, 2)
        bits(0x1000, 0x1000, "no set-point acknowledge")
        write(0x6040, ENABLE, 2)
        bits(0x1400, 0x0400, "target not reached")
    close_to(start + 30_000, 100, "pp")
    write(0x607A, start + 400_000, 4)
    write(0x6040, 0x3F, 2)
    until(lambda: abs(read_signed(0x606C)) > 100_000, "pp: does not run")
    write(0x6040, 0x11F, 2)  # halt
    standing()
    bits(0x0400, 0x0400, "pp: halt not reached")
    if not start + 30_000 < position() < start + 399_000:
        sys.exit("pp: halt does not stop on the way")
    write(0x6040, ENABLE, 2)


def velocity():
    mode(2, "vl")
    enable()
    write(0x6048, 1000, 4, 1)
    write(0x6048, 1, 2, 2)
    write(0x6049, 1000, 4, 1)
    write(0x6049, 1, 2, 2)
    write(0x6042, 120, 2)
    write(0x6040, 0x7F, 2)
    until(lambda: abs(read_signed(0x6044, size=2) - 120) <= 6, "vl: 6044h does not reach 120 rpm")
    write(0x6042, -60, 2)
    until(lambda: abs(read_signed(0x6044, size=2) + 60) <= 6, "vl: 6044h does not reach -60 rpm")
    write(0x6040, ENABLE, 2)
    standing()


def profile_velocity():
    mode(3, "pv")
    enable()
    write(0x6083, 2_000_000, 4)
    write(0x6084, 2_000_000, 4)
    for speed in (100_000, -50_000):
        write(0x60FF, speed, 4)
        until(lambda: abs(read_signed(0x606C) - speed) < 4000, f"pv: does not run at {speed}")
        bits(0x0400, 0x0400, "pv: target not reached")
    write(0x60FF, 0, 4)
    bits(0x1000, 0x1000, "pv: speed 0 not shown")
    standing()


def profile_torque():
    mode(4, "pt")
    enable()
    write(0x6087, 1000, 4)  # per mille of the rated torque in a second
    for torque in range(20, 320, 20):  # as much as its friction wants
        write(0x6071, torque, 2)
        until(lambda: abs(read_signed(0x6077, size=2) - torque) <= 5, f"pt: 6077h does not reach {torque}")
        if read_signed(0x606C) > 2000:
            break
    else:
        sys.exit("pt: the torque moves nothing")
    write(0x6071, 0, 2)
    until(lambda: abs(read_signed(0x6077, size=2)) <= 2, "pt: the torque does not go")
    mode(3, "pv")
    standing()


def homing():
    mode(6, "hm")
    enable()
    write(0x607C, 1000, 4)
    write(0x6099, 50_000, 4, 1)
    write(0x6099, 10_000, 4, 2)
    write(0x609A, 2_000_000, 4)
    for method in (33, 34, 37):  # next index pulse in either direction, and where it stands
        write(0x6098, method, 1)
        write(0x6040, 0x1F, 2)
        bits(0x3400, 0x1400, f"homing by method {method} not attained")
        write(0x6040, ENABLE, 2)
    close_to(-1000, 100, "hm: zero is not where home and the home offset 607Ch say")


# -- cyclic modes by process data and SYNC ---------------------------------------------------------------------------

def map_pdo(communication, mapping, cob, objects):
    write(communication, 0x80000000 | cob, 4, 1)
    write(mapping, 0, 1)
    for i, entry in enumerate(objects):
        write(mapping, entry, 4, i + 1)
    write(mapping, len(objects), 1)
    write(communication, 1, 1, 2)
    write(communication, cob, 4, 1)


class Cyclic:
    """Controlword and one target with every SYNC; statusword and position come back."""

    def __init__(self, target, size):
        self.size, self.word, self.target, self.status, self.position, self.answers = size, SHUTDOWN, 0, 0, 0, 0
        send(0x000, bytes([0x80, node]))
        map_pdo(0x1400, 0x1600, 0x200 + node, [0x60400010, target << 16 | (0x0100 if target == 0x60C1 else 0) | size * 8])
        map_pdo(0x1800, 0x1A00, 0x180 + node, [0x60410010, 0x60640020])
        write(0x60C2, round(PERIOD * 1000), 1, 1)
        write(0x60C2, -3, 1, 2)
        send(0x000, bytes([0x01, node]))

    def cycle(self):
        send(0x080, b"")
        end = time.monotonic() + PERIOD
        while (left := end - time.monotonic()) > 0:
            message = bus.recv(left)
            if message is not None and message.arbitration_id == 0x180 + node:
                self.status = int.from_bytes(message.data[0:2], "little")
                self.position = int.from_bytes(message.data[2:6], "little", signed=True)
                self.answers += 1
        send(0x200 + node, self.word.to_bytes(2, "little") + (self.target & 0xFFFFFFFF).to_bytes(4, "little")[:self.size])

    def until(self, met, what):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            self.cycle()
            if met():
                return
        sys.exit(f"{what}: statusword {self.status:04X}h, position {self.position}, target {self.target}")

    def enable(self, follow_position):
        for word, code in ((SHUTDOWN, 0x21), (SWITCH_ON, 0x23), (ENABLE, 0x27)):
            self.word = word
            if follow_position:
                self.target = self.position
            self.until(lambda code=code: self.status & 0x6F == code and self.answers > 3, f"no state {code:02X}h")

    def off(self):
        self.word = SHUTDOWN
        self.until(lambda: self.status & 0x6F == 0x21, "does not let go")
        if self.answers < 10:
            sys.exit("too few answers to SYNC")


def cyclic_position(number, name, target, on):
    mode(number, name)
    axis = Cyclic(target, 4)
    axis.enable(True)
    axis.word = on
    axis.until(lambda: axis.status & 0x1000, f"{name}: does not follow")
    start = axis.target
    for i in range(1, 101):
        axis.target = start + i * 300
        axis.cycle()
    axis.until(lambda: abs(axis.position - axis.target) < 200, f"{name}: not at its target")
    axis.off()


def cyclic_velocity():
    mode(9, "csv")
    axis = Cyclic(0x60FF, 4)
    axis.enable(False)
    start = axis.position
    axis.target = 100_000
    axis.until(lambda: axis.position - start > 20_000, "csv: does not run")
    axis.target = 0
    for _ in range(30):
        axis.cycle()
    standing()
    axis.off()


def cyclic_torque():
    mode(10, "cst")
    axis = Cyclic(0x6071, 2)
    axis.enable(False)
    start = axis.position

    def moves():
        axis.target = min(axis.target + 2, 300)
        return axis.position - start > 500

    axis.until(moves, "cst: the torque moves nothing")
    axis.target = 0
    axis.cycle()
    axis.off()


if read(0x1000) & 0xFFFF != 402:
    sys.exit("1000h does not say CiA 402")
write(0x1017, 50, 2)
send(0x000, bytes([1, node]))
for _ in range(200):
    if wait_for(0x700 + node, "heartbeat")[0] == 5:
        break
else:
    sys.exit("the node does not become operational")
states()
fault()
for drive_in in (profile_position, velocity, profile_velocity, profile_torque, homing):
    drive_in()
    reach(SHUTDOWN, "Ready to switch on")
cyclic_position(7, "ip", 0x60C1, 0x1F)
cyclic_position(8, "csp", 0x607A, ENABLE)
cyclic_velocity()
cyclic_torque()
reach(DISABLE, "Switch on disabled")
bus.shutdown()
missing = set(STATES) - {"Not ready"} - set(visited)
if missing:
    sys.exit(f"never in: {', '.join(sorted(missing))}")
print(f"{len(visited)} states reached, modes {' '.join(dict.fromkeys(modes))}")
