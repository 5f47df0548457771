# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
"""format_peers.py <format_reader> <imu_calibrate> <recordings>: each reader beside its peer in Python, side by side on
the same file, best of several times: pyulog, mcap with mcap-ros2-support, and, where there is no package, plain Python
(MIP, tables). Run it with the peers' python: build/peer/bin/python3."""

import csv
import os
import struct
import subprocess
import sys
import tempfile
import time

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from pyulog import ULog

reader, command, recordings = (os.path.abspath(path) for path in sys.argv[1:4])


def best(function, repeats=9):
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        count = function()
        times.append(time.process_time() - begin)
    return min(times), count


def of_ulog(path):
    return len(ULog(path, ["sensor_combined"]).data_list[0].data["timestamp"])


def of_mcap(path):
    with open(path, "rb") as file:
        return sum(1 for _ in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages())


def of_table(path):
    with open(path, newline="") as file:
        rows = csv.reader(file)
        next(rows)
        return len([[float(cell or "nan") for cell in row] for row in rows])


def of_mip(path):
    """Checksums, and the fields of sensor data: what any reader must do."""
    data = open(path, "rb").read()
    at = count = 0
    while at + 6 <= len(data):
        end = at + 4 + data[at + 3]
        if data[at : at + 2] != b"ue":
            at += 1
            continue
        a = b = 0
        for byte in data[at:end]:
            a = (a + byte) & 255
            b = (b + a) & 255
        if data[end : end + 2] != bytes((a, b)):
            at += 1
            continue
        if data[at + 2] == 0x80:
            field = at + 4
            got = {}
            while field < end:
                got[data[field + 1]] = data[field + 2 : field + data[field]]
                field += data[field]
            if 4 in got and 5 in got:
                struct.unpack(">3f3fQ", got[4] + got[5] + got[0xD5])
                count += 1
        at = end + 2
    return count


with tempfile.TemporaryDirectory() as folder:
    ulog = f"{recordings}/formats/px4_ulog/sample.ulg"
    mip = f"{recordings}/formats/mip/mip_data.bin"
    mcap = f"{folder}/sample.mcap"
    table = f"{folder}/sample.csv"
    subprocess.run([command, "convert", ulog, "-o", mcap], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([command, "convert", ulog, "-o", table], check=True, stdout=subprocess.DEVNULL)
    lines = subprocess.run([reader, ulog, mcap, table, mip], check=True, capture_output=True, text=True).stdout
    for line, peer, name in zip(lines.splitlines(), (of_ulog, of_mcap, of_table, of_mip),
                                ("ULog, pyulog", "MCAP, mcap-ros2-support", "table, Python's csv", "MIP, plain Python")):
        path, seconds, samples = line.rsplit(" ", 2)
        theirs, count = best(lambda: peer(path))
        if count != int(samples):
            sys.exit(f"{name}: {count} samples, ours {samples}")
        size = os.path.getsize(path)
        print(f"[ FIGURE   ] {name}: {samples} samples, {1e-6 * size / float(seconds):.0f} MB/s, "
              f"{theirs / float(seconds):.0f} x the peer")
