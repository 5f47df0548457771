// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Every file of the corpora, everything that once broke a reader (named crash-...), and what fuzzing found, through its
// target.

#include <gtest/gtest.h>

#include <filesystem>

#include "fuzz/targets.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::fuzz {
namespace {

class Corpus : public testing::TestWithParam<NamedTarget> {};

TEST_P(Corpus, IsReadOrRefused) {
  for (const char* corpora : {TRUNNION_CORPUS, TRUNNION_FOUND}) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(corpora) / GetParam().name)) {
      SCOPED_TRACE(entry.path());
      const std::string bytes = io::read_whole(entry.path().string());
      GetParam().run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
      ++files;
    }
    EXPECT_GT(files, 0) << corpora;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Corpus, testing::ValuesIn(kTargets),
                         [](const auto& about) { return std::string(about.param.name); });

}  // namespace
}  // namespace trunnion::fuzz
