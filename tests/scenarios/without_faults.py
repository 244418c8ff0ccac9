#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""without_faults.py SERVOGATE PATH...: each scenario with a fault must fail when the fault is left out; else it would
notice nothing. Prints those that pass; exit code 1 where there is one."""
import json
import os
import subprocess
import sys
import tempfile


def has_fault(file: str) -> bool:
    with open(file, encoding="utf-8") as text:
        return any(line.startswith("fault =") for line in text)


def main() -> int:
    servogate, paths = sys.argv[1], sys.argv[2:]
    with tempfile.TemporaryDirectory() as folder:
        results = os.path.join(folder, "results.json")
        run = subprocess.run([servogate, "test", *paths, "--without-faults", "--quiet", "--json", results], stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True)
        if run.returncode not in (0, 1):
            print(run.stdout)
            return 1
        with open(results, encoding="utf-8") as file:
            scenarios = json.load(file)["scenarios"]
    faulty = [s for s in scenarios if has_fault(s["file"])]
    blind = [s for s in faulty if s["status"] != "failed"]
    for s in blind:
        print(f"{s['file']}: {s['name']}: {s['status']} without its fault")
    print(f"{len(faulty)} scenarios with a fault, {len(faulty) - len(blind)} fail without it")
    return 1 if blind or not faulty else 0


sys.exit(main())
