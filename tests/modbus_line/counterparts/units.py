# SPDX-License-Identifier: Apache-2.0
"""Units of pymodbus: units.py tcp PORT UNIT... | rtu DEVICE UNIT...
Discrete input n is on where n is the unit's number; input register n is 100 * unit + n. Prints "ready" when it serves;
what is written stays, and holding register 10 of a unit counts nothing."""
import asyncio
import sys

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server import StartAsyncSerialServer, StartAsyncTcpServer
from pymodbus.transaction import ModbusRtuFramer


class Told(ModbusSequentialDataBlock):
    """Says what is written, a line each."""

    def __init__(self, unit, kind, size):
        super().__init__(0, [0] * size)
        self.told = (unit, kind)

    def setValues(self, address, values):
        super().setValues(address, values)
        unit, kind = self.told
        print("written", unit, kind, address, *[int(v) for v in values], flush=True)


def unit_of(unit):
    return ModbusSlaveContext(
        di=ModbusSequentialDataBlock(0, [int(n == unit) for n in range(16)]),
        co=Told(unit, "coils", 16),
        ir=ModbusSequentialDataBlock(0, [100 * unit + n for n in range(4)]),
        hr=Told(unit, "registers", 2),
        zero_mode=True,
    )


async def main():
    wire, where, *units = sys.argv[1:]
    context = ModbusServerContext(slaves={int(u): unit_of(int(u)) for u in units}, single=False)
    if wire == "tcp":
        # A port whose last connections have just been ended may be taken again.
        server = await StartAsyncTcpServer(
            context, address=("127.0.0.1", int(where)), allow_reuse_address=True, defer_start=True
        )
    else:
        server = await StartAsyncSerialServer(
            context, framer=ModbusRtuFramer, port=where, baudrate=115200, parity="N", timeout=1, defer_start=True
        )
        await server.start()
    print("ready", flush=True)
    await server.serve_forever()


asyncio.run(main())
