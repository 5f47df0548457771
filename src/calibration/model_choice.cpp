// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/model_choice.hpp"

#include <algorithm>
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

/// A model with one term more.
struct Candidate {
  std::string name;
  ModelTerms terms;
  int parameters = 0;
};

std::vector<Candidate> candidates(const ModelTerms& terms, bool has_temperature) {
  struct Term {
    const char* name;
    bool ModelTerms::*chosen;
    int parameters;
  };
  constexpr std::array<Term, 5> kTerms = {{{"cubic", &ModelTerms::cubic, 3},
                                           {"g_sensitivity", &ModelTerms::g_sensitivity, 9},
                                           {"quadratic", &ModelTerms::quadratic, 3},
                                           {"asymmetry", &ModelTerms::asymmetry, 6},
                                           {"size_effect", &ModelTerms::size_effect, 6}}};
  std::vector<Candidate> all;
  for (const Term& term : kTerms) {
    if (terms.*term.chosen) continue;
    all.push_back({term.name, terms, term.parameters});
    all.back().terms.*term.chosen = true;
  }
  // a polynomial may lack one order and have the next
  for (int order = terms.temperature + 1; has_temperature && order <= ThermalErrors<double>::kMostOrder; ++order) {
    all.push_back({"temperature: " + std::to_string(order), terms, 12 * (order - terms.temperature)});
    all.back().terms.temperature = order;
  }
  return all;
}

/// A fit, or why there is none.
struct Fit {
  std::optional<Solution> solution;
  double chi_square = kInfinity;
  std::string why;
  ExitCode code = ExitCode::kNumerics;
};

Fit fit(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
        const TableSolveOptions& options) {
  Fit result;
  try {
    result.solution = solve_table(recordings, rig, site, options);
  } catch (const Error& e) {
    if (e.code() != ExitCode::kNumerics && e.code() != ExitCode::kInput) throw;
    result.why = e.what();
    result.code = e.code();
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
              const TableSolveOptions& options, const TemperatureRange& temperature, const Solution& solution) {
  double chi_square = 0.0;
  std::vector<int> mounts;
  mounts.reserve(held_out.size());
  for (const TableRecording& recording : held_out) mounts.push_back(recording.mount);
  LayoutRequest request = layout_request(options, rig, mounts, 1.0);
  request.temperature = temperature;
  const Layout layout(request);
  for (std::size_t r = 0; r < held_out.size(); ++r) {
    RecordingModel model(held_out[r], r, rig, site, layout, solution.record.value.clock_offset);
    model.set_noise(solution.noise);
    chi_square += model.evaluate(solution.record.value, nullptr);
  }
  return chi_square;
}

}  // namespace

ModelChoice choose_model(const std::vector<TableRecording>& all_recordings, const Rig& rig, const Site& site,
                         TableSolveOptions options) {
  const TemperatureRange temperature = range_of(all_recordings);
  const std::string without = why_no_temperature(all_recordings, temperature);
  const bool has_temperature = without.empty();
  std::vector<TableRecording> with_temperature;
  if (has_temperature) {
    // models with and without terms of temperature are held against the same windows
    with_temperature = all_recordings;
    for (TableRecording& recording : with_temperature) {
      auto& windows = recording.data.windows;
      windows.erase(std::remove_if(windows.begin(), windows.end(),
                                   [&](const ObservationWindow& w) { return !temperature.holds(w.temperature); }),
                    windows.end());
    }
  }
  const std::vector<TableRecording>& recordings = has_temperature ? with_temperature : all_recordings;
  const auto with_terms = [&](const ModelTerms& terms) {
    TableSolveOptions with = options;
    with.progress = nullptr;
    with.even_temperatures = false;  // likelihoods of one and the same noise
    with.terms = terms;
    return with;
  };
  ModelChoice choice;
  choice.terms = {false, false};
  Fit best = fit(recordings, rig, site, with_terms(choice.terms));
  std::string last_why = best.why;
  ExitCode last_code = best.code;
  const std::vector<TableRecording> seen = part(recordings, false);
  const std::vector<TableRecording> held_out = part(recordings, true);
  double residuals = 0.0;
  for (const TableRecording& recording : recordings)
    residuals += 6.0 * static_cast<double>(recording.data.windows.size());
  std::vector<std::string> out;  // what the held-out windows refused
  for (;;) {
    std::optional<Candidate> next;
    Fit next_fit;
    double most = 0.0;
    TermVerdict next_verdict;
    std::vector<TermVerdict> others;
    for (const Candidate& candidate : candidates(choice.terms, has_temperature)) {
      if (std::find(out.begin(), out.end(), candidate.name) != out.end()) continue;
      if (options.progress) options.progress("trying " + candidate.name);
      TermVerdict verdict;
      verdict.term = candidate.name;
      verdict.parameters = candidate.parameters;
      verdict.asked = candidate.parameters * std::log(residuals);
      Fit one = fit(recordings, rig, site, with_terms(candidate.terms));
      verdict.why = one.why;
      if (!one.solution) {
        last_why = one.why;
        last_code = one.code;
      } else {
        verdict.gain = best.solution ? best.chi_square - one.chi_square : kInfinity;
      }
      // where there is no fit without it, the best of those with one, by the same criterion
      const double worth =
          best.solution ? verdict.gain / verdict.asked : 2.0 + residuals / (one.chi_square + verdict.asked);
      if (one.chi_square < kInfinity && worth > std::max(1.0, most)) {
        most = worth;
        if (next) others.push_back(next_verdict);
        next = candidate;
        next_fit = std::move(one);
        next_verdict = verdict;
      } else {
        others.push_back(verdict);
      }
    }
    if (!next) {
      choice.verdicts.insert(choice.verdicts.end(), others.begin(), others.end());
      break;
    }
    const TableSolveOptions options_with = with_terms(next->terms);
    const TableSolveOptions options_without = with_terms(choice.terms);
    const Fit fit_with = fit(seen, rig, site, options_with);
    const Fit fit_without = fit(seen, rig, site, options_without);
    if (fit_with.solution && fit_without.solution)
      next_verdict.held_out_gain = unseen(held_out, rig, site, options_without, temperature, *fit_without.solution) -
                                   unseen(held_out, rig, site, options_with, temperature, *fit_with.solution);
    else
      next_verdict.held_out_gain = fit_with.solution ? kInfinity : -kInfinity;
    next_verdict.taken = next_verdict.held_out_gain > 0.0;
    choice.verdicts.push_back(next_verdict);
    if (next_verdict.taken) {
      choice.terms = next->terms;
      best = std::move(next_fit);
      out.clear();  // beside this one another may be worth it after all
    } else {
      out.push_back(next->name);
    }
  }
  if (!best.solution) throw Error(last_code, last_why);
  if (!has_temperature && temperature.is_known())
    choice.verdicts.push_back({"temperature", false, 0, 0.0, 0.0, 0.0, without});
  options.terms = choice.terms;
  choice.solution =
      choice.terms.temperature > 0 ? solve_table(recordings, rig, site, options) : std::move(*best.solution);
  return choice;
}

}  // namespace trunnion::calibration
