// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_journal.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <memory>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/digest.hpp"

namespace trunnion::io {
namespace {

class LcmJournalTest : public testing::Test {
 protected:
  static std::string message(int i) {
    return std::string(static_cast<std::size_t>(20 + i % 7), static_cast<char>('a' + i % 26));
  }
  static void write(LcmJournal& journal, int from, int to) {
    for (int i = from; i < to; ++i) journal.write(1000 + i, i % 3 == 0 ? "ENCODER" : "IMU", message(i));
  }
  /// A log of the same messages, written in one go.
  std::string whole(int n) {
    LcmLogWriter log(folder_ / "whole.lcm");
    for (int i = 0; i < n; ++i) log.write(1000 + i, i % 3 == 0 ? "ENCODER" : "IMU", message(i));
    log.commit();
    return read_whole(folder_ / "whole.lcm");
  }
  TemporaryFolder folder_;
  std::string path_ = folder_ / "a.lcm";
};

TEST_F(LcmJournalTest, IsTheLogThatAWriterWouldHaveWritten) {
  LcmJournal journal(path_, nullptr);
  write(journal, 0, 500);
  EXPECT_EQ(journal.finish(), sha256(whole(500)));
  EXPECT_EQ(read_whole(path_), whole(500));
  EXPECT_THROW(read_whole(LcmJournal::part_of(path_)), Error);
}

// Cut at every byte of its last records, it goes on as if it had never been.
TEST_F(LcmJournalTest, ARecordThatWasCutOffIsDroppedAndTheRestGoneOnWith) {
  {
    LcmJournal journal(path_, nullptr);
    write(journal, 0, 40);
  }
  const std::string part = read_whole(LcmJournal::part_of(path_));
  for (std::size_t length = part.size() - 120; length <= part.size(); ++length) {
    write_whole(LcmJournal::part_of(path_), part.substr(0, length));
    int recovered = 0;
    LcmJournal journal(path_, [&](const LcmEvent& event) {
      EXPECT_EQ(event.timestamp, 1000 + recovered);
      EXPECT_EQ(event.data, message(recovered));
      ++recovered;
    });
    EXPECT_EQ(journal.recovered(), recovered);
    EXPECT_GE(recovered, 37);
    write(journal, recovered, 60);
    journal.finish();
    EXPECT_EQ(read_whole(path_), whole(60)) << length;
  }
}

TEST_F(LcmJournalTest, TwoProgramsDoNotRecordIntoOne) {
  LcmJournal journal(path_, nullptr);
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm.part: another program is recording there", LcmJournal(path_, nullptr));
  EXPECT_REFUSES(ExitCode::kInput, "cannot write", LcmJournal(folder_ / "none/a.lcm", nullptr));
}

TEST_F(LcmJournalTest, AFileThatIsNoLogIsNotOverwritten) {
  const std::string other(100000, 'x');
  write_whole(LcmJournal::part_of(path_), other);
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm.part: is no LCM log that was begun", LcmJournal(path_, nullptr));
  EXPECT_EQ(read_whole(LcmJournal::part_of(path_)), other);
}

TEST_F(LcmJournalTest, SetAsideItTakesANameThatIsFree) {
  for (int i = 1; i <= 3; ++i) {
    LcmJournal journal(path_, nullptr);
    write(journal, 0, i);
    EXPECT_EQ(journal.set_aside(), path_ + ".interrupted-" + std::to_string(i));
  }
  EXPECT_EQ(folder_.files(), 3U);
}

TEST_F(LcmJournalTest, AFullDiskEndsTheJournalAndNotTheProgram) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  LcmJournal journal(path_, nullptr);
  write(journal, 0, 100);
  journal.flush();
  rlimit small = before;
  small.rlim_cur = 8000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  write(journal, 100, 2000);
  journal.flush();
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_NE(journal.failure().find("a.lcm.part: cannot write: "), std::string::npos) << journal.failure();
  EXPECT_EQ(journal.finish(), "");
  // what was whole stays, and can be read
  LcmLogReader log(LcmJournal::part_of(path_));
  LcmEvent event;
  int records = 0;
  while (log.next(event)) ++records;
  EXPECT_GE(records, 100);
  EXPECT_EQ(log.lost_bytes(), 0);
}

}  // namespace
}  // namespace trunnion::io
