// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/allan_deviation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trunnion/calibration/share_out.hpp"
#include "trunnion/core/chi_square.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::calibration {
namespace {

constexpr std::size_t kBlock = 1024;          // stays in the nearest cache while all taus look at it
constexpr std::size_t kChunk = 128 * kBlock;  // of one thread, with sums of its own: their order is always the same

/// sum (a_k - 2 b_k + c_k)^2. Eight sums at a time: no adding waits for the one before.
double squares(const double* a, const double* b, const double* c, std::size_t count) {
  constexpr std::size_t kLanes = 8;
  std::array<double, kLanes> sum{};
  std::size_t k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double d = (a[k + i] + c[k + i]) - 2.0 * b[k + i];
      sum[i] += d * d;
    }
  }
  double rest = 0.0;
  for (; k < count; ++k) {
    const double d = (a[k] + c[k]) - 2.0 * b[k];
    rest += d * d;
  }
  for (const double one : sum) rest += one;
  return rest;
}

constexpr std::size_t kTogether = 4;  // taus

/// Adds squares() of kTogether taus, each twice the one before, over a block: a reading that two of them share is
/// loaded once. @param at x at the block's begin and at one, two, four, ... steps from there
void add_squares_together(const std::array<const double*, kTogether + 2>& at, double* sum) {
  using Lanes = Eigen::Array<double, 4, 1>;
  constexpr auto kLanes = static_cast<std::size_t>(Lanes::SizeAtCompileTime);
  std::array<Lanes, kTogether> lanes;
  lanes.fill(Lanes::Zero());
  const auto load = [&](std::size_t from, std::size_t k) -> Lanes { return Eigen::Map<const Lanes>(at[from] + k); };
  for (std::size_t k = 0; k < kBlock; k += kLanes) {
    const Lanes begin = load(0, k);
    Lanes middle = load(1, k);
    for (std::size_t j = 0; j < kTogether; ++j) {
      const Lanes end = load(j + 2, k);
      lanes[j] += (end + begin - 2.0 * middle).square();
      middle = end;
    }
  }
  for (std::size_t j = 0; j < kTogether; ++j) sum[j] += lanes[j].sum();
}

/// sum y_k; eight sums at a time.
double total(const double* y, std::size_t count) {
  constexpr std::size_t kLanes = 8;
  std::array<double, kLanes> sum{};
  std::size_t k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    for (std::size_t i = 0; i < kLanes; ++i) sum[i] += y[k + i];
  }
  double rest = 0.0;
  for (; k < count; ++k) rest += y[k];
  for (const double one : sum) rest += one;
  return rest;
}

/// Readings become the sum of what came so far less the mean: x from x_1 on, for x_0 is zero.
void integrate(std::vector<double>& readings) {
  const std::size_t chunks = (readings.size() + kChunk - 1) / kChunk;
  const auto size = [&](std::size_t chunk) { return std::min(kChunk, readings.size() - chunk * kChunk); };
  std::vector<double> sum(chunks);
  share_out(chunks, [&](std::size_t chunk) { sum[chunk] = total(readings.data() + chunk * kChunk, size(chunk)); });
  const double mean = total(sum.data(), chunks) / static_cast<double>(readings.size());
  std::vector<double> before(chunks);
  for (std::size_t chunk = 1; chunk < chunks; ++chunk)
    before[chunk] = before[chunk - 1] + (sum[chunk - 1] - mean * static_cast<double>(kChunk));
  share_out(chunks, [&](std::size_t chunk) {
    double integral = before[chunk];
    double* const reading = readings.data() + chunk * kChunk;
    for (std::size_t k = 0; k < size(chunk); ++k) reading[k] = integral += reading[k] - mean;
  });
}

/// Sums for every m that begin in one chunk of x.
void add_chunk(const std::vector<double>& x, const std::vector<std::size_t>& m, std::size_t chunk,
               std::vector<double>& sum) {
  const std::size_t n = x.size();
  const std::size_t end = std::min(n, (chunk + 1) * kChunk);
  for (std::size_t from = chunk * kChunk; from < end; from += kBlock) {
    const double* const first = x.data() + from;
    std::size_t j = 0;
    for (; j + kTogether <= m.size() && from + 2 * m[j + kTogether - 1] + kBlock <= n; j += kTogether) {
      std::array<const double*, kTogether + 2> at{first};
      for (std::size_t i = 0; i <= kTogether; ++i) at[i + 1] = first + (m[j] << i);
      add_squares_together(at, &sum[j]);
    }
    for (; j < m.size() && from + 2 * m[j] < n; ++j) {
      sum[j] += squares(first + 2 * m[j], first + m[j], first, std::min(kBlock, n - 2 * m[j] - from));
    }
  }
}

/// Degrees of freedom of eq. (1) from n points of x, by the noise that the slope of log sigma against log tau shows.
/// NIST SP 1065, table 5. White phase noise, of which a long tau would have as many as a short one, is believed only
/// where every shorter tau shows it too: @p steep.
double degrees_of_freedom(double slope, bool steep, double n, double m) {
  const double white_phase = (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m));
  const double white = (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * 4.0 * m * m / (4.0 * m * m + 5.0);
  const double flicker =
      m == 1.0 ? 2.0 * (n - 2.0) / (2.3 * n - 4.9) * (n - 2.0) : 5.0 * n * n / (4.0 * m * (n + 3.0 * m));
  const double walk =
      (n - 2.0) / m * ((n - 1.0) * (n - 1.0) - 3.0 * m * (n - 1.0) + 4.0 * m * m) / ((n - 3.0) * (n - 3.0));
  const double freedom = steep ? white_phase : slope < -0.25 ? white : slope < 0.25 ? flicker : walk;
  return std::max(freedom, 1.0);
}

/// min || W (A c - b) ||, c >= 0, by trying every set of terms: there are five at most.
template <int Terms>
Eigen::Matrix<double, Terms, 1> non_negative_fit(const Eigen::Matrix<double, Eigen::Dynamic, Terms>& A,
                                                 const Eigen::VectorXd& b, double& misfit) {
  using Vector = Eigen::Matrix<double, Terms, 1>;
  Vector best = Vector::Zero();
  misfit = b.squaredNorm();
  for (unsigned set = 1; set < (1U << static_cast<unsigned>(Terms)); ++set) {
    std::array<Eigen::Index, static_cast<std::size_t>(Terms)> column{};
    Eigen::Index count = 0;
    for (int i = 0; i < Terms; ++i) {
      if (((set >> i) & 1U) != 0) column[static_cast<std::size_t>(count++)] = i;
    }
    if (count > A.rows()) continue;
    Eigen::MatrixXd part(A.rows(), count);
    Eigen::VectorXd scale(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      part.col(i) = A.col(column[static_cast<std::size_t>(i)]);
      scale(i) = part.col(i).norm();
      part.col(i) /= scale(i);
    }
    const Eigen::VectorXd c = (part.transpose() * part).ldlt().solve(part.transpose() * b);
    if (!c.allFinite() || (c.array() < 0.0).any()) continue;
    const double error = (part * c - b).squaredNorm();
    if (!(error < misfit)) continue;
    misfit = error;
    best.setZero();
    for (Eigen::Index i = 0; i < count; ++i) best(column[static_cast<std::size_t>(i)]) = c(i) / scale(i);
  }
  return best;
}

/// -2 log of the likelihood of the points where the variances are @p model, up to a constant: each is chi-square.
double deviance(const std::vector<AllanPoint>& curve, const Eigen::VectorXd& model) {
  double sum = 0.0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double m = std::max(model(static_cast<Eigen::Index>(i)), 1e-300);
    sum += curve[i].freedom * (std::log(m) + curve[i].deviation * curve[i].deviation / m);
  }
  return sum;
}

/// Coefficients of the columns of @p shape, not negative, by weights of the model's own variance: those of the measured
/// one would believe most in what came out low by chance.
template <int Terms>
Eigen::Matrix<double, Terms, 1> most_likely(const std::vector<AllanPoint>& curve,
                                            const Eigen::Matrix<double, Eigen::Dynamic, Terms>& shape,
                                            Eigen::VectorXd& model) {
  constexpr int kRounds = 20;
  const auto rows = static_cast<Eigen::Index>(curve.size());
  Eigen::VectorXd variance(rows);
  for (Eigen::Index i = 0; i < rows; ++i) variance(i) = std::pow(curve[static_cast<std::size_t>(i)].deviation, 2.0);
  model = variance;
  Eigen::Matrix<double, Terms, 1> c;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, Eigen::Dynamic, Terms> A = shape;
    Eigen::VectorXd b(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double weight = std::sqrt(0.5 * curve[static_cast<std::size_t>(i)].freedom) / std::max(model(i), 1e-300);
      A.row(i) *= weight;
      b(i) = weight * variance(i);
    }
    double misfit = 0.0;
    c = non_negative_fit<Terms>(A, b, misfit);
    // where no term reaches, the next round needs a weight all the same
    model = (shape * c).cwiseMax(1e-3 * variance);
  }
  model = shape * c;
  return c;
}

double wander_shape(double tau, double T) {
  const double u = tau / T;
  // the bracket of eq. (3) is u^2 / 3 - ... for short taus, where it cancels
  const double bracket =
      u < 1e-3 ? u * u / 3.0 * (1.0 - 0.75 * u) : 1.0 - (3.0 - 4.0 * std::exp(-u) + std::exp(-2.0 * u)) / (2.0 * u);
  return 2.0 * T / tau * bracket;
}

}  // namespace

std::vector<AllanPoint> allan_deviation(std::vector<double> readings, double period) {
  integrate(readings);
  const std::vector<double>& x = readings;
  const std::size_t n = readings.size() + 1;
  std::vector<std::size_t> m;
  for (std::size_t step = 1; 2 * step < n; step *= 2) m.push_back(step);
  const std::size_t chunks = (x.size() + kChunk - 1) / kChunk;
  std::vector<std::vector<double>> part(chunks, std::vector<double>(m.size(), 0.0));
  share_out(chunks, [&](std::size_t chunk) { add_chunk(x, m, chunk, part[chunk]); });
  std::vector<double> sum(m.size());
  for (std::size_t j = 0; j < m.size(); ++j) {
    const double first = x[2 * m[j] - 1] - 2.0 * x[m[j] - 1];
    sum[j] = first * first;
    for (const std::vector<double>& one : part) sum[j] += one[j];
  }

  std::vector<AllanPoint> curve(m.size());
  for (std::size_t j = 0; j < m.size(); ++j) {
    const auto step = static_cast<double>(m[j]);
    // x is in readings, not in their integral: a period is left out on both sides
    curve[j].tau = step * period;
    curve[j].deviation = std::sqrt(sum[j] / (2.0 * static_cast<double>(n - 2 * m[j]))) / step;
  }
  bool steep = true;
  for (std::size_t j = 0; j < m.size(); ++j) {
    AllanPoint& point = curve[j];
    const std::size_t a = j == 0 ? 0 : j - 1;
    const std::size_t b = std::min(j + 1, m.size() - 1);
    const double slope = b > a && curve[a].deviation > 0.0 && curve[b].deviation > 0.0
                             ? std::log(curve[b].deviation / curve[a].deviation) / std::log(curve[b].tau / curve[a].tau)
                             : -0.5;
    steep = steep && slope < -0.75;
    point.freedom = degrees_of_freedom(slope, steep, static_cast<double>(n), static_cast<double>(m[j]));
    const double high = chi_square_quantile(point.freedom, 1.0);
    const double low = std::max(chi_square_quantile(point.freedom, -1.0), 1e-3 * point.freedom);
    point.low = point.deviation * std::sqrt(point.freedom / high);
    point.high = point.deviation * std::sqrt(point.freedom / low);
  }
  return curve;
}

NoiseTerms fit_noise_terms(const std::vector<AllanPoint>& curve) {
  const auto rows = static_cast<Eigen::Index>(curve.size());
  Eigen::Matrix<double, Eigen::Dynamic, 5> shape(rows, 5);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double tau = curve[static_cast<std::size_t>(i)].tau;
    shape.row(i) << 3.0 / (tau * tau), 1.0 / tau, 2.0 * std::log(2.0) / kPi, tau / 3.0, tau * tau / 2.0;
  }
  Eigen::VectorXd model;
  const Eigen::Matrix<double, 5, 1> c = most_likely<5>(curve, shape, model).cwiseSqrt();
  return {c(0), c(1), c(2), c(3), c(4)};
}

TriadNoise fit_sheet_noise(const std::vector<AllanPoint>& curve) {
  constexpr double kStep = 1.05;      // of the correlation times that are tried
  constexpr double kWorthIt = 9.21;   // deviance that a wander takes off: by chance one time in a hundred
  constexpr double kShortest = 50.0;  // samples: what is correlated for less is the shape of the white noise
  const auto rows = static_cast<Eigen::Index>(curve.size());
  Eigen::VectorXd model;
  Eigen::Matrix<double, Eigen::Dynamic, 1> white(rows, 1);
  for (Eigen::Index i = 0; i < rows; ++i) white(i) = 1.0 / curve[static_cast<std::size_t>(i)].tau;
  const double density = std::sqrt(most_likely<1>(curve, white, model)(0));
  TriadNoise best{density, 0.0, 1.0};
  double least = deviance(curve, model) - kWorthIt;
  for (double T = kShortest * curve.front().tau; T <= curve.back().tau; T *= kStep) {
    Eigen::Matrix<double, Eigen::Dynamic, 2> shape(rows, 2);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double tau = curve[static_cast<std::size_t>(i)].tau;
      shape.row(i) << 1.0 / tau, wander_shape(tau, T);
    }
    const Eigen::Vector2d c = most_likely<2>(curve, shape, model);
    const double now = deviance(curve, model);
    if (!(now < least) || !(c(1) > 0.0)) continue;
    least = now;
    best = {std::sqrt(c(0)), std::sqrt(c(1)), T};
  }
  return best;
}

}  // namespace trunnion::calibration
