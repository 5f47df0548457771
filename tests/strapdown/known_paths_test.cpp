// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Motions that others test their integrators with, at their tolerances and at a hundredth of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "trunnion/core/units.hpp"
#include "trunnion/simulation/analytic_path.hpp"
#include "trunnion/simulation/rotating_platform.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion {
namespace {

using simulation::PathTruth;
using simulation::Pose;
using simulation::TimeJet;
using Wide = long double;
using S = TimeJet<Wide>;

S of(double value) { return S(static_cast<Wide>(value)); }

/// Largest errors by component: north, east, down [m], velocities [m/s], roll, pitch, heading [deg].
struct Errors {
  std::array<double, 9> largest{};
  void add(const NavigationState<double>& a, const NavigationState<Wide>& b) {
    const Wide sl = std::sin(b.latitude);
    const Ellipsoid<Wide> ellipsoid(sl * sl);
    const auto north = (static_cast<Wide>(a.latitude) - b.latitude) * (ellipsoid.north_radius + b.height);
    const auto east =
        (static_cast<Wide>(a.longitude) - b.longitude) * (ellipsoid.east_radius + b.height) * std::cos(b.latitude);
    const auto angles = [](const auto& q) {
      const auto C = q.toRotationMatrix();
      return std::array<double, 3>{static_cast<double>(std::atan2(C(2, 1), C(2, 2))),
                                   static_cast<double>(-std::asin(C(2, 0))),
                                   static_cast<double>(std::atan2(C(1, 0), C(0, 0)))};
    };
    const auto mine = angles(a.attitude.cast<Wide>());
    const auto truth = angles(b.attitude);
    const Vec3<Wide> v = a.velocity.cast<Wide>() - b.velocity;
    const auto d = [](Wide x) { return static_cast<double>(x); };
    const std::array<double, 9> now = {d(north),
                                       d(east),
                                       d(b.height - static_cast<Wide>(a.height)),
                                       d(v.x()),
                                       d(v.y()),
                                       d(v.z()),
                                       (mine[0] - truth[0]) / kRadPerDeg,
                                       (mine[1] - truth[1]) / kRadPerDeg,
                                       (mine[2] - truth[2]) / kRadPerDeg};
    for (std::size_t i = 0; i < now.size(); ++i) largest[i] = std::max(largest[i], std::abs(now[i]));
  }
  void expect_within(const std::array<double, 9>& tolerance, double share, const char* what) const {
    double worst = 0.0;
    for (std::size_t i = 0; i < tolerance.size(); ++i) {
      worst = std::max(worst, largest[i] / tolerance[i]);
      EXPECT_LT(largest[i], share * tolerance[i]) << what << ", component " << i;
    }
    std::printf("[ FIGURE   ] %s: at most %.2g of the tolerance; %.2g %.2g %.2g m\n", what, worst, largest[0],
                largest[1], largest[2]);
  }
};

template <class Algorithm, class Path>
Errors navigate(const Path& path, double rate_hz, double seconds) {
  const PathTruth<Path> truth(path);
  Navigator<Algorithm> navigator(truth.state(0.0L), 1.0 / rate_hz);
  const Wide period = 1.0L / static_cast<Wide>(rate_hz);
  Errors errors;
  for (long long i = 0; i < static_cast<long long>(seconds * rate_hz); ++i) {
    const Increment<Wide> s = truth.increment(period * static_cast<Wide>(i), period * static_cast<Wide>(i + 1));
    EXPECT_EQ(navigator.add({s.angle.cast<double>(), s.velocity.cast<double>()}), Status::kOk);
    if (navigator.updated() && (i + 1) % 120 == 0)
      errors.add(navigator.state(), truth.state(period * static_cast<Wide>(i + 1)));
  }
  return errors;
}

struct Stationary {
  Pose<S> operator()(const S&) const {
    return {of(55.0 * kRadPerDeg), of(37.0 * kRadPerDeg), of(150.0),
            of(-5.0 * kRadPerDeg), of(10.0 * kRadPerDeg), of(110.0 * kRadPerDeg)};
  }
};

// pyins: an hour at rest at 10 Hz.
TEST(KnownPaths, Stationary) {
  const std::array<double, 9> tolerance = {1e-3, 1e-3, 1e-2, 1e-6, 1e-6, 1e-5, 1e-8, 1e-8, 1e-8};
  navigate<PreviousSample<double>>(Stationary{}, 10.0, 3600.0)
      .expect_within(tolerance, 0.01, "stationary, 1 h, 10 Hz, 1 and previous");
  navigate<ExactSamples<double, 6>>(Stationary{}, 10.0, 3600.0)
      .expect_within(tolerance, 0.01, "stationary, 1 h, 10 Hz, exact 6");
}

S inverse(const S& a) {
  const Wide y = 1.0L / a.value;
  return a.chain(y, -y * y, 2.0L * y * y * y);
}
S arctangent(const S& a) {
  const Wide k = 1.0L / (1.0L + a.value * a.value);
  return a.chain(std::atan(a.value), k, -2.0L * a.value * k * k);
}

/// (5, -3, 0.2) m/s and 1 m/s of sines in 60 s on top, heading along it. Angles of position take the place of their
/// integrals over the ellipsoid: the velocities are those to 1e-4 of themselves.
struct SineVelocity {
  Pose<S> operator()(const S& t) const {
    const double w = 2.0 * kPi / 60.0;
    const S phase = of(w) * t;
    const S north = of(5.0) * t + of(1.0 / w) * (of(1.0) - cos(phase));
    const S east = of(-3.0) * t + of(1.0 / w) * sin(phase);
    const S down = of(0.2) * t + of(1.0 / w) * (of(1.0) - cos(phase));
    const S v_north = of(5.0) + sin(phase);
    const S v_east = of(-3.0) + cos(phase);
    const S v_down = of(0.2) + sin(phase);
    const S along = inverse_sqrt(v_north * v_north + v_east * v_east);
    return {of(55.0 * kRadPerDeg) + of(1.0 / 6.38e6) * north,
            of(37.0 * kRadPerDeg) + of(1.0 / 3.67e6) * east,
            of(1500.0) - down,
            of(0.0),
            arctangent(v_down * along),
            arctangent(v_east * inverse(v_north))};
  }
};

// pyins: an hour of it at 100 Hz.
TEST(KnownPaths, SineVelocity) {
  const std::array<double, 9> tolerance = {0.1, 0.1, 3.0, 1e-3, 1e-3, 1e-2, 1e-6, 1e-6, 1e-5};
  navigate<PreviousSample<double>>(SineVelocity{}, 100.0, 3600.0)
      .expect_within(tolerance, 0.01, "sine velocity, 1 h, 100 Hz, 1 and previous");
  navigate<ExactSamples<double, 6>>(SineVelocity{}, 100.0, 3600.0)
      .expect_within(tolerance, 0.01, "sine velocity, 1 h, 100 Hz, exact 6");
}

/// Savage's spin-cone: a cone of 45 deg at 10 Hz, and a spin of 1 Hz about the body's axis.
struct SpinCone {
  Pose<S> operator()(const S& t) const {
    const double cone = 2.0 * kPi * 10.0;
    const double spin = 2.0 * kPi;
    const double beta = 45.0 * kRadPerDeg;
    return {of(0.7), of(0.1), of(0.0), of(spin - cone * std::cos(beta)) * t, of(0.5 * kPi - beta), of(-cone) * t};
  }
};

// Makani holds it to 1e-2 rad/s and 0.2 m/s^2; a minute here, to a hundredth of that.
TEST(KnownPaths, SpinCone) {
  const std::array<double, 9> tolerance = {360.0, 360.0, 360.0, 12.0, 12.0, 12.0, 34.0, 34.0, 34.0};
  navigate<PreviousSample<double>>(SpinCone{}, 2400.0, 60.0)
      .expect_within(tolerance, 0.01, "spin-cone, 60 s, 2400 Hz, 1 and previous");
  navigate<ExactSamples<double, 6>>(SpinCone{}, 2400.0, 60.0)
      .expect_within(tolerance, 1e-6, "spin-cone, 60 s, 2400 Hz, exact 6");
}

// Savage's spin-rock: a turn of 0.3 rad/s with 0.4 rad at 2 Hz on top about a skew axis, the unit a metre off it. Its
// place is C l.
TEST(KnownPaths, SpinRock) {
  const PathTruth<Stationary> base(Stationary{});
  const Vec3<Wide> axis = Vec3<Wide>(0.6L, -0.48L, 0.64L);
  const Vec3<Wide> arm(0.8L, 0.6L, -0.3L);
  const auto angle = [](Wide t) {
    const Wide w = 4.0L * static_cast<Wide>(kPi);
    return S(0.3L * t + 0.4L * std::sin(w * t), 0.3L + 0.4L * w * std::cos(w * t), -0.4L * w * w * std::sin(w * t));
  };
  const simulation::RotatingPlatform unit([&base](Wide t) { return base.sample(t); }, angle, Mat3<Wide>::Identity(),
                                          axis, arm);
  const NavigationState<Wide> rest = base.state(0.0L);
  const auto place = [&](Wide t) {  // of the unit from the axis, and its velocity, n-components
    const Mat3<Wide> C =
        (rest.attitude * Quaternion<Wide>(Eigen::AngleAxis<Wide>(angle(t).value, axis))).toRotationMatrix();
    return std::array<Vec3<Wide>, 2>{C * arm, C * (angle(t).rate * axis.cross(arm))};
  };
  const Wide sl = std::sin(rest.latitude);
  const Ellipsoid<Wide> ellipsoid(sl * sl);
  const auto off = [&](Wide t) {
    NavigationState<Wide> state = rest;
    const auto [r, v] = place(t);
    state.latitude += r.x() / (ellipsoid.north_radius + rest.height);
    state.longitude += r.y() / ((ellipsoid.east_radius + rest.height) * std::cos(rest.latitude));
    state.height -= r.z();
    state.velocity = v;
    state.attitude = rest.attitude * Quaternion<Wide>(Eigen::AngleAxis<Wide>(angle(t).value, axis));
    return state;
  };
  Navigator<ExactSamples<double, 6>> navigator(off(0.0L), 1.0 / 400.0);
  double largest = 0.0;
  for (int i = 0; i < 400 * 60; ++i) {
    const Increment<Wide> s = simulation::integrate<Wide>(unit, i / 400.0L, (i + 1) / 400.0L);
    ASSERT_EQ(navigator.add({s.angle.cast<double>(), s.velocity.cast<double>()}), Status::kOk);
    if (!navigator.updated()) continue;
    const NavigationState<double> now = navigator.state();
    const NavigationState<Wide> truth = off((i + 1) / 400.0L);
    const Wide metre = 6.4e6L;
    largest =
        std::max({largest, std::abs(static_cast<double>((static_cast<Wide>(now.latitude) - truth.latitude) * metre)),
                  std::abs(static_cast<double>((static_cast<Wide>(now.longitude) - truth.longitude) * metre)),
                  std::abs(static_cast<double>(static_cast<Wide>(now.height) - truth.height))});
  }
  std::printf("[ FIGURE   ] spin-rock, 60 s, 400 Hz, exact 6: %.2g m\n", largest);
  EXPECT_LT(largest, 5e-3);  // the base feels gravity a metre from the unit: 3e-6 m/s^2, 5 mm in a minute
}

}  // namespace
}  // namespace trunnion
