# SPDX-License-Identifier: Apache-2.0
"""One CANopen node as seen by a master: python-can and the standard, no CANopen package."""
import sys
import time

import can

PATIENCE = 60.0  # s


class Abort(Exception):
    """An SDO abort; `code` is its number."""

    def __init__(self, code):
        super().__init__(f"{code:08X}h")
        self.code = code


class Node:
    def __init__(self, number, interface, channel, options):
        values = {k: int(v) if v.isdigit() else v for k, v in (o.split("=", 1) for o in options)}
        self.number = number
        self.bus = can.Bus(interface=interface, channel=channel, **values)
        self.heard = []  # frames that nobody has waited for

    def send(self, identifier, data):
        self.bus.send(can.Message(arbitration_id=identifier, data=bytes(data), is_extended_id=False))

    def listen(self, seconds):
        """Everything that comes in this time."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            message = self.bus.recv(left)
            if message is not None:
                self.heard.append(message)
        heard, self.heard = self.heard, []
        return heard

    def wait_for(self, identifier, seconds=PATIENCE):
        """The next frame with this identifier, None when there is none."""
        for i, message in enumerate(self.heard):
            if message.arbitration_id == identifier:
                return bytes(self.heard.pop(i).data)
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            message = self.bus.recv(left)
            if message is None or message.is_remote_frame:
                continue
            if message.arbitration_id == identifier:
                return bytes(message.data)
            self.heard.append(message)
        return None

    def sdo(self, request):
        """Eight bytes there, eight bytes back, whatever they are."""
        self.send(0x600 + self.number, request)
        answer = self.wait_for(0x580 + self.number)
        if answer is None:
            sys.exit(f"node {self.number} does not answer {bytes(request).hex()}")
        return answer

    def _checked(self, request):
        answer = self.sdo(request)
        if answer[0] == 0x80:
            raise Abort(int.from_bytes(answer[4:], "little"))
        return answer

    def read(self, index, subindex=0, size=4, signed=False):
        answer = self._checked([0x40, index & 0xFF, index >> 8, subindex, 0, 0, 0, 0])
        return int.from_bytes(answer[4:4 + size], "little", signed=signed)

    def write(self, index, value, size, subindex=0):
        head = [{1: 0x2F, 2: 0x2B, 4: 0x23}[size], index & 0xFF, index >> 8, subindex]
        self._checked(head + list((value & 0xFFFFFFFF).to_bytes(4, "little")))

    def refusal(self, index, value, size, subindex=0):
        """The abort code of a write, 0 when it is taken."""
        try:
            self.write(index, value, size, subindex)
        except Abort as abort:
            return abort.code
        return 0

    def status(self):
        return self.read(0x6041, size=2)

    def until(self, met, what):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if met():
                return
            time.sleep(0.002)
        sys.exit(f"{what}: statusword {self.status():04X}h, error {self.read(0x603F, size=2):04X}h, "
                 f"position {self.read(0x6064, signed=True)}, inputs {self.read(0x60FD):08X}h")

    def bits(self, mask, value, what):
        self.until(lambda: self.status() & mask == value, what)
