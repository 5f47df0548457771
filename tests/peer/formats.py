# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
"""formats.py <imu_calibrate> <rosbags-convert> <sample.ulg> <folder>: what formats_test runs."""

import csv
import os
import struct
import subprocess
import sys

import numpy
from mcap.data_stream import ReadDataStream
from mcap.reader import make_reader
from mcap.records import Chunk, MessageIndex
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import CompressionType
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer
from pyulog import ULog
from rosbags.rosbag1 import Writer as Bag1
from rosbags.typesys import Stores, get_typestore

command, rosbags_convert, ulog, folder = sys.argv[1:5]
os.chdir(folder)

HEADER = """std_msgs/Header header
{}================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
IMU = HEADER.format(
    """geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
"""
) + """================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
JOINTS = HEADER.format("string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n")
N = 3000
random = numpy.random.default_rng(7)
stamps = 1_700_000_000_000_000 + 2500 * numpy.arange(N)
values = random.normal(size=(N, 6))
angles = random.normal(size=(N, 2))


def run(*arguments):
    done = subprocess.run([command, *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(arguments)}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def table(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], numpy.array([[float(cell) for cell in row[:7]] for row in rows[1:]])


def hold(what, same):
    if not same:
        sys.exit(f"FAILED: {what}")
    print(f"{what}: the same")


def vector(v):
    return {"x": v[0], "y": v[1], "z": v[2]}


def stamp(utime):
    return {"sec": int(utime // 1_000_000), "nanosec": int(1000 * (utime % 1_000_000))}


# their MCAP, in every compression: the same stamps and bits
for compression in (CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD):
    with open("theirs.mcap", "wb") as file:
        writer = Writer(file, compression=compression, chunk_size=50_000)
        imu = writer.register_msgdef("sensor_msgs/msg/Imu", IMU)
        joints = writer.register_msgdef("sensor_msgs/msg/JointState", JOINTS)
        for k in range(N):
            ns = int(stamps[k]) * 1000
            writer.write_message(
                "/imu/data", imu,
                {"header": {"stamp": stamp(stamps[k]), "frame_id": "imu_link"},
                 "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
                 "orientation_covariance": [-1.0] + 8 * [0.0],
                 "angular_velocity": vector(values[k, :3]), "angular_velocity_covariance": 9 * [0.0],
                 "linear_acceleration": vector(values[k, 3:]), "linear_acceleration_covariance": 9 * [0.0]},
                log_time=ns, publish_time=ns)
            writer.write_message(
                "/joint_states", joints,
                {"header": {"stamp": stamp(stamps[k]), "frame_id": ""}, "name": ["pitch", "azimuth"],
                 "position": [angles[k, 1], angles[k, 0]], "velocity": [], "effort": []},
                log_time=ns, publish_time=ns)
        writer.finish()
    run("convert", "theirs.mcap", "-o", "theirs.csv")
    ours = table("theirs.csv")[1]
    hold(f"MCAP of mcap-ros2-support, {compression.name}",
         ours.shape == (N, 7) and (numpy.rint(1e6 * ours[:, 0]) == stamps).all() and (ours[:, 1:] == values).all())
    encoder = numpy.genfromtxt("theirs_encoder.csv", delimiter=",", skip_header=1)
    hold("its joints", (encoder[:, 1:] == angles).all())

# our MCAP, read by theirs
run("convert", "theirs.mcap", "-o", "ours.mcap")
with open("ours.mcap", "rb") as file:
    messages = {"/imu/data": [], "/joint_states": []}
    for _, channel, message, decoded in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
        messages[channel.topic].append((message.log_time, decoded))
read = numpy.array([[m.angular_velocity.x, m.angular_velocity.y, m.angular_velocity.z, m.linear_acceleration.x,
                     m.linear_acceleration.y, m.linear_acceleration.z] for _, m in messages["/imu/data"]])
hold("our MCAP in mcap-ros2-support",
     (read == values).all() and [t for t, _ in messages["/imu/data"]] == [1000 * int(s) for s in stamps])
with open("ours.mcap", "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    summary = reader.get_summary()
    hold("its summary", summary is not None and summary.statistics.message_count == 2 * N
         and summary.statistics.message_start_time == 1000 * int(stamps[0])
         and summary.statistics.message_end_time == 1000 * int(stamps[-1])
         and {c.topic: summary.statistics.channel_message_counts[i] for i, c in summary.channels.items()}
         == {"/imu/data": N, "/joint_states": N}
         and len(summary.chunk_indexes) == summary.statistics.chunk_count > 1)
    some = [m.log_time for _, _, m in reader.iter_messages(topics=["/imu/data"], starting_at=1000 * int(stamps[1000]),
                                                          ending_before=1000 * int(stamps[1010]))]
    hold("ten samples by its index", some == [1000 * int(s) for s in stamps[1000:1010]])
    found = {}  # of each message, through the indices: its stamp there, and its own
    for chunk_index in summary.chunk_indexes:
        file.seek(chunk_index.chunk_start_offset + 9)
        chunk = get_chunk_data_stream(Chunk.read(ReadDataStream(file)))[0].read(chunk_index.uncompressed_size)
        hold_here = file.tell() == chunk_index.chunk_start_offset + chunk_index.chunk_length
        for channel, offset in chunk_index.message_index_offsets.items():
            file.seek(offset + 9)
            for stamped, place in MessageIndex.read(ReadDataStream(file)).records:
                owner, _, log_time = struct.unpack_from("<HIQ", chunk, place + 9)
                hold_here = hold_here and owner == channel and log_time == stamped
                found[channel] = found.get(channel, 0) + 1
        hold_here or sys.exit("FAILED: an index of our MCAP")
    hold("all through its indices", sorted(found.values()) == [N, N])
hold("its joints", all(list(m.name) == ["azimuth", "pitch"] and (numpy.array(m.position) == a).all()
                       for (_, m), a in zip(messages["/joint_states"], angles)))

# a bag of ROS 1, by the conversion that the how-to names
store = get_typestore(Stores.ROS1_NOETIC)
types = store.types
with Bag1("ros1.bag") as bag:
    connection = bag.add_connection("/imu/data", "sensor_msgs/msg/Imu", typestore=store)
    Vector3 = types["geometry_msgs/msg/Vector3"]
    zeros = numpy.zeros(9)
    for k in range(N):
        header = types["std_msgs/msg/Header"](k, types["builtin_interfaces/msg/Time"](**stamp(stamps[k])), "imu")
        message = types["sensor_msgs/msg/Imu"](
            header, types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0), zeros, Vector3(*values[k, :3]), zeros,
            Vector3(*values[k, 3:]), zeros)
        bag.write(connection, int(stamps[k]) * 1000, store.serialize_ros1(message, "sensor_msgs/msg/Imu"))
subprocess.run([rosbags_convert, "--src", "ros1.bag", "--dst", "ros2", "--dst-storage", "mcap"], check=True)
run("convert", "ros2/ros2.mcap", "-o", "ros1.csv")
ours = table("ros1.csv")[1]
hold("a bag of ROS 1 by rosbags-convert", (numpy.rint(1e6 * ours[:, 0]) == stamps).all() and (ours[:, 1:] == values).all())

# a real ULog
if os.path.exists(ulog):
    run("convert", ulog, "-o", "ulog.csv")
    ours = table("ulog.csv")[1]
    theirs = ULog(ulog, ["sensor_combined"]).data_list[0].data
    columns = [theirs[f"{name}[{i}]"] for name in ("gyro_rad", "accelerometer_m_s2") for i in range(3)]
    hold(f"a real ULog in pyulog, {len(ours)} samples",
         (numpy.rint(1e6 * ours[:, 0]) == theirs["timestamp"]).all()
         and all((ours[:, 1 + i].astype(numpy.float32) == column).all() for i, column in enumerate(columns)))
else:
    print(f"no real recordings: {ulog} is absent")
