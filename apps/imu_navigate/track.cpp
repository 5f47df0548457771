// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "track.hpp"

#include <algorithm>
#include <cmath>

#include "../terminal.hpp"
#include "trunnion/alignment/fine.hpp"
#include "trunnion/alignment/swinging.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::app {
namespace {

/// What alignment found.
struct Aligned {
  Quaternion<double> q_nb = Quaternion<double>::Identity();
  Vec3<double> gyro_bias = Vec3<double>::Zero();
  double heading_sigma = 0.0;
  LatitudeEstimate<double> latitude;
};

/// Mean over a rest, and how its half-second means scatter.
struct Rest {
  InertialSample<double> mean;
  MeanSigma<double> scatter;  // 1 sigma of an axis of the mean
};

/// A stamp, and how long after the first sample.
std::string when(const BodyMotionSeries& motion, std::size_t i) {
  char text[80];
  std::snprintf(text, sizeof text, "%.3f s (%.2f s after the start)", motion.stamp[i],
                motion.stamp[i] - motion.stamp[0]);
  return text;
}

NavigationState<double> place_of(const Start& start) {
  NavigationState<double> state;
  state.latitude = start.latitude;
  state.longitude = start.longitude;
  state.height = start.height;
  return state;
}

Vec3<double> earth_rate_at(double latitude) {
  return Vec3<double>(kEarthRate * std::cos(latitude), 0.0, -kEarthRate * std::sin(latitude));
}

/// Tilt from gravity, heading as given.
Quaternion<double> level(const Vec3<double>& f, double heading) {
  const double roll = std::atan2(-f.y(), -f.z());
  const double pitch = std::atan2(f.x(), std::hypot(f.y(), f.z()));
  return Quaternion<double>(Eigen::AngleAxisd(heading, Vec3<double>::UnitZ()) *
                            Eigen::AngleAxisd(pitch, Vec3<double>::UnitY()) *
                            Eigen::AngleAxisd(roll, Vec3<double>::UnitX()));
}

/// @throws Error (input) when half-second means wander as those of no base at rest, or the means are those of no rest
Rest rest_of(const BodyMotionSeries& motion, const Start& start, std::size_t count) {
  constexpr double kLargestWander = 0.5 * kRadPerDeg;  // rad/s
  constexpr double kLargestForce = 0.15;               // m/s^2
  constexpr double kLargestRate = 10.0 * kRadPerDeg;   // rad/s: a bias is smaller
  Rest rest;
  InertialSample<double>& mean = rest.mean;
  for (std::size_t i = 0; i < count; ++i) {
    mean.w += motion.mean[i].w / static_cast<double>(count);
    mean.f += motion.mean[i].f / static_cast<double>(count);
  }
  const double gravity = normal_gravity(start.latitude, start.height);
  if (std::abs(mean.f.norm() - gravity) > 0.5)
    throw Error(ExitCode::kInput, "alignment: the mean specific force is " + figure(mean.f.norm(), 4) +
                                      " m/s^2, gravity " + figure(gravity, 4) +
                                      ": are units and columns right? Of increments say --increments");
  if (mean.w.norm() > kLargestRate)
    throw Error(ExitCode::kInput, "alignment: the base turns at " + figure(mean.w.norm() / kRadPerDeg, 4) +
                                      " deg/s all the time: are units and columns right?");
  const auto block = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(0.5 / motion.period)));
  double blocks = 0.0;
  for (std::size_t from = 0; from + block <= count; from += block) {
    InertialSample<double> off{-mean.w, -mean.f};
    for (std::size_t i = from; i < from + block; ++i) {
      off.w += motion.mean[i].w / static_cast<double>(block);
      off.f += motion.mean[i].f / static_cast<double>(block);
    }
    if (off.w.norm() > kLargestWander || off.f.norm() > kLargestForce)
      throw Error(ExitCode::kInput, "alignment: the base moves: " + figure(off.w.norm() / kRadPerDeg, 3) +
                                        " deg/s and " + figure(off.f.norm(), 3) + " m/s^2 off the mean at " +
                                        when(motion, from) + "; align at rest, or say --align swinging or none");
    blocks += 1.0;
    rest.scatter.w += off.w.squaredNorm() / 3.0;
    rest.scatter.f += off.f.squaredNorm() / 3.0;
  }
  if (blocks > 1.0) {
    rest.scatter.w = std::sqrt(rest.scatter.w / (blocks - 1.0) / blocks);
    rest.scatter.f = std::sqrt(rest.scatter.f / (blocks - 1.0) / blocks);
  }
  return rest;
}

Aligned finely(const BodyMotionSeries& motion, const Start& start, std::size_t count, const Aligned& coarse) {
  const UnitNoise& noise = start.noise;
  const auto walk = [](const TriadNoise& n) { return n.wander * std::sqrt(2.0 / n.wander_correlation_time); };
  NavigationState<double> state = place_of(start);
  state.attitude = coarse.q_nb;
  const double tilt = std::max(1e-4, 3.0 * noise.accel.wander / kStandardGravity);
  FineAlignment<PreviousSample<double>> fine(
      state, motion.period, std::max(1, static_cast<int>(std::lround(0.1 / motion.period))), start.lever_arm,
      {noise.gyro.density, noise.accel.density, walk(noise.gyro), walk(noise.accel), 2e-3, tilt, 0.5, 0.02,
       noise.gyro.wander, noise.accel.wander});
  for (std::size_t i = 0; i < count; ++i) {
    if (fine.add(increment_of(motion.mean[i], motion.period)) == Status::kMovingBase)
      throw Error(ExitCode::kInput,
                  "alignment: the base moves, or the sheet promises too much: " + figure(fine.innovation().norm(), 3) +
                      " m/s at " + when(motion, i) + ", " + figure(std::sqrt(fine.strangeness()), 3) +
                      " sigmas from a point at rest; is --lever-arm-m right? See also --align swinging");
  }
  return {fine.navigator().state().attitude, fine.gyro_bias(), std::sqrt(fine.covariance()(2, 2)), coarse.latitude};
}

Aligned swinging(const BodyMotionSeries& motion, const Start& start, std::size_t count) {
  SwingingAlignment<double> alignment(start.latitude, static_cast<double>(count) * motion.period, motion.period);
  for (std::size_t i = 0; i < count; ++i) (void)alignment.add(increment_of(motion.mean[i], motion.period));
  const auto attitude = alignment.attitude();
  if (!attitude.ok()) throw Error(ExitCode::kNumerics, "alignment: heading is not observable: too short, or at a pole");
  // the one thing that it can check: the cone of gravity is as wide as its latitude says
  if (alignment.heading_doubt() > 0.2)
    throw Error(ExitCode::kNumerics,
                "alignment: heading is not to be believed: gravity went round by " +
                    figure(100.0 * alignment.heading_doubt(), 3) +
                    " % another angle than with the Earth: gyro biases, or a base that goes somewhere");
  return {attitude.value(), Vec3<double>::Zero(), alignment.heading_doubt(), {}};
}

Aligned align(const BodyMotionSeries& motion, const Start& start, std::size_t count) {
  Aligned aligned;
  if (start.align == Align::kNone) {
    aligned.q_nb = level(Vec3<double>(0.0, 0.0, -1.0), start.heading);
    return aligned;
  }
  if (start.align == Align::kSwinging) {
    aligned = swinging(motion, start, count);
    return aligned;
  }
  const Rest rest = rest_of(motion, start, count);
  const InertialSample<double>& mean = rest.mean;
  if (start.align == Align::kLevel) {
    aligned.q_nb = level(mean.f, start.heading);
    aligned.gyro_bias = mean.w - aligned.q_nb.conjugate() * earth_rate_at(start.latitude);
    return aligned;
  }
  if (!start.has_noise || !(start.noise.gyro.wander > 0.0) || !(start.noise.accel.wander > 0.0))
    throw Error(
        ExitCode::kUsage,
        "--align compass and fine need --sheet with noise and bias instability: they say what the heading is worth");
  const double time = static_cast<double>(count) * motion.period;
  const auto sigma = [time](const TriadNoise& n, double scatter) {
    return std::hypot(std::max(n.density / std::sqrt(time), scatter), n.wander);
  };
  const MeanSigma<double> sigmas = {sigma(start.noise.gyro, rest.scatter.w), sigma(start.noise.accel, rest.scatter.f)};
  const auto found = coarse_align<double>(mean, sigmas, start.latitude);
  const auto latitude = latitude_from_rest<double>(mean, sigmas);
  if (!found.ok() || !latitude.ok())
    throw Error(ExitCode::kNumerics,
                "alignment: heading is not observable: these gyros hide the Earth's rate; give it, with --align level");
  const double off = latitude.value().latitude - start.latitude;
  if (std::abs(off) > 5.0 * latitude.value().sigma)
    throw Error(ExitCode::kNumerics,
                "alignment: heading is not to be believed: the Earth's rate puts the latitude at " +
                    figure(latitude.value().latitude / kRadPerDeg, 4) + " +- " +
                    figure(latitude.value().sigma / kRadPerDeg, 2) + " deg, it is " +
                    figure(start.latitude / kRadPerDeg, 4) +
                    ": gyro biases beyond the sheet's, or a base that moves (--align swinging)");
  aligned.latitude = latitude.value();
  aligned.q_nb = found.value().q_nb;
  aligned.heading_sigma = std::sqrt(found.value().covariance(2, 2));
  return start.align == Align::kFine ? finely(motion, start, count, aligned) : aligned;
}

template <class Algorithm>
void fly(const BodyMotionSeries& motion, const NavigationState<double>& state, const Vec3<double>& gyro_bias,
         std::size_t first, double output_hz, Track& track) {
  Navigator<Algorithm> navigator(state, motion.period);
  const auto every = static_cast<std::size_t>(std::max(1L, std::lround(1.0 / (output_hz * motion.period))));
  ProgressLine progress;
  std::size_t since = 0;
  for (std::size_t i = first; i < motion.mean.size(); ++i) {
    InertialSample<double> mean = motion.mean[i];
    mean.w -= gyro_bias;
    if (navigator.add(increment_of(mean, motion.period)) != Status::kOk)
      throw Error(ExitCode::kInput,
                  "more than a radian in one sample at " + when(motion, i) + ": is the unit of the rates right?");
    ++since;
    if (!navigator.updated() || (since < every && i + 1 < motion.mean.size())) continue;
    since = 0;
    track.epoch.push_back({motion.stamp[i], navigator.state()});
    progress.show("navigating " + figure(100.0 * static_cast<double>(i) / static_cast<double>(motion.mean.size()), 3) +
                  " %");
  }
}

}  // namespace

Track navigate(const BodyMotionSeries& motion, const Start& start, const std::string& algorithm, double output_hz) {
  const std::size_t count =
      start.align == Align::kNone ? 0 : static_cast<std::size_t>(std::lround(start.align_time / motion.period));
  if (count + 10 > motion.mean.size())
    throw Error(ExitCode::kInput,
                "the recording of " + figure(static_cast<double>(motion.mean.size()) * motion.period, 4) +
                    " s is shorter than its alignment of " + figure(start.align_time, 4) + " s (--align-s)");
  const Aligned aligned = align(motion, start, count);
  Track track;
  track.heading_at_start = euler_angles(aligned.q_nb).z();
  track.heading_sigma = aligned.heading_sigma;
  track.latitude_seen = aligned.latitude.latitude;
  track.latitude_sigma = aligned.latitude.sigma;
  if (std::abs(euler_angles(aligned.q_nb).x()) > 150.0 * kRadPerDeg)
    track.warnings.push_back("the unit is upside down, roll " + figure(euler_angles(aligned.q_nb).x() / kRadPerDeg, 4) +
                             " deg: at rest with z down the specific force is -9.8 along z");
  NavigationState<double> state = place_of(start);
  state.attitude = aligned.q_nb;
  track.epoch.push_back({motion.stamp[count] - motion.period, state});
  const auto run = [&](auto kind) { fly<decltype(kind)>(motion, state, aligned.gyro_bias, count, output_hz, track); };
  if (algorithm == "2")
    run(MultiSample<double, 2>{});
  else if (algorithm == "3")
    run(MultiSample<double, 3>{});
  else if (algorithm == "4")
    run(MultiSample<double, 4>{});
  else if (algorithm == "exact4")
    run(ExactSamples<double, 4>{});
  else if (algorithm == "exact6")
    run(ExactSamples<double, 6>{});
  else if (algorithm == "exact8")
    run(ExactSamples<double, 8>{});
  else
    run(PreviousSample<double>{});
  return track;
}

namespace {
constexpr double kLongestWait = 5.0;  // s
}  // namespace

Track reckon(const BodyMotionSeries& motion, const Start& start, const Wheel<double>& wheel, double output_hz) {
  if (std::abs(start.latitude) > 89.9 * kRadPerDeg)
    throw Error(ExitCode::kInput, "a wheel at a pole: dead reckoning is by latitude and longitude");
  WheelDeadReckoning<double> reckoning(wheel, start.heading, motion.period);
  const double sl = std::sin(start.latitude);
  const Ellipsoid<double> ellipsoid(sl * sl);
  const auto every = static_cast<std::size_t>(std::max(1L, std::lround(1.0 / (output_hz * motion.period))));
  Track track;
  track.heading_at_start = start.heading;
  for (std::size_t i = 0; i < motion.mean.size(); ++i) {
    (void)reckoning.add(motion.mean[i]);
    if (reckoning.state() == WheelState::kWaiting && motion.stamp[i] - motion.stamp[0] > kLongestWait)
      throw Error(ExitCode::kInput, "the wheel is not at rest for a second within the first " +
                                        figure(kLongestWait, 2) +
                                        " s: its gyros' biases cannot be read; start the recording at rest");
    if (reckoning.state() == WheelState::kSaturated) track.saturated_time += motion.period;
    if (i % every != 0 && i + 1 < motion.mean.size()) continue;
    NavigationState<double> state = place_of(start);
    state.latitude += reckoning.north() / (ellipsoid.north_radius + start.height);
    state.longitude += reckoning.east() / ((ellipsoid.east_radius + start.height) * std::cos(start.latitude));
    state.longitude = std::remainder(state.longitude, 2.0 * kPi);
    const double heading = reckoning.heading();
    state.velocity = reckoning.speed() * Vec3<double>(std::cos(heading), std::sin(heading), 0.0);
    state.attitude = Quaternion<double>(Eigen::AngleAxisd(heading, Vec3<double>::UnitZ()));
    track.epoch.push_back({motion.stamp[i], state});
  }
  if (reckoning.state() == WheelState::kWaiting)
    throw Error(ExitCode::kInput, "the wheel is never at rest for a second: its gyros' biases cannot be read");
  track.distance = reckoning.distance();
  track.axle_scale = reckoning.axle_scale();
  if (track.distance < 2.0 * kPi * wheel.radius)
    track.warnings.push_back("the wheel made less than a turn: is the unit's z along the axle?");
  if (std::abs(track.axle_scale) > 0.02)
    track.warnings.push_back("the axle gyro's scale is off by " + figure(100.0 * track.axle_scale, 2) +
                             " %: is the unit on the hub, z along the axle, and its axes right-handed?");
  if (track.saturated_time > 0.0)
    track.warnings.push_back("the axle gyro was at its range for " + figure(track.saturated_time, 3) + " s");
  return track;
}

}  // namespace trunnion::app
