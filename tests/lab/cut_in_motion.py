# SPDX-License-Identifier: Apache-2.0
"""Waits until the set-points of X and Y (607Ah in 201h and 202h) have moved together for 50 cycles, X faster than it
homes, then carries a command out; `error-frame` puts the controller's message of bus-off on the bus.
Usage: cut_in_motion.py INTERFACE COMMAND"""
import os
import socket
import struct
import sys

CAN_ERR_FLAG, CAN_ERR_BUSOFF = 0x20000000, 0x40
LEAST = {0x201: 6500, 0x202: 1}  # counts in a cycle of 4 ms; homing has 5243
bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
bus.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, struct.pack("=IIII", 0x201, 0x7FF, 0x202, 0x7FF))
bus.bind((sys.argv[1],))
last, moving = {}, {0x201: 0, 0x202: 0}
while min(moving.values()) < 50:
    identifier, length, data = struct.unpack("=IB3x8s", bus.recv(16))
    target = int.from_bytes(data[2:6], "little", signed=True)
    moves = abs(target - last.get(identifier, target)) >= LEAST[identifier]
    moving[identifier] = moving[identifier] + 1 if moves else 0
    last[identifier] = target
if sys.argv[2] == "error-frame":
    bus.send(struct.pack("=IB3x8s", CAN_ERR_FLAG | CAN_ERR_BUSOFF, 8, bytes(8)))
else:
    sys.exit(os.system(sys.argv[2]) != 0)
