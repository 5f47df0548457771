// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "corrector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../terminal.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/error_model/flash_block.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

constexpr double kNear = 0.3;              // of one: no unit's scale errs by as much
constexpr double kTolerableDamage = 1e-3;  // messages that are left out, against samples

bool is_block(const std::string& path) { return path.size() > 4 && path.compare(path.size() - 4, 4, ".bin") == 0; }

InertialSample<double> wide(const InertialSample<float>& s) { return {s.w.cast<double>(), s.f.cast<double>()}; }
InertialSample<float> narrow(const InertialSample<double>& s) { return {s.w.cast<float>(), s.f.cast<float>()}; }

}  // namespace

void check_counts(const io::SensorSheet& sheet, const std::string& path, int bits) {
  const double full_scale = std::ldexp(1.0, bits - 1);
  const auto hold = [&](const char* key, const NominalScale<double>& counts, double range, double most) {
    const double reach = full_scale / std::abs(counts.scale);
    if (reach > most) {
      throw io::input_error(path, 0, key,
                            "of " + figure(counts.scale, 6) + " makes " + std::to_string(bits) + " bits reach to " +
                                figure(reach, 3) + ": no raw counts; a sheet of a unit that reads in SI has none");
    }
    const double counted = range * std::abs(counts.scale) + std::abs(counts.zero);
    if (counted > 1.001 * full_scale || std::abs(counts.zero) >= full_scale) {
      throw io::input_error(path, 0, key,
                            "and the range make " + figure(counted, 6) + " counts, with the zero: more than --bits " +
                                std::to_string(bits) + " hold (an unsigned register needs one bit more)");
    }
  };
  hold("scale_counts_per_rad_s", sheet.counts.gyro, sheet.gyro_range, 1000.0);
  hold("scale_counts_per_m_s2", sheet.counts.accel, sheet.accel_range, 1e5);
}

bool can_be_undone(const InertialUnit<double>& unit, const InertialSample<double>& corrected) {
  return unit.gyro.converges_at(corrected.w) && unit.accel.converges_at(corrected.f);
}

Corrector::Corrector(const CorrectorOptions& options) {
  UnitScale<double> scale;
  if (!options.sheet.empty()) {
    const io::SensorSheet sheet = io::read_sensor_sheet(options.sheet);
    scale = sheet.counts;
    if (!options.in_floating_point) {
      check_counts(sheet, options.sheet, options.bits);
    } else if (scale.gyro.scale == 1.0 || scale.accel.scale == 1.0) {
      throw io::input_error(options.sheet, 0, "scale_counts_per_rad_s, scale_counts_per_m_s2",
                            "are not stated: what is a raw count?");
    }
  }
  int fraction = options.fraction;
  if (is_block(options.calibration)) {
    read_block(options, scale);
    if (integers_) fraction = integers_->shift - 2;
  } else {
    unit_ = io::unit_of(io::read_calibration_file(options.calibration), options.calibration, options.recording);
    thermal_ = unit_.thermal.order() > 0;
    si_.emplace(unit_);
    if (!options.sheet.empty() && options.in_floating_point) {
      counts_.emplace(unit_, scale);
    } else if (!options.sheet.empty()) {
      const auto made = count_calibration(unit_, scale, options.bits, options.fraction);
      if (!made.ok()) {
        throw io::input_error(
            options.calibration, 0, "",
            "does not fit the integers of " + std::to_string(options.bits) +
                " bits (imu_calibrate export says why): --float corrects raw counts in floating point");
      }
      integers_ = std::make_unique<CountCoefficients>(made.value().coefficients);
    }
  }
  gyro_out_ = 1.0 / (scale.gyro.scale * std::ldexp(1.0, fraction));
  accel_out_ = 1.0 / (scale.accel.scale * std::ldexp(1.0, fraction));
}

void Corrector::read_block(const CorrectorOptions& options, const UnitScale<double>& scale) {
  const std::string bytes = io::read_whole(options.calibration, sizeof(FlashBlock));
  alignas(8) unsigned char memory[sizeof(FlashBlock)] = {};
  std::copy_n(bytes.begin(), std::min(bytes.size(), sizeof memory), memory);
  const auto read = read_flash_block(memory, bytes.size());
  if (!read.ok()) throw io::input_error(options.calibration, 0, "", "is no whole block of this version");
  const FlashBlock& block = *read.value();
  if (options.recording > 0)
    throw Error(ExitCode::kUsage, options.calibration + ": a block has one turn-on bias: leave --recording out");
  if (block.has_counts == 0) {
    if (!options.sheet.empty())
      throw Error(ExitCode::kUsage, options.calibration + ": is a block for readings in SI: leave --sheet out");
    si_float_.emplace(block.unit);
    return;
  }
  if (options.sheet.empty())
    throw io::input_error(options.calibration, 0, "", "is for raw counts: --sheet says what one is");
  // the scale is folded into the block: it is near that of the sheet it was made with
  const auto near = [](float folded, double counts) {
    return std::abs(static_cast<double>(folded) * counts - 1.0) < kNear;
  };
  if (!near(block.unit.gyro.A.x.x, scale.gyro.scale) || !near(block.unit.accel.A.x.x, scale.accel.scale))
    throw io::input_error(options.sheet, 0, "",
                          "is not the sheet that " + options.calibration + " was made with: its counts are others");
  if (block.has_counts == 1 && !options.in_floating_point) {
    integers_ = std::make_unique<CountCoefficients>(block.counts);
  } else {
    counts_float_.emplace(block.unit);
  }
}

bool Corrector::undoes(const InertialSample<double>& corrected) const { return can_be_undone(unit_, corrected); }

const char* Corrector::path() const { return integers_ ? "integers" : counts_ || si_ ? "double" : "float"; }

InertialSample<double> Corrector::correct(std::int64_t utime, const InertialSample<double>& reading,
                                          double temperature) {
  take_temperature(temperature);
  if (si_) {
    si_->set_temperature(celsius_);
    return si_->correct(1e-6 * static_cast<double>(utime), reading);
  }
  return wide(std::isfinite(celsius_) ? si_float_->correct(narrow(reading), static_cast<float>(celsius_))
                                      : si_float_->correct(narrow(reading)));
}

InertialSample<double> Corrector::correct(const io::ImuCounts& raw) {
  take_temperature(raw.celsius());
  const bool warm = std::isfinite(celsius_);
  if (integers_) {
    CountCorrection correction(*integers_);
    if (warm) correction.set_temperature(static_cast<std::int32_t>(std::lround(256.0 * celsius_)));
    const UnitOutput<std::int32_t> out = correction.correct_saturated(raw.counts);
    return {Vec3<double>(out[0], out[1], out[2]) * gyro_out_, Vec3<double>(out[3], out[4], out[5]) * accel_out_};
  }
  const auto& y = raw.counts;
  const InertialSample<double> reading{Vec3<double>(y[0], y[1], y[2]), Vec3<double>(y[3], y[4], y[5])};
  if (counts_) {
    counts_->set_temperature(celsius_);
    return counts_->correct(1e-6 * static_cast<double>(raw.utime), reading);
  }
  return wide(warm ? counts_float_->correct(narrow(reading), static_cast<float>(celsius_))
                   : counts_float_->correct(narrow(reading)));
}

void Corrector::take_temperature(double celsius) {
  if (std::isfinite(celsius))
    celsius_ = celsius;
  else if (thermal_)
    ++without_temperature_;
}

CorrectedMessages::CorrectedMessages(const std::string& source, const io::LogChannels& channels)
    : decoder_(source, taken_, channels), mapped_(channels.imu.map != nullptr) {}

const std::string* CorrectedMessages::left_out(const io::LcmEvent& event, const std::string& why) {
  why_ = why;
  if (first_fault_.empty()) first_fault_ = why;
  ++damaged_;
  damaged_bytes_ += static_cast<long long>(event.data.size());
  return nullptr;
}

void CorrectedMessages::finish() const {
  if (static_cast<double>(damaged_) > kTolerableDamage * static_cast<double>(samples_))
    throw Error(ExitCode::kInput, first_fault_);
}

const std::string* CorrectedMessages::correct(const io::LcmEvent& event, Corrector& corrector) {
  why_.clear();
  if (!mapped_) {
    if (const auto raw = io::decode_imu_counts(event.data)) {
      if (!corrector.takes_counts()) {
        return left_out(event, "raw counts, and no sheet says what one is");
      }
      const InertialSample<double> corrected = corrector.correct(*raw);
      if (!corrector.undoes(corrected)) return left_out(event, kNotUndone);
      sequence_.add(raw->sequence);
      ++samples_;
      io::encode_imu(raw->utime, raw->sequence, corrected, message_, raw->celsius());
      return &message_;
    }
  }
  taken_.stamps.clear();
  taken_.values.clear();
  const long long damaged = decoder_.damaged_records();
  try {
    decoder_.imu(event);
  } catch (const Error& e) {
    taken_.values.clear();
    why_ = e.what();
  }
  if (decoder_.damaged_records() > damaged) {
    why_ = decoder_.first_fault();
    taken_.values.clear();
  }
  if (!taken_.values.empty() && !corrector.takes_si()) why_ = "readings in SI, and the block is for raw counts";
  if (!why_.empty()) return left_out(event, why_);
  if (taken_.values.empty()) return nullptr;
  for (std::size_t k = 0; k < taken_.values.size(); ++k) {
    taken_.values[k] = corrector.correct(taken_.stamps[k], taken_.values[k], taken_.celsius);
    if (!corrector.undoes(taken_.values[k])) return left_out(event, kNotUndone);
  }
  const long long first = samples_;
  samples_ += static_cast<long long>(taken_.values.size());
  if (!mapped_) {
    sequence_ = decoder_.imu_sequence();
    message_.assign(event.data);  // stamps, sequence and temperature stay
    if (!io::replace_samples(taken_.values, message_))
      return left_out(event, "is no message that can be written again");
  } else if (taken_.values.size() == 1) {
    io::encode_imu(taken_.stamps.front(), first, taken_.values.front(), message_);
  } else {
    io::encode_imu_batch(first, taken_.stamps, taken_.values, message_);
  }
  return &message_;
}

}  // namespace trunnion::app
