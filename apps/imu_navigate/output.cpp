// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "output.hpp"

#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {

void write_csv(const std::string& path, const Track& track) {
  io::WholeFile file(path);
  file.write("t_s,lat_deg,lon_deg,h_m,north_m_s,east_m_s,down_m_s,roll_deg,pitch_deg,yaw_deg\n");
  char row[400];
  for (const Epoch& e : track.epoch) {
    const Vec3<double> angles = euler_angles(e.state.attitude) / kRadPerDeg;
    const Vec3<double>& v = e.state.velocity;
    const int size = std::snprintf(row, sizeof row, "%.6f,%.10f,%.10f,%.4f,%.5f,%.5f,%.5f,%.6f,%.6f,%.6f\n", e.t,
                                   e.state.latitude / kRadPerDeg, e.state.longitude / kRadPerDeg, e.state.height, v.x(),
                                   v.y(), v.z(), angles.x(), angles.y(), angles.z());
    file.write({row, static_cast<std::size_t>(size)});
  }
  file.commit();
}

void write_log(const std::string& path, const Track& track) {
  io::LcmLogWriter log(path);
  std::string message;
  std::int64_t sequence = 0;
  for (const Epoch& e : track.epoch) {
    const auto utime = static_cast<std::int64_t>(std::llround(1e6 * e.t));
    io::encode_navigation(utime, sequence++, e.state, message);
    log.write(utime, "NAVIGATION", message);
  }
  log.commit();
}

void write_kml(const std::string& path, const Track& track) {
  io::WholeFile file(path);
  file.write(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>"
      "<Placemark><name>track</name><Style><LineStyle><color>ff0000ff</color><width>3</width></LineStyle></Style>"
      "<MultiGeometry><LineString><coordinates>\n");
  char point[100];
  double before = track.epoch.front().state.longitude;
  for (const Epoch& e : track.epoch) {
    if (std::abs(e.state.longitude - before) > kPi)
      file.write("</coordinates></LineString><LineString><coordinates>\n");
    before = e.state.longitude;
    const int size = std::snprintf(point, sizeof point, "%.9f,%.9f,%.3f\n", e.state.longitude / kRadPerDeg,
                                   e.state.latitude / kRadPerDeg, e.state.height);
    file.write({point, static_cast<std::size_t>(size)});
  }
  file.write("</coordinates></LineString></MultiGeometry></Placemark></Document></kml>\n");
  file.commit();
}

void write_plots(const std::string& folder, const std::string& table, const std::string& truth) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(ExitCode::kInput, folder + ": " + error.message());
  const auto quoted = [](const std::string& path) {
    std::string text = "'";
    for (const char c : path) text += c == '\'' ? std::string("''") : std::string(1, c);
    return text + "'";
  };
  std::FILE* gnuplot = ::popen("gnuplot 2>/dev/null", "w");
  if (gnuplot == nullptr) throw Error(ExitCode::kInput, "--plot: gnuplot cannot be started");
  std::string script =
      "set datafile separator ','\nset term pngcairo size 1000,700\nset key autotitle columnhead\nset grid\n";
  const auto picture = [&](const std::string& name) {
    script += "set output " + quoted(folder + "/" + name + ".png") + "\n";
  };
  const std::string data = quoted(table);
  picture("track");
  script += "set xlabel 'longitude, deg'\nset ylabel 'latitude, deg'\nplot " + data +
            " using 3:2 with lines title 'navigated'";
  if (!truth.empty()) script += ", " + quoted(truth) + " using 'lon_deg':'lat_deg' with lines title 'truth'";
  script += "\nset xlabel 'time, s'\n";
  picture("height");
  script += "set ylabel 'height, m'\nplot " + data + " using 1:4 with lines title 'navigated'\n";
  picture("velocity");
  script += "set ylabel 'velocity, m/s'\nplot " + data +
            " using 1:5 with lines title 'north', '' using 1:6 with lines title 'east', '' using 1:7 with lines title "
            "'down'\n";
  picture("attitude");
  script += "set ylabel 'attitude, deg'\nplot " + data +
            " using 1:8 with lines title 'roll', '' using 1:9 with lines title 'pitch', '' using 1:10 with lines title "
            "'yaw'\n";
  std::fwrite(script.data(), 1, script.size(), gnuplot);
  const int status = ::pclose(gnuplot);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(ExitCode::kInput, "--plot: gnuplot is missing or failed");
}

}  // namespace trunnion::app
