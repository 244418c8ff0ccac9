# SPDX-License-Identifier: Apache-2.0
"""Client of a servogate control (`Control`), and a whole simulated machine that a test steps (`Machine`)."""

from .control import Control, ControlError
from .machine import Failed, Machine, MachineError, Refused

__all__ = ["Control", "ControlError", "Failed", "Machine", "MachineError", "Refused"]
