// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/model_choice.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "table_problem.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBlock = 5.0;  // s
constexpr int kHeldOut = 5;     // every fifth block

struct Term {
  const char* name;
  bool ModelTerms::*chosen;
  int parameters;
};
constexpr std::array<Term, 3> kTerms = {{{"cubic", &ModelTerms::cubic, 3},
                                         {"g_sensitivity", &ModelTerms::g_sensitivity, 9},
                                         {"quadratic", &ModelTerms::quadratic, 3}}};

/// A fit, or why there is none.
struct Fit {
  std::optional<Solution> solution;
  double chi_square = kInfinity;
  std::string why;
};

Fit fit(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
        const TableSolveOptions& options) {
  Fit result;
  try {
    result.solution = solve_table(recordings, rig, site, options);
  } catch (const Error& e) {
    if (e.code() != ExitCode::kNumerics) throw;
    result.why = e.what();
    return result;
  }
  if (!result.solution->observability.refused.empty()) {
    result.why = describe(result.solution->observability);
    return result;
  }
  const FitFigures& figures = result.solution->record.fit;
  const double freedom = 6.0 * static_cast<double>(figures.windows) - static_cast<double>(result.solution->x.size());
  result.chi_square = figures.reduced_chi_square * std::max(1.0, freedom);
  return result;
}

/// The windows that are held out, or the others.
std::vector<TableRecording> part(const std::vector<TableRecording>& recordings, bool held_out) {
  std::vector<TableRecording> some = recordings;
  for (TableRecording& recording : some) {
    std::vector<ObservationWindow> kept;
    for (const ObservationWindow& window : recording.data.windows) {
      const bool out = static_cast<long long>(std::floor(window.t / kBlock)) % kHeldOut == kHeldOut - 1;
      if (out == held_out) kept.push_back(window);
    }
    recording.data.windows = std::move(kept);
  }
  return some;
}

/// Chi-square of windows that a fit has not seen.
double unseen(const std::vector<TableRecording>& held_out, const Rig& rig, const Site& site,
              const TableSolveOptions& options, const Solution& solution) {
  double chi_square = 0.0;
  std::vector<int> mounts;
  mounts.reserve(held_out.size());
  for (const TableRecording& recording : held_out) mounts.push_back(recording.mount);
  const Layout layout(layout_request(options, rig, mounts, 1.0));
  for (std::size_t r = 0; r < held_out.size(); ++r) {
    RecordingModel model(held_out[r], r, rig, site, layout, solution.record.value.clock_offset);
    model.set_noise(solution.noise);
    chi_square += model.evaluate(solution.record.value, nullptr);
  }
  return chi_square;
}

}  // namespace

ModelChoice choose_model(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
                         TableSolveOptions options) {
  ModelChoice choice;
  choice.terms = {false, false, false};
  options.terms = choice.terms;
  Fit best = fit(recordings, rig, site, options);
  std::string last_why = best.why;
  const std::vector<TableRecording> seen = part(recordings, false);
  const std::vector<TableRecording> held_out = part(recordings, true);
  double residuals = 0.0;
  for (const TableRecording& recording : recordings)
    residuals += 6.0 * static_cast<double>(recording.data.windows.size());
  std::array<bool, kTerms.size()> out{};
  for (;;) {
    std::optional<std::size_t> next;
    Fit next_fit;
    double most = 0.0;
    std::array<TermVerdict, kTerms.size()> now;
    for (std::size_t i = 0; i < kTerms.size(); ++i) {
      if (choice.terms.*kTerms[i].chosen || out[i]) continue;
      if (options.progress) options.progress(std::string("trying ") + kTerms[i].name);
      TableSolveOptions with = options;
      with.progress = nullptr;
      with.terms = choice.terms;
      with.terms.*kTerms[i].chosen = true;
      Fit one = fit(recordings, rig, site, with);
      TermVerdict& verdict = now[i];
      verdict.term = kTerms[i].name;
      verdict.parameters = kTerms[i].parameters;
      verdict.asked = kTerms[i].parameters * std::log(residuals);
      verdict.why = one.why;
      if (!one.solution) {
        last_why = one.why;
        continue;
      }
      verdict.gain = best.solution ? best.chi_square - one.chi_square : kInfinity;
      // where there is no fit without it, the best of those with one
      const double worth = best.solution ? verdict.gain / verdict.asked : 2.0 + residuals / one.chi_square;
      if (one.chi_square == kInfinity || !(worth > std::max(1.0, most))) continue;
      most = worth;
      next = i;
      next_fit = std::move(one);
    }
    if (!next) {
      for (const TermVerdict& verdict : now) {
        if (!verdict.term.empty()) choice.verdicts.push_back(verdict);
      }
      break;
    }
    TermVerdict verdict = now[*next];
    TableSolveOptions with = options;
    with.progress = nullptr;
    with.terms = choice.terms;
    TableSolveOptions without = with;
    with.terms.*kTerms[*next].chosen = true;
    const Fit fit_with = fit(seen, rig, site, with);
    const Fit fit_without = fit(seen, rig, site, without);
    if (fit_with.solution && fit_without.solution)
      verdict.held_out_gain = unseen(held_out, rig, site, without, *fit_without.solution) -
                              unseen(held_out, rig, site, with, *fit_with.solution);
    else
      verdict.held_out_gain = fit_with.solution ? kInfinity : -kInfinity;
    verdict.taken = verdict.held_out_gain > 0.0;
    choice.verdicts.push_back(verdict);
    if (verdict.taken) {
      choice.terms.*kTerms[*next].chosen = true;
      best = std::move(next_fit);
      out.fill(false);  // beside this one another may be worth it after all
    } else {
      out[*next] = true;
    }
  }
  if (!best.solution) throw Error(ExitCode::kNumerics, last_why);
  choice.solution = std::move(*best.solution);
  return choice;
}

}  // namespace trunnion::calibration
