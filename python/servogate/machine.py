# SPDX-License-Identifier: Apache-2.0
"""A whole simulated machine in virtual time, stepped by a test (`servogate test --session`)."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from types import TracebackType
from typing import Any, Dict, List, Mapping, Optional, Sequence, Type, Union

Value = Union[bool, float, str]
Condition = Mapping[str, Any]


class MachineError(Exception):
    """The machine cannot be put together, or a word, signal or fault is not of this machine."""


class Refused(Exception):
    """The control refused what it was asked for. `code` is the id of its sentence."""

    def __init__(self, text: str, code: str) -> None:
        super().__init__(f"{text} [{code}]")
        self.code = code


class Failed(AssertionError):
    """What was expected did not happen; the text has a picture of the last 50 ms."""


def program() -> str:
    """The command: $SERVOGATE, or servogate of the search path."""
    named = os.environ.get("SERVOGATE") or shutil.which("servogate")
    if not named:
        raise MachineError("no servogate on the search path: install it, or set SERVOGATE to the program")
    return named


def _time(value: Union[str, float]) -> str:
    return value if isinstance(value, str) else f"{value * 1000:.6f} ms"


class Machine:
    """A machine whose time moves only when it is asked to: by advance(), by waiting, or while an answer is waited for.

    Same calls, same values, to the last bit. Times are texts with a unit ("200 ms") or seconds.
    """

    def __init__(self, machine_file: str, *, servogate: Optional[str] = None) -> None:
        self._process = subprocess.Popen(
            [servogate or program(), "test", "--session", machine_file],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8", bufsize=1)
        self._answer()

    def __enter__(self) -> "Machine":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def close(self) -> None:
        if self._process.stdin and not self._process.stdin.closed:
            self._process.stdin.close()
        self._process.wait()
        for stream in (self._process.stdout, self._process.stderr):
            if stream:
                stream.close()

    def _answer(self) -> Dict[str, Any]:
        assert self._process.stdout is not None and self._process.stderr is not None
        line = self._process.stdout.readline()
        if not line:
            raise MachineError(self._process.stderr.read().strip() or "servogate has ended")
        answer: Dict[str, Any] = json.loads(line)
        self.time: float = answer.get("t", 0.0)
        """Machine time in seconds."""
        return answer

    def _ask(self, **what: Any) -> Dict[str, Any]:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(what) + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            pass
        answer = self._answer()
        if answer.get("ok"):
            return answer
        status, text = answer.get("status"), answer.get("message", "")
        if status == "failed":
            if answer.get("code"):
                raise Refused(text, answer["code"])
            raise Failed(text + ("\n" + answer["diagram"] if answer.get("diagram") else ""))
        raise MachineError("\n".join(answer.get("findings", [])) or text)

    def step(self, **keys: Any) -> None:
        """One step of a scenario, with the keys of docs/scenario-reference.md; `for` and `from` as `for_`, `from_`."""
        self._ask(step=_plain(keys))

    def do(self, words: Union[str, Mapping[str, Any]], *, wait: bool = False) -> None:
        """What an operator or client does: "ready", "jog X +5 mm" ... `wait`: until what it begins has ended. Refused."""
        self.step(do=words, **({"wait": True} if wait else {}))

    def advance(self, time: Union[str, float]) -> None:
        """Lets machine time pass."""
        self.step(do=f"wait {_time(time)}")

    def read(self, *signals: str) -> Any:
        """The value of a signal: a float, a bool of a switch, or a word; of several a list."""
        values = self._ask(read=list(signals))["values"]
        return values[0] if len(signals) == 1 else values

    def __getitem__(self, signal: str) -> Value:
        value: Value = self.read(signal)
        return value

    def set(self, point: str, value: Union[bool, float, str]) -> None:
        """Plays an input of a simulated station; "auto": it follows the world again."""
        words = ("on" if value else "off") if isinstance(value, bool) else str(value)
        self.do(f"set {point} {words}")

    def write(self, place: str, value: float) -> None:
        """Writes a place of packet K, as its operator."""
        self.do(f"write {place} {value!r}")

    def fault(self, device: str, kind: str, **parameters: Any) -> None:
        """A fault of docs/faults.md with its parameters; `for` as `for_`."""
        self.step(fault={"device": device, "kind": kind, **parameters})

    def clear(self, device: str, kind: Optional[str] = None) -> None:
        self.step(clear={"device": device, **({"kind": kind} if kind else {})})

    def expect(self, condition: Optional[Condition] = None, *, within: Union[str, float, None] = None, **keys: Any) -> None:
        """A condition must be true now, or within a time. `expect(signal="X.actual", above="4 mm", within="1 s")`. Failed."""
        self.step(expect=_plain(condition or keys), **({"within": _time(within)} if within is not None else {}))

    def until(self, condition: Optional[Condition] = None, *, timeout: Union[str, float] = 60.0, **keys: Any) -> float:
        """Lets time pass until a condition is true, at most `timeout` of machine time; machine time then. Failed."""
        self.expect(condition or keys, within=timeout)
        return self.time

    def always(self, condition: Optional[Condition] = None, **keys: Any) -> None:
        """From now on a condition must be true in every cycle; a later call fails in the cycle in which it is not."""
        self.step(expect=_plain(condition or keys), always=True)

    def never(self, condition: Optional[Condition] = None, **keys: Any) -> None:
        self.step(never=_plain(condition or keys), always=True)

    def alarms(self) -> List[int]:
        """Numbers of the active alarms, oldest first."""
        return list(self._ask(alarms=True)["alarms"])

    def ask(self, cmd: str, **fields: Any) -> Dict[str, Any]:
        """Any command of the control socket (docs/control-socket.md); the whole reply. Refused."""
        return dict(self._ask(ask={"cmd": cmd, **fields})["reply"])


def _plain(value: Any) -> Any:
    """`for_` is `for` in a file."""
    if isinstance(value, Mapping):
        return {key.rstrip("_"): _plain(item) for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(item) for item in value]
    return value
