// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <CLI/CLI.hpp>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>

#include "../outputs.hpp"
#include "../program.hpp"
#include "../terminal.hpp"
#include "output.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/whole_file.hpp"
#ifdef TRUNNION_HAS_BUS
#include "trunnion/bus/connection.hpp"
#endif

namespace trunnion::app {
namespace {

struct Options {
  std::vector<std::string> inputs;
  std::vector<std::string> navigation;
  std::vector<std::string> antennas;
  double length = 0.0;
  double length_sigma = 0.005;
  std::string signals;
  std::string filter = "mekf";
  bool smooth = false;
  double walk = 1.0;  // deg/s/sqrt(s)
  double coloured = 0.0;
  double coloured_time = 30.0;  // s
  double code_sigma = 0.3;
  double phase_sigma = 0.002;
  double mask = 10.0;     // deg
  double longest = 30.0;  // s
  bool exclude = true;
  std::string url;
  std::string channel = "GNSS";
  std::string orbit_channel = "GNSS_ORBIT";
  std::string imu_channel;
  std::string sheet;
  std::string out_channel = "ATTITUDE";
  std::string output, log, raw_log, summary;
  std::string format = "text";
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',')
      parts.emplace_back();
    else if (c != ' ')
      parts.back() += c;
  }
  return parts;
}

Vec3<double> antenna(const std::string& text) {
  const std::vector<std::string> parts = split(text);
  Vec3<double> place;
  bool good = parts.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    const char* const end = parts[i].data() + parts[i].size();
    const auto [after, error] = std::from_chars(parts[i].data(), end, place(static_cast<int>(i)));
    good = error == std::errc{} && after == end && std::isfinite(place(static_cast<int>(i)));
  }
  if (!good) throw Error(ExitCode::kUsage, "--antenna '" + text + "': should be x,y,z in metres, as in 1.0,0,-0.05");
  return place;
}

EngineOptions engine_options(const Options& o) {
  for (const double value : {o.length, o.length_sigma, o.walk, o.coloured, o.coloured_time, o.code_sigma, o.phase_sigma,
                             o.mask, o.longest}) {
    if (!std::isfinite(value)) throw Error(ExitCode::kUsage, "an option's number is not finite");
  }
  EngineOptions options;
  if (o.length > 0.0) {
    if (!o.antennas.empty())
      throw Error(
          ExitCode::kUsage,
          "--baseline-length-m is of two antennas, the second on the body's x axis; --antenna says where they are");
    options.slaves.emplace_back(o.length, 0.0, 0.0);
  }
  for (const std::string& text : o.antennas) options.slaves.push_back(antenna(text));
  if (options.slaves.empty())
    throw Error(ExitCode::kUsage,
                "where are the antennas? --baseline-length-m, or --antenna x,y,z for each slave, from the master");
  options.figure_sigma = o.length_sigma;
  options.noise = {o.code_sigma, o.phase_sigma, o.mask * kRadPerDeg};
  options.filter = o.filter == "none"    ? AttitudeFilter::kNone
                   : o.filter == "paper" ? AttitudeFilter::kPaper
                                         : AttitudeFilter::kMultiplicative;
  options.tracker.noise.walk = o.walk * kRadPerDeg;
  options.tracker.noise.coloured = o.coloured;
  options.tracker.noise.coloured_time = o.coloured_time;
  options.tracker.longest = o.longest;
  options.tracker.fix.exclude = o.exclude;
  options.keep_records = o.smooth;
  if (o.smooth && options.filter != AttitudeFilter::kMultiplicative)
    throw Error(ExitCode::kUsage, "--smooth is of --filter mekf");
  if (o.coloured > 0.0 && options.filter != AttitudeFilter::kMultiplicative)
    throw Error(ExitCode::kUsage, "--coloured is of --filter mekf");
  if (!o.imu_channel.empty()) {
    if (options.filter != AttitudeFilter::kMultiplicative)
      throw Error(ExitCode::kUsage, "--imu-channel is of --filter mekf");
    if (o.sheet.empty()) throw Error(ExitCode::kUsage, "--imu-channel needs --sheet: how noisy are its gyros?");
    const io::SensorSheet sheet = io::read_sensor_sheet(o.sheet);
    if (!sheet.has_noise) throw Error(ExitCode::kInput, o.sheet + ": states no noise");
    const TriadNoise& gyro = sheet.noise.gyro;
    options.driven = true;
    options.tracker.noise.gyro = gyro.density;
    options.tracker.noise.walk = gyro.wander * std::sqrt(2.0 / gyro.wander_correlation_time);
    options.tracker.noise.time = gyro.wander_correlation_time;
    constexpr double kTurnOn = 1.0;  // deg/s of a bias that nobody has calibrated
    options.tracker.slow_sigma = kTurnOn * kRadPerDeg;
  } else if (!o.sheet.empty()) {
    throw Error(ExitCode::kUsage, "--sheet is of --imu-channel");
  }
  return options;
}

bool is_lcm_log(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> first{};
  file.read(first.data(), first.size());
  return file.gcount() == 4 && first == std::array<char, 4>{'\xed', '\xa1', '\xda', '\x01'};
}

std::vector<io::SignalName> signals_of(const std::string& text) {
  std::vector<io::SignalName> names;
  for (const std::string& part : split(text)) names.push_back(io::SignalName::parse(part));
  if (names.size() > static_cast<std::size_t>(kGroups))
    throw Error(ExitCode::kUsage, "--signals: " + std::to_string(kGroups) + " at most");
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (names[i].text() == names[j].text()) throw Error(ExitCode::kUsage, "--signals: " + names[i].text() + " twice");
    }
  }
  return names;
}

/// Gyros of a channel into the engine.
class GyroSink final : public SampleSink {
 public:
  explicit GyroSink(Engine& engine) : engine_(engine) {}
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    constexpr double kLongest = 1.0;  // s: a longer gap is no sample's period
    const double t = 1e-6 * static_cast<double>(utime - last_);
    if (last_ != 0 && t > 0.0 && t < kLongest) engine_.gyro(utime, t, sample.w);
    if (last_ == 0 || t > 0.0) last_ = utime;
  }
  void encoder(std::int64_t, double, double) override {}

 private:
  Engine& engine_;
  std::int64_t last_ = 0;
};

class Run {
 public:
  explicit Run(const Options& o)
      : o_(o),
        options_(engine_options(o)),
        engine_(Engine::make(options_)),
        keeps_(o.smooth || !o.output.empty() || !o.log.empty()) {
    std::vector<std::string> inputs = o.inputs;
    inputs.insert(inputs.end(), o.navigation.begin(), o.navigation.end());
    check_outputs({o.output, o.log, o.raw_log, o.summary}, inputs);
    for (const std::string& path : o.navigation) orbits_.add(path);
    if (orbits_.losses().satellites > 0)
      warn(std::to_string(orbits_.losses().satellites) +
           " messages of orbits could not be read; first: " + orbits_.losses().first);
  }

  ExitCode run() {
    const bool from_log = o_.inputs.size() == 1 && is_lcm_log(o_.inputs[0]);
    if (o_.inputs.empty())
      live();
    else if (from_log)
      log();
    else
      rinex();
    return finish();
  }

 private:
  void warn(const std::string& what) {
    warnings_.push_back(what);
    std::fprintf(stderr, "gnss_attitude: warning: %s\n", what.c_str());
  }

  bool take(const ArrayEpoch& epoch) {
    const Solution solution = engine_->add(epoch);
    if (!o_.smooth) tally_.add(solution);
    // a day of epochs is not kept where nobody asked for them
    if (solutions_.empty() || keeps_)
      solutions_.push_back(solution);
    else
      solutions_.back() = solution;
    return !interrupted();
  }

  void rinex() {
    const std::size_t antennas = 1 + options_.slaves.size();
    if (o_.inputs.size() != antennas)
      throw Error(ExitCode::kUsage, std::to_string(antennas) + " antennas were described, the master and " +
                                        std::to_string(options_.slaves.size()) + "; observation files of " +
                                        std::to_string(o_.inputs.size()) + " were given");
    for (std::size_t i = 0; i < antennas; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (o_.inputs[i] == o_.inputs[j]) throw Error(ExitCode::kUsage, o_.inputs[i] + ": is there twice");
      }
    }
    if (!o_.url.empty() || !o_.imu_channel.empty())
      throw Error(ExitCode::kUsage, "--lcm-url and --imu-channel are of a bus or a log");
    for (const std::string& path : o_.inputs) {
      if (is_lcm_log(path)) throw Error(ExitCode::kUsage, path + ": is an LCM log, which stands alone");
    }
    if (o_.navigation.empty()) throw Error(ExitCode::kUsage, "where are the satellites? --nav FILE");
    signals_ = o_.signals.empty() ? common_signals(o_.inputs) : signals_of(o_.signals);
    std::optional<io::LcmLogWriter> raw;
    std::string message;
    std::int64_t orbit_sequence = 0;
    const auto record = [&](const io::GnssRaw& observed) {
      if (orbit_sequence == 0) {
        orbits_.each([&](const BroadcastOrbit& orbit) {
          io::encode_gnss_orbit(observed.utime, orbit_sequence++, orbit, message);
          raw->write(observed.utime, o_.orbit_channel, message);
        });
      }
      io::encode_gnss_raw(observed, signals_, message);
      raw->write(observed.utime, o_.channel, message);
    };
    if (!o_.raw_log.empty()) raw.emplace(o_.raw_log);
    ProgressLine progress;
    figures_ = read_rinex(
        o_.inputs, signals_, orbits_, [&](const ArrayEpoch& epoch) { return take(epoch); },
        [&](double fraction) {
          progress.show(figure(100.0 * fraction, 3) + " %, " + std::to_string(tally_.epochs()) + " epochs");
        },
        raw ? std::function<void(const io::GnssRaw&)>(record) : std::function<void(const io::GnssRaw&)>());
    if (raw && !interrupted()) raw->commit();
  }

  MessageReceivers receivers(ArraySink sink) {
    if (!o_.raw_log.empty()) throw Error(ExitCode::kUsage, "--raw-log is of RINEX files: messages are raw already");
    signals_ = signals_of(o_.signals.empty() ? "G1C,E1C,J1C,C2I" : o_.signals);
    return MessageReceivers(1 + options_.slaves.size(), signals_, orbits_, std::move(sink));
  }

  /// @return false when the reading is to end
  bool handle(const io::LcmEvent& event, MessageReceivers& receivers, io::LcmDecoder& unit) {
    if (event.channel == o_.channel) return receivers.raw(event);
    if (event.channel == o_.orbit_channel)
      receivers.orbit(event);
    else if (!o_.imu_channel.empty() && event.channel == o_.imu_channel)
      unit.imu(event);
    return true;
  }

  void log() {
    MessageReceivers all = receivers([&](const ArrayEpoch& epoch) { return take(epoch); });
    GyroSink gyros(*engine_);
    io::LcmDecoder unit(o_.inputs[0], gyros);
    io::Sha256 digest;
    io::LcmLogReader reader(o_.inputs[0], &digest);
    io::LcmEvent event;
    ProgressLine progress;
    long long events = 0;
    bool goes_on = true;
    while (goes_on && reader.next(event)) {
      goes_on = handle(event, all, unit);
      if (++events % 256 == 0)
        progress.show(figure(100.0 * static_cast<double>(event.byte) / static_cast<double>(reader.size()), 3) + " %");
    }
    if (goes_on) (void)all.finish();
    unit.finish();
    if (reader.lost_bytes() > 0)
      warn(std::to_string(reader.lost_bytes()) + " damaged bytes of " + o_.inputs[0] + " were passed over");
    hear(all);
    if (!o_.imu_channel.empty() && unit.samples() == 0)
      throw io::input_error(o_.inputs[0], 0, "channel " + o_.imu_channel, "holds no sample");
    figures_.digests.push_back(digest.finish());
    if (figures_.epochs == 0)
      throw io::input_error(o_.inputs[0], 0, "channel " + o_.channel,
                            all.damaged() > 0 ? "holds no gnss_raw_t of the master that can be read"
                                              : "holds no gnss_raw_t of antenna 0, the master");
  }

  void hear(const MessageReceivers& all) {
    figures_ = all.figures();
    if (all.damaged() > 0) warn(std::to_string(all.damaged()) + " messages could not be decoded");
    if (all.without_signal() > 0) {
      std::string wanted;
      for (const io::SignalName& name : signals_) wanted += " " + name.text();
      warn(std::to_string(all.without_signal()) + " messages hold none of the signals" + wanted + " (--signals)");
    }
    for (const int stranger : all.strangers())
      warn("antenna " + std::to_string(stranger) + " sends, and was not described");
    for (std::size_t k = 0; k < figures_.with_slave.size(); ++k) {
      if (figures_.epochs > 0 && figures_.with_slave[k] == 0)
        warn("antenna " + std::to_string(k + 1) + " was never heard with the master");
    }
  }

#ifdef TRUNNION_HAS_BUS
  void live() {
    if (o_.smooth) throw Error(ExitCode::kUsage, "--smooth needs the whole log");
    bus::Connection connection(o_.url);
    std::string message;
    std::int64_t sequence = 0;
    std::optional<AttitudeStatus> said;
    MessageReceivers all = receivers([&](const ArrayEpoch& epoch) {
      const bool goes_on = take(epoch);
      const Solution& solution = solutions_.back();
      io::encode_attitude(message_of(solution, sequence++), message);
      connection.publish(o_.out_channel, message);
      if (solution.status != said) {
        said = solution.status;
        std::fprintf(stderr, "%s, %d satellites%s\n", status_name(*said), solution.satellites,
                     solution.silent ? ", a receiver is silent" : "");
      }
      return goes_on;
    });
    GyroSink gyros(*engine_);
    io::LcmDecoder unit(connection.url(), gyros);
    for (const std::string& channel : {o_.channel, o_.orbit_channel, o_.imu_channel}) {
      if (!channel.empty())
        connection.subscribe(channel, [&](const io::LcmEvent& event) { (void)handle(event, all, unit); });
    }
    std::fprintf(stderr, "%s: %s to %s\n", connection.url().c_str(), o_.channel.c_str(), o_.out_channel.c_str());
    auto heard = std::chrono::steady_clock::now();
    while (!interrupted()) {
      const auto now = std::chrono::steady_clock::now();
      if (connection.handle(100)) {
        heard = now;
      } else if (now - heard > std::chrono::seconds(10)) {
        heard = now + std::chrono::hours(1);
        std::fprintf(stderr, "nothing is heard on %s\n", o_.channel.c_str());
      }
    }
    (void)all.finish();
    hear(all);
    live_ = true;
  }

#else
  void live() { throw Error(ExitCode::kUsage, "this program was built without LCM: give it RINEX files or a log"); }
#endif

  ExitCode finish() {
    if (interrupted() && !live_) return ExitCode::kInterrupted;
    for (const std::string& warning : figures_.warnings) warn(warning);
    if (!figures_.left_out.without_orbit.empty()) {
      std::string names;
      for (const std::string& name : figures_.left_out.without_orbit) names += " " + name;
      warn("no healthy orbit within four hours:" + names);
    }
    if (figures_.left_out.half_cycles > 0)
      warn(std::to_string(figures_.left_out.half_cycles) +
           " phases that their receiver calls half a cycle doubtful were left out");
    if (figures_.left_out.too_many > 0)
      warn(std::to_string(figures_.left_out.too_many) + " signals beyond the " + std::to_string(kMostSignals) +
           " of an epoch were left out");
    if (o_.smooth) {
      engine_->smooth(solutions_);
      for (const Solution& s : solutions_) tally_.add(s);
    }
    const nlohmann::ordered_json tree = tally_.json(options_);
    for (std::size_t k = 0; k < options_.slaves.size(); ++k) compare_length(k);
    nlohmann::ordered_json whole = {
        {"schema", "trunnion/gnss_attitude/1"}, {"tool", tool_name()}, {"inputs", o_.inputs}};
    if (!figures_.digests.empty()) whole["sha256"] = figures_.digests;
    if (!o_.navigation.empty()) whole["navigation"] = {{"files", o_.navigation}, {"sha256", orbits_.digest()}};
    std::vector<std::string> names;
    for (const io::SignalName& name : signals_) names.push_back(name.text());
    whole["signals"] = names;
    whole["filter"] = o_.filter;
    whole["smoothed"] = o_.smooth;
    for (const auto& [key, value] : tree.items()) whole[key] = value;
    if (engine_->restarts() > 0) whole["filter_restarts"] = engine_->restarts();
    whole["warnings"] = warnings_;
    const bool refused = tally_.sure() == 0 && !live_;
    if (!refused) {
      if (!o_.output.empty()) write_attitude_csv(o_.output, solutions_);
      if (!o_.log.empty()) write_attitude_log(o_.log, o_.out_channel, solutions_);
      if (!o_.summary.empty()) io::write_whole(o_.summary, json_text(whole));
    }
    if (o_.format == "json")
      std::fputs(json_text(whole).c_str(), stdout);
    else
      print_summary(whole);
    if (refused) {
      std::fprintf(stderr, "gnss_attitude: no epoch could be fixed: %s\n", tally_.why_not().c_str());
      return ExitCode::kNumerics;
    }
    return ExitCode::kDone;
  }

  /// What the phases say of a slave's stated length.
  void compare_length(std::size_t k) {
    constexpr double kFar = 3.0;  // of its sigmas
    const double stated = options_.slaves[k].norm();
    const std::string name = "baseline " + std::to_string(k + 1) + ": ";
    const long long free = tally_.but_for_the_length(k);
    if (free > 0 && 5 * free > tally_.epochs())
      warn(name + "the phases of " + std::to_string(free) + " epochs fit, but not the length of " + figure(stated, 6) +
           " m that was stated: without it they say " + figure(tally_.free_length(k), 6) + " m");
    else if (tally_.measured(k) > 0 && std::abs(tally_.length(k) - stated) > kFar * options_.figure_sigma)
      warn(name + "measures " + figure(tally_.length(k), 6) + " m, stated were " + figure(stated, 6) + " m, which is " +
           figure(std::abs(tally_.length(k) - stated) / options_.figure_sigma, 2) + " times --length-sigma-m");
    else if (tally_.sure() > 0 && 10 * tally_.measured(k) < tally_.epochs())
      warn(name + "was measured in " + std::to_string(tally_.measured(k)) + " of " + std::to_string(tally_.epochs()) +
           " epochs");
  }

  const Options& o_;
  EngineOptions options_;
  std::unique_ptr<Engine> engine_;
  io::OrbitBook orbits_;
  std::vector<io::SignalName> signals_;
  AttitudeFigures tally_;
  std::vector<Solution> solutions_;
  ReceiverFigures figures_;
  std::vector<std::string> warnings_;
  bool live_ = false;
  bool keeps_;
};

void add_options(CLI::App& app, Options& o) {
  app.add_option("inputs", o.inputs,
                 "RINEX observation files, the master's first; or an LCM log; none: the bus, until interrupted");
  app.add_option("--nav", o.navigation, "RINEX navigation file; may be given again. Messages may bring orbits, too")
      ->allow_extra_args(false);
  app.add_option("--baseline-length-m", o.length, "Two antennas: the slave ahead of the master, on the body's x axis")
      ->check(CLI::Range(0.01, 1000.0));
  app.add_option("--antenna", o.antennas, "x,y,z of a slave from the master, in the body [m]; once for each")
      ->allow_extra_args(false);
  app.add_option("--length-sigma-m", o.length_sigma, "1 sigma of the lengths, and of what the figure may be otherwise")
      ->capture_default_str()
      ->check(CLI::Range(0.0001, 10.0));
  app.add_option(
      "--signals", o.signals,
      "Like G1C,E1C: systems G, E, J, C, band, attribute; default the first band of all that the files share");
  app.add_option("--mask-deg", o.mask, "Lowest satellite")->capture_default_str()->check(CLI::Range(0.0, 80.0));
  app.add_option("--code-sigma-m", o.code_sigma, "Of one receiver's code at the zenith")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 100.0));
  app.add_option("--phase-sigma-m", o.phase_sigma, "Of one receiver's phase at the zenith")
      ->capture_default_str()
      ->check(CLI::Range(1e-5, 0.05));
  app.add_flag("!--no-exclusion", o.exclude, "Leave no satellite out where one does not fit");

  app.add_option("--filter", o.filter,
                 "mekf: multiplicative; paper: the seven-state quaternion filter; none: each epoch alone")
      ->capture_default_str()
      ->check(CLI::IsMember({"mekf", "paper", "none"}));
  app.add_flag("--smooth", o.smooth, "Smooth the whole log (mekf)");
  app.add_option("--rate-walk-deg-per-s", o.walk, "How fast the rate wanders, in a second")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e4));
  app.add_option("--coloured", o.coloured,
                 "Errors of the phases that stay, multipath, as a multiple of the white noise (mekf)")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--coloured-s", o.coloured_time, "For how long they stay")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 1e5));
  app.add_option("--predict-s", o.longest, "How long the filter goes on alone")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e5));

  app.add_option("-l,--lcm-url", o.url, "Bus; default LCM_DEFAULT_URL, or LCM's own");
  app.add_option("--channel", o.channel, "Of gnss_raw_t, all antennas")->capture_default_str();
  app.add_option("--orbit-channel", o.orbit_channel, "Of gnss_orbit_t")->capture_default_str();
  app.add_option("--imu-channel", o.imu_channel, "Gyros that drive the filter, in the body's axes; needs --sheet");
  app.add_option("--sheet", o.sheet, "Sensor sheet of that unit: its noise");
  app.add_option("--out-channel", o.out_channel, "Of attitude_t, on the bus and in --log")->capture_default_str();

  app.add_option("-o,--output", o.output, "CSV of every epoch");
  app.add_option("--log", o.log, "LCM log of attitude_t");
  app.add_option("--raw-log", o.raw_log, "LCM log of the RINEX files as gnss_raw_t and gnss_orbit_t");
  app.add_option("--summary", o.summary, "JSON of the summary");
  app.add_option("--format", o.format, "Of standard output")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  app.footer("Example:\n  gnss_attitude base.obs rover.obs --nav base.nav --baseline-length-m 0.9902 -o attitude.csv");
}

}  // namespace

ExitCode run_attitude(std::vector<std::string> arguments) {
  CLI::App app("Attitude from the carrier phases of two or three GNSS antennas.", "gnss_attitude");
  app.set_version_flag("--version", tool_name());
  Options o;
  add_options(app, o);
  return run_program(app, std::move(arguments), [&] {
    catch_interrupts();
    return Run(o).run();
  });
}

}  // namespace trunnion::app

int main(int argc, char** argv) { return trunnion::app::main_of(argc, argv, trunnion::app::run_attitude); }
