# SPDX-License-Identifier: Apache-2.0
import os
import subprocess

import pytest

import servogate
from servogate.machine import program

MILL = os.path.join(os.path.dirname(__file__), "..", "..", "examples", "mill", "machine.toml")


@pytest.fixture
def control(tmp_path):
    path = str(tmp_path / "mill.sock")
    up = subprocess.Popen([program(), "up", MILL, "--virtual", "--speed", "20", "--socket", path, "--json"],
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    assert up.stdout.readline(), "it says when it listens"
    with servogate.Control(path, timeout=120) as client:
        yield client
        client.down()
    up.wait()
    up.stdout.close()


def test_an_axis_is_homed_and_jogged_by_a_client(control):
    # Before the first cycle a status has no axes yet.
    control.until(lambda s: "axes" in s and all(a["drive"] != "offline" for a in s["axes"]), timeout=600)
    control.power()
    control.until(lambda s: all(a["enabled"] for a in s["axes"]), timeout=600)
    control.home()
    control.until(lambda s: all(a["homed"] for a in s["axes"]) and not s.get("homing", False), timeout=600)
    control.until(lambda s: not any(a["moving"] for a in s["axes"]), timeout=600)
    control.jog("X", 2.0)
    status = control.until(lambda s: abs(control.axis("X", s)["position"] - 2.0) < 0.01, timeout=600)
    assert status["axes"][0]["letter"] == "X"


def test_a_refusal_is_an_exception_with_its_code(control):
    with pytest.raises(servogate.ControlError) as refused:
        control.start()
    assert refused.value.code
    assert refused.value.reply["ok"] is False
