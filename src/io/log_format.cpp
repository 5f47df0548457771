// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/log_format.hpp"

#include <algorithm>
#include <filesystem>

#include "byte_stream.hpp"
#include "log_formats.hpp"
#include "trunnion/io/lcm_log.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kHead = 4096;  // bytes of a file that its format is judged by

/// Samples as imu_t on IMU, readings as encoder_t on ENCODER.
class LcmSampleWriter final : public LogWriter {
 public:
  explicit LcmSampleWriter(const std::string& path) : path_(path), log_(path) {}
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    encode_imu(utime, samples_++, sample, message_, celsius_);
    log_.write(utime, imu_channel_, message_);
  }
  void temperature(double celsius) override { celsius_ = celsius; }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    encode_encoder(utime, readings_++, azimuth, pitch, message_);
    log_.write(utime, encoder_channel_, message_);
  }
  void commit() override { log_.commit(); }
  [[nodiscard]] std::vector<std::string> files() const override { return {path_}; }

 private:
  std::string path_;
  std::string imu_channel_ = LogChannels().imu_channel();
  std::string encoder_channel_ = LogChannels().encoder_channel();
  LcmLogWriter log_;
  std::string message_;
  std::int64_t samples_ = 0;
  std::int64_t readings_ = 0;
  double celsius_ = std::numeric_limits<double>::quiet_NaN();
};

struct Stranger {
  std::string_view begins;
  const char* what;
};

/// Files that people have and that are no log here: what to do with them.
const Stranger kStrangers[] = {
    {{"\x1f\x8b", 2}, "is compressed with gzip: expand it (gunzip -k)"},
    {{"\x28\xb5\x2f\xfd", 4}, "is compressed with zstd: expand it (unzstd)"},
    {{"\xfd"
      "7zXZ",
      5},
     "is compressed with xz: expand it (unxz -k)"},
    {{"BZh", 3}, "is compressed with bzip2: expand it (bunzip2 -k)"},
    {{"PK\x03\x04", 4}, "is a zip archive: take the file out of it; a workbook (.xlsx) is to be saved as CSV"},
    {{"#ROSBAG V", 9}, "is a bag of ROS 1: convert it (rosbags-convert --dst-storage mcap)"},
    {{"SQLite format 3", 15},
     "is a database, as ROS 2 records into by default before Iron: convert it (ros2 bag convert) to MCAP"},
    {{"\x89HDF", 4}, "is HDF5: write its samples as a table"},
    {{"PAR1", 4}, "is Parquet: write its samples as a table"},
    {{"TDSm", 4}, "is TDMS: write its samples as a table"},
    {{"\xd0\xcf\x11\xe0", 4}, "is a file of an old office program: write its samples as a table"},
    {{"<?xml", 5}, "is XML, not a recording"},
    {{"{\n", 2}, "is JSON: write its samples as a table"},
    {{"{\"", 2}, "is JSON: write its samples as a table"},
    {{"MATLAB 5.0 MAT-file", 19}, "is a MAT-file: write its samples as a table"},
    {{"\x7f"
      "ELF",
      4},
     "is a program"},
};

}  // namespace

/// The last of the list: a log that begins with damage is one still.
const LogFormat kLcmFormat = {
    "lcm",
    "LCM log",
    ".lcm",
    [](std::string_view) { return true; },
    read_lcm_recording,
    [](const std::string& path) -> std::unique_ptr<LogWriter> { return std::make_unique<LcmSampleWriter>(path); },
    nullptr,
    true};

const std::vector<LogFormat>& log_formats() {
  static const std::vector<LogFormat> kFormats = {kUlogFormat, kMcapFormat, kMipFormat, kCsvFormat, kLcmFormat};
  return kFormats;
}

const LogFormat& format_by_name(const std::string& name) {
  const std::vector<LogFormat>& formats = log_formats();
  const auto found =
      std::find_if(formats.begin(), formats.end(), [&](const LogFormat& format) { return name == format.name; });
  if (found == formats.end()) throw Error(ExitCode::kUsage, "no format '" + name + "'");
  return *found;
}

const LogFormat& format_of(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown))
    throw input_error(path, 0, "", "is a folder: name the recording in it, as a bag of ROS 2 has a .mcap");
  ByteStream file(path);
  file.have(kHead);
  const std::string_view head(file.data(), std::min(kHead, file.available()));
  for (const Stranger& stranger : kStrangers) {
    if (head.substr(0, stranger.begins.size()) == stranger.begins) throw input_error(path, 0, "", stranger.what);
  }
  const std::vector<LogFormat>& formats = log_formats();
  return *std::find_if(formats.begin(), formats.end(), [&](const LogFormat& format) { return format.matches(head); });
}

LogLosses read_log(const LogRequest& request, SampleSink& sink) { return format_of(request.path).read(request, sink); }

}  // namespace trunnion::io
