# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
"""faults.py <folder of the commands> <shim> <kills> [live]: every write, sync, rename and read of solve, apply, convert and export
fails once, sixty of a kind where there are more; everything dribbles; and the commands are killed at random moments. An output is there whole, as without the
fault, or it is not there; of a pair of tables there are never halves of two recordings. With live (in a network of its own, see tests/apps/isolated): imu_live finds the disk
full, and is killed while it records, and what was in its journal once is in its recording in the end."""

import os
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time

bin_folder, shim, kills = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3])
live = len(sys.argv) > 4
random.seed(20261127)
failures = []
QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def command(name, *arguments):
    return [os.path.join(bin_folder, name), *arguments]


def run(arguments, fault="", **more):
    environment = {**os.environ, "LD_PRELOAD": shim, "TRUNNION_FAULT": fault, **more} if fault else os.environ
    return subprocess.run(arguments, env=environment, capture_output=True, text=True, errors="replace", timeout=300)


def hold(law, what):
    if not law:
        failures.append(what)
        print(f"FAILED: {what}")


def content(path):
    with open(path, "rb") as file:
        return file.read()


def left_over(folder):
    return [name for name in os.listdir(folder) if ".part" in name]


def every_call_fails(name, arguments, output, reference):
    """The N-th call of each kind fails, for every N that there is."""
    struck = 0
    for kind in ("open", "write", "fsync", "rename", "read"):
        done = run(arguments, f"{kind} 0", TRUNNION_CALLS="calls")
        os.remove(output)
        calls = int(content("calls"))
        hold(calls > 0, f"{name}: no {kind} to fail")
        numbers = range(1, calls + 1) if calls <= 60 else sorted(random.sample(range(1, calls + 1), 60))
        for number in numbers:
            done = run(arguments, f"{kind} {number}")
            struck += 1
            at = f"{name}, {kind} {number} of {calls}"
            if done.returncode == 0:  # what it could do without: a page of help, a list of processors
                hold(content(output) == reference, f"{at}: ended well, and the output is another")
                os.remove(output)
                continue
            hold(done.returncode == 3, f"{at}: exit {done.returncode}: {done.stderr[-200:]}")
            hold(done.stderr.strip() != "", f"{at}: no word")
            hold(not os.path.exists(output), f"{at}: an output of {os.path.exists(output) and os.path.getsize(output)} bytes")
            hold(not left_over("."), f"{at}: {left_over('.')} is left")
            for path in [output, *left_over(".")]:
                if os.path.exists(path):
                    os.remove(path)
    for seed in range(3):
        done = run(arguments, f"dribble {seed}")
        hold(done.returncode == 0 and content(output) == reference, f"{name}, dribbling: exit {done.returncode} {done.stderr[-200:]}")
    print(f"[ FIGURE   ] {name}: {struck} calls failed, one at a time; no output half-written")


def killed(name, arguments, output, reference, times):
    begin = time.perf_counter()
    subprocess.run(arguments, capture_output=True, check=True)
    duration = time.perf_counter() - begin
    whole = 0
    for turn in range(times):
        if os.path.exists(output):
            os.remove(output)
        if turn % 2 == 1:  # one of before, that stays until the new one is whole
            with open(output, "wb") as file:
                file.write(b"of before")
        process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(random.uniform(0.0, 1.1 * duration))
        process.kill()
        process.wait()
        hold(turn % 2 == 0 or os.path.exists(output), f"{name}, killed: the output of before is gone")
        if os.path.exists(output) and content(output) != b"of before":
            whole += 1
            hold(content(output) == reference, f"{name}, killed: the output is not whole")
        for path in left_over("."):
            os.remove(path)
    print(f"[ FIGURE   ] {name}: killed {times} times at random moments of {duration:.2f} s, {whole} times too late; no output half-written")


def pairs(arguments, outputs, times):
    """Of two files that belong together there are never halves of two recordings."""
    begin = time.perf_counter()
    subprocess.run(arguments, capture_output=True, check=True)
    duration = time.perf_counter() - begin
    reference = {path: content(path) for path in outputs}

    def hold_pair(at):
        there = {path: content(path) for path in outputs if os.path.exists(path)}
        of_before = [path for path in there if there[path] == b"of before"]
        hold(all(path in of_before or there[path] == reference[path] for path in there), f"{at}: a table is not whole")
        hold(len(of_before) in (0, len(there)), f"{at}: tables of two recordings")
        for path in left_over("."):
            os.remove(path)

    def put_before():
        for path in outputs:
            with open(path, "wb") as file:
                file.write(b"of before")

    struck = 0
    for kind in ("open", "write", "fsync", "rename"):
        put_before()
        run(arguments, f"{kind} 0", TRUNNION_CALLS="calls")
        calls = int(content("calls"))
        hold(calls > 0, f"pair: no {kind} to fail")
        numbers = range(1, calls + 1) if calls <= 60 else sorted(random.sample(range(1, calls + 1), 60))
        struck += len(numbers)
        for number in numbers:
            put_before()
            done = run(arguments, f"{kind} {number}")
            at = f"pair, {kind} {number}"
            hold(done.returncode in (0, 3) and not left_over("."), f"{at}: exit {done.returncode}, {left_over('.')} is left")
            hold_pair(at)
            if done.returncode == 0:  # what it could do without
                hold(all(content(path) == reference[path] for path in outputs), f"{at}: ended well, and a table is another")
            else:
                hold(done.stderr.strip() != "", f"{at}: no word")
    for turn in range(times):
        put_before()
        process = subprocess.Popen(arguments, **QUIET)
        time.sleep(random.uniform(0.7 if turn % 2 else 0.0, 1.1) * duration)  # the renames are at its end
        process.kill()
        process.wait()
        hold_pair("pair, killed")
    print(f"[ FIGURE   ] pair of tables: killed {times} times, {struck} calls failed, one at a time; never of two recordings")


def records(data):
    """Length of the whole records that an LCM log begins with, and their number."""
    at = count = 0
    while at + 28 <= len(data):
        sync, _, _, channel, size = struct.unpack_from(">IqqII", data, at)
        if sync != 0xEDA1DA01 or at + 28 + channel + size > len(data):
            break
        at += 28 + channel + size
        count += 1
    return at, count


def live_folder(name):
    os.mkdir(name)
    for file in ("run.yaml", "rig.urdf", "sheet.yaml"):
        with open(f"{name}/{file}", "wb") as out:
            out.write(content(f"table/{file}"))


def full_live(times):
    """The disk is full from a write on, whichever it is: the calibration goes on, it is said that nothing more is recorded, what was
    recorded before stays, and no recording is there that is not whole."""
    live_folder("full")
    log = "full/position_1.lcm"
    listen = command("imu_live", "full/run.yaml", "--unattended", "--silence-s", "30", "--port", "0", "-o", "full/calibration.yaml")
    kept, begin = b"", 0
    for number in range(1, times + 1):
        environment = {**os.environ, "LD_PRELOAD": shim, "TRUNNION_FAULT": f"full {number}"}
        session = subprocess.Popen(listen, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(1.0)
        end = begin + 20 + 10 * number
        play = command("imu_replay", "table/position_1.lcm", "--speed", "10", "--start", str(begin), "--end", str(end))
        begin = end
        subprocess.run(play, **QUIET)
        session.send_signal(signal.SIGINT)
        _, words = session.communicate(timeout=60)
        at = f"imu_live, disk full from write {number}"
        hold(session.returncode == 130 and "No space left" in words, f"{at}: exit {session.returncode}: {words[-200:]}")
        data = content(log + ".part")
        whole = data[: records(data)[0]]
        hold(whole.startswith(kept), f"{at}: what had been recorded is lost")
        hold(not os.path.exists(log) and not os.path.exists("full/calibration.yaml"), f"{at}: an output is there")
        kept = whole
    hold(records(kept)[1] > 0, "imu_live, full disks: nothing was recorded before any")
    print(f"[ FIGURE   ] imu_live: a disk full at each of its first {times} writes; {records(kept)[1]} records before stay, nothing half-written", flush=True)


def killed_live(times):
    """Recording goes on over many deaths; what was in the journal at one of them is in the recording."""
    live_folder("live")
    deaths = mount = 0
    while deaths < times and mount < 3:
        mount += 1
        before = b""
        log = f"live/position_{mount}.lcm"
        session = subprocess.Popen(command("imu_live", "live/run.yaml", "--unattended", "--silence-s", "3", "--port", "0"), **QUIET)
        time.sleep(1.0)
        replay = subprocess.Popen(command("imu_replay", f"table/position_{mount}.lcm", "--speed", "20", "--end", "650"), **QUIET)
        while deaths < times and replay.poll() is None:
            time.sleep(random.uniform(0.05, 0.8))
            session.kill()
            session.wait()
            deaths += 1
            data = content(log + ".part") if os.path.exists(log + ".part") else b""
            length, _ = records(data)
            hold(data[:length].startswith(before), f"mount {mount}: what had been recorded is lost after {deaths} deaths")
            before = data[:length]
            session = subprocess.Popen(command("imu_live", "live/run.yaml", "--unattended", "--silence-s", "3", "--port", "0"), **QUIET)
        replay.kill()
        replay.wait()
        # the rest of it, then silence: the mount is recorded
        subprocess.run(command("imu_replay", f"table/position_{mount}.lcm", "--speed", "20", "--start", "651"), **QUIET)
        for _ in range(40):
            if os.path.exists(log):
                break
            time.sleep(0.5)
        session.send_signal(signal.SIGINT)
        session.wait()
        hold(os.path.exists(log) and content(log).startswith(before), f"mount {mount}: the recording is not what was recorded")
        hold(records(before)[1] > 0, f"mount {mount}: nothing was recorded")
        print(f"mount {mount}: {records(before)[1]} records outlived {deaths} deaths", flush=True)
    print(f"[ FIGURE   ] imu_live: killed {deaths} times while it recorded; no record that was in its journal is lost")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    subprocess.run(command("imu_calibrate", "simulate", "--seed", "7", "-o", "table"), capture_output=True, check=True)
    if live:
        full_live(8)
        killed_live(kills)
    else:
        subprocess.run(command("imu_calibrate", "solve", "table/run.yaml", "-o", "calibration.yaml"), capture_output=True, check=True)
        subprocess.run(command("imu_calibrate", "simulate", "--rest-only", "-o", "rest"), capture_output=True, check=True)
        jobs = [
            ("solve", command("imu_calibrate", "solve", "table/run.yaml", "-o", "solved.yaml"), "solved.yaml", 0.2),
            ("apply", command("imu_calibrate", "apply", "calibration.yaml", "table/position_1.lcm", "-o", "applied.lcm"), "applied.lcm", 0.4),
            ("convert", command("imu_calibrate", "convert", "table/position_1.lcm", "-o", "converted.mcap"), "converted.mcap", 0.3),
            ("export", command("imu_calibrate", "export", "calibration.yaml", "--format", "kalibr", "-o", "exported.yaml"), "exported.yaml", 0.1),
        ]
        for name, arguments, output, share in jobs:
            subprocess.run(arguments, capture_output=True, check=True)
            reference = content(output)
            every_call_fails(name, arguments, output, reference)
            if kills > 0:
                killed(name, arguments, output, reference, round(kills * share))
        tables = command("imu_calibrate", "convert", "table/position_1.lcm", "-o", "pair.csv")
        pairs(tables, ["pair.csv", "pair_encoder.csv"], round(kills * 0.1))
print(f"{len(failures)} failures")
sys.exit(bool(failures))
