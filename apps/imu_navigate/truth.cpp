// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "trunnion/core/units.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::app {
namespace {

constexpr double kMoving = 1.0;      // m/s: slower, a course is noise
constexpr double kCourseSpan = 0.5;  // s either side

struct Plane {
  double north_per_rad, east_per_rad, latitude, longitude;
  Plane(double latitude_0, double longitude_0, double height) : latitude(latitude_0), longitude(longitude_0) {
    const double sl = std::sin(latitude);
    const Ellipsoid<double> ellipsoid(sl * sl);
    north_per_rad = ellipsoid.north_radius + height;
    east_per_rad = (ellipsoid.east_radius + height) * std::cos(latitude);
  }
};

/// The slope of a least-squares parabola through (t, value) at t = 0.
class Parabola {
 public:
  void add(double t, double value) {
    const std::array<double, 3> power = {1.0, t, t * t};
    for (int i = 0; i < 3; ++i) {
      b_(i) += power[static_cast<std::size_t>(i)] * value;
      for (int j = 0; j < 3; ++j) A_(i, j) += power[static_cast<std::size_t>(i)] * power[static_cast<std::size_t>(j)];
    }
    ++count_;
  }
  [[nodiscard]] double slope() const { return count_ < 4 ? 0.0 : Vec3<double>(A_.inverse() * b_).y(); }

 private:
  Mat3<double> A_ = Mat3<double>::Zero();
  Vec3<double> b_ = Vec3<double>::Zero();
  int count_ = 0;
};

}  // namespace

Truth::Truth(const std::string& path, double offset) : offset_(offset) {
  std::string digest;
  // a receiver slower than its log repeats itself: a repeated position counts after a fifth of a second only
  io::read_columns_csv(
      path, {"t", "lat", "lon", "h"},
      [&](const double* v) {
        if (!(std::abs(v[1]) <= 0.5 * kPi))
          throw io::input_error(path, 0, "lat", "is beyond a pole: are the columns right?");
        if (!point_.empty()) {
          const Point& last = point_.back();
          if (v[0] <= last.t) return;
          if (v[1] == last.latitude && v[2] == last.longitude && v[0] < last.t + 0.2) return;
        }
        point_.push_back({v[0], v[1], v[2], v[3], 0.0, 0.0, 0.0, 0.0});
      },
      digest);
  if (point_.size() < 10) throw io::input_error(path, 0, "", "has fewer than ten positions");
  const Plane plane(latitude(), longitude(), height());
  for (Point& p : point_) {
    p.north = (p.latitude - plane.latitude) * plane.north_per_rad;
    p.east = std::remainder(p.longitude - plane.longitude, 2.0 * kPi) * plane.east_per_rad;
  }
  // half a second either side, or two positions where they are rarer
  for (std::size_t k = 0; k < point_.size(); ++k) {
    Point& p = point_[k];
    std::size_t from = k;
    std::size_t to = k;
    while (from > 0 && (point_[from - 1].t >= p.t - kCourseSpan || from + 2 > k)) --from;
    while (to + 1 < point_.size() && (point_[to + 1].t <= p.t + kCourseSpan || to < k + 2)) ++to;
    Parabola north;
    Parabola east;
    for (std::size_t i = from; i <= to; ++i) {
      north.add(point_[i].t - p.t, point_[i].north);
      east.add(point_[i].t - p.t, point_[i].east);
    }
    p.speed = std::hypot(north.slope(), east.slope());
    p.course = std::atan2(east.slope(), north.slope());
  }
}

/// Calls visit(point, north, east, height, heading of the track) for every point that the track covers.
template <class Visit>
void Truth::along(const Track& track, Visit visit) const {
  const Plane plane(latitude(), longitude(), height());
  std::size_t k = 0;
  bool any = false;
  for (const Point& p : point_) {
    const double t = p.t - offset_;
    if (t < track.epoch.front().t || t > track.epoch.back().t) continue;
    while (k + 2 < track.epoch.size() && track.epoch[k + 1].t < t) ++k;
    const Epoch& a = track.epoch[k];
    const Epoch& b = track.epoch[k + 1];
    const double share = (t - a.t) / (b.t - a.t);
    const auto between = [share](double from, double to) { return from + share * (to - from); };
    const double heading_a = euler_angles(a.state.attitude).z();
    const double turned = std::remainder(euler_angles(b.state.attitude).z() - heading_a, 2.0 * kPi);
    visit(p, (between(a.state.latitude, b.state.latitude) - plane.latitude) * plane.north_per_rad,
          (std::remainder(a.state.longitude - plane.longitude, 2.0 * kPi) +
           share * std::remainder(b.state.longitude - a.state.longitude, 2.0 * kPi)) *
              plane.east_per_rad,
          between(a.state.height, b.state.height), heading_a + share * turned);
    any = true;
  }
  if (!any) throw Error(ExitCode::kInput, "the truth and the track have no time in common: is --truth-offset-s right?");
}

double Truth::heading_offset(const Track& track, double seconds) const {
  double first = 0.0;
  bool moving = false;
  double s = 0.0;
  double c = 0.0;
  along(track, [&](const Point& p, double, double, double, double heading) {
    if (p.speed <= kMoving) return;
    if (!moving) first = p.t;
    moving = true;
    if (p.t > first + seconds) return;
    s += std::sin(p.course - heading);
    c += std::cos(p.course - heading);
  });
  if (!moving) throw Error(ExitCode::kInput, "the truth never moves: it has no course to take a heading from");
  return std::atan2(s, c);
}

Comparison Truth::compare(const Track& track) const {
  Comparison comparison;
  double squares = 0.0;
  long long count = 0;
  long long count_points = 0;
  double first_t = 0.0;
  std::vector<std::pair<double, double>> last;
  bool first = true;
  double north_before = 0.0;
  double east_before = 0.0;
  along(track, [&](const Point& p, double north, double east, double up, double heading) {
    if (!first) comparison.distance += std::hypot(p.north - north_before, p.east - east_before);
    first = false;
    north_before = p.north;
    east_before = p.east;
    if (count_points++ == 0) first_t = p.t;
    comparison.time = p.t - first_t;
    comparison.end_horizontal = std::hypot(north - p.north, east - p.east);
    comparison.largest_horizontal = std::max(comparison.largest_horizontal, comparison.end_horizontal);
    comparison.largest_vertical = std::max(comparison.largest_vertical, std::abs(up - p.height));
    if (p.speed <= kMoving) return;
    const double error = std::remainder(heading - p.course, 2.0 * kPi);
    squares += error * error;
    ++count;
    last.emplace_back(p.t, error);
  });
  comparison.moving = count > 0;
  if (count > 0) comparison.heading_rms = std::sqrt(squares / static_cast<double>(count));
  double sum = 0.0;
  int ends = 0;
  for (const auto& [t, error] : last) {
    if (t < last.back().first - 2.0) continue;
    sum += error;
    ++ends;
  }
  if (ends > 0) comparison.heading_end = sum / ends;
  return comparison;
}

void turn_track(Track& track, double angle) {
  const NavigationState<double> start = track.epoch.front().state;
  const Plane plane(start.latitude, start.longitude, start.height);
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  const Quaternion<double> turn(Eigen::AngleAxisd(angle, Vec3<double>::UnitZ()));
  for (Epoch& epoch : track.epoch) {
    const double north = (epoch.state.latitude - start.latitude) * plane.north_per_rad;
    const double east = std::remainder(epoch.state.longitude - start.longitude, 2.0 * kPi) * plane.east_per_rad;
    epoch.state.latitude = start.latitude + (c * north - s * east) / plane.north_per_rad;
    epoch.state.longitude = std::remainder(start.longitude + (s * north + c * east) / plane.east_per_rad, 2.0 * kPi);
    epoch.state.velocity = turn * epoch.state.velocity;
    epoch.state.attitude = turn * epoch.state.attitude;
  }
  track.heading_at_start += angle;
}

}  // namespace trunnion::app
