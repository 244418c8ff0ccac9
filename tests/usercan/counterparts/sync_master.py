# SPDX-License-Identifier: Apache-2.0
"""A master of several drives that asks for their actual values every millisecond: maps TPDO 1 (6041h, 6064h) on SYNC,
starts the nodes, sends CYCLES SYNC. Standard library only.
Usage: sync_master.py socketcan INTERFACE NODES CYCLES     in the computer's time
       sync_master.py lockstep PORT NODES CYCLES           in the time of `servogate can bus can0 --lockstep N`"""
import os
import socket
import struct
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../../drivers/usercan/participant"))
from servogate_lockstep import Bus, Frame

PERIOD = 1_000_000  # ns


def session(nodes, cycles):
    """What it says: ("ask", identifier, data, identifier of the answer), ("send", identifier, data), ("tick",)."""
    for _ in range(50):  # until all have booted
        yield ("tick",)
    for node in range(1, nodes + 1):
        cob = 0x180 + node
        for index, subindex, size, value in ((0x1800, 1, 4, 0x80000000 | cob), (0x1A00, 0, 1, 0),
                                             (0x1A00, 1, 4, 0x60410010), (0x1A00, 2, 4, 0x60640020), (0x1A00, 0, 1, 2),
                                             (0x1800, 2, 1, 1), (0x1800, 1, 4, cob)):
            command = {1: 0x2F, 2: 0x2B, 4: 0x23}[size]
            answer = yield ("ask", 0x600 + node, struct.pack("<BHBI", command, index, subindex, value), 0x580 + node)
            if answer[0] != 0x60:
                sys.exit(f"node {node}: {index:04X}h:{subindex} was not written: {answer.hex()}")
    yield ("send", 0x000, b"\x01\x00")
    for _ in range(50):
        yield ("tick",)
    for _ in range(cycles):
        yield ("tick",)
        yield ("send", 0x080, b"")
    for _ in range(5):
        yield ("tick",)


def in_lockstep(port, script):
    bus = Bus("127.0.0.1", port, "can0", "master")
    step, tick = next(script), PERIOD
    asked = False
    while (now := bus.wait()) is not None:
        heard = {f.id: f.data for f in bus.received()}
        try:
            while True:
                if step[0] == "send":
                    bus.send(Frame(step[1], step[2]))
                    step = next(script)
                elif step[0] == "tick" and now >= tick:
                    tick = (now // PERIOD + 1) * PERIOD
                    step = next(script)
                elif step[0] == "ask" and not asked:
                    bus.send(Frame(step[1], step[2]))
                    asked = True
                elif step[0] == "ask" and step[3] in heard:
                    asked = False
                    step = script.send(heard.pop(step[3]))
                else:
                    break
        except StopIteration:
            return
        bus.done(max(now + 1, tick if step[0] == "tick" else now + PERIOD))


def answer(bus, question, expected):
    """Waits for the answer to this question: to an access of the same object, since the same may have been asked before."""
    while True:
        identifier, length, data = struct.unpack("=IB3x8s", bus.recv(16))
        if identifier == expected and data[1:4] == question[1:4]:
            return data[:length]


def on_socketcan(interface, script):
    bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    # Only answers to service data wake this process.
    bus.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, struct.pack("=II", 0x580, 0x780))
    bus.bind((interface,))
    bus.settimeout(1.0)  # a node may come late: what it did not hear is asked again
    due, tries = None, 0
    step = next(script)
    try:
        while True:
            if step[0] == "tick":
                due = (due or time.monotonic_ns()) + PERIOD
                time.sleep(max(0, due - time.monotonic_ns()) * 1e-9)
                step = next(script)
                continue
            bus.send(struct.pack("=IB3x8s", step[1], len(step[2]), step[2]))
            if step[0] == "send":
                step = next(script)
                continue
            try:
                step = script.send(answer(bus, step[2], step[3]))
                tries = 0
            except TimeoutError:
                tries += 1
                if tries == 60:
                    sys.exit(f"no answer on {step[3]:03X}h to {step[2].hex()} in {tries} s")
    except StopIteration:
        return


def main():
    script = session(int(sys.argv[3]), int(sys.argv[4]))
    if sys.argv[1] == "lockstep":
        in_lockstep(int(sys.argv[2]), script)
    else:
        on_socketcan(sys.argv[2], script)


main()
