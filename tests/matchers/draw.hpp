// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Random numbers, vectors and matrices for identities that hold for every input.

#pragma once

#include <random>

#include "trunnion/core/linear.hpp"

namespace trunnion {

/// Uniform between -size and size.
class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double operator()(double size) { return size * uniform_(engine_); }
  Vec3<double> vector(double size) {
    Vec3<double> v;
    for (int i = 0; i < 3; ++i) v(i) = (*this)(size);
    return v;
  }
  Mat3<double> matrix(double size) {
    Mat3<double> M;
    for (int i = 0; i < 9; ++i) M(i / 3, i % 3) = (*this)(size);
    return M;
  }

 private:
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

}  // namespace trunnion
