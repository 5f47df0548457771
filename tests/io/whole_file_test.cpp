// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/whole_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/digest.hpp"

namespace trunnion::io {
namespace {

TEST(WholeFile, LeavesNothingBehindUnlessCommitted) {
  const TemporaryFolder folder;
  {
    WholeFile file(folder / "a.txt");
    file.write("half");
  }
  EXPECT_EQ(folder.files(), 0U);
  write_whole(folder / "a.txt", "whole");
  EXPECT_EQ(folder.files(), 1U);
  EXPECT_EQ(read_whole(folder / "a.txt"), "whole");
}

TEST(WholeFile, KeepsTheOldFileUntilTheNewOneIsWhole) {
  const TemporaryFolder folder;
  write_whole(folder / "a.txt", "old");
  {
    WholeFile file(folder / "a.txt");
    file.write("new");
    EXPECT_EQ(read_whole(folder / "a.txt"), "old");
  }
  EXPECT_EQ(read_whole(folder / "a.txt"), "old");
}

TEST(WholeFile, RefusesAFolderThatIsNotThereAndAFolderInItsPlace) {
  const TemporaryFolder folder;
  EXPECT_REFUSES(ExitCode::kInput, "cannot write: No such file", write_whole(folder / "none/a.txt", "x"));
  std::filesystem::create_directory(folder / "sub");
  EXPECT_REFUSES(ExitCode::kInput, "is a folder", write_whole(folder / "sub", "x"));
}

TEST(WholeFile, RefusesADeviceAndWritesThroughALink) {
  const TemporaryFolder folder;
  EXPECT_REFUSES(ExitCode::kInput, "is a device", write_whole("/dev/null", "x"));
  write_whole(folder / "target.txt", "old");
  std::filesystem::create_symlink(folder / "target.txt", folder / "link.txt");
  write_whole(folder / "link.txt", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_whole(folder / "target.txt"), "new");
}

TEST(WholeFile, SaysThatTheDiskIsFull) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full";
  const TemporaryFolder folder;
  // the temporary file itself is the full device
  const std::string target = folder / "a.txt";
  std::filesystem::create_symlink("/dev/full", target + ".part-" + std::to_string(::getpid()));
  EXPECT_REFUSES(ExitCode::kInput, "cannot write: No space left on device", write_whole(target, "x"));
  EXPECT_FALSE(std::filesystem::exists(target));
}

// FIPS 180-4, example.
TEST(Sha256, MeetsThePublishedExample) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace trunnion::io
