// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/rate_test.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kStill = 2e-3;        // rad/s
constexpr double kTurning = 0.02;      // rad/s
constexpr double kConstant = 0.01;     // of the azimuth's rate, within a run
constexpr double kShortest = 2.0;      // s, of a run
constexpr double kShortestRest = 3.0;  // s
constexpr double kAlong = 0.9;         // of the rate, for a run to lie along a sensor

/// Means over a run, rests taken off.
struct Run {
  Vec3<double> output = Vec3<double>::Zero();
  Vec3<double> input = Vec3<double>::Zero();
};

/// One window in the case of a perfect fixture.
struct Seen {
  enum class Kind { kRest, kAzimuth, kPitch, kOther } kind = Kind::kOther;
  int direction = 0;  // of the pitch
  double t = 0.0;
  double azimuth_rate = 0.0;
  Vec3<double> output;
  Vec3<double> input;  // against the table
  Vec3<double> earth;
};

std::vector<Seen> look(const TableRecording& recording, const Rig& rig, const Site& site) {
  const TwoAxisTable<double> table(rig.geometry, TwoAxisErrors<double>(), site.latitude, site.gravity);
  const Mat3<double> C_bp = rig.mount[static_cast<std::size_t>(recording.mount)].C_pb.transpose();
  const EncoderCourse& course = recording.data.course;
  std::vector<Seen> all;
  for (const ObservationWindow& window : recording.data.windows) {
    if (!course.covers(window.t - window.half_width, window.t + window.half_width)) continue;
    Seen seen;
    seen.t = window.t;
    seen.output = window.mean.w;
    seen.input.setZero();
    seen.earth.setZero();
    std::array<double, 2> rate{};
    for (std::size_t n = 0; n < kWindowNodes; ++n) {
      const std::array<CourseValue, 2> at = course.at(window.t + window.half_width * kNodeAbscissa[n]);
      const Vec3<double> turning =
          table.input({at[0].angle, at[0].rate, 0.0}, {at[1].angle, at[1].rate, 0.0}, Vec3<double>::Zero()).w;
      const Vec3<double> standing =
          table.input({at[0].angle, 0.0, 0.0}, {at[1].angle, 0.0, 0.0}, Vec3<double>::Zero()).w;
      seen.input += window.weight[n] * (C_bp * (turning - standing));
      seen.earth += window.weight[n] * (C_bp * standing);
      for (std::size_t a = 0; a < 2; ++a) rate[a] += window.weight[n] * at[a].rate;
    }
    seen.azimuth_rate = rate[0];
    seen.direction = std::abs(rate[1]) < kStill ? 0 : rate[1] > 0.0 ? 1 : -1;
    seen.kind = std::abs(rate[0]) + std::abs(rate[1]) < kStill ? Seen::Kind::kRest
                : std::abs(rate[0]) > kTurning                 ? Seen::Kind::kAzimuth
                : std::abs(rate[1]) > kTurning                 ? Seen::Kind::kPitch
                                                               : Seen::Kind::kOther;
    all.push_back(seen);
  }
  return all;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The runs of one recording, eq. (1). A run with a swinging pitch is two: of both directions of the swing.
void add_runs(const TableRecording& recording, const Rig& rig, const Site& site, std::vector<Run>& runs,
              Vec3<double>& bias, double& rest_time) {
  const std::vector<Seen> seen = look(recording, rig, site);
  const double step = recording.data.windows.empty() ? 0.1 : 2.0 * recording.data.windows.front().half_width;
  struct Stretch {
    Seen::Kind kind;
    std::size_t from, to;
    int sign;
  };
  std::vector<Stretch> stretches;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const int sign = seen[k].kind == Seen::Kind::kAzimuth ? (seen[k].azimuth_rate > 0.0 ? 1 : -1) : 0;
    if (stretches.empty() || stretches.back().kind != seen[k].kind || stretches.back().sign != sign ||
        seen[k].t - seen[stretches.back().to - 1].t > 1.5 * step)
      stretches.push_back({seen[k].kind, k, k + 1, sign});
    else
      stretches.back().to = k + 1;
  }
  const auto mean_rest = [&](const Stretch& rest) {
    Vec3<double> mean = Vec3<double>::Zero();
    for (std::size_t k = rest.from; k < rest.to; ++k) mean += seen[k].output;
    return Vec3<double>(mean / static_cast<double>(rest.to - rest.from));
  };
  const auto is_rest = [&](const Stretch& s) {
    return s.kind == Seen::Kind::kRest && static_cast<double>(s.to - s.from) * step >= kShortestRest;
  };
  for (const Stretch& s : stretches) {
    if (!is_rest(s)) continue;
    for (std::size_t k = s.from; k < s.to; ++k) {
      bias += step * (seen[k].output - seen[k].earth);
      rest_time += step;
    }
  }
  // a swing of the pitch alone is cut by its turning points: it is one run all the same
  for (std::size_t i = 0; i < stretches.size();) {
    const Seen::Kind kind = stretches[i].kind;
    if (kind != Seen::Kind::kAzimuth && kind != Seen::Kind::kPitch) {
      ++i;
      continue;
    }
    std::size_t last = i;
    if (kind == Seen::Kind::kPitch) {
      while (last + 1 < stretches.size() && !is_rest(stretches[last + 1]) &&
             stretches[last + 1].kind != Seen::Kind::kAzimuth)
        ++last;
    }
    const std::size_t from = stretches[i].from;
    const std::size_t to = stretches[last].to;
    const Stretch* before = nullptr;
    const Stretch* after = nullptr;
    for (std::size_t j = 0; j < stretches.size(); ++j) {
      if (!is_rest(stretches[j])) continue;
      if (j < i) before = &stretches[j];
      if (j > last && after == nullptr) after = &stretches[j];
    }
    i = last + 1;
    if (before == nullptr || after == nullptr || static_cast<double>(to - from) * step < kShortest) continue;
    const Vec3<double> rest = 0.5 * (mean_rest(*before) + mean_rest(*after));
    std::vector<double> rates;
    for (std::size_t k = from; k < to; ++k) rates.push_back(seen[k].azimuth_rate);
    const double rate = median(rates);
    for (const int direction : {1, -1, 0}) {
      Run run;
      double count = 0.0;
      for (std::size_t k = from; k < to; ++k) {
        if (seen[k].direction != direction) continue;
        if (kind == Seen::Kind::kAzimuth && std::abs(seen[k].azimuth_rate - rate) > kConstant * std::abs(rate))
          continue;
        if (kind == Seen::Kind::kPitch && seen[k].kind != Seen::Kind::kPitch) continue;
        run.output += seen[k].output;
        run.input += seen[k].input;
        count += 1.0;
      }
      if (count * step < 0.25 * kShortest) continue;
      run.output = run.output / count - rest;
      run.input /= count;
      runs.push_back(run);
    }
  }
}

/// Eq. (2) of one sensor.
RateTestAxis fit_line(const std::vector<Run>& runs, int i) {
  RateTestAxis axis;
  std::vector<const Run*> along;
  double largest = 0.0;
  for (const Run& run : runs) {
    if (std::abs(run.input(i)) < kAlong * run.input.norm()) continue;
    along.push_back(&run);
    largest = std::max(largest, std::abs(run.output(i)));
  }
  if (along.size() < 3) return axis;
  axis.excited = true;
  Eigen::MatrixXd A(static_cast<Eigen::Index>(along.size()), 2);
  Eigen::VectorXd b(A.rows());
  for (std::size_t k = 0; k < along.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    A.row(row) << along[k]->input(i), 1.0;
    b(row) = along[k]->output(i);
  }
  const Eigen::Vector2d line = A.colPivHouseholderQr().solve(b);
  axis.scale_error = line(0) - 1.0;
  axis.zero = line(1);
  axis.nonlinearity = (A * line - b).cwiseAbs().maxCoeff() / largest;
  std::array<double, 2> square{};
  std::array<double, 2> product{};
  for (Eigen::Index k = 0; k < A.rows(); ++k) {
    const std::size_t side = A(k, 0) > 0.0 ? 0 : 1;
    square[side] += A(k, 0) * A(k, 0);
    product[side] += A(k, 0) * (b(k) - line(1));
  }
  if (square[0] > 0.0 && square[1] > 0.0)
    axis.asymmetry = std::abs(product[0] / square[0] - product[1] / square[1]) / line(0);
  return axis;
}

}  // namespace

RateTestResult rate_test(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site) {
  std::vector<Run> runs;
  Vec3<double> bias = Vec3<double>::Zero();
  double rest_time = 0.0;
  for (const TableRecording& recording : recordings) add_runs(recording, rig, site, runs, bias, rest_time);
  if (runs.size() < 4 || rest_time == 0.0)
    throw Error(ExitCode::kInput,
                "a rate test needs turns at constant rates, and a rest before and after each: there are " +
                    std::to_string(runs.size()) + " such runs");
  RateTestResult result;
  result.runs = static_cast<int>(runs.size());
  for (int i = 0; i < 3; ++i) result.axis[static_cast<std::size_t>(i)] = fit_line(runs, i);
  for (int i = 0; i < 3; ++i) {
    const RateTestAxis& own = result.axis[static_cast<std::size_t>(i)];
    result.gyro.M(i, i) = own.scale_error;
    result.determined(i, i) = own.excited;
    // eq. (3): against the other rates that some run lies along
    std::vector<int> others;
    for (int j = 0; j < 3; ++j) {
      if (j != i && result.axis[static_cast<std::size_t>(j)].excited) others.push_back(j);
    }
    if (others.empty()) continue;
    Eigen::MatrixXd A(static_cast<Eigen::Index>(runs.size()), static_cast<Eigen::Index>(others.size()));
    Eigen::VectorXd Y(A.rows());
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      for (std::size_t j = 0; j < others.size(); ++j) A(row, static_cast<Eigen::Index>(j)) = runs[k].input(others[j]);
      Y(row) = runs[k].output(i) - (1.0 + own.scale_error) * runs[k].input(i) - own.zero;
    }
    const Eigen::VectorXd e = A.colPivHouseholderQr().solve(Y);
    for (std::size_t j = 0; j < others.size(); ++j) {
      result.gyro.M(i, others[j]) = e(static_cast<Eigen::Index>(j));
      result.determined(i, others[j]) = true;
    }
  }
  result.gyro.bias = bias / rest_time;
  return result;
}

}  // namespace trunnion::calibration
