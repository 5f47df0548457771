// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "recording_model.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <type_traits>

namespace trunnion::calibration {
namespace {

constexpr double kWindowMargin =
    0.25;                           // s of encoder course that a window needs on either side: room for the clock offset
constexpr double kSlowRate = 0.02;  // rad/s: no lever arm adds anything
constexpr double kTurningRate = 0.05;  // rad/s
constexpr double kRestLength = 10.0;   // s, of a rest
constexpr double kRestRate = 2e-4;     // rad/s: a window slower than this is one node

// What a window depends on through the rig: the places of the derivatives in a Jet and in a row.
enum RigPlace : int {
  kTilt = 0,
  kHeading = 2,
  kNonorthogonality = 3,
  kEccentricity = 4,
  kOffset = 8,
  kLever = 9,
  kGravity = 12,
  kRigPlaces = 13
};  // of the rig
constexpr int kMountPlace = kRigPlaces;
constexpr int kSharedPlaces = kRigPlaces + 3;
// ... and through the sensor of the row
enum OwnPlace : int { kBias = 0, kMatrix = 1, kHigherOrder = 4, kAsymmetry = 5, kForceRow = 6, kOwnPlaces = 9 };
// ... and, where there are terms of temperature, five of its bias and five of its scale. The residual is last.
constexpr int kThermalPlace = kOwnPlaces + kSharedPlaces;
constexpr int kOrders = ThermalErrors<double>::kMostOrder;

using Jet = ceres::Jet<double, kRigPlaces>;

// The derivatives of a window's mean need no more than Gauss-Legendre of order two: they err by (w T)^4 / 4320, 1e-8
// for 50 deg/s in 0.1 s.
constexpr double kDerivativeNode = 0.57735026918962576451;

/// J^T J of one sensor's rows, gathered by blocks: one matrix product is many times cheaper than a rank-one update a
/// row.
template <int kRow>
class NormalMatrix {
 public:
  using Total = Eigen::Matrix<double, kRow, kRow>;
  void add(const Eigen::Matrix<double, kRow, 1>& row) {
    block_.col(rows_++) = row;
    if (rows_ == kBlock) flush();
  }
  const Total& total() {
    flush();
    return total_;
  }

 private:
  static constexpr int kBlock = 64;
  void flush() {
    total_.noalias() += block_.leftCols(rows_) * block_.leftCols(rows_).transpose();
    rows_ = 0;
  }
  Eigen::Matrix<double, kRow, kBlock> block_;
  Total total_ = Total::Zero();
  Eigen::Index rows_ = 0;
};
using Shared = Eigen::Matrix<double, 3, kSharedPlaces>;

template <class T>
T variable(double value, int place) {
  if constexpr (std::is_same_v<T, double>) {
    (void)place;
    return value;
  } else {
    return T(value, place);
  }
}

/// The table and the lever arm at @p values; as Jets, with the derivatives to their unknowns.
template <class T>
struct Rigged {
  TwoAxisTable<T> table;
  Vec3<T> lever;
};

template <class T>
Rigged<T> rigged(const Rig& rig, const Site& site, const CalibrationValues& values, std::size_t mount) {
  TwoAxisErrors<T> errors;
  errors.tilt_x = variable<T>(values.rig.tilt_x, kTilt);
  errors.tilt_y = variable<T>(values.rig.tilt_y, kTilt + 1);
  errors.heading = variable<T>(values.rig.heading, kHeading);
  errors.nonorthogonality = variable<T>(values.rig.nonorthogonality, kNonorthogonality);
  int place = kEccentricity;
  for (std::size_t a = 0; a < errors.eccentricity.size(); ++a) {
    errors.eccentricity[a].cosine = variable<T>(values.rig.eccentricity[a].cosine, place++);
    errors.eccentricity[a].sine = variable<T>(values.rig.eccentricity[a].sine, place++);
  }
  Vec3<T> lever;
  for (int i = 0; i < 3; ++i) lever(i) = variable<T>(values.lever_arm[mount](i), kLever + i);
  return {TwoAxisTable<T>(rig.geometry, errors, site.latitude, variable<T>(values.gravity, kGravity)), lever};
}

}  // namespace

/// The rig at one estimate.
struct RecordingModel::Model {
  Rigged<double> plain;
  std::optional<Rigged<Jet>> derived;
  Mat3<double> C_bp;
  std::array<Mat3<double>, 3> dC_bp;  ///< to the mount's errors
};

/// Mean input of a window in the case, its sizes, squares and cubes, and their derivatives.
struct RecordingModel::WindowInput {
  Vec3<double> w, f, w3, f2, w_size, f_size;
  Mat3<double> of_place;  ///< [w' x] + [w x]^2: force for a place in the case, where there is a size effect
  Shared dw, df, dw3, df2;
};

RecordingModel::RecordingModel(const TableRecording& recording, std::size_t index, const Rig& rig, const Site& site,
                               const Layout& layout, double clock_offset)
    : recording_(recording), index_(index), first_offset_(clock_offset), rig_(rig), site_(site), layout_(layout) {
  refresh();
}

void RecordingModel::refresh() {
  const CompressedRecording& data = recording_.data;
  for (; examined_ < data.windows.size(); ++examined_) {
    const double margin = data.windows[examined_].half_width + kWindowMargin;
    const double t = data.windows[examined_].t - first_offset_;
    if (t + margin > data.course.end()) break;  // the encoders are not there yet
    if (layout_.thermal_order > 0 && !layout_.temperature.holds(data.windows[examined_].temperature)) continue;
    if (data.course.covers(t - margin, t + margin)) usable_.push_back(examined_);
  }
  inflation_.resize(usable_.size(), {1, 1, 1, 1, 1, 1});
  if (usable_.empty()) return;
  // an end of a window is known from the readings of about one knot interval
  const double sigma = data.course.reading_sigma() * std::sqrt(data.course.period() / data.course.knot_spacing());
  const double width = 2.0 * window(0).half_width;
  encoder_variance_ = 2.0 * sigma * sigma / (width * width);
  // a reading stays where it is throughout a rest: its error is one draw for all windows of some ten seconds
  angle_variance_ = data.course.reading_sigma() * data.course.reading_sigma() * kRestLength / width;
}

double RecordingModel::evaluate(const CalibrationValues& values, Eigen::MatrixXd* normal, int power) const {
  const auto nothing = [](std::size_t, int, double, double) {};
  if (normal == nullptr) return run<Rows::kNone>(values, nullptr, power, nothing);
  return layout_.thermal_order > 0 ? run<Rows::kThermal>(values, normal, power, nothing)
                                   : run<Rows::kPlain>(values, normal, power, nothing);
}

void RecordingModel::residuals(const CalibrationValues& values, const Visit& visit) const {
  run<Rows::kNone>(values, nullptr, 1, visit);
}

/// White measurement variance of a row, before robust inflation.
double RecordingModel::variance(std::size_t k, int row, bool moving) const {
  const double time = window(k).samples * recording_.data.figures.period;
  const double density = row < 3 ? noise_.gyro.density : noise_.accel.density;
  const double white = density * density / time;
  if (row < 3) return white + (moving ? encoder_variance_ : 0.0);
  return white + site_.gravity * site_.gravity * angle_variance_;
}

double RecordingModel::force_at_rest() const {
  std::vector<double> force;
  for (std::size_t k = 0; k < usable_.size(); ++k) {
    const auto reading = recording_.data.course.at(window(k).t);
    if (std::abs(reading[0].rate) + std::abs(reading[1].rate) < kSlowRate) force.push_back(window(k).mean.f.norm());
  }
  if (force.empty()) return site_.gravity;
  const auto middle = force.begin() + static_cast<std::ptrdiff_t>(force.size() / 2);
  std::nth_element(force.begin(), middle, force.end());
  return *middle;
}

double RecordingModel::rate_ratio() const {
  Vec3<double> bias = Vec3<double>::Zero();  // where the table stands still
  int still = 0;
  for (std::size_t k = 0; k < usable_.size(); ++k) {
    const auto reading = recording_.data.course.at(window(k).t);
    if (std::abs(reading[0].rate) + std::abs(reading[1].rate) >= kSlowRate) continue;
    bias += (window(k).mean.w - bias) / ++still;
  }
  std::vector<double> ratio;
  for (std::size_t k = 0; k < usable_.size(); ++k) {
    const auto reading = recording_.data.course.at(window(k).t);
    const double rate = std::hypot(reading[0].rate, reading[1].rate);
    if (rate > kTurningRate) ratio.push_back((window(k).mean.w - bias).norm() / rate);
  }
  if (ratio.empty() || still == 0) return 1.0;
  const auto middle = ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 2);
  std::nth_element(ratio.begin(), middle, ratio.end());
  return *middle;
}

void RecordingModel::rest_noise(std::vector<double>& gyro, std::vector<double>& accel) const {
  for (std::size_t k = 1; k < usable_.size(); ++k) {
    const ObservationWindow& a = window(k - 1);
    const ObservationWindow& b = window(k);
    if (b.t - a.t > 3.0 * b.half_width) continue;
    const auto from = recording_.data.course.at(a.t - a.half_width);
    const auto to = recording_.data.course.at(b.t + b.half_width);
    if (std::abs(to[0].angle - from[0].angle) + std::abs(to[1].angle - from[1].angle) > 1e-4) continue;
    const double time = std::sqrt(recording_.data.figures.period / (1.0 / a.samples + 1.0 / b.samples));
    for (int i = 0; i < 3; ++i) {
      gyro.push_back(std::abs(b.mean.w(i) - a.mean.w(i)) * time);
      accel.push_back(std::abs(b.mean.f(i) - a.mean.f(i)) * time);
    }
  }
}

template <class T>
AxisMotion<T> RecordingModel::motion(const CourseValue& reading) const {
  if constexpr (std::is_same_v<T, double>) {
    return {reading.angle, reading.rate, reading.acceleration};
  } else {
    // the encoder is read at t - offset
    AxisMotion<T> m{T(reading.angle), T(reading.rate), T(reading.acceleration)};
    m.angle.v(kOffset) = -reading.rate;
    m.rate.v(kOffset) = -reading.acceleration;
    m.acceleration.v(kOffset) = -reading.jerk;
    return m;
  }
}

/// A pass over the windows at one estimate, which may go on when there are more of them.
template <RecordingModel::Rows kRows>
struct RecordingModel::Pass {
  static constexpr bool kWithRows = kRows != Rows::kNone;
  static constexpr int kRow = static_cast<int>(kRows);
  using Row = Eigen::Matrix<double, kRow, 1>;

  Pass(const RecordingModel& of, const CalibrationValues& at, int weight_power = 1)
      : values(at),
        model{rigged<double>(of.rig_, of.site_, at, of.mount()), {}, {}, {}},
        row_normal(kWithRows ? 6 : 0),
        power(weight_power) {
    const std::size_t mount = of.mount();
    if constexpr (kWithRows) model.derived = rigged<Jet>(of.rig_, of.site_, at, mount);
    // C_bp = Exp(-e) C_bp(nominal), and its derivatives to e
    using MountJet = ceres::Jet<double, 3>;
    Vec3<MountJet> minus_e;
    for (int i = 0; i < 3; ++i) minus_e(i) = -MountJet(at.mount_error[mount](i), i);
    const Mat3<MountJet> turned =
        rotation_exp<MountJet>(minus_e) * of.rig_.mount[mount].C_pb.transpose().template cast<MountJet>();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        model.C_bp(i, j) = turned(i, j).a;
        for (std::size_t e = 0; e < 3; ++e) model.dC_bp[e](i, j) = turned(i, j).v(static_cast<Eigen::Index>(e));
      }
    }
    whitening.reserve(6);
    for (int row = 0; row < 6; ++row) whitening.emplace_back(row < 3 ? of.noise_.gyro : of.noise_.accel, Row::Zero());
  }

  CalibrationValues values;
  Model model;
  std::vector<NormalMatrix<kRow>> row_normal;
  std::vector<Whitening<Row>> whitening;
  int power;
  std::size_t next = 0;  // window
  double cost = 0.0;
};

template <RecordingModel::Rows kRows, class VisitRow>
double RecordingModel::run(const CalibrationValues& values, Eigen::MatrixXd* normal, int power,
                           VisitRow&& visit) const {
  Pass<kRows> pass(*this, values, power);
  advance(pass, visit);
  if constexpr (kRows != Rows::kNone) scatter(pass, *normal);
  return pass.cost;
}

RecordingModel::Linearisation::Linearisation(const RecordingModel& model, const CalibrationValues& values)
    : model_(&model), pass_(std::make_unique<Pass<Rows::kPlain>>(model, values)) {}
RecordingModel::Linearisation::Linearisation(Linearisation&&) noexcept = default;
RecordingModel::Linearisation::~Linearisation() = default;

void RecordingModel::Linearisation::extend(const Visit& visit) { model_->advance(*pass_, visit); }

void RecordingModel::Linearisation::add_to(Eigen::MatrixXd& normal) { model_->scatter(*pass_, normal); }

/// Takes the windows from the pass's next one on.
template <RecordingModel::Rows kRows, class VisitRow>
void RecordingModel::advance(Pass<kRows>& pass, VisitRow&& visit) const {
  constexpr bool kWithRows = kRows != Rows::kNone;
  const CalibrationValues& values = pass.values;
  const InertialUnit<double>& unit = values.unit;
  Mat3<double> K_g = unit.gyro.matrix();
  Mat3<double> K_a = unit.accel.matrix();
  Vec3<double> bias_g = values.recording_bias[index_].w;
  Vec3<double> bias_a = values.recording_bias[index_].f;
  const bool has_places = layout_.accel_place >= 0 || !unit.accel_place.isZero(0.0);
  double t = 0.0;  // temperature less T_0
  WindowInput in;
  in.of_place.setZero();
  for (; pass.next < usable_.size(); pass.next += stride_) {
    const std::size_t k = pass.next;
    const ObservationWindow& window = this->window(k);
    const bool moving = window_input<kWithRows>(pass.model, window, values.clock_offset, has_places, in);
    if (layout_.thermal_order > 0) {
      const InertialSample<double> bias = unit.thermal.at(window.temperature, unit.thermal.bias);
      const InertialSample<double> scale = unit.thermal.at(window.temperature, unit.thermal.scale);
      bias_g = values.recording_bias[index_].w + bias.w;
      bias_a = values.recording_bias[index_].f + bias.f;
      K_g.diagonal() = unit.gyro.matrix().diagonal() + scale.w;
      K_a.diagonal() = unit.accel.matrix().diagonal() + scale.f;
      t = window.temperature - unit.thermal.reference;
    }
    const Mat3<double> at_place = in.of_place * unit.accel_place;  // a column an accelerometer
    const Vec3<double> r_g =
        window.mean.w - (K_g * in.w + bias_g + unit.gyro.cubic.cwiseProduct(in.w3) +
                         0.5 * unit.gyro.asymmetry.cwiseProduct(in.w_size) + unit.g_sensitivity * in.f);
    const Vec3<double> r_a =
        window.mean.f - (K_a * in.f + (K_a * at_place).diagonal() + bias_a + unit.accel.quadratic.cwiseProduct(in.f2) +
                         0.5 * unit.accel.asymmetry.cwiseProduct(in.f_size));
    Shared dr_g;
    Shared dr_a;
    if constexpr (kWithRows) {
      // of asymmetry and size effect, which are small, what the rig's errors change is smaller still
      dr_g.noalias() = -(K_g * in.dw + unit.g_sensitivity * in.df);
      dr_g -= unit.gyro.cubic.asDiagonal() * in.dw3;
      dr_a.noalias() = -(K_a * in.df);
      dr_a -= unit.accel.quadratic.asDiagonal() * in.df2;
    }
    for (int row = 0; row < 6; ++row) {
      const int i = row % 3;
      const bool gyro = row < 3;
      auto& filter = pass.whitening[static_cast<std::size_t>(row)];
      const double inflation = static_cast<double>(inflation_[k][static_cast<std::size_t>(row)]);
      filter.predict(window.t, variance(k, row, moving) * inflation);
      const double residual = gyro ? r_g(i) : r_a(i);
      const double weight = weights_.empty() ? 1.0 : std::pow(static_cast<double>(weights_[k]), pass.power);
      double innovation = 0.0;
      if constexpr (kWithRows) {
        typename Pass<kRows>::Row v;
        v(kBias) = -1.0;
        v.template segment<3>(kMatrix) = gyro ? Vec3<double>(-in.w) : Vec3<double>(-(in.f + at_place.col(i)));
        v(kHigherOrder) = gyro ? -in.w3(i) : -in.f2(i);
        v(kAsymmetry) = -0.5 * (gyro ? in.w_size(i) : in.f_size(i));
        v.template segment<3>(kForceRow) =
            gyro ? Vec3<double>(-in.f) : Vec3<double>(-(K_a.row(i) * in.of_place).transpose());
        v.template segment<kSharedPlaces>(kOwnPlaces) = gyro ? dr_g.row(i).transpose() : dr_a.row(i).transpose();
        if constexpr (kRows == Rows::kThermal) {
          double power = 1.0;
          for (int order = 0; order < kOrders; ++order) {
            power *= t;
            v(kThermalPlace + order) = -power;
            v(kThermalPlace + kOrders + order) = -power * (gyro ? in.w(i) : in.f(i) + at_place(i, i));
          }
        }
        constexpr int kResidual = Pass<kRows>::kRow - 1;
        v(kResidual) = residual;
        const auto e = filter.innovate(v);
        innovation = e(kResidual);
        pass.row_normal[static_cast<std::size_t>(row)].add(weights_.empty() ? e : e * std::sqrt(weight));
      } else {
        innovation = filter.innovate(Eigen::Matrix<double, 1, 1>(residual))(0);
      }
      pass.cost += weight * innovation * innovation;
      visit(k, row, residual, innovation);
    }
  }
}

/// Mean input over the window's samples, and its derivatives. @return whether the rig moves in it
template <bool kWithRows>
bool RecordingModel::window_input(const Model& model, const ObservationWindow& window, double offset, bool has_places,
                                  WindowInput& in) const {
  const EncoderCourse& course = recording_.data.course;
  std::array<std::array<CourseValue, 2>, kWindowNodes> reading;
  bool moving = false;
  for (std::size_t n = 0; n < kWindowNodes; ++n) {
    reading[n] = course.at(window.t - offset + window.half_width * kNodeAbscissa[n]);
    moving = moving || std::abs(reading[n][0].rate) + std::abs(reading[n][1].rate) > kRestRate;
  }
  std::size_t nodes = kWindowNodes;
  std::array<double, kWindowNodes> weight = window.weight;
  if (!moving) {
    // linear over the window: the mean of the readings stands for them all
    std::array<CourseValue, 2> mean;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      for (std::size_t n = 0; n < kWindowNodes; ++n) {
        mean[axis].angle += weight[n] * reading[n][axis].angle;
        mean[axis].rate += weight[n] * reading[n][axis].rate;
        mean[axis].acceleration += weight[n] * reading[n][axis].acceleration;
        mean[axis].jerk += weight[n] * reading[n][axis].jerk;
      }
    }
    reading[0] = mean;
    weight[0] = 1.0;
    nodes = 1;
  }
  in.w.setZero();
  in.f.setZero();
  in.w3.setZero();
  in.f2.setZero();
  in.w_size.setZero();
  in.f_size.setZero();
  in.of_place.setZero();
  for (std::size_t n = 0; n < nodes; ++n) {
    const InertialSample<double> input =
        model.plain.table.input(motion<double>(reading[n][0]), motion<double>(reading[n][1]), model.plain.lever);
    const Vec3<double> w = model.C_bp * input.w;
    const Vec3<double> f = model.C_bp * input.f;
    in.w += weight[n] * w;
    in.f += weight[n] * f;
    in.w3 += weight[n] * w.cwiseProduct(w).cwiseProduct(w);
    in.f2 += weight[n] * f.cwiseProduct(f);
    in.w_size += weight[n] * w.cwiseAbs();
    in.f_size += weight[n] * f.cwiseAbs();
    for (int i = 0; has_places && i < 3; ++i) {
      // the force is linear in the lever arm
      const Vec3<double> farther = model.plain.lever + Vec3<double>(model.C_bp.row(i).transpose());
      const InertialSample<double> there =
          model.plain.table.input(motion<double>(reading[n][0]), motion<double>(reading[n][1]), farther);
      in.of_place.col(i) += weight[n] * (model.C_bp * (there.f - input.f));
    }
  }
  if constexpr (kWithRows) {
    in.dw.setZero();
    in.df.setZero();
    in.dw3.setZero();
    in.df2.setZero();
    if (moving) {
      for (const double node : {-kDerivativeNode, kDerivativeNode}) {
        add_derivatives(model, course.at(window.t - offset + window.half_width * node), 0.5, in);
      }
    } else {
      add_derivatives(model, reading[0], 1.0, in);
    }
  }
  return moving;
}

void RecordingModel::add_derivatives(const Model& model, const std::array<CourseValue, 2>& reading, double weight,
                                     WindowInput& in) const {
  const InertialSample<Jet> input =
      model.derived->table.input(motion<Jet>(reading[0]), motion<Jet>(reading[1]), model.derived->lever);
  Eigen::Matrix<double, 3, kRigPlaces> dw_p;
  Eigen::Matrix<double, 3, kRigPlaces> df_p;
  Vec3<double> w_p;
  Vec3<double> f_p;
  for (int i = 0; i < 3; ++i) {
    w_p(i) = input.w(i).a;
    f_p(i) = input.f(i).a;
    dw_p.row(i) = input.w(i).v.transpose();
    df_p.row(i) = input.f(i).v.transpose();
  }
  Shared dw;
  Shared df;
  dw.leftCols<kRigPlaces>().noalias() = model.C_bp * dw_p;
  df.leftCols<kRigPlaces>().noalias() = model.C_bp * df_p;
  for (int e = 0; e < 3; ++e) {
    dw.col(kMountPlace + e).noalias() = model.dC_bp[static_cast<std::size_t>(e)] * w_p;
    df.col(kMountPlace + e).noalias() = model.dC_bp[static_cast<std::size_t>(e)] * f_p;
  }
  const Vec3<double> w = model.C_bp * w_p;
  const Vec3<double> f = model.C_bp * f_p;
  in.dw += weight * dw;
  in.df += weight * df;
  in.dw3 += (3.0 * weight * w.cwiseProduct(w)).asDiagonal() * dw;
  in.df2 += (2.0 * weight * f).asDiagonal() * df;
}

/// Adds the normal matrices of the sensors to that of all unknowns.
template <RecordingModel::Rows kRows>
void RecordingModel::scatter(Pass<kRows>& pass, Eigen::MatrixXd& into) const {
  for (int row = 0; row < 6; ++row) scatter_row(row, pass.row_normal[static_cast<std::size_t>(row)].total(), into);
}

template <class RowNormal>
void RecordingModel::scatter_row(int row, const RowNormal& normal, Eigen::MatrixXd& into) const {
  constexpr int kRow = RowNormal::RowsAtCompileTime;
  std::array<int, static_cast<std::size_t>(kRow)> place;
  place.fill(-1);
  const int i = row % 3;
  const bool gyro = row < 3;
  const std::size_t r = index_;
  const auto m = static_cast<std::size_t>(recording_.mount);
  place[kBias] = (gyro ? layout_.gyro_bias[r] : layout_.accel_bias[r]) + i;
  for (int j = 0; j < 3; ++j) {
    place[static_cast<std::size_t>(kMatrix + j)] = gyro ? layout_.gyro_matrix + 3 * i + j : layout_.accel_matrix[i][j];
    if (gyro && layout_.g_sensitivity >= 0)
      place[static_cast<std::size_t>(kForceRow + j)] = layout_.g_sensitivity + 3 * i + j;
    if (!gyro && layout_.accel_place >= 0 && i > 0)
      place[static_cast<std::size_t>(kForceRow + j)] = layout_.accel_place + 3 * (i - 1) + j;
  }
  const int asymmetry = gyro ? layout_.gyro_asymmetry : layout_.accel_asymmetry;
  if (asymmetry >= 0) place[kAsymmetry] = asymmetry + i;
  if constexpr (kRow == static_cast<int>(Rows::kThermal)) {
    for (int k = 0; k < layout_.thermal_order; ++k) {
      const int bias = layout_.thermal + 12 * k + row;
      place[static_cast<std::size_t>(kThermalPlace + k)] = bias;
      place[static_cast<std::size_t>(kThermalPlace + kOrders + k)] = bias + 6;
    }
  }
  const int higher = gyro ? layout_.gyro_cubic : layout_.accel_quadratic;
  if (higher >= 0) place[kHigherOrder] = higher + i;
  const auto shared = [&](int at, int first, int count) {
    for (int j = 0; first >= 0 && j < count; ++j) place[static_cast<std::size_t>(kOwnPlaces + at + j)] = first + j;
  };
  shared(kTilt, layout_.tilt, 2);
  shared(kHeading, layout_.heading, 1);
  shared(kNonorthogonality, layout_.nonorthogonality, 1);
  shared(kEccentricity, layout_.eccentricity, 4);
  shared(kOffset, layout_.clock_offset, 1);
  shared(kLever, layout_.lever_arm[m], 3);
  shared(kGravity, layout_.gravity, 1);
  shared(kMountPlace, layout_.mount_error[m], 3);
  place[kRow - 1] = layout_.size();
  for (int a = 0; a < kRow; ++a) {
    for (int b = 0; b <= a; ++b) {
      const int pa = place[static_cast<std::size_t>(a)];
      const int pb = place[static_cast<std::size_t>(b)];
      if (pa < 0 || pb < 0) continue;
      into(pa, pb) += normal(a, b);
      if (pa != pb) into(pb, pa) += normal(a, b);
    }
  }
}

}  // namespace trunnion::calibration
