// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "../outputs.hpp"
#include "../terminal.hpp"
#include "bench.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "result.hpp"
#include "trials_file.hpp"
#include "trunnion/calibration/allan_deviation.hpp"
#include "trunnion/calibration/verification.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/table_moves.hpp"
#include "trunnion/io/whole_file.hpp"
#include "trunnion/report/document.hpp"
#include "trunnion/report/picture.hpp"

namespace trunnion::app {
namespace {

using calibration::Parameter;
using calibration::Solution;
using report::Picture;
using report::Section;
using report::Table;

constexpr std::array<const char*, 6> kAxis = {"gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"};
constexpr std::size_t kMostPoints = 1500;  // of a picture
constexpr std::size_t kMostBars = 40;      // of a picture: a page holds it
constexpr int kWeakest = 6;                // directions that are named

struct Options {
  std::string run;
  std::string output;
  std::string trials;
  std::string allan;
  std::string format;
};

double sigma_of(const Solution& solution, std::size_t i) {
  const auto at = static_cast<Eigen::Index>(i);
  return std::sqrt(solution.observability.covariance(at, at));
}

/// Value and sigma of every entry, and sigmas against the limits as bars.
Section parameters(const io::RunFile& run, const Solution& solution) {
  Section section{"Parameters", {}, {}, {}};
  section.text = {
      "1 sigma of each entry over the limit that it is held against: that of the run file, or, where it states "
      "none, the one beyond which the entry is refused. Left of the line is within."};
  Table table{{"entry", "value", "1 sigma", "limit of sigma", "unit"}, {}};
  std::vector<std::vector<double>> bars;
  std::string labels;
  const auto draw = [&] {
    if (bars.empty()) return;
    section.pictures.push_back(
        report::gnuplot("1 sigma over its limit, logarithmic",
                        report::data_block("bars", bars) + "set logscale x\nset xrange [1e-5:2]\nset yrange [" +
                            std::to_string(bars.size()) + ":-1] \nset ytics (" + labels +
                            ") font ',9'\nset grid x\nset lmargin 34\nunset key\nset arrow from 1, graph 0 to 1, "
                            "graph 1 nohead lc rgb '#b3261e' lw 2\nplot $bars using "
                            "(1e-5):2:(1e-5):1:($2-0.35):($2+0.35) with boxxyerror fs solid "
                            "0.6 lc rgb '#30638e'\n",
                        760, 90 + 15 * static_cast<int>(bars.size())));
    bars.clear();
    labels.clear();
  };
  for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
    const Parameter& p = solution.parameters[i];
    const double asked = run.limits[static_cast<std::size_t>(p.kind)].sigma;
    const bool stated = asked > 0.0 && calibration::has_verdict(p);
    const double limit = stated ? asked : p.refuse_above * p.in_unit;
    const double sigma = sigma_of(solution, i) * p.in_unit;
    table.rows.push_back({p.name, figure(solution.x(static_cast<Eigen::Index>(i)) * p.in_unit, 6), figure(sigma, 3),
                          (stated ? "" : "refused above ") + figure(limit, 3), p.unit});
    if (!calibration::has_verdict(p)) continue;
    if (bars.size() == kMostBars) draw();
    labels += std::string(bars.empty() ? "" : ", ") + report::quoted(p.name) + " " + std::to_string(bars.size());
    bars.push_back({sigma / limit, static_cast<double>(bars.size())});
  }
  draw();
  section.tables.push_back(table);
  return section;
}

/// What the recordings are from the calibrated table, before and after.
Section residuals(const io::RunFile& run, const io::RigFile& rig, const io::CalibrationFile& file,
                  const UnitNoise& noise, ProgressLine& progress) {
  Section section{"Residuals by position", {}, {}, {}};
  section.text = {
      "Standard deviation of output minus what the calibrated table does, in windows of 0.1 s, before and after "
      "correction, with the floor that noise and wander leave. These recordings were used: a recording that was "
      "not is held against the calibration by imu_calibrate verify."};
  Table table{{"recording", "axis", "before", "after", "floor", "after / floor", "unit"}, {}};
  std::vector<Picture> pictures;
  for (std::size_t r = 0; r < run.recordings.size(); ++r) {
    progress.show("residuals of " + run.recordings[r].name());
    BeforeAndAfter both(compress_options(run, run.recordings[r]), file.record.value.unit);
    std::vector<std::pair<std::string, std::string>> digests;
    io::read_recording(run, run.recordings[r], both, digests);
    both.say_what_is_missing(file.record.value.unit, run.recordings[r].name());
    const int mount = file.record.recording_mount[r];
    const calibration::Verification v = calibration::verify(both.before.finish(), both.after.finish(), mount,
                                                            file.record.value, rig.rig, run.site, noise);
    std::size_t largest = 0;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const calibration::AxisVerification& a = v.axis[axis];
      const double unit = axis < 3 ? kRadPerDeg : 1e3 * kMetresPerS2PerMicroG;
      table.rows.push_back({file.mounts[static_cast<std::size_t>(mount)], kAxis[axis], figure(a.before / unit, 4),
                            figure(a.after / unit, 4), figure(a.floor / unit, 4), figure(a.after / a.floor, 3),
                            axis < 3 ? "deg/s" : "mg"});
      if (axis < 3 && a.before > v.axis[largest].before) largest = axis;
    }
    std::vector<std::vector<double>> rows;
    const std::size_t step = v.course.size() / kMostPoints + 1;
    for (std::size_t k = 0; k < v.course.size(); k += step)
      rows.push_back({v.course[k][0] - v.course.front()[0], v.course[k][1 + largest] / kRadPerDeg,
                      v.course[k][7 + largest] / kRadPerDeg});
    pictures.push_back(
        report::gnuplot(std::string("Output minus the table's rate, ") + kAxis[largest] + ", " +
                            file.mounts[static_cast<std::size_t>(mount)] + ": before and after",
                        report::data_block("course", rows) +
                            "set xlabel 'time [s]'\nset ylabel 'difference [deg/s]'\nset grid\nplot $course using "
                            "1:2 with lines lc rgb '#b3261e' title 'before', $course using 1:3 with lines lc rgb "
                            "'#30638e' title 'after'\n"));
  }
  section.pictures = std::move(pictures);
  section.tables.push_back(table);
  return section;
}

Section correlations(const Solution& solution) {
  Section section{"Correlations and weak directions", {}, {}, {}};
  const auto n = static_cast<Eigen::Index>(solution.parameters.size());
  const Eigen::MatrixXd& P = solution.observability.covariance;
  const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd R = scale.asDiagonal() * P * scale.asDiagonal();
  std::vector<std::vector<double>> rows;
  for (Eigen::Index i = 0; i < n; ++i) {
    rows.emplace_back();
    for (Eigen::Index j = 0; j < n; ++j) rows.back().push_back(R(i, j));
  }
  section.pictures.push_back(report::gnuplot(
      "Correlation matrix, entries in the order of the table above",
      report::data_block("R", rows) +
          "set cbrange [-1:1]\nset palette defined (-1 '#b3261e', 0 '#ffffff', 1 '#30638e')\nset xrange "
          "[-0.5:" +
          std::to_string(n) + "-0.5]\nset yrange [" + std::to_string(n) +
          "-0.5:-0.5]\nset size ratio 1\nunset key\nplot $R matrix with image pixels\n",
      640, 560));

  // the posterior in units of the limits: its widest directions are the weak ones
  Eigen::VectorXd limit(n);
  for (Eigen::Index i = 0; i < n; ++i) limit(i) = solution.parameters[static_cast<std::size_t>(i)].refuse_above;
  const Eigen::VectorXd one_over = limit.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(one_over.asDiagonal() * P * one_over.asDiagonal());
  std::vector<std::vector<double>> spectrum;
  for (Eigen::Index j = 0; j < n; ++j)
    spectrum.push_back({static_cast<double>(j), 1.0 / std::sqrt(std::max(eigen.eigenvalues()(n - 1 - j), 1e-300))});
  section.pictures.push_back(report::gnuplot(
      "Singular values of the whitened Jacobian in units of the limits, weakest first: below 1 a direction is refused",
      report::data_block("s", spectrum) +
          "set logscale y\nset grid\nunset key\nset xlabel 'direction'\nset arrow from graph 0, first "
          "1 to graph 1, first 1 nohead lc rgb '#b3261e' lw 2\nplot $s using 1:2 with points pt 7 ps "
          "0.5 lc rgb '#30638e'\n"));
  Table table{{"weak direction", "1 sigma, in limits", "entries"}, {}};
  for (int w = 0; w < kWeakest && w < n; ++w) {
    const Eigen::VectorXd direction = eigen.eigenvectors().col(n - 1 - w).cwiseAbs();
    std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return direction(a) > direction(b); });
    std::string names;
    for (std::size_t i = 0; i < 5 && direction(order[i]) > 0.2 * direction(order[0]); ++i)
      names += (i == 0 ? "" : ", ") + solution.parameters[static_cast<std::size_t>(order[i])].name;
    table.rows.push_back({std::to_string(w + 1), figure(std::sqrt(eigen.eigenvalues()(n - 1 - w)), 3), names});
  }
  section.tables.push_back(table);
  const calibration::Entanglement worst = calibration::worst_entanglement(P, solution.parameters);
  section.text = {"Hardest to tell apart: " + solution.parameters[worst.entry].name + " and " +
                  solution.parameters[worst.with].name + ", correlation " + figure(worst.correlation, 3) +
                  "; the sigma is " + figure(worst.price, 3) + " times what it would be were the other known."};
  return section;
}

/// Against what the moves of the run foretold.
Section predicted(const io::RunFile& run, const io::RigFile& rig, const std::vector<std::string>& names,
                  const Solution& solution, const std::vector<calibration::TableRecording>& recordings) {
  Section section{"Predicted and achieved", {}, {}, {}};
  if (run.moves.empty()) {
    section.text = {"The run file names no moves (imu_calibrate plan writes them): nothing was predicted."};
    return section;
  }
  planning::Bench bench = bench_of(run, rig, names, mounts_of_recordings(run));
  bench.prediction.encoder_rate = 1.0 / recordings.front().data.course.period();
  bench.prediction.encoder_quantum = recordings.front().data.course.reading_sigma() * std::sqrt(12.0);
  bench.prediction.solve.noise = solution.noise;
  const planning::Plan plan = planning::predict(bench, io::read_table_moves(run.moves, run.recordings.size()));
  section.text = {
      "1 sigma of the solve over the one predicted from the moves alone, with the noise that the solve used."};
  Table table{{"entry", "predicted", "achieved", "ratio", "unit"}, {}};
  for (std::size_t i = 0; i < plan.parameters.size() && i < solution.parameters.size(); ++i) {
    const Parameter& p = solution.parameters[i];
    if (p.name != plan.parameters[i].name) continue;
    const auto at = static_cast<Eigen::Index>(i);
    const double before = std::sqrt(plan.predicted.covariance(at, at));
    table.rows.push_back({p.name, figure(before * p.in_unit, 3), figure(sigma_of(solution, i) * p.in_unit, 3),
                          figure(sigma_of(solution, i) / before, 3), p.unit});
  }
  section.tables.push_back(table);
  return section;
}

/// Curves of `imu_calibrate allan -o`: axis, tau, deviation, low, high.
Section allan(const std::string& path) {
  Section section{"Noise", {}, {}, {}};
  const std::string text = io::read_whole(path);
  std::map<std::string, std::vector<std::vector<double>>> curves;
  std::size_t from = text.find('\n');
  if (text.rfind("axis,tau_s,deviation,low,high", 0) != 0)
    throw Error(ExitCode::kInput, path + ":1: is no file of curves: imu_calibrate allan -o writes them");
  long long line = 1;
  while (from != std::string::npos && from + 1 < text.size()) {
    const std::size_t end = std::min(text.find('\n', from + 1), text.size());
    const std::string row = text.substr(from + 1, end - from - 1);
    ++line;
    std::array<char, 16> axis{};
    std::array<double, 4> v{};
    if (std::sscanf(row.c_str(), "%15[a-z_],%lf,%lf,%lf,%lf", axis.data(), &v[0], &v[1], &v[2], &v[3]) != 5)
      throw Error(ExitCode::kInput, path + ":" + std::to_string(line) + ": is no row of a curve");
    if (!std::all_of(v.begin(), v.end(), [](double value) { return std::isfinite(value) && value >= 0.0; }))
      throw Error(ExitCode::kInput, path + ":" + std::to_string(line) + ": is not finite");
    curves[axis.data()].push_back({v[0], v[1], v[2], v[3]});
    from = end;
  }
  for (const char* const triad : {"gyro", "accel"}) {
    std::string script;
    std::string plot;
    for (const auto& [axis, rows] : curves) {
      if (axis.rfind(triad, 0) != 0) continue;
      script += report::data_block(axis, rows);
      plot += std::string(plot.empty() ? "plot $" : ", $") + axis +
              " using 1:2:3:4 with yerrorlines pt 7 ps 0.4 title " + report::quoted(axis);
    }
    if (plot.empty()) continue;
    section.pictures.push_back(report::gnuplot(std::string("Allan deviation, ") + triad + ", with 1 sigma limits",
                                               script + "set logscale xy\nset grid\nset xlabel 'tau [s]'\nset ylabel " +
                                                   (triad[0] == 'g' ? "'deg/h'" : "'ug'") + "\n" + plot + "\n"));
  }
  return section;
}

/// The methods of a campaign, each axis as best mean over its own: one is the best.
Section radar(const std::string& path) {
  Section section{"Methods compared", {}, {}, {}};
  const nlohmann::ordered_json all = read_trials(path);
  const std::vector<std::pair<const char*, const char*>> figures = {{"installation_deg", "installation"},
                                                                    {"aligned_deg", "cross-coupling"},
                                                                    {"gyro_scale_ppm", "gyro scale"},
                                                                    {"accel_scale_ppm", "accel scale"}};
  std::map<std::string, std::map<std::string, std::pair<double, int>>> sums;
  for (const auto& trial : all["trials"]) {
    for (const auto& [method, one] : trial["methods"].items()) {
      for (const auto& [name, title] : figures) {
        if (!one.contains(name)) continue;
        auto& [sum, count] = sums[method][name];
        sum += one[name].template get<double>();
        ++count;
      }
    }
  }
  Table table{{"method", "installation [deg]", "cross-coupling [deg]", "gyro scale [ppm]", "accelerometer scale [ppm]"},
              {}};
  std::map<std::string, double> best;
  for (const auto& [method, of] : sums) {
    for (const auto& [name, sum] : of) {
      const double mean = sum.first / sum.second;
      best[name] = best.count(name) == 0 ? mean : std::min(best[name], mean);
    }
  }
  // a row a method, a column a figure
  std::string block = "$methods << EOD\n";
  for (const auto& [method, of] : sums) {
    std::vector<std::string> row = {method};
    std::string name = method;
    std::replace(name.begin(), name.end(), '_', '-');
    block += name;
    for (const auto& [figure_name, title] : figures) {
      const auto at = of.find(figure_name);
      row.push_back(at == of.end() ? "-" : figure(at->second.first / at->second.second, 3));
      // three decades from the rim to the middle
      const double score =
          at == of.end()
              ? 0.0
              : std::max(0.0, 1.0 + std::log10(best[figure_name] * at->second.second / at->second.first) / 3.0);
      block += " " + figure(score, 6);
    }
    block += "\n";
    table.rows.push_back(row);
  }
  block += "EOD\n";
  std::string plot = "plot ";
  std::string axes;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    axes += "set paxis " + std::to_string(i + 1) + " range [0:1]\n";
    plot += std::string(i == 0 ? "" : ", ") + "$methods using " + std::to_string(i + 2) + ":key(1) title " +
            report::quoted(figures[i].second);
  }
  section.text = {
      "Means over " + std::to_string(all["trials"].size()) +
      " simulated units. In the picture the best method of each figure is at the rim, one that is a thousand times "
      "worse, or does not have the figure, in the middle; the scale is logarithmic."};
  section.pictures.push_back(report::gnuplot(
      "Methods",
      block + "set spiderplot\nset style spiderplot fs transparent solid 0.08 border lw 2\nset grid spider\n" + axes +
          "set key outside right\n" + plot + "\n",
      760, 520));
  section.tables.push_back(table);
  return section;
}

ExitCode report_of(const Options& o) {
  std::string format = o.format;
  if (format.empty()) {
    const std::string extension = std::filesystem::path(o.output).extension().string();
    format = extension == ".md" ? "markdown" : extension == ".json" ? "json" : "html";
    if (format == "html" && extension != ".html" && !o.output.empty())
      throw Error(ExitCode::kUsage, o.output + ": a report is a .html, .md or .json; or state --format");
  }
  const io::RunFile run = io::read_run_file(o.run);
  if (run.rig.empty()) throw Error(ExitCode::kInput, o.run + ": a report is of a table run: this run has no rig");
  check_outputs({o.output}, files_of(run));
  check_outputs({o.output}, {o.trials, o.allan});
  ProgressLine progress;
  RunInputs inputs;
  const std::vector<std::string> names = mounts_of(run);
  const io::RigFile rig = io::read_rig(run.rig, run.outer_axis, run.inner_axis, names);
  const std::vector<calibration::TableRecording> recordings = read_table_recordings(run, names, inputs);
  calibration::TableSolveOptions options = table_options(run, names);
  options.progress = [&](const std::string& stage) { progress.show(stage); };
  const Solution solution = calibration::solve_table(recordings, rig.rig, run.site, options);
  const io::CalibrationFile file = calibration_of(run, solution, inputs, names);

  report::Document document;
  document.title = "Calibration of " + (file.model.empty() ? std::string("an inertial unit") : file.model) +
                   (file.serial.empty() ? "" : ", " + file.serial);
  document.good = file.within_limits;
  const bool limits = std::any_of(run.limits.begin(), run.limits.end(), [](const io::EntryVerdict& limit) {
    return limit.sigma >= 0.0 || limit.value >= 0.0;
  });
  document.verdict = !file.within_limits ? std::to_string(file.out_of_limits.size()) + " entries are out of limits"
                     : limits            ? "Within the limits of the run file"
                                         : "Every entry is determined; the run file states no limits";
  const FitFigures& fit = file.record.fit;
  Section summary{"Summary", file.out_of_limits, {}, {}};
  summary.tables.push_back({{"figure", "value"},
                            {{"samples", std::to_string(fit.samples)},
                             {"windows", std::to_string(fit.windows)},
                             {"outliers", std::to_string(fit.outliers)},
                             {"reduced chi-square", figure(fit.reduced_chi_square, 5)},
                             {"gauge", std::accumulate(file.gauge.begin(), file.gauge.end(), std::string(),
                                                       [](const std::string& all, const std::string& one) {
                                                         return all + (all.empty() ? "" : ", ") + one;
                                                       })}}});
  document.sections.push_back(summary);
  document.sections.push_back(parameters(run, solution));
  document.sections.push_back(residuals(run, rig, file, solution.noise, progress));
  document.sections.push_back(correlations(solution));
  document.sections.push_back(predicted(run, rig, names, solution, recordings));
  if (!o.allan.empty()) document.sections.push_back(allan(o.allan));
  if (!o.trials.empty()) document.sections.push_back(radar(o.trials));
  Section provenance{
      "Provenance", {"Made by " + file.tool + " from " + file.run + "."}, {{{"input", "SHA-256"}, {}}}, {}};
  for (const auto& [path, digest] : file.inputs) provenance.tables.front().rows.push_back({path, digest});
  document.sections.push_back(provenance);

  bool pictures = true;
  for (const Section& section : document.sections) {
    for (const Picture& picture : section.pictures) pictures = pictures && !picture.svg.empty();
  }
  if (!pictures && format == "html")
    std::fprintf(stderr, "the report has no pictures, or not all of them: gnuplot is not installed, or failed\n");
  const std::string text = format == "html"       ? report::to_html(document)
                           : format == "markdown" ? report::to_markdown(document)
                                                  : report::to_json(document);
  if (o.output.empty())
    std::fputs(text.c_str(), stdout);
  else
    io::write_whole(o.output, text);
  return file.within_limits ? ExitCode::kDone : ExitCode::kOutOfLimits;
}

}  // namespace

void add_report(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand(
      "report",
      "One page for people, of a table run: verdict, sigmas, residuals, correlations, prediction, provenance");
  auto o = std::make_shared<Options>();
  command->add_option("run", o->run, "Run file of the calibration; it is solved anew")->required();
  command->add_option("-o,--output", o->output, "File to write: .html, .md, .json; without one, standard output");
  command->add_option("--trials", o->trials, "Result file of a campaign, for the picture of the methods");
  command->add_option("--allan", o->allan, "Curves that imu_calibrate allan -o wrote, for the picture of the noise");
  command->add_option("--format", o->format, "html, markdown or json; default by the name of the output, else html")
      ->check(CLI::IsMember({"html", "markdown", "json"}));
  command->footer(
      "Example:\n  imu_calibrate report run.yaml -o report.html\nPictures are made by gnuplot, where it is installed.");
  command->callback([o, &exit_code] { exit_code = report_of(*o); });
}

}  // namespace trunnion::app
