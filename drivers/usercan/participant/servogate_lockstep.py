# SPDX-License-Identifier: Apache-2.0
"""Lets a Python program take part in a servogate bus in lockstep: `servogate can bus can0 --lockstep N` grants time,
this program answers when it is done with it. One file, standard library only. See docs/can.md.

    bus = Bus("127.0.0.1", 29536, "can0", "my-device")
    while (now := bus.wait()) is not None:
        for frame in bus.received():
            ...
        bus.send(Frame(0x181, b"\\x01\\x02"))
        bus.done(now + 1_000_000)      # wake me in a millisecond, or when a frame has ended

Times are nanoseconds since the beginning.
"""

import collections
import socket

Frame = collections.namedtuple("Frame", "id data extended remote length", defaults=(b"", False, False, None))


class Bus:
    """A participant's end of a bus in lockstep."""

    def __init__(self, host, port, name, participant, timeout=30.0):
        """Connects and joins; raises OSError or RuntimeError. `participant` is a name that nobody else has."""
        self._socket = socket.create_connection((host, port), timeout)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket.settimeout(None)
        self._bytes = b""
        self._out = []
        self._heard = []
        self.now = 0
        self._expect(None, "hi")
        for said in (f"open {name}", "rawmode", "remotemode", f"lockstep {participant}"):
            self._expect(said, "ok")

    def wait(self):
        """Waits for the next grant and returns the time granted; None: time has ended, or the server is gone."""
        self._heard = []
        while True:
            words = self._element()
            if words is None or words[0] == "end":
                return None
            if words[0] == "grant":
                self.now = int(words[1])
                return self.now
            if words[0] in ("frame", "remote"):
                self._heard.append(self._frame(words))

    def received(self):
        """The frames that have ended since the last grant, in their order."""
        heard, self._heard = self._heard, []
        return heard

    def send(self, frame):
        """Sends a frame: it takes part in the arbitration at this instant."""
        identifier = f"{frame.id:08X}" if frame.extended else f"{frame.id:03X}"
        if frame.remote:
            self._out.append(f"< remote {identifier} {frame.length or 0:X} >")
        else:
            data = " ".join(f"{b:02X}" for b in frame.data)
            self._out.append(f"< send {identifier} {len(frame.data):X} {data} >")

    def done(self, wish):
        """Done with this instant; time is wanted again at `wish`, or when a frame has ended."""
        self._out.append(f"< done {self.now} {wish} >")
        try:
            self._socket.sendall("".join(self._out).encode("ascii"))
        except ConnectionError:
            pass  # the server is gone: what it said before is still to be read, then wait() returns None
        self._out = []

    def close(self):
        self._socket.close()

    @staticmethod
    def _frame(words):
        extended = len(words[1]) == 8
        if words[0] == "remote":
            return Frame(int(words[1], 16), b"", extended, True, int(words[3], 16))
        data = bytes.fromhex("".join(words[3:]))
        return Frame(int(words[1], 16), data, extended, False, len(data))

    def _element(self):
        """The words of the next element; None: the server is gone."""
        while True:
            end = self._bytes.find(b">")
            if end >= 0:
                begin = self._bytes.rfind(b"<", 0, end)
                words = self._bytes[begin + 1 : end].decode("ascii").split()
                self._bytes = self._bytes[end + 1 :]
                if words:
                    return words
                continue
            try:
                more = self._socket.recv(65536)
            except ConnectionError:  # it ended with something of ours unread
                more = b""
            if not more:
                return None
            self._bytes += more

    def _expect(self, said, answer):
        if said is not None:
            self._socket.sendall(f"< {said} >".encode("ascii"))
        while True:
            words = self._element()
            if words is None or words[0] == "error":
                raise RuntimeError(f"bus server: {' '.join(words or ['gone'])} (on '{said or 'connect'}')")
            if words[0] == answer:
                return
