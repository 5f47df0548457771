// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Designs the moves of a calibration: the least time for an accuracy, or the best accuracy for a time.
///
///   cost = (mean over the asked entries of (sigma_i / wanted_i)^p)^(1/p),  p = 8: nearly the worst of them    ... (1)
///
/// Every mount goes through blocks: rests, turns both ways, swings, each of some seconds. Blocks are added one by one,
/// the one with the largest decrease of log cost a second first; then each is exchanged for the best of all. Sigmas
/// come from the whole sequence each time (calibration/prediction.hpp), transitions and bias wander included. Fedorov,
/// Theory of Optimal Experiments (1972), ch. 3, for the exchange; docs/theory/planning.md, eq. 5-6.

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "trunnion/calibration/prediction.hpp"
#include "trunnion/positions/entry.hpp"
#include "trunnion/positions/table_move.hpp"
#include "trunnion/simulation/table_sequence.hpp"

namespace trunnion::planning {

using simulation::TableSequence;

/// What a bench can do, and the solve to come.
struct Bench {
  const Rig* rig = nullptr;
  Site site;
  std::vector<int> mounts;    ///< of the recordings, indices into Rig::mount
  TableLimits limits;         ///< accelerations finite
  double largest_rate = 1.0;  ///< rad/s, that the unit's range and the joints allow
  calibration::PredictionOptions prediction;
};

/// Sigmas wanted, one a kind of entry, in the unit of its key; infinite where nothing is asked.
using WantedSigmas = EntryLimits;
WantedSigmas nothing_wanted();

struct Plan {
  std::vector<TableSequence> recordings;
  std::vector<calibration::Parameter> parameters;
  calibration::Observability predicted;
  Eigen::MatrixXd information;  ///< of the motions alone, SI

  [[nodiscard]] double duration() const;
  /// Largest sigma over what is wanted of it; zero where nothing is.
  [[nodiscard]] double worst(const WantedSigmas& wanted) const;
};

/// Predicts what these sequences tell.
Plan predict(const Bench& bench, const std::vector<TableSequence>& recordings);

/// Of all its moves [rad/s].
double largest_rate_of(const Plan& plan);

/// Largest sigma of each kind of a plan: what another is to reach.
WantedSigmas sigmas_of(const Plan& plan);

/// Told the time of the plan so far [s] and its worst sigma over the wanted.
using SearchProgress = std::function<void(double time, double worst)>;

/// The least time for @p wanted, or the best for @p time [s], whole of all recordings (0: as needed).
/// @return a plan that does not reach @p wanted where @p longest [s] does not
/// @throws Error (usage) where the shortest plan there is is longer than that
Plan search(const Bench& bench, const WantedSigmas& wanted, double time, double longest,
            const SearchProgress& progress = {});

/// One block more, in words, and what it does.
struct Addition {
  std::string what;  ///< "20 s of turns at 100 deg/s both ways with swings"
  std::size_t recording = 0;
  double seconds = 0.0;
  double cost_before = 0.0;  ///< eq. (1), of the sigmas over those of the plan without it where nothing is wanted
  double cost_after = 0.0;
};
Addition cheapest_addition(const Bench& bench, const Plan& plan, const WantedSigmas& wanted);

}  // namespace trunnion::planning
