# SPDX-License-Identifier: Apache-2.0
"""A master on a bus in lockstep: NMT start, then SYNC every millisecond; prints what it hears with its instant.
Usage: lockstep_master.py PORT"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../../drivers/usercan/participant"))
from servogate_lockstep import Bus, Frame

bus = Bus("127.0.0.1", int(sys.argv[1]), "can0", "master")
sync = 1_000_000
while (now := bus.wait()) is not None:
    for frame in bus.received():
        print(now, f"{frame.id:03X}", frame.data.hex())
    if now == 0:
        bus.send(Frame(0x000, b"\x01\x00"))
    if now >= sync:
        bus.send(Frame(0x080))
        sync += 1_000_000
    bus.done(sync)
bus.close()
