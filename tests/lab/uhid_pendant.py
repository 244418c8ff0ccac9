# SPDX-License-Identifier: Apache-2.0
"""Pendants as uhid devices of the kernel. This file knows their reports, not the product.

Usage: uhid_pendant.py < ACTIONS      an XHC WHB04B-6; one action a line, "done ACTION" when it has happened
  plug   unplug   turn TURNS COUNTS: X at 0.1 mm a count, every 100 ms"""
import os
import select
import struct
import sys
import threading
import time


class Pendant:
    """A HID device. Source: linux/uhid.h; USB HID 1.11, 6.2.2 Report Descriptor."""

    CREATE2, DESTROY, START, INPUT2, SET_REPORT, SET_REPORT_REPLY = 11, 1, 2, 12, 13, 14

    def __init__(self, vendor, product, name, number, size, display, serial="LAB3"):
        self.number, self.size, self.shown = number, size, {}
        body = bytes([0x15, 0, 0x26, 0xFF, 0, 0x75, 8])
        descriptor = bytes([0x06, 0x00, 0xFF, 0x09, 1, 0xA1, 1])
        descriptor += (bytes([0x85, number]) if number else b"") + bytes([0x09, 2]) + body + bytes([0x95, size, 0x81, 2])
        if display:
            descriptor += bytes([0x85, display, 0x09, 3, 0x95, 7, 0xB1, 2])
        descriptor += bytes([0xC0])
        self.file = os.open("/dev/uhid", os.O_RDWR | os.O_CLOEXEC)
        self.write(self.CREATE2, struct.pack("<128s64s64sHHIIII4096s", name.encode(), b"", serial.encode(), len(descriptor), 3,
                                             vendor, product, 1, 0, descriptor))
        threading.Thread(target=self.serve, daemon=True).start()

    def write(self, kind, body):
        os.write(self.file, struct.pack("<I", kind) + body)

    def serve(self):
        try:
            while True:
                select.select([self.file], [], [])
                event = os.read(self.file, 4380)
                kind = struct.unpack_from("<I", event)[0]
                if kind == self.SET_REPORT:
                    answer, _, _, size = struct.unpack_from("<IBBH", event, 4)
                    report = event[12:12 + size]
                    if report[1:3] == b"\xfe\xfd":
                        self.shown[0] = report
                    self.write(self.SET_REPORT_REPLY, struct.pack("<IH", answer, 0))
        except (OSError, ValueError):
            pass

    def report(self, *body):
        data = (bytes([self.number]) if self.number else b"") + bytes(b & 0xFF for b in body)
        assert len(body) == self.size
        self.write(self.INPUT2, struct.pack("<H4096s", len(data), data))

    def unplug(self):
        self.write(self.DESTROY, b"")
        os.close(self.file)


def main():
    pendant, random = None, 0
    for line in sys.stdin:
        what, *numbers = line.split()
        if what == "plug":
            pendant = Pendant(0x10CE, 0xEB93, "XHC WHB04B-6", 4, 7, 6)
        elif what == "unplug":
            pendant.unplug()
        elif what == "turn":
            turns, counts = map(int, numbers)
            for turn in range(turns + 1):  # the first report selects, and moves nothing
                random = random % 255 + 1
                pendant.report(random, 0, 0, 0x0F, 0x11, counts if turn else 0, 0)
                time.sleep(0.1)
        print("done", line.strip(), flush=True)


if __name__ == "__main__":
    main()
