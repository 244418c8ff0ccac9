# SPDX-License-Identifier: Apache-2.0
"""An inverter with the registers of a Delta MS300, served by pymodbus, which knows nothing of the product.
Usage: retrofit_inverter.py tcp PORT | rtu DEVICE.  The motor follows its frequency at 60 Hz a second; without a request for a
second the inverter stops and trips with code 58."""
import asyncio
import sys
import time

from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext
from pymodbus.server import StartAsyncSerialServer, StartAsyncTcpServer
from pymodbus.transaction import ModbusRtuFramer

RAMP, PATIENCE, LOST = 60.0, 1.0, 58


class Inverter:
    def __init__(self):
        self.parameters = {0x0014: 1, 0x0015: 2, 0x0902: 1, 0x0903: 10}
        self.command, self.frequency, self.trip, self.hz, self.seen = 1, 0, 0, 0.0, time.monotonic()

    def live(self):
        now = time.monotonic()
        if self.hz != 0.0 and now - self.seen > PATIENCE:
            self.trip = LOST
        way = {2: 1, 1: 0}.get(self.command & 3, 0) * {1: 1, 2: -1}.get(self.command >> 4 & 3, 0)
        wanted = 0.0 if self.trip else way * self.frequency / 100
        step = RAMP * (now - self.seen)
        self.hz += max(-step, min(step, wanted - self.hz))
        self.seen = now

    def validate(self, address, count=1):
        return True

    def getValues(self, address, count=1):
        self.live()
        runs = self.command & 3 == 2 and not self.trip
        registers = self.parameters | {
            0x2000: self.command, 0x2001: self.frequency, 0x2100: self.trip, 0x2103: round(abs(self.hz) * 100),
            0x2101: (3 if runs else 0) | (0x18 if self.hz < 0 else 0), 0x2102: self.frequency}
        return [registers.get(a, 0) for a in range(address, address + count)]

    def setValues(self, address, values):
        self.live()
        for n, value in enumerate(values):
            if address + n == 0x2000:
                self.command = value
            elif address + n == 0x2001:
                self.frequency = value
            elif address + n == 0x2002 and value & 2:
                self.trip = 0
            else:
                self.parameters[address + n] = value
        print("written", hex(address), *values, flush=True)

    def reset(self):
        pass


async def main():
    wire, where = sys.argv[1:]
    context = ModbusServerContext(slaves={1: ModbusSlaveContext(hr=Inverter(), zero_mode=True)}, single=False)
    if wire == "tcp":
        server = await StartAsyncTcpServer(
            context, address=("127.0.0.1", int(where)), allow_reuse_address=True, defer_start=True)
    else:
        server = await StartAsyncSerialServer(
            context, framer=ModbusRtuFramer, port=where, baudrate=38400, parity="N", stopbits=2, timeout=1, defer_start=True)
        await server.start()
    print("ready", flush=True)
    await server.serve_forever()


asyncio.run(main())
