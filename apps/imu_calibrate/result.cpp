// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "result.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "../terminal.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

constexpr double kQuiet = 0.5;  // reduced chi-square

/// Holds every entry against the limits of the run file.
void judge_limits(const io::RunFile& run, const calibration::Solution& solution, io::CalibrationFile& file) {
  for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
    const calibration::Parameter& p = solution.parameters[i];
    const io::EntryVerdict& limit = run.limits[static_cast<std::size_t>(p.kind)];
    if (!calibration::has_verdict(p)) continue;
    const auto at = static_cast<Eigen::Index>(i);
    const double value = solution.x(at) * p.in_unit;
    const double sigma = std::sqrt(solution.observability.covariance(at, at)) * p.in_unit;
    if (limit.value >= 0.0 && std::abs(value) > limit.value) {
      file.out_of_limits.push_back(p.name + ": " + figure(value, 4) + " " + p.unit + ", limit " +
                                   figure(limit.value, 4));
    }
    if (limit.sigma >= 0.0 && sigma > limit.sigma) {
      file.out_of_limits.push_back(p.name + ": sigma " + figure(sigma, 3) + " " + p.unit + ", limit " +
                                   figure(limit.sigma, 4));
    }
  }
  file.within_limits = file.out_of_limits.empty();
}

}  // namespace

std::vector<std::string> mounts_of(const io::RunFile& run) {
  std::vector<std::string> mounts;
  for (const io::RecordingFiles& files : run.recordings) {
    if (std::find(mounts.begin(), mounts.end(), files.mount) == mounts.end()) mounts.push_back(files.mount);
  }
  return mounts;
}

calibration::ModelTerms terms_of(const io::RunFile& run) {
  return {run.cubic, run.g_sensitivity, run.quadratic, run.asymmetry, run.size_effect, run.temperature};
}

calibration::TableSolveOptions table_options(const io::RunFile& run, const std::vector<std::string>& mounts) {
  calibration::TableSolveOptions options;
  options.terms = terms_of(run);
  options.refuse_above = run.refuse_above;
  options.bias_per_recording = run.bias_per_recording;
  options.estimate_clock_offset = run.estimate_clock_offset;
  options.clock_offset = run.clock_offset;
  options.noise_from_data = !run.sheet.has_noise;
  options.noise = run.sheet.noise;
  options.mount_names = mounts;
  return options;
}

io::CalibrationFile calibration_of(const io::RunFile& run, const calibration::Solution& solution,
                                   const RunInputs& inputs, const std::vector<std::string>& mounts) {
  if (!solution.observability.refused.empty()) {
    const std::string beyond = calibration::implausible(solution.parameters, solution.x);
    throw Error(ExitCode::kNumerics,
                calibration::describe(solution.observability) +
                    (beyond.empty() ? "" : "and no unit has these: look at units, signs, mounts first\n" + beyond));
  }
  io::CalibrationFile file;
  file.mounts = mounts;
  file.model = run.sheet.model;
  file.serial = run.serial;
  file.record = solution.record;
  file.record.fit.lost_records = inputs.losses.records;
  file.record.fit.lost_bytes = inputs.losses.bytes;
  file.gauge = solution.gauge;
  file.tool = tool_name();
  file.run = std::filesystem::path(run.path).filename().string();
  const std::filesystem::path folder = std::filesystem::path(run.path).parent_path();
  const auto near = [&](const std::string& path) {
    return std::filesystem::path(path).lexically_proximate(folder.empty() ? "." : folder).string();
  };
  for (const auto& [path, digest] : inputs.digests) file.inputs.emplace_back(near(path), digest);
  for (const std::string& path : {run.path, run.rig, run.sheet_path}) {
    if (!path.empty()) file.inputs.emplace_back(near(path), io::sha256(io::read_whole(path)));
  }
  judge_limits(run, solution, file);
  return file;
}

void print_calibration(const calibration::Solution& solution, const io::CalibrationFile& file, bool sheet_noise) {
  std::printf("%-44s %14s %12s  %s\n", "entry", "value", "1 sigma", "unit");
  for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
    const calibration::Parameter& p = solution.parameters[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(solution.observability.covariance(at, at)) * p.in_unit;
    const double value = solution.x(at) * p.in_unit;
    // as many digits as the sigma has to say
    const int decimals =
        sigma > 0.0 && std::isfinite(sigma) ? std::clamp(2 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9) : 3;
    std::printf("%-44s %14.*f %12.*f  %s\n", p.name.c_str(), decimals, value, decimals, sigma, p.unit.c_str());
  }
  const ThermalErrors<double>& thermal = file.record.value.unit.thermal;
  if (thermal.order() > 0)
    std::printf("temperature: about %s degC, from %s to %s\n", figure(thermal.reference, 4).c_str(),
                figure(thermal.lowest, 4).c_str(), figure(thermal.highest, 4).c_str());
  std::printf("gauge:");
  for (const std::string& g : file.gauge) std::printf(" %s", g.c_str());
  const FitFigures& fit = file.record.fit;
  std::printf(
      "\nfit: %lld samples, %lld windows, %lld outliers, %lld records and %lld bytes lost, reduced chi-square %.4f, %d "
      "iterations\n",
      fit.samples, fit.windows, fit.outliers, fit.lost_records, fit.lost_bytes, fit.reduced_chi_square, fit.iterations);
  if (sheet_noise && fit.reduced_chi_square < kQuiet) {
    std::printf("the data are quieter than the sheet says: every sigma is too large by some %s; leave its noise out\n",
                figure(1.0 / std::sqrt(fit.reduced_chi_square), 2).c_str());
  }
  std::printf("verdict: %s\n", file.within_limits ? "within limits" : "out of limits");
  for (const std::string& entry : file.out_of_limits) std::printf("  %s\n", entry.c_str());
}

}  // namespace trunnion::app
