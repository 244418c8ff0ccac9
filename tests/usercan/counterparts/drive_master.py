# SPDX-License-Identifier: Apache-2.0
"""python-can as a CANopen master of one drive: identity by SDO, NMT, the CiA 402 states up and down, motion in
profile velocity. Every wrong answer ends it with exit code 1 and a sentence.
Usage: drive_master.py NODE INTERFACE CHANNEL [KEY=VALUE...]"""
import sys
import time

import can

node = int(sys.argv[1])
options = {k: int(v) if v.isdigit() else v for k, v in (a.split("=", 1) for a in sys.argv[4:])}
bus = can.Bus(interface=sys.argv[2], channel=sys.argv[3], **options)


def send(identifier, data):
    bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))


def wait_for(identifier, what, seconds=10.0):
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


def read(index, subindex=0):
    return int.from_bytes(sdo(0x40, index, subindex)[4:], "little")


def write(index, value, size, subindex=0):
    sdo({1: 0x2F, 2: 0x2B, 4: 0x23}[size], index, subindex, (value & 0xFFFFFFFF).to_bytes(4, "little"))


def state(word, mask, value, what):
    write(0x6040, word, 2)
    for _ in range(200):
        if read(0x6041) & mask == value:
            return
        time.sleep(0.01)
    sys.exit(f"the drive does not reach {what}: 6041h = {read(0x6041):04X}h")


if read(0x1000) & 0xFFFF != 402:
    sys.exit("1000h does not say CiA 402")
write(0x1017, 50, 2)
send(0x000, bytes([1, node]))
for _ in range(50):
    if wait_for(0x700 + node, "heartbeat")[0] == 5:
        break
else:
    sys.exit("the node does not become operational")
state(0x06, 0x6F, 0x21, "Ready to switch on")
state(0x07, 0x6F, 0x23, "Switched on")
write(0x6060, 3, 1)
state(0x0F, 0x6F, 0x27, "Operation enabled")
before = read(0x6064)
write(0x6083, 2_000_000, 4)
write(0x60FF, 100_000, 4)
for _ in range(500):
    if abs(read(0x6064) - before) > 10_000:
        break
    time.sleep(0.01)
else:
    sys.exit("the drive does not move in profile velocity")
write(0x60FF, 0, 4)
state(0x07, 0x6F, 0x23, "Switched on")
state(0x00, 0x4F, 0x40, "Switch on disabled")
bus.shutdown()
print("done")
