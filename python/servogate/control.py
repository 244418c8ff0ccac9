# SPDX-License-Identifier: Apache-2.0
"""A client of the control socket of `servogate up` (docs/control-socket.md)."""

from __future__ import annotations

import glob
import json
import os
import socket
import time
from types import TracebackType
from typing import Any, Callable, Dict, List, Optional, Type

Reply = Dict[str, Any]


class ControlError(Exception):
    """The control refused a request, or cannot be reached. `code` is the id of its sentence, `reply` all of it."""

    def __init__(self, text: str, code: str = "", reply: Optional[Reply] = None) -> None:
        super().__init__(text)
        self.code = code
        self.reply = reply or {}


def find_socket() -> str:
    """The socket of $SERVOGATE_SOCKET, or of the only control that runs for this user."""
    named = os.environ.get("SERVOGATE_SOCKET", "")
    if named:
        return named
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    folder = os.path.join(runtime, "servogate") if runtime else f"/tmp/servogate-{os.getuid()}"
    found = sorted(glob.glob(os.path.join(folder, "*.sock")))
    if len(found) != 1:
        raise ControlError(f"{len(found)} controls run ({', '.join(found) or 'none'}): name the socket")
    return found[0]


class Control:
    """A connection to a running control. What it holds (jogs, forces) ends with it.

    Not for several threads at once. Every request has a time limit; a refusal raises ControlError.
    """

    def __init__(self, path: Optional[str] = None, *, timeout: float = 10.0, language: str = "en") -> None:
        self.path = path or find_socket()
        self.timeout = timeout
        self.language = language
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(timeout)
        try:
            self._socket.connect(self.path)
        except OSError as error:
            self._socket.close()
            raise ControlError(f"{self.path}: {error.strerror}") from error
        self._received = b""

    def __enter__(self) -> "Control":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def close(self) -> None:
        self._socket.close()

    def request(self, cmd: str, **fields: Any) -> Reply:
        """Any command of docs/control-socket.md; the whole reply. Raises ControlError where it is refused."""
        line = json.dumps({"cmd": cmd, "asker": "scenario", "language": self.language, **fields}) + "\n"
        try:
            self._socket.sendall(line.encode())
            while b"\n" not in self._received:
                more = self._socket.recv(65536)
                if not more:
                    raise ControlError(f"{self.path}: the control has closed the connection")
                self._received += more
        except OSError as error:
            raise ControlError(f"{self.path}: {error}") from error
        answer, self._received = self._received.split(b"\n", 1)
        reply: Reply = json.loads(answer)
        if not reply.get("ok", False):
            raise ControlError(reply.get("text", "refused"), reply.get("code", ""), reply)
        return reply

    def status(self) -> Reply:
        return self.request("status")

    def alarms(self) -> List[Dict[str, Any]]:
        return list(self.request("alarms").get("alarms", []))

    def axis(self, letter: str, status: Optional[Reply] = None) -> Dict[str, Any]:
        """The entry of one axis in a status; without one it asks."""
        for entry in (status or self.status())["axes"]:
            if entry["letter"] == letter:
                return dict(entry)
        raise KeyError(letter)

    def power(self, on: bool = True) -> Reply:
        return self.request("power", value=1 if on else 0)

    def home(self, *axes: str) -> Reply:
        return self.request("home", axes=list(axes))

    def jog(self, axis: str, distance: float) -> Reply:
        """mm or degrees, signed."""
        return self.request("jog", axis=axis, value=distance)

    def load(self, program: str, *, process: int = 1) -> Reply:
        return self.request("load", program=os.path.abspath(program), process=process)

    def start(self, *, process: int = 1) -> Reply:
        return self.request("start", process=process)

    def mdi(self, block: str, *, process: int = 1) -> Reply:
        return self.request("mdi", block=block, process=process)

    def hold(self) -> Reply:
        return self.request("hold")

    def resume(self, *, process: int = 1) -> Reply:
        return self.request("resume", process=process)

    def stop(self) -> Reply:
        return self.request("stop")

    def reset(self) -> Reply:
        return self.request("reset")

    def override(self, percent: float, *, process: int = 1) -> Reply:
        return self.request("override", value=percent, process=process)

    def set_input(self, point: str, value: Any) -> Reply:
        """Plays an input of a simulated station: True, False, a number, or "auto"."""
        return self.request("input", point=point, value=value)

    def down(self) -> Reply:
        return self.request("down")

    def until(self, condition: Callable[[Reply], bool], *, timeout: float = 60.0, period: float = 0.05) -> Reply:
        """Looks at the status until `condition` is true of it, and returns it. TimeoutError behind `timeout` seconds of the
        wall clock. An alarm does not end it: ask for `status["alarms"]` in the condition where it should."""
        end = time.monotonic() + timeout
        while True:
            status = self.status()
            if condition(status):
                return status
            if time.monotonic() >= end:
                raise TimeoutError(f"not within {timeout} s; alarms: {status.get('alarms', [])}")
            time.sleep(period)
