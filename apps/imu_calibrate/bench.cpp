// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench.hpp"

#include <algorithm>

#include "result.hpp"

namespace trunnion::app {

std::vector<std::string> mounts_of_recordings(const io::RunFile& run) {
  std::vector<std::string> mounts;
  for (const io::RecordingFiles& files : run.recordings) mounts.push_back(files.mount);
  return mounts;
}

planning::Bench bench_of(const io::RunFile& run, const io::RigFile& rig, const std::vector<std::string>& names,
                         const std::vector<std::string>& mounts) {
  planning::Bench bench;
  bench.rig = &rig.rig;
  bench.site = run.site;
  for (const std::string& mount : mounts)
    bench.mounts.push_back(static_cast<int>(std::find(names.begin(), names.end(), mount) - names.begin()));
  bench.limits = rig.limits;
  bench.prediction.solve = table_options(run, names);
  bench.prediction.soak = run.soak;
  if (run.sheet.rate_hz > 0.0) bench.prediction.rate = run.sheet.rate_hz;
  return bench;
}

}  // namespace trunnion::app
