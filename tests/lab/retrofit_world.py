# SPDX-License-Identifier: Apache-2.0
"""What surrounds the example retrofit when its switches are lines of a GPIO chip and its drives are on vcan0: the slides follow
the drives' process data, and their switches pull the lines. It knows the machine file and the wire, not the product.

Usage: retrofit_world.py MACHINE SYSFS_OF_CHIP < ACTIONS      one action a line; "done ACTION" when it has happened
  stick POINT 0|1   free POINT   bounce POINT COUNT MS   run COMMAND   moving ACTION: once X has moved by 5 mm"""
import os
import socket
import select
import struct
import subprocess
import sys
import time
import tomllib

MOVED = 5.0  # mm
machine = tomllib.load(open(sys.argv[1], "rb"))
sysfs = sys.argv[2]
start = {d["node"]: float(d["start"].split()[0]) for d in machine["simulation"]["drive"]}
points = {p["name"]: p for s in machine["station"] if s["kind"] == "gpio" for p in s["points"]}


class Wire:
    """An input line of the chip; levels as packet A has them."""

    def __init__(self, name):
        self.inverted = points[name].get("inverted", False)
        self.stuck = self.wanted = self.shown = None
        number = "".join(c for c in points[name]["channel"] if c.isdigit())
        self.file = os.open(f"{sysfs}/sim_gpio{number}/pull", os.O_WRONLY)

    def set(self, level):
        self.wanted = level
        level = level if self.stuck is None else self.stuck
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
        self.mm = self.begin = start[axis["drive"]]
        self.per_count = float(axis["lead"].split()[0]) / axis["counts_per_rev"]
        self.switches = []
        for s in machine["simulation"]["switch"]:
            if s["axis"] == axis["letter"]:
                ends = [float(s[k].split()[0]) if k in s else e for k, e in (("from", -1e9), ("to", 1e9))]
                self.switches.append((wires[s["point"]], *ends))
        self.follow(0)

    def follow(self, counts):
        self.mm = self.begin + counts * self.per_count
        for wire, low, high in self.switches:
            wire.set(low <= self.mm <= high)


def act(words):
    what, *rest = words
    if what == "stick":
        wires[rest[0]].stuck = rest[1] == "1"
        wires[rest[0]].set(wires[rest[0]].wanted)
    elif what == "free":
        wires[rest[0]].stuck = None
        wires[rest[0]].set(wires[rest[0]].wanted)
    elif what == "bounce":
        wire, level = wires[rest[0]], wires[rest[0]].shown
        for _ in range(int(rest[1])):
            for now in (not level, level):
                wire.set(now)
                time.sleep(float(rest[2]) / 1000)
    elif what == "run":
        subprocess.run(" ".join(rest), shell=True, check=True)
    print("done", *words, flush=True)


ids = {n["name"]: n["id"] for n in machine["bus"][0]["node"]}
slides = {ids[a["drive"].split(".")[1]]: Slide(a) for a in machine["axis"] if "drive" in a}
for name, wire in wires.items():
    if wire.shown is None:
        wire.set(name in ("estop_chain_ok", "door_closed"))
can = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
filters = [value for node in slides for value in (0x180 + node, 0x7FF)]
can.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, struct.pack(f"={len(filters)}I", *filters))
can.bind(("vcan0",))
print("ready", flush=True)
x, waiting, sources = slides[ids["x"]], [], [can, sys.stdin]
while True:
    ready = select.select(sources, [], [])[0]
    if sys.stdin in ready:
        line = sys.stdin.readline().split()
        if not line:
            sources.remove(sys.stdin)
        elif line[0] == "moving":
            waiting.append((x.mm, line[1:]))
        else:
            act(line)
    if can in ready:
        identifier, size, data = struct.unpack("=IB3x8s", can.recv(16))
        slide = slides.get(identifier - 0x180)
        if slide is not None and size == 6:
            slide.follow(struct.unpack("<i", data[2:6])[0])
    if waiting and abs(x.mm - waiting[0][0]) >= MOVED:
        act(waiting.pop(0)[1])
