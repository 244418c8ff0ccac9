#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads a capture by the CSV reader of Python and prints its rows as `time_ns value ...`; an empty cell is nan.
Shares nothing with the program that wrote the file."""
import csv
import decimal
import sys

with open(sys.argv[1], newline="", encoding="utf-8") as file:
    rows = csv.reader(file, strict=True)
    header = next(rows)
    for row in rows:
        assert len(row) == len(header), "as many cells as names"
        time_ns = decimal.Decimal(row[0]) * 1_000_000_000
        assert time_ns == int(time_ns)
        print(int(time_ns), *(cell or "nan" for cell in row[1:]))
