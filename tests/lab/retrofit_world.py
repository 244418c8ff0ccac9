# SPDX-License-Identifier: Apache-2.0
"""What surrounds the example retrofit when its switches are lines of a simulated GPIO chip and its drives are on vcan0: the
slides follow the drives' process data, and their switches pull the lines. It knows the machine file and the wire, not the
product. A button is pressed until the program moves something.

Usage: retrofit_world.py MACHINE SYSFS_OF_CHIP [--at MM ACTION]
ACTION, once X has moved MM from where it was when the program began to move it:
  run:COMMAND  stick:POINT:0|1  bounce:POINT:COUNT:MS
Before anything moves:  --stuck POINT 0|1"""
import argparse
import os
import select
import socket
import struct
import subprocess
import sys
import time
import tomllib

parser = argparse.ArgumentParser()
parser.add_argument("machine")
parser.add_argument("sysfs")
parser.add_argument("--at", nargs=2)
parser.add_argument("--stuck", nargs=2)
options = parser.parse_args()
machine = tomllib.load(open(options.machine, "rb"))
start = {d["node"]: float(d["start"].split()[0]) for d in machine["simulation"]["drive"]}
points = {p["name"]: p for s in machine["station"] if s["kind"] == "gpio" for p in s["points"]}


class Wire:
    """An input line of the chip; `level` as packet A has it."""

    def __init__(self, name):
        self.inverted = points[name].get("inverted", False)
        self.name, self.stuck, self.shown = name, None, None
        number = "".join(c for c in points[name]["channel"] if c.isdigit())
        self.file = os.open(f"{options.sysfs}/sim_gpio{number}/pull", os.O_WRONLY)

    def set(self, level):
        level = self.stuck if self.stuck is not None else bool(level)
        if level == self.shown:
            return
        self.shown = level
        try:
            os.pwrite(self.file, b"pull-up" if level != self.inverted else b"pull-down", 0)
        except OSError:
            pass  # the chip has gone


wires = {name: Wire(name) for name, p in points.items() if p["channel"].startswith("di")}


class Slide:
    """An axis with its switches."""

    def __init__(self, axis):
        self.node = axis["drive"]
        self.mm = self.home = start[self.node]
        self.per_count = float(axis["lead"].split()[0]) / axis["counts_per_rev"]
        self.switches = []
        for s in machine["simulation"]["switch"]:
            if s["axis"] == axis["letter"]:
                ends = [float(s[k].split()[0]) if k in s else e for k, e in (("from", -1e9), ("to", 1e9))]
                self.switches.append((wires[s["point"]], *ends))
        self.place()

    def place(self):
        for wire, low, high in self.switches:
            wire.set(low <= self.mm <= high)

    def follow(self, counts):
        self.mm = self.home + counts * self.per_count
        self.place()


if options.stuck:
    wires[options.stuck[0]].stuck = options.stuck[1] == "1"
ids = {n["name"]: n["id"] for n in machine["bus"][0]["node"]}
slides = {ids[a["drive"].split(".")[1]]: Slide(a) for a in machine["axis"]}
for name in ("estop_chain_ok", "door_closed"):
    wires[name].set(True)
wires["cycle_start"].set(False)
for wire in wires.values():
    if wire.shown is None:
        wire.set(False)
print("ready", flush=True)


def act(action):
    kind, _, rest = action.partition(":")
    if kind == "run":
        subprocess.run(rest, shell=True, check=True)
    elif kind == "stick":
        name, level = rest.split(":")
        wires[name].stuck = level == "1"
        wires[name].set(None)
    elif kind == "bounce":
        name, count, ms = rest.split(":")
        for _ in range(int(count)):
            for level in (not wires[name].shown, wires[name].shown):
                wires[name].set(level)
                time.sleep(float(ms) / 1000)
    print("done", action, flush=True)


can = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
can.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, struct.pack("=IIIIII", *(v for n in slides for v in (0x180 + n, 0x7FF))))
can.bind(("vcan0",))
x, begun, pressed = slides[ids["x"]], None, 0.0
while True:
    now = time.monotonic()
    if begun is None and now - pressed > 1.0:
        wires["cycle_start"].set(not wires["cycle_start"].shown)
        pressed = now
    if not select.select([can], [], [], 0.2)[0]:
        continue
    identifier, size, data = struct.unpack("=IB3x8s", can.recv(16))
    slide = slides.get(identifier - 0x180)
    if slide is None or size != 6:
        continue
    slide.follow(struct.unpack("<i", data[2:6])[0])
    if options.at and slide is x and begun is None and x.mm != x.home:
        begun = x.mm
    if options.at and begun is not None and abs(x.mm - begun) >= float(options.at[0]):
        wires["cycle_start"].set(False)
        act(options.at[1])
        options.at = None
