// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>

#include "../program.hpp"
#include "../terminal.hpp"
#include "corrector.hpp"
#include "trunnion/bus/connection.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/run_file.hpp"

namespace trunnion::app {
namespace {

constexpr auto kLookEvery = std::chrono::milliseconds(200);

struct Options {
  CorrectorOptions corrector;
  std::string url;
  std::string run;
  std::string in;
  std::string out = "IMU_CORRECTED";
};

/// Whether a file is another than it was.
class Watched {
 public:
  explicit Watched(std::string path) : path_(std::move(path)) { changed(); }
  bool changed() {
    struct stat now {};
    if (::stat(path_.c_str(), &now) != 0) return false;  // gone, or between two names: the last one stays
    const bool same = now.st_ino == inode_ && now.st_size == size_ && now.st_mtim.tv_sec == time_.tv_sec &&
                      now.st_mtim.tv_nsec == time_.tv_nsec;
    inode_ = now.st_ino;
    size_ = now.st_size;
    time_ = now.st_mtim;
    return !same;
  }

 private:
  std::string path_;
  ino_t inode_ = 0;
  off_t size_ = -1;
  timespec time_{};
};

class Correct {
 public:
  explicit Correct(const Options& o)
      : o_(o),
        channels_(channels(o)),
        connection_(o.url),
        file_(o.corrector.calibration),
        corrector_(std::make_unique<Corrector>(o.corrector)),
        messages_(connection_.url(), channels_) {
    if (channels_.imu_channel() == o.out)
      throw Error(ExitCode::kUsage, "--out " + o.out + ": is the channel that is corrected");
    connection_.subscribe(channels_.imu_channel(), &Correct::on_message, *this);
  }

  ExitCode run() {
    std::fprintf(stderr, "%s: %s to %s, %s%s\n", connection_.url().c_str(), channels_.imu_channel().c_str(),
                 o_.out.c_str(), corrector_->takes_counts() ? "raw counts in " : "no raw counts: there is no --sheet",
                 corrector_->takes_counts() ? corrector_->path() : "");
    auto looked = std::chrono::steady_clock::now();
    while (!interrupted()) {
      connection_.handle(100);
      const auto now = std::chrono::steady_clock::now();
      if (now - looked < kLookEvery) continue;
      looked = now;
      if (file_.changed()) reload();
    }
    const SequenceWatch& sequence = messages_.sequence();
    std::fprintf(stderr, "%lld samples corrected, %lld lost before, %lld messages left out\n", messages_.samples(),
                 sequence.numbered() ? sequence.lost() : 0, messages_.damaged());
    return ExitCode::kDone;
  }

 private:
  static io::LogChannels channels(const Options& o) {
    io::LogChannels channels;
    if (!o.run.empty()) channels = io::read_run_file(o.run).channels;
    if (!o.in.empty()) channels.imu.name = o.in;
    return channels;
  }

  void on_message(const io::LcmEvent& event) {
    const std::string* const corrected = messages_.correct(event, *corrector_);
    if (corrected != nullptr) {
      connection_.publish(o_.out, *corrected);
    } else if (!messages_.why().empty() && messages_.why() != said_) {
      said_ = messages_.why();
      std::fprintf(stderr, "left out: %s\n", said_.c_str());
    }
  }

  void reload() {
    try {
      corrector_ = std::make_unique<Corrector>(o_.corrector);
      std::fprintf(stderr, "%s: read again\n", o_.corrector.calibration.c_str());
    } catch (const Error& e) {
      std::fprintf(stderr, "%s; the calibration before it stays\n", e.what());
    }
  }

  const Options& o_;
  io::LogChannels channels_;
  bus::Connection connection_;
  Watched file_;  // before it is read
  std::unique_ptr<Corrector> corrector_;
  CorrectedMessages messages_;
  std::string said_;
};

}  // namespace

ExitCode run_correct(std::vector<std::string> arguments) {
  CLI::App app("Corrects a unit's messages as they come, with the code that runs in firmware.", "imu_correct");
  app.set_version_flag("--version", tool_name());
  Options o;
  app.add_option("calibration", o.corrector.calibration,
                 "Calibration file, or a block of imu_calibrate export (.bin); read again when it changes")
      ->required();
  app.add_option("-l,--lcm-url", o.url, "Bus; default LCM_DEFAULT_URL, or LCM's own");
  app.add_option("--in", o.in, "Channel to correct; default IMU, or that of --run");
  app.add_option("--out", o.out, "Channel to publish on")->capture_default_str();
  app.add_option("--run", o.run, "Run file whose `channels` say what the messages are");
  auto* const sheet = app.add_option("--sheet", o.corrector.sheet, "Sensor sheet: what a raw count of imu_counts_t is");
  app.add_option("--bits", o.corrector.bits, "Of a raw count, sign included")
      ->capture_default_str()
      ->check(CLI::Range(2, 30))
      ->needs(sheet);
  app.add_option("--fraction", o.corrector.fraction, "Binary digits behind the point of a corrected count")
      ->capture_default_str()
      ->check(CLI::Range(0, 28))
      ->needs(sheet);
  app.add_flag("--float", o.corrector.in_floating_point, "Correct raw counts in floating point, not in integers")
      ->needs(sheet);
  app.add_option("--recording", o.corrector.recording,
                 "Use the turn-on bias of this recording, from 1; default the mean")
      ->check(CLI::Range(1, 1000));
  app.footer("Example:\n  imu_correct calibration.yaml --in IMU --out IMU_CORRECTED");
  return run_program(app, std::move(arguments), [&] {
    catch_interrupts();
    return Correct(o).run();
  });
}

}  // namespace trunnion::app

int main(int argc, char** argv) { return trunnion::app::main_of(argc, argv, trunnion::app::run_correct); }
