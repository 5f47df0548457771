// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/whole_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
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

TEST(WholeFile, PassesByWhatOthersLeftInItsPlace) {
  const TemporaryFolder folder;
  const std::string target = folder / "a.txt";
  const std::string taken = target + ".part-" + std::to_string(::getpid());
  write_whole(folder / "victim.txt", "kept");
  std::filesystem::create_symlink(folder / "victim.txt", taken);
  write_whole(target, "new");
  EXPECT_EQ(read_whole(folder / "victim.txt"), "kept");
  EXPECT_EQ(read_whole(target), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(target));
}

TEST(WholeFile, KeepsPermissionsAndALinkToNothing) {
  const TemporaryFolder folder;
  using std::filesystem::perms;
  write_whole(folder / "a.txt", "old");
  std::filesystem::permissions(folder / "a.txt", perms::owner_read | perms::owner_write);
  write_whole(folder / "a.txt", "new");
  EXPECT_EQ(std::filesystem::status(folder / "a.txt").permissions(), perms::owner_read | perms::owner_write);
  std::filesystem::create_symlink("later.txt", folder / "link.txt");
  write_whole(folder / "link.txt", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_whole(folder / "later.txt"), "new");
}

TEST(WholeFile, IsGoneBeforeAProgramThatIsStopped) {
  const TemporaryFolder folder;
  WholeFile file(folder / "a.txt");
  EXPECT_EQ(folder.files(), 1U);
  remove_unfinished();
  EXPECT_EQ(folder.files(), 0U);
}

TEST(WholeFile, SaysWhatTheDiskRefuses) {
  const TemporaryFolder folder;
  const rlimit before = [] {
    rlimit limit{};
    ::getrlimit(RLIMIT_FSIZE, &limit);
    return limit;
  }();
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_REFUSES(ExitCode::kInput, "cannot write: File too large",
                 write_whole(folder / "a.txt", std::string(2000, 'x')));
  ::setrlimit(RLIMIT_FSIZE, &before);
  static_cast<void>(std::signal(SIGXFSZ, handler));
  EXPECT_EQ(folder.files(), 0U);
}

// FIPS 180-4, example.
TEST(Sha256, MeetsThePublishedExample) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace trunnion::io
