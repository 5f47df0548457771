// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "fuzz/targets.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "trunnion/core/error.hpp"
#include "trunnion/error_model/flash_block.hpp"
#include "trunnion/interferometer/baseline.hpp"
#include "trunnion/io/antenna_epoch.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/export_format.hpp"
#include "trunnion/io/gnss_messages.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/log_format.hpp"
#include "trunnion/io/message_map.hpp"
#include "trunnion/io/observation_reader.hpp"
#include "trunnion/io/orbit_book.hpp"
#include "trunnion/io/run_file.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/table_moves.hpp"
#include "trunnion/io/urdf.hpp"

namespace trunnion::fuzz {
namespace {

void hold(bool law, const char* what) {
  if (law) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

/// The bytes as a file, in memory.
class File {
 public:
  File(const std::uint8_t* data, std::size_t size) : descriptor_(::memfd_create("input", MFD_CLOEXEC)) {
    hold(descriptor_ >= 0 && ::write(descriptor_, data, size) == static_cast<ssize_t>(size), "a file in memory");
    path_ = "/proc/self/fd/" + std::to_string(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { ::close(descriptor_); }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

class Finite final : public SampleSink {
 public:
  void imu(std::int64_t, const InertialSample<double>& s) override {
    hold(s.w.allFinite() && s.f.allFinite(), "a sample that is finite");
  }
  void temperature(double celsius) override { hold(!std::isinf(celsius), "a temperature that is finite or unknown"); }
  void encoder(std::int64_t, double azimuth, double pitch) override {
    hold(std::isfinite(azimuth) && std::isfinite(pitch), "angles that are finite");
  }
};

/// A refusal is an Error of the input, with words.
template <class Read>
void refused_or(const Read& read) {
  try {
    read();
  } catch (const Error& e) {
    hold(e.code() == ExitCode::kInput, "a refusal of the input");
    hold(std::strlen(e.what()) > 0, "a refusal in words");
  }
}

/// @param channel that a user may name
void log(const char* format, const char* channel, const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  for (const int way : {0, 1, 2, 3, 4}) {
    refused_or([&] {
      Finite sink;
      io::LogRequest request;
      request.path = file.path();
      request.need_imu = way != 2;
      request.need_encoder = way == 1 || way == 2;
      if (way == 4) request.channels.imu.name = channel;
      if (way == 3) request.columns = {{"t", {"", 0, "samples"}}, {"gyro_x", {"", 2, "counts"}}};
      request.channels.sheet.rate_hz = 100.0;
      io::format_by_name(format).read(request, sink);
    });
  }
}

const std::vector<io::SignalName>& signals() {
  static const std::vector<io::SignalName> all = {io::SignalName::parse("G1C"), io::SignalName::parse("G2W"),
                                                  io::SignalName::parse("E1C"), io::SignalName::parse("C2I")};
  return all;
}

}  // namespace

void csv(const std::uint8_t* data, std::size_t size) { log("csv", "", data, size); }
void mcap(const std::uint8_t* data, std::size_t size) { log("mcap", "/imu", data, size); }
void ulog(const std::uint8_t* data, std::size_t size) { log("ulog", "vehicle_imu#1", data, size); }
void lcm_log(const std::uint8_t* data, std::size_t size) { log("lcm", "X", data, size); }

/// As it is, and with the checksums that make its packets whole.
void mip(const std::uint8_t* data, std::size_t size) {
  log("mip", "", data, size);
  std::vector<std::uint8_t> whole(data, data + size);
  for (std::size_t at = 0; at + 6 <= size;) {
    const std::size_t length = 4 + std::size_t{whole[at + 3]};
    if (whole[at] != 0x75 || whole[at + 1] != 0x65 || at + length + 2 > size) {
      ++at;
      continue;
    }
    std::uint8_t a = 0;
    std::uint8_t b = 0;
    for (std::size_t i = 0; i < length; ++i) {
      a = static_cast<std::uint8_t>(a + whole[at + i]);
      b = static_cast<std::uint8_t>(b + a);
    }
    whole[at + length] = a;
    whole[at + length + 1] = b;
    at += length + 2;
  }
  log("mip", "", whole.data(), whole.size());
}

/// The first byte chooses who reads: our own types, or a preset's.
void lcm_message(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  const auto& presets = io::message_presets();
  const std::size_t which = data[0] % (presets.size() + 1);
  io::LogChannels channels;
  channels.sheet.rate_hz = 100.0;
  channels.sheet.counts.gyro.scale = 100.0;
  channels.sheet.counts.accel.scale = 100.0;
  bool is_imu = true;
  if (which < presets.size()) {
    is_imu = presets[which].is_imu;
    (is_imu ? channels.imu : channels.encoder).map = std::make_shared<const io::MessageMap>(presets[which].map);
  }
  refused_or([&] {
    Finite sink;
    io::LcmDecoder decoder("a bus", sink, channels);
    io::LcmEvent event;
    event.channel = "X";
    event.data = {reinterpret_cast<const char*>(data) + 1, size - 1};
    if (is_imu) decoder.imu(event);
    if (!is_imu || which == presets.size()) decoder.encoder(event);
    decoder.finish();
  });
}

/// Definitions, and a reader of every type that they hold.
void lcm_type(const std::uint8_t* data, std::size_t size) {
  io::LcmTypes types;
  refused_or([&] { types.add_text({reinterpret_cast<const char*>(data), size}, "types.lcm"); });
  for (const std::string& name : types.names()) {
    refused_or([&] {
      io::LcmFieldReader reader(types, name, {});
      reader.read(std::string(64, '\1'));
    });
  }
}

void run_file(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  refused_or([&] { static_cast<void>(io::read_run_file(file.path())); });
}

void calibration_file(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  refused_or([&] {
    const io::CalibrationFile calibration = io::read_calibration_file(file.path());
    static_cast<void>(io::to_yaml(calibration));
    const InertialUnit<double> unit = io::unit_of(calibration, file.path(), 0);
    for (const io::ExportFormat& format : io::export_formats()) {
      io::ExportRequest request;
      request.unit = unit;
      static_cast<void>(format.make(request));
    }
  });
}

void sensor_sheet(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  refused_or([&] { static_cast<void>(io::read_sensor_sheet(file.path())); });
}

void table_moves(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  refused_or([&] { static_cast<void>(io::read_table_moves(file.path(), 3)); });
}

void urdf(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  refused_or([&] { static_cast<void>(io::read_rig(file.path(), "azimuth", "pitch")); });
}

void rinex_observations(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  refused_or([&] {
    io::ObservationReader reader(file.path());
    static_cast<void>(reader.available());
    reader.choose(signals());
    io::ObservationEpoch epoch;
    while (reader.next(epoch)) {
      for (const io::SignalObservation& seen : epoch.at)
        hold(!std::isinf(seen.code) && !std::isinf(seen.phase), "observations that are finite or unknown");
    }
  });
}

void rinex_orbits(const std::uint8_t* data, std::size_t size) {
  const File file(data, size);
  io::OrbitBook book;
  refused_or([&] { book.add(file.path()); });
  book.each([](const BroadcastOrbit& orbit) {
    std::string message;
    io::encode_gnss_orbit(0, 0, orbit, message);
    hold(io::decode_gnss_orbit(message).has_value(), "an orbit that goes over a bus");
  });
}

void gnss_message(const std::uint8_t* data, std::size_t size) {
  const std::string_view message(reinterpret_cast<const char*>(data), size);
  static_cast<void>(io::decode_gnss_raw(message, signals()));
  static_cast<void>(io::decode_gnss_orbit(message));
  static_cast<void>(io::decode_attitude(message));
  static_cast<void>(io::decode_imu_counts(message));
}

/// As it is, and with the header and the checksum that make it whole: the checksum is against damage, not against
/// intent.
void flash_block(const std::uint8_t* data, std::size_t size) {
  FlashBlock block;
  std::memcpy(static_cast<void*>(&block), data, std::min(size, sizeof block));
  static_cast<void>(read_flash_block(&block, std::min(size, sizeof block)));
  block.magic = FlashBlock::kMagic;
  block.version = FlashBlock::kVersion;
  block.seal();
  const auto read = read_flash_block(&block, sizeof block);
  if (!read.ok()) return;
  hold(read.value()->counts.is_usable(), "coefficients that shift by what they may");
  const UnitCorrection<float> correction(read.value()->unit);
  const auto checked = correction.checked({Vec3<float>(1.0F, -2.0F, 3.0F), Vec3<float>(0.1F, 9.8F, -0.2F)});
  if (checked.ok()) hold(checked.value().w.allFinite() && checked.value().f.allFinite(), "a correction that is finite");
}

}  // namespace trunnion::fuzz
