# SPDX-License-Identifier: Apache-2.0
import os

import pytest

import servogate

MILL = os.path.join(os.path.dirname(__file__), "..", "..", "examples", "mill", "machine.toml")


def test_a_silent_drive_stops_the_machine(machine):
    mill = machine(MILL)
    mill.do("ready")
    mill.do("jog X +")
    mill.until(signal="X.velocity", above="50 mm/s")
    mill.fault("can.x", "silent", for_="2 s")
    mill.expect(alarm=2004, within="100 ms")
    mill.expect(standstill="all", distance="30 mm", within="1 s")
    mill.until(signal="X.enabled", equals=False, timeout=2)
    assert mill["X.enabled"] is False
    assert 2004 in mill.alarms()


def test_time_moves_only_when_it_is_asked_to(machine):
    mill = machine(MILL)
    before = mill.time
    assert mill.read("X.actual", "NC.state") == [0.0, "idle"]
    assert mill.time == before
    mill.advance(0.5)
    assert mill.time == pytest.approx(before + 0.5, abs=0.0011)


def test_same_calls_give_the_same_values(machine):
    def run():
        mill = machine(MILL)
        mill.do("ready")
        mill.do("jog X +3.5 mm")
        mill.advance("37 ms")
        return mill.read("X.actual", "X.velocity", "Y.actual")

    assert run() == run()


def test_a_refusal_has_its_code(machine):
    mill = machine(MILL)
    with pytest.raises(servogate.Refused) as refused:
        mill.do("start")
    assert refused.value.code.startswith("gate.") or refused.value.code
    with pytest.raises(servogate.MachineError, match="nowhere"):
        mill.read("nowhere")
    with pytest.raises(servogate.MachineError, match="dance"):
        mill.do("dance X")


def test_a_failure_says_what_there_was(machine):
    mill = machine(MILL)
    mill.do("ready")
    with pytest.raises(servogate.Failed, match=r"expected X.actual > 5 mm within 200 ms, got X.actual = "):
        mill.expect(signal="X.actual", above="5 mm", within="200 ms")


def test_what_must_always_hold_fails_the_call_in_which_it_does_not(machine):
    mill = machine(MILL)
    mill.do("ready")
    mill.never(signal="X.actual", above="3 mm")
    mill.do("jog X +2 mm", wait=True)
    with pytest.raises(servogate.Failed, match="never X.actual > 3 mm"):
        mill.do("jog X +2 mm", wait=True)


def test_inputs_and_places_are_played_and_the_plc_is_seen(machine):
    mill = machine(MILL)
    mill.do("ready")
    mill.set("door_closed", False)
    mill.advance("100 ms")
    assert mill["door_closed"] is False
    assert mill["NC.stop"] is True
    reply = mill.ask("status")
    assert reply["axes"][0]["letter"] == "X"


def test_a_machine_that_is_wrong_says_so(machine, tmp_path):
    wrong = tmp_path / "machine.toml"
    wrong.write_text("schema = 1\n")
    with pytest.raises(servogate.MachineError):
        machine(str(wrong))
