// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "output.hpp"

#include <cmath>
#include <cstdio>

#include "../terminal.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

constexpr double kLooseAngle = 1.0;           // rad: an angle less sure than that is none
constexpr double kLevel = 10.0 * kRadPerDeg;  // 1 sigma of what no antenna shows, about level
constexpr double kMostlyFree = 0.5;           // of an angle, that the free one makes

/// One more cell; empty where @p known is false or the value is not finite.
void append_cell(std::string& row, bool known, double value, const char* format) {
  row += ',';
  if (!known || !std::isfinite(value)) return;
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  row += text;
}

}  // namespace

const char* status_name(AttitudeStatus status) {
  switch (status) {
    case AttitudeStatus::kNone:
      return "none";
    case AttitudeStatus::kFloat:
      return "float";
    case AttitudeStatus::kPredicted:
      return "predicted";
    case AttitudeStatus::kHeld:
      return "held";
    case AttitudeStatus::kFixed:
      return "fixed";
  }
  return "none";
}

Vec3<double> euler_sigma(const AttitudeEstimate<double>& attitude) {
  const Vec3<double> euler = euler_angles(attitude.q_nb);
  const double sr = std::sin(euler.x());
  const double cr = std::cos(euler.x());
  const double cp = std::cos(euler.y());
  Mat3<double> J;  // of roll, pitch, yaw with respect to the rotation vector in the body
  J << 1.0, sr * std::tan(euler.y()), cr * std::tan(euler.y()), 0.0, cr, -sr, 0.0, sr / cp, cr / cp;
  const Mat3<double> across = Mat3<double>::Identity() - attitude.free_axis * attitude.free_axis.transpose();
  const Mat3<double> Q = J * across * attitude.covariance * across * J.transpose();
  const Vec3<double> moved = J * attitude.free_axis;
  Vec3<double> sigma;
  for (int i = 0; i < 3; ++i) {
    // of the covariance, the part along the free axis is the filter's, and means nothing
    sigma(i) = std::sqrt(std::max(0.0, Q(i, i)) + kLevel * kLevel * moved(i) * moved(i));
    if (std::abs(moved(i)) > kMostlyFree || !(sigma(i) < kLooseAngle)) sigma(i) = std::nan("");
  }
  return sigma;
}

std::string attitude_row(const Solution& s) {
  char text[80];
  std::snprintf(text, sizeof text, "%d,%.4f,%s,%d", s.time.week, s.time.seconds, status_name(s.status), s.satellites);
  std::string row = text;
  const bool any = s.attitude.observable > 0;
  const Vec3<double> euler = euler_angles(s.attitude.q_nb) / kRadPerDeg;
  const Vec3<double> sigma =
      any ? Vec3<double>(euler_sigma(s.attitude) / kRadPerDeg) : Vec3<double>(Vec3<double>::Constant(std::nan("")));
  for (const int i : {2, 1, 0})
    append_cell(row, std::isfinite(sigma(i)), i == 2 && euler(i) < 0.0 ? euler(i) + 360.0 : euler(i), "%.5f");
  for (const int i : {2, 1, 0}) append_cell(row, true, sigma(i), "%.5f");
  row += ',' + std::to_string(s.attitude.observable);
  const Quaternion<double>& q = s.attitude.q_nb;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) append_cell(row, any, value, "%.9f");
  for (int i = 0; i < 3; ++i) append_cell(row, s.has_rate, s.rate(i) / kRadPerDeg, "%.5f");
  for (std::size_t k = 0; k < 2; ++k) {
    for (int i = 0; i < 3; ++i) append_cell(row, s.has_baseline[k], s.baseline(i, static_cast<int>(k)), "%.5f");
  }
  append_cell(row, s.degrees > 0, s.misfit, "%.3f");
  append_cell(row, s.degrees > 0, s.degrees, "%.0f");
  append_cell(row, s.degrees > 0, s.gap, "%.3f");
  row += ',' + std::to_string(s.excluded);
  return row;
}

void write_attitude_csv(const std::string& path, const std::vector<Solution>& solutions) {
  io::WholeFile file(path);
  file.write(
      "gps_week,t_s,status,satellites,heading_deg,pitch_deg,roll_deg,heading_sigma_deg,pitch_sigma_deg,roll_sigma_deg,"
      "observable_axes,q_w,q_x,q_y,q_z,rate_x_deg_s,rate_y_deg_s,rate_z_deg_s,b1_north_m,b1_east_m,b1_down_m,b2_north_"
      "m,"
      "b2_east_m,b2_down_m,misfit,degrees,gap,excluded\n");
  for (const Solution& s : solutions) file.write(attitude_row(s) + "\n");
  file.commit();
}

io::AttitudeMessage message_of(const Solution& s, std::int64_t sequence) {
  io::AttitudeMessage message;
  message.utime = s.utime;
  message.sequence = sequence;
  message.status = s.status;
  message.satellites = s.satellites;
  message.attitude = s.attitude;
  if (s.has_rate) message.rate = s.rate;
  return message;
}

void write_attitude_log(const std::string& path, const std::string& channel, const std::vector<Solution>& solutions) {
  io::LcmLogWriter log(path);
  std::string message;
  std::int64_t sequence = 0;
  for (const Solution& s : solutions) {
    io::encode_attitude(message_of(s, sequence++), message);
    log.write(s.utime, channel, message);
  }
  log.commit();
}

void AttitudeFigures::add(const Solution& s) {
  ++epochs_;
  ++counts_[s.status];
  ++reasons_[s.reason];
  silent_ += s.silent ? 1 : 0;
  refused_ += s.refused ? 1 : 0;
  for (std::size_t k = 0; k < 2; ++k) {
    if (s.other_length[k] > 0.0) {
      free_length_[k] += s.other_length[k];
      ++free_[k];
    }
    if (!s.has_baseline[k]) continue;
    const double l = s.baseline.col(static_cast<int>(k)).norm();
    length_[k] += l;
    square_[k] += l * l;
    ++measured_[k];
  }
  if (s.status < AttitudeStatus::kHeld) return;
  misfit_ += s.misfit;
  degrees_ += s.degrees;
  excluded_ += s.excluded;
  const Vec3<double> euler = euler_angles(s.attitude.q_nb);
  const Vec3<double> sure = euler_sigma(s.attitude);
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(sure(i))) continue;
    sine_(i) += std::sin(euler(i));
    cosine_(i) += std::cos(euler(i));
    sigma_(i) += sure(i);
    ++angles_[static_cast<std::size_t>(i)];
  }
}

long long AttitudeFigures::sure() const {
  long long sum = 0;
  for (const auto& [status, count] : counts_) sum += status >= AttitudeStatus::kHeld ? count : 0;
  return sum;
}

nlohmann::ordered_json AttitudeFigures::json(const EngineOptions& options) const {
  nlohmann::ordered_json tree;
  tree["epochs"] = epochs_;
  for (const AttitudeStatus status : {AttitudeStatus::kFixed, AttitudeStatus::kHeld, AttitudeStatus::kPredicted,
                                      AttitudeStatus::kFloat, AttitudeStatus::kNone}) {
    const auto found = counts_.find(status);
    tree[status_name(status)] = found == counts_.end() ? 0 : found->second;
  }
  if (silent_ > 0) tree["receiver_silent"] = silent_;
  if (refused_ > 0) tree["refused_by_filter"] = refused_;
  if (excluded_ > 0) tree["satellites_left_out"] = excluded_;
  if (degrees_ > 0.0) tree["reduced_chi_square"] = misfit_ / degrees_;
  for (std::size_t k = 0; k < options.slaves.size(); ++k) {
    nlohmann::ordered_json baseline = {{"stated_length_m", options.slaves[k].norm()}};
    if (measured_[k] > 0) {
      const double n = static_cast<double>(measured_[k]);
      baseline["measured_length_m"] = length(k);
      baseline["scatter_m"] = std::sqrt(std::max(0.0, square_[k] / n - length_[k] / n * length_[k] / n));
    }
    if (free_[k] > 0) baseline["length_without_the_stated_m"] = free_length(k);
    tree["baseline_" + std::to_string(k + 1)] = baseline;
  }
  const char* const names[] = {"roll", "pitch", "heading"};
  for (const int i : {2, 1, 0}) {
    const auto n = static_cast<double>(angles_[static_cast<std::size_t>(i)]);
    if (n < 1.0) continue;
    // circular, as a heading near north must be
    const double r = std::min(1.0, std::hypot(sine_(i), cosine_(i)) / n);
    double mean = std::atan2(sine_(i), cosine_(i)) / kRadPerDeg;
    if (i == 2 && mean < 0.0) mean += 360.0;
    tree[names[i]] = {{"epochs", angles_[static_cast<std::size_t>(i)]},
                      {"mean_deg", mean},
                      {"scatter_deg", std::sqrt(-2.0 * std::log(std::max(r, 1e-300))) / kRadPerDeg},
                      {"sigma_deg", sigma_(i) / n / kRadPerDeg}};
  }
  return tree;
}

std::string AttitudeFigures::why_not() const {
  const auto count = [&](Status status) {
    const auto found = reasons_.find(status);
    return found == reasons_.end() ? 0 : found->second;
  };
  if (silent_ == epochs_) return "a receiver was never heard";
  const long long few = count(Status::kNotObservable);
  const long long doubtful = count(Status::kAmbiguous);
  if (count(Status::kInconsistent) > std::max(few, doubtful))
    return "no whole cycles fit the phases and the stated antennas; are their places, and --phase-sigma-m, right?";
  if (doubtful >= few)
    return "several sets of whole cycles fit; more --signals, a third antenna, or a surer --length-sigma-m decide";
  return "fewer than four common satellites with an orbit above the mask whose phases are surer than a sixteenth of a "
         "wavelength (--signals, --mask-deg, --phase-sigma-m)";
}

}  // namespace trunnion::app
