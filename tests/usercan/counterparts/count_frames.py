# SPDX-License-Identifier: Apache-2.0
"""Reads frames whose first two bytes count, over python-can's socketcand interface; exit code 1 when one is missing.
Usage: count_frames.py PORT FRAMES"""
import sys

import can

bus = can.Bus(interface="socketcand", channel="can0", host="127.0.0.1", port=int(sys.argv[1]))
last = None
for _ in range(int(sys.argv[2])):
    message = bus.recv(10.0)
    if message is None:
        sys.exit("no frame for 10 s")
    number = int.from_bytes(message.data, "little")
    if last is not None and number != (last + 1) % 65536:
        sys.exit(f"{number} came after {last}")
    last = number
bus.shutdown()
