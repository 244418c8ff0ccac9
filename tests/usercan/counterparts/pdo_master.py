# SPDX-License-Identifier: Apache-2.0
"""A master with its own idea of the PDOs. `fixed` and `whole`: the drive does not let its maps be changed, or only switched off and
on, and says so by the abort codes of CiA 301; what else belongs to a PDO it lets be written. `moved`: TPDO1 gets another COB-ID,
and of 30 frames with SYNC every third is missing, those of TPDO2 are not. The first wrong answer ends it with exit code 1.
Usage: pdo_master.py fixed|whole|moved NODE INTERFACE CHANNEL [KEY=VALUE...]"""
import sys

from node import Node

n = int(sys.argv[2])
drive = Node(n, sys.argv[3], sys.argv[4], sys.argv[5:])
READ_ONLY, NOT_MAPPABLE, UNSUPPORTED = 0x06010002, 0x06040041, 0x06010000
OFF, NO_RTR = 0x80000000, 0x40000000


def check(got, wanted, what):
    if got != wanted:
        sys.exit(f"{what}: {got:08X}h instead of {wanted:08X}h")


def maps():
    return [(index, sub, drive.read(index, sub)) for index in (0x1600, 0x1601, 0x1A00, 0x1A01)
            for sub in range(1, drive.read(index, size=1) + 1)]


def communication():
    """COB-ID, transmission type, inhibit and event time of an invalid PDO."""
    drive.write(0x1801, OFF | 0x280 + n, 4, 1)
    for sub, value, size in ((2, 1, 1), (3, 50, 2), (5, 20, 2)):
        drive.write(0x1801, value, size, sub)
    drive.write(0x1801, 0x1C0 | NO_RTR, 4, 1)
    check(drive.read(0x1801, 1), 0x1C0 | NO_RTR, "1801h:01")


def fixed():
    before = maps()
    for index in (0x1600, 0x1A00):
        drive.write(index - 0x200, OFF | drive.read(index - 0x200, 1), 4, 1)
        check(drive.refusal(index, 0, 1), READ_ONLY, f"{index:04X}h:00 = 0")
        check(drive.refusal(index, 0x60410010, 4, 1), READ_ONLY, f"{index:04X}h:01")
    if maps() != before:
        sys.exit("a refused write has changed a map")
    communication()


def whole():
    before = maps()
    check(drive.refusal(0x1600, 0, 1), UNSUPPORTED, "1600h:00 = 0 of a valid PDO")
    drive.write(0x1400, OFF | 0x200 + n, 4, 1)
    drive.write(0x1600, 0, 1)
    check(drive.refusal(0x1600, 0x607A0020, 4, 1), NOT_MAPPABLE, "another object in 1600h:01")
    check(drive.refusal(0x1600, 2, 1), NOT_MAPPABLE, "another count in 1600h:00")
    drive.write(0x1600, before[0][2], 4, 1)
    drive.write(0x1600, 1, 1)
    drive.write(0x1400, 0x200 + n, 4, 1)
    if maps() != before:
        sys.exit("switched off and on it is another map")
    communication()


def moved():
    new = 0x3A0 + n
    for number, cob in ((1, new), (2, 0x280 + n)):
        parameter = 0x1800 + number - 1
        drive.write(parameter, OFF | NO_RTR | drive.read(parameter, 1) & 0x7FF, 4, 1)
        drive.write(parameter, 1, 1, 2)
        drive.write(parameter, OFF | NO_RTR | cob, 4, 1)
        drive.write(parameter, NO_RTR | cob, 4, 1)
    drive.send(0x000, [0x01, n])
    drive.listen(0.1)
    heard = []
    for _ in range(30):
        drive.send(0x080, [])
        if drive.wait_for(0x280 + n) is None:
            sys.exit("TPDO2 does not come")
        heard += [m.arbitration_id for m in drive.heard]
        drive.heard = []
    check(heard.count(new), 20, "frames of TPDO1 under its new COB-ID")
    check(heard.count(0x180 + n), 0, "frames of TPDO1 under its old one")


{"fixed": fixed, "whole": whole, "moved": moved}[sys.argv[1]]()
drive.bus.shutdown()
print(f"PDOs {sys.argv[1]}: as the standard says")
