# SPDX-License-Identifier: Apache-2.0
"""From what make prints (standard input) to compile_commands.json (standard output): an entry for each file compiled."""
import json
import os
import shlex
import sys

entries = []
for line in sys.stdin:
    words = shlex.split(line) if " -c " in line and line.rstrip().endswith(".o") else []
    if "-c" in words[:-1]:
        entries.append({"directory": os.getcwd(), "file": words[words.index("-c") + 1], "output": words[-1],
                        "arguments": words})
json.dump(entries, sys.stdout, indent=1)
sys.exit(0 if entries else "compile_commands.py: make named no file that it compiles")
