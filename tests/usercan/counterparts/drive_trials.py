# SPDX-License-Identifier: Apache-2.0
"""Everything that a master can do wrong with a drive: every command in every state, SDO requests against the rules, PDOs that are mapped
anew while operational, SYNC with a counter, blocks with wrong checksums, heartbeats that stop. The answers are those of CiA 301 and 402-2;
the first other one ends it with exit code 1. Usage: drive_trials.py NODE INTERFACE CHANNEL [KEY=VALUE...]"""
import sys
import time

from node import Abort, Node

drive = Node(int(sys.argv[1]), sys.argv[2], sys.argv[3], sys.argv[4:])
n = drive.number
OFF, READY, ON, ENABLED, QUICK, FAULT = (
    "Switch on disabled", "Ready to switch on", "Switched on", "Operation enabled", "Quick stop active", "Fault")
CODES = {OFF: (0x4F, 0x40), READY: (0x6F, 0x21), ON: (0x6F, 0x23), ENABLED: (0x6F, 0x27), QUICK: (0x6F, 0x07),
         FAULT: (0x4F, 0x08)}
WORDS = {OFF: 0x00, READY: 0x06, ON: 0x07, ENABLED: 0x0F, QUICK: 0x02}


def check(got, wanted, what):
    if got != wanted:
        as_hex = [f"{v:08X}h" if isinstance(v, int) else str(v) for v in (got, wanted)]
        sys.exit(f"{what}: {as_hex[0]} instead of {as_hex[1]}")


def control(word):
    drive.write(0x6040, word, 2)


def state():
    word = drive.status()
    for name, (mask, code) in CODES.items():
        if word & mask == code:
            return name
    return f"statusword {word:04X}h"


def settles(name, what):
    end = time.monotonic() + 60
    while state() != name and time.monotonic() < end:
        time.sleep(0.002)
    check(state(), name, what)
    time.sleep(0.02)
    check(state(), name, what + ", and stays")


def lose_master(milliseconds=40):
    """A heartbeat of node 127 that comes once and no more."""
    drive.write(0x1016, 127 << 16 | milliseconds, 4, 1)
    drive.send(0x700 + 127, [5])
    drive.until(lambda: drive.read(0x1001, size=1) & 0x10, "the lost heartbeat is not noticed")
    drive.write(0x1016, 0, 4, 1)


def bring_to(name):
    if state() == FAULT:
        control(0x00)
        control(0x80)
        settles(OFF, "fault reset")
    control(0x00)
    settles(OFF, "disable voltage")
    path = {OFF: [], READY: [READY], ON: [READY, ON], ENABLED: [READY, ON, ENABLED], FAULT: [],
            QUICK: [READY, ON, ENABLED, QUICK]}[name]
    for step in path:
        control(WORDS[step])
        settles(step, f"{WORDS[step]:02X}h")
    if name == FAULT:
        drive.write(0x6007, 1, 2)
        lose_master()
        settles(FAULT, "lost heartbeat")


def states():
    """Rows: where it is; columns: what each command makes of it. Figure "Finite state automaton", quick stop 605Ah = 6."""
    table = {
        OFF: {0x00: OFF, 0x02: OFF, 0x06: READY, 0x07: OFF, 0x0F: OFF},
        READY: {0x00: OFF, 0x02: OFF, 0x06: READY, 0x07: ON, 0x0F: ENABLED},
        ON: {0x00: OFF, 0x02: OFF, 0x06: READY, 0x07: ON, 0x0F: ENABLED},
        ENABLED: {0x00: OFF, 0x02: QUICK, 0x06: READY, 0x07: ON, 0x0F: ENABLED},
        QUICK: {0x00: OFF, 0x02: QUICK, 0x06: QUICK, 0x07: QUICK, 0x0F: ENABLED},
        FAULT: {0x00: FAULT, 0x02: FAULT, 0x06: FAULT, 0x07: FAULT, 0x0F: FAULT},
    }
    drive.write(0x605A, 6, 2)
    for start, row in table.items():
        for word, end in row.items():
            bring_to(start)
            control(word)
            settles(end, f"{word:02X}h in {start}")
    bring_to(FAULT)
    control(0x80)
    settles(OFF, "fault reset")


def option_codes():
    for index, good, bad in ((0x605A, (0, 1, 2, 3, 4, 5, 6, 7, 8), (9,)), (0x605B, (0, 1), (2,)),
                             (0x605C, (0, 1), (2,)), (0x605D, (1, 2, 3, 4), (0, 5)), (0x605E, (0, 1, 2, 3, 4), (5,)),
                             (0x6007, (0, 1, 2, 3), (4,))):
        before = drive.read(index, size=2)
        for value in good:
            check(drive.refusal(index, value, 2), 0, f"{index:04X}h = {value}")
            check(drive.read(index, size=2), value, f"{index:04X}h reads back")
        for value in bad:
            code = drive.refusal(index, value, 2)
            if code not in (0x06090030, 0x06090031, 0x06090032):
                sys.exit(f"{index:04X}h = {value}: {code:08X}h is no abort for a value")
        drive.write(index, before, 2)


def service_data():
    check(drive.refusal(0x6041, 0, 2), 0x06010002, "writing the statusword")
    check(drive.refusal(0x5FFF, 0, 2), 0x06020000, "an object that does not exist")
    check(drive.refusal(0x607D, 0, 4, 3), 0x06090011, "a sub-index that does not exist")
    check(drive.refusal(0x6040, 0, 4), 0x06070012, "four bytes for a controlword")
    check(drive.refusal(0x607A, 0, 2), 0x06070013, "two bytes for a position")
    check(drive.refusal(0x6060, 5, 1), 0x06090030, "a mode that does not exist")
    check(drive.refusal(0x1003, 1, 1), 0x06090030, "1003h takes 0 only")
    check(drive.refusal(0x1010, 1, 4, 1), 0x08000020, "1010h without its word")
    try:
        drive.read(0x60C4, 6)
        sys.exit("60C4h:06 can be read")
    except Abort as abort:
        check(abort.code, 0x06010001, "reading what is write only")
    for request, code, what in (
            ([0xE5, 0, 0, 0, 0, 0, 0, 0], 0x05040001, "no such command"),
            ([0x60, 0, 0, 0, 0, 0, 0, 0], 0x05040001, "a segment without a beginning"),
            ([0x00, 1, 2, 3, 4, 5, 6, 7], 0x05040001, "a segment of nothing")):
        check(int.from_bytes(drive.sdo(request)[4:], "little"), code, what)
    drive.sdo([0x40, 0x08, 0x10, 0, 0, 0, 0, 0])  # 1008h comes in segments
    check(int.from_bytes(drive.sdo([0x70, 0, 0, 0, 0, 0, 0, 0])[4:], "little"), 0x05030000, "a toggle that is wrong")
    drive.send(0x600 + n, [0x40, 0x00, 0x10])  # not eight bytes: not SDO
    check(drive.wait_for(0x580 + n, 0.2), None, "an SDO of three bytes is answered")
    check(drive.read(0x1000) & 0xFFFF, 402, "after all that")


def crc(data):
    value = 0
    for byte in data:
        value ^= byte << 8
        for _ in range(8):
            value = (value << 1 ^ 0x1021 if value & 0x8000 else value << 1) & 0xFFFF
    return value


def write_block(data, checksum):
    """2100h, a name, in a block; the server's last word."""
    answer = drive.sdo([0xC6, 0x00, 0x21, 0] + list(len(data).to_bytes(4, "little")))
    check(answer[0], 0xA4, "block download with checksum")
    pieces = [data[i:i + 7] for i in range(0, len(data), 7)]
    for i, piece in enumerate(pieces):
        last = i + 1 == len(pieces)
        drive.send(0x600 + n, bytes([i + 1 | (0x80 if last else 0)]) + piece.ljust(7, b"\0"))
    confirmed = drive.wait_for(0x580 + n)
    check(list(confirmed[:2]), [0xA2, len(pieces)], "confirmation of the block")
    unused = 7 - len(pieces[-1])
    return drive.sdo([0xC1 | unused << 2] + list(checksum.to_bytes(2, "little")) + [0] * 5)


def read_name():
    answer = drive.sdo([0x40, 0x00, 0x21, 0, 0, 0, 0, 0])
    if answer[0] & 0x02:
        return answer[4:8 - (answer[0] >> 2 & 3)]
    text, toggle = b"", 0
    while True:
        answer = drive.sdo([0x60 | toggle, 0, 0, 0, 0, 0, 0, 0])
        text += answer[1:8 - (answer[0] >> 1 & 7)]
        toggle ^= 0x10
        if answer[0] & 1:
            return text


def blocks():
    good, bad = b"a name of more than one segment", b"another name that comes damaged"
    check(write_block(good, crc(good))[0], 0xA1, "end of a good block")
    check(read_name(), good, "what was written")
    answer = write_block(bad, crc(bad) ^ 1)
    check((answer[0], int.from_bytes(answer[4:], "little")), (0x80, 0x05040004), "a wrong checksum")
    check(read_name(), good, "a block with a wrong checksum changes nothing")
    answer = drive.sdo([0xA0, 0x00, 0x21, 0, 0, 0, 0, 0])
    check(int.from_bytes(answer[4:], "little"), 0x05040002, "a block of no segments")


def nmt(command):
    drive.send(0x000, [command, n])
    time.sleep(0.02)


def answered():
    """What has come of all that was sent before, however long it took: the drive answers in its turn."""
    drive.status()
    return drive.listen(0)


def map_pdo(parameter, entries, cob, kind):
    drive.write(parameter, 0x80000000 | cob, 4, 1)
    drive.write(parameter + 0x200, 0, 1)
    for i, entry in enumerate(entries):
        drive.write(parameter + 0x200, entry, 4, i + 1)
    drive.write(parameter + 0x200, len(entries), 1)
    drive.write(parameter, kind, 1, 2)
    drive.write(parameter, cob, 4, 1)


def process_data():
    nmt(0x01)
    for sub, value, code in ((0, 0, 0x06010000), (1, 0x607A0020, 0x06010000)):
        check(drive.refusal(0x1A00, value, 1 if sub == 0 else 4, sub), code, f"1A00h:{sub:02X} of a valid PDO")
    map_pdo(0x1800, [0x60410010, 0x60640020], 0x180 + n, 1)
    map_pdo(0x1801, [0x606C0020], 0x280 + n, 3)
    answered()
    seen = []
    for i in range(6):
        drive.send(0x080, [])
        seen += answered()
        if i == 2:  # another PDO, while this one counts its SYNCs
            map_pdo(0x1802, [0x60770010], 0x380 + n, 1)
    heard = [m.arbitration_id for m in seen]
    check([heard.count(c + n) for c in (0x180, 0x280, 0x380)], [6, 2, 3], "TPDOs of six SYNCs")
    for bad, code in ((0x60410020, 0x06070010), (0x60400008, 0x06070010), (0x5FFF0010, 0x06020000),
                      (0x607D0320, 0x06090011), (0x60980008, 0x06040041)):
        drive.write(0x1803, 0x80000480 + n, 4, 1)
        drive.write(0x1A03, 0, 1)
        check(drive.refusal(0x1A03, bad, 4, 1), code, f"mapping {bad:08X}h")
    check(drive.refusal(0x1803, 0x00000601, 4, 1), 0x06090030, "the identifier of an SDO")


def sync_counter():
    nmt(0x80)
    for bad in (1, 241, 255):
        if not drive.refusal(0x1019, bad, 1):
            sys.exit(f"1019h takes {bad}")
    drive.write(0x1006, 10_000, 4)
    check(drive.refusal(0x1019, 4, 1), 0x08000022, "1019h while 1006h is not 0")
    drive.write(0x1006, 0, 4)
    drive.write(0x1019, 4, 1)
    drive.write(0x1801, 0x80000280 + n, 4, 1)
    drive.write(0x1801, 4, 1, 2)
    drive.write(0x1801, 3, 1, 6)
    drive.write(0x1801, 0x280 + n, 4, 1)
    nmt(0x01)
    answered()
    came = []
    for counter in (1, 2, 3, 4, 1, 2, 3, 4):
        drive.send(0x080, [counter])
        if any(m.arbitration_id == 0x280 + n for m in answered()):
            came.append(counter)
    check(came, [3, 3], "TPDO2 with 1800h:06 = 3, each fourth SYNC")
    drive.send(0x080, [])
    emcy = drive.wait_for(0x080 + n)
    check(emcy is not None and int.from_bytes(emcy[:2], "little"), 0x8240, "EMCY for a SYNC without its counter")
    nmt(0x80)
    drive.write(0x1801, 0x80000280 + n, 4, 1)
    drive.write(0x1801, 0, 1, 6)
    drive.write(0x1019, 0, 1)
    drive.send(0x080, [])


def lost_connections():
    drive.write(0x605A, 6, 2)
    for option, after in ((0, ENABLED), (1, FAULT), (2, OFF), (3, QUICK)):
        drive.write(0x6007, option, 2)
        bring_to(ENABLED)
        drive.write(0x6007, option, 2)
        nmt(0x01)
        lose_master()
        settles(after, f"6007h = {option} and a lost heartbeat")
    drive.write(0x6007, 1, 2)


bring_to(OFF)
drive.write(0x6060, 1, 1)
for trial in (option_codes, service_data, blocks, process_data, sync_counter, lost_connections, states):
    trial()
bring_to(OFF)
drive.bus.shutdown()
print("the drive keeps to the standard")
