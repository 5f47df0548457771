# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
"""snippets.py <source> <folder of the commands>: every command line that README, docs or CONTRIBUTING shows names a command, a
subcommand and options that there are, and every YAML block of a page is YAML. What can be run without a table, the tutorials'
tests and tests/firmware/how_to run."""

import os
import pathlib
import re
import shlex
import subprocess
import sys

try:
    import yaml
except ImportError:
    print("PyYAML is not installed (python3-yaml): skipped")
    sys.exit(77)

source, commands = pathlib.Path(sys.argv[1]), sys.argv[2]
programs = {name for name in os.listdir(commands) if re.match(r"(imu|gnss)_[a-z]+$", name)}
helps, faults, checked = {}, [], 0


def help_of(words):
    key = tuple(words)
    if key not in helps:
        done = subprocess.run([os.path.join(commands, words[0]), *words[1:], "--help"], capture_output=True, text=True)
        helps[key] = done.stdout if done.returncode == 0 else None
    return helps[key]


def check(where, line):
    global checked
    line = re.sub(r"\s#.*$", "", line).strip().removeprefix("$ ").removeprefix("sudo ")
    try:
        words = shlex.split(line)
    except ValueError:
        return faults.append(f"{where}: no command line: {line}")
    if not words or os.path.basename(words[0]) not in programs:
        return
    checked += 1
    program = [os.path.basename(words[0])]
    text = help_of(program)
    if "Subcommands:" in text and len(words) > 1 and not words[1].startswith("-"):
        program.append(words[1])
        text = help_of(program)
        if text is None:
            return faults.append(f"{where}: no subcommand {words[1]}: {line}")
    known = set(re.findall(r"(?<![\w-])(--?[A-Za-z][\w-]*)", text))
    for word in words[len(program):]:
        if word in ("|", ">", "&&", "&", ";", "2>"):
            break
        if re.match(r"--?[A-Za-z]", word) and word.split("=")[0] not in known:
            faults.append(f"{where}: {' '.join(program)} has no {word.split('=')[0]}: {line}")


for page in [source / "README.md", source / "CONTRIBUTING.md", *sorted((source / "docs").rglob("*.md"))]:
    language, block, begin = None, [], 0
    text = re.sub(r"\\\n *", "", page.read_text())  # a command line that goes on
    for number, line in enumerate(text.splitlines(), 1):
        fence = re.match(r"```(\w*)$", line.strip())
        where = f"{page.relative_to(source)}:{number}"
        if fence and language is None:
            language, block, begin = fence.group(1) or "text", [], number
        elif fence:
            if language == "yaml":
                try:
                    yaml.safe_load("\n".join(block))
                    checked += 1
                except yaml.YAMLError as error:
                    faults.append(f"{page.relative_to(source)}:{begin}: no YAML: {error}")
            language = None
        elif language in ("console", "sh", "bash"):
            check(where, line)
        elif language == "yaml":
            block.append(line)
        elif language is None:
            for inline in re.findall(r"`([^`]+)`", line):
                if " -" in inline:
                    check(where, inline)
for fault in faults:
    print(fault)
print(f"{checked} snippets looked at, {len(faults)} wrong")
sys.exit(bool(faults) or checked < 50)
