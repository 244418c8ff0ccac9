# SPDX-License-Identifier: Apache-2.0
"""A CAN adapter of the Lawicel kind on a serial port: what it is told goes to a CAN interface of the kernel, what it hears there to the port.
Source: Lawicel AB, CAN232 manual version 3. It knows the protocol, not the product. Usage: slcan_adapter.py TTY INTERFACE"""
import os
import select
import socket
import struct
import sys
import tty

EXTENDED, REMOTE, ERROR = 0x80000000, 0x40000000, 0x20000000
port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
tty.setraw(port)
can = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
can.bind((sys.argv[2],))
opened = listens = False
print("ready", flush=True)


def answer(line):
    """The answer to a command, without its end; None: it is refused."""
    global opened, listens
    command, rest = line[:1], line[1:]
    if command == b"S" and not opened and rest.isdigit():
        return b""
    if command in (b"O", b"L") and not opened:
        opened, listens = True, command == b"L"
        return b""
    if command == b"C":
        opened = False
        return b""
    if command == b"V":
        return b"V1013"
    if command == b"N":
        return b"NLAB4"
    if command == b"F" and opened:
        return b"F00"
    if command in (b"t", b"T", b"r", b"R") and opened and not listens:
        digits = 3 if command in (b"t", b"r") else 8
        identifier, size = int(rest[:digits], 16), int(rest[digits:digits + 1], 16)
        data = bytes.fromhex(rest[digits + 1:].decode()) if command in (b"t", b"T") else b""
        if size > 8 or (command in (b"t", b"T") and len(data) != size):
            return None
        flags = (EXTENDED if digits == 8 else 0) | (0 if command in (b"t", b"T") else REMOTE)
        can.send(struct.pack("=IB3x8s", identifier | flags, size, data))
        return b"z" if digits == 3 else b"Z"
    return None


pending = b""
while True:
    for ready in select.select([port, can], [], [])[0]:
        if ready == port:
            pending += os.read(port, 4096)
            *lines, pending = pending.split(b"\r")
            for line in lines:
                said = answer(line)
                os.write(port, b"\a" if said is None else said + b"\r")
        else:
            identifier, size, data = struct.unpack("=IB3x8s", can.recv(16))
            if not opened or identifier & ERROR:
                continue
            letter = (b"R" if identifier & EXTENDED else b"r") if identifier & REMOTE else (b"T" if identifier & EXTENDED else b"t")
            number = b"%08X" % (identifier & 0x1FFFFFFF) if identifier & EXTENDED else b"%03X" % (identifier & 0x7FF)
            body = b"" if identifier & REMOTE else data[:size].hex().upper().encode()
            os.write(port, letter + number + b"%d" % size + body + b"\r")
