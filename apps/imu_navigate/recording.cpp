// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "../terminal.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/error_model/stream_correction.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/run_file.hpp"
#include "trunnion/positions/channel_clock.hpp"

namespace trunnion::app {
namespace {

struct Stamped {
  std::int64_t utime;
  double value;
};

std::string at(double t) { return figure(t, 13) + " s"; }

class Collector final : public SampleSink {
 public:
  Collector(std::string path, Recording& into) : path_(std::move(path)), into_(into) {}

  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    if (!accepted(clock_, utime, "IMU")) return;
    if (clock_forgets_first_) {
      samples_.clear();
      utimes_.clear();
      celsius_.clear();
    }
    utimes_.push_back(utime);
    samples_.push_back(sample);
    celsius_.push_back(told_);
  }
  void temperature(double celsius) override { told_ = celsius; }
  void encoder(std::int64_t utime, double azimuth, double) override {
    if (!accepted(axis_clock_, utime, "encoder")) return;
    if (clock_forgets_first_) angles_.clear();
    angles_.push_back({utime, azimuth});
  }
  void pulse(std::int64_t utime) { pulses_.push_back(utime); }

  std::vector<std::int64_t> utimes_;
  std::vector<InertialSample<double>> samples_;
  std::vector<double> celsius_;
  std::vector<Stamped> angles_;
  std::vector<std::int64_t> pulses_;

 private:
  bool accepted(ChannelClock& clock, std::int64_t utime, const char* channel) {
    clock_forgets_first_ = false;
    switch (clock.judge(utime)) {
      case ChannelClock::Verdict::kNext:
        return true;
      case ChannelClock::Verdict::kNextAndFirstWasStray:
        clock_forgets_first_ = true;
        ++into_.strays;
        return true;
      case ChannelClock::Verdict::kDuplicate:
        ++into_.duplicates;
        return false;
      case ChannelClock::Verdict::kStray:
        ++into_.strays;
        return false;
      case ChannelClock::Verdict::kReset:
        break;
    }
    throw io::input_error(path_, 0, channel,
                          "the stamps are more than a second apart, or the clock was set: is the unit of t right?");
  }

  std::string path_;
  Recording& into_;
  ChannelClock clock_;
  ChannelClock axis_clock_;
  bool clock_forgets_first_ = false;
  double told_ = std::nan("");
};

void read_log(const RecordingSource& source, Collector& collector, Recording& recording) {
  io::LcmLogReader log(source.log);
  io::LcmDecoder decoder(source.log, collector);
  const std::string channel = source.channel.empty() ? io::LogChannels().imu_channel() : source.channel;
  io::LcmEvent event;
  ProgressLine progress;
  const auto size = static_cast<double>(std::max<std::int64_t>(1, log.size()));
  while (log.next(event)) {
    if (event.channel == channel) decoder.imu(event);
    if (source.axis.empty() && source.needs_angle && event.channel == "ENCODER") decoder.encoder(event);
    if (source.axis.empty() && source.needs_pulses && event.channel == "INDEX")
      collector.pulse(io::decode_index(source.log, event));
    progress.show("reading " + figure(100.0 * static_cast<double>(event.byte) / size, 3) + " %");
  }
  decoder.finish();
  if (collector.samples_.empty())
    throw io::input_error(source.log, 0, "", "no usable message on the IMU channel '" + channel + "'");
  recording.damaged = log.lost_records() + decoder.damaged_records();
}

std::int64_t to_utime(const std::string& path, double t) {
  if (!(std::abs(t) < 9e12)) throw io::input_error(path, 0, "t", "is beyond any clock");
  return std::llround(1e6 * t);
}

void read_axis(const RecordingSource& source, Collector& collector) {
  std::string digest;
  if (source.needs_angle) {
    io::read_columns_csv(
        source.axis, {"t", "angle"},
        [&](const double* v) { collector.encoder(to_utime(source.axis, v[0]), v[1], 0.0); }, digest);
  } else {
    io::read_columns_csv(
        source.axis, {"t"}, [&](const double* v) { collector.pulse(to_utime(source.axis, v[0])); }, digest);
  }
}

/// Mean of the steps that are near their median.
double period_of(const std::vector<std::int64_t>& utimes, const std::string& path) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < utimes.size(); ++i)
    steps.push_back(1e-6 * static_cast<double>(ChannelClock::difference(utimes[i], utimes[i - 1])));
  if (steps.size() < 100)
    throw io::input_error(path, 0, "",
                          "has " + std::to_string(utimes.size()) + " samples with stamps of their own, 100 are needed");
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double median = *middle;
  double sum = 0.0;
  long long count = 0;
  for (const double step : steps) {
    if (std::abs(step - median) > 0.4 * median) continue;
    sum += step;
    ++count;
  }
  if (2 * count < static_cast<long long>(steps.size()))
    throw io::input_error(path, 0, "t", "the stamps come in bunches: no sample period is to be seen");
  return sum / static_cast<double>(count);
}

/// Fills holes up to the longest gap by a straight line. @throws Error (input) for a longer one
void fill(const RecordingSource& source, const Collector& collector, Recording& recording) {
  const std::int64_t origin = collector.utimes_.front();
  const auto seconds = [&](std::int64_t utime) {
    return 1e-6 * static_cast<double>(origin) + 1e-6 * static_cast<double>(ChannelClock::difference(utime, origin));
  };
  double clock = seconds(origin);  // smooth: a stamp that jitters is no hole
  for (std::size_t i = 0; i < collector.utimes_.size(); ++i) {
    const double t = seconds(collector.utimes_[i]);
    const InertialSample<double>& next = collector.samples_[i];
    if (i > 0) {
      const double step = t - recording.stamp.back();
      if (step > source.longest_gap + recording.period)
        throw io::input_error(
            source.log, 0, "t",
            "a gap of " + figure(step, 3) + " s before " + at(t) +
                ": an inertial solution does not cross it; cut there, or allow it with --longest-gap-s");
      const auto missing = static_cast<int>(std::floor((t - clock) / recording.period - 1.0 + 0.2));
      const InertialSample<double> last = recording.sample.back();
      const double before = recording.stamp.back();
      for (int k = 1; k <= missing; ++k) {
        const double share = static_cast<double>(k) / (missing + 1);
        recording.stamp.push_back(before + share * step);
        recording.sample.push_back({last.w + share * (next.w - last.w), last.f + share * (next.f - last.f)});
        recording.celsius.push_back(collector.celsius_[i]);
        ++recording.filled;
      }
      clock += recording.period * (1 + std::max(0, missing));
      clock += 0.05 * (t - clock);
    }
    recording.stamp.push_back(t);
    recording.sample.push_back(next);
    recording.celsius.push_back(collector.celsius_[i]);
  }
  const double elapsed = recording.stamp.back() - recording.stamp.front();
  const double counted = recording.period * static_cast<double>(recording.stamp.size() - 1);
  if (std::abs(counted - elapsed) > 1e-3 * elapsed)
    recording.warnings.push_back("samples of " + figure(1e3 * recording.period, 5) + " ms make " + figure(counted, 6) +
                                 " s of the " + figure(elapsed, 6) + " s between first and last: uneven sampling");
  for (const std::int64_t utime : collector.pulses_) recording.pulse.push_back(seconds(utime));
  std::sort(recording.pulse.begin(), recording.pulse.end());
}

/// The angle at every stamp: unwrapped, then along a straight line between readings.
void interpolate_angle(const std::string& path, const Collector& collector, Recording& recording) {
  std::vector<double> t;
  std::vector<double> angle;
  const std::int64_t origin = collector.utimes_.front();
  for (const Stamped& reading : collector.angles_) {
    t.push_back(recording.stamp.front() + 1e-6 * static_cast<double>(ChannelClock::difference(reading.utime, origin)));
    const double last = angle.empty() ? reading.value : angle.back();
    angle.push_back(last + std::remainder(reading.value - last, 2.0 * kPi));
  }
  if (t.size() < 2 || t.front() > recording.stamp[1] || t.back() < recording.stamp.back() - 0.1)
    throw io::input_error(path, 0, "", "the encoder does not cover the recording");
  std::size_t k = 0;
  std::size_t i = 0;
  for (const double stamp : recording.stamp) {
    const double rate = std::abs(recording.sample[i++].w.z());
    while (k + 2 < t.size() && t[k + 1] < stamp) ++k;
    const double step = t[k + 1] - t[k];
    if (step > 0.1)
      throw io::input_error(path, 0, "t",
                            "no encoder reading for " + figure(step, 3) + " s after " + at(t[k]) +
                                ": an encoder is read at least ten times a second");
    if (rate * step > 2.5)
      throw io::input_error(path, 0, "t",
                            "the axis turns by " + figure(rate * step / kRadPerDeg, 3) +
                                " deg between two encoder readings after " + at(t[k]) +
                                ": which way is not to be told");
    recording.angle.push_back(angle[k] + (angle[k + 1] - angle[k]) * (stamp - t[k]) / step);
  }
}

/// Increments given as rates, or the other way round: gravity tells.
void judge_magnitude(const RecordingSource& source, Recording& recording) {
  double sum = 0.0;
  for (const InertialSample<double>& s : recording.sample) sum += s.f.norm();
  const double force = sum / static_cast<double>(recording.sample.size());
  if (force > 3.0 && force < 40.0) return;
  const bool other_way = source.increments ? force * recording.period > 3.0 && force * recording.period < 40.0
                                           : force / recording.period > 3.0 && force / recording.period < 40.0;
  recording.warnings.push_back("the mean specific force is " + figure(force, 3) + " m/s^2: " +
                               (other_way ? source.increments ? "these look like rates; leave --increments out"
                                                              : "these look like increments; say --increments"
                                          : "no gravity, or another unit"));
}

}  // namespace

Recording read_recording(const RecordingSource& source) {
  Recording recording;
  Collector collector(source.log, recording);
  if (io::is_run_file(source.log))
    throw Error(ExitCode::kUsage,
                source.log + ": is a run file: imu_calibrate convert makes a log of a recording of it");
  if (io::format_of(source.log).by_channel) {
    read_log(source, collector, recording);
  } else {
    io::LogRequest request;
    request.path = source.log;
    request.channels.imu.name = source.channel;
    request.need_encoder = source.axis.empty() && source.needs_angle;
    recording.damaged = io::read_log(request, collector).records;
  }
  if (!source.axis.empty()) read_axis(source, collector);
  recording.period = period_of(collector.utimes_, source.log);
  fill(source, collector, recording);
  if (source.increments) {
    for (InertialSample<double>& s : recording.sample) s = {s.w / recording.period, s.f / recording.period};
  }
  judge_magnitude(source, recording);
  const std::string axis = source.axis.empty() ? source.log : source.axis;
  if (source.needs_angle) interpolate_angle(axis, collector, recording);
  if (source.needs_pulses && recording.pulse.size() < 2)
    throw io::input_error(axis, 0, "", "fewer than two index pulses");
  if (!source.calibration.empty()) {
    const InertialUnit<double> unit = io::read_calibration_file(source.calibration).record.value.unit;
    if (unit.thermal.order() > 0 && std::none_of(recording.celsius.begin(), recording.celsius.end(),
                                                 [](double celsius) { return std::isfinite(celsius); }))
      recording.warnings.push_back(source.calibration +
                                   " has terms of temperature, and the recording states none: at " +
                                   figure(unit.thermal.reference, 4) + " degC");
    StreamCorrection<double> correction(unit);
    for (std::size_t i = 0; i < recording.sample.size(); ++i) {
      correction.set_temperature(recording.celsius[i]);
      recording.sample[i] = correction.correct(recording.stamp[i], recording.sample[i]);
    }
  }
  return recording;
}

}  // namespace trunnion::app
