# SPDX-License-Identifier: Apache-2.0
"""Fixture `machine`: a function that starts a simulated machine, which ends with the test."""

from __future__ import annotations

from typing import Callable, Iterator, List

import pytest

from .machine import Machine


@pytest.fixture
def machine() -> Iterator[Callable[[str], Machine]]:
    """`machine("machine.toml")` starts one in virtual time; all of a test end with it."""
    started: List[Machine] = []

    def start(machine_file: str) -> Machine:
        started.append(Machine(machine_file))
        return started[-1]

    yield start
    for one in started:
        one.close()
