// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/orbit_book.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "rinex_fields.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {

using namespace rinex;

namespace {

constexpr int kFirstYear = 1981;  // whose GPS weeks count
constexpr int kEndYear = 2150;

/// One message: the number of its lines, and what it says. @return false when a needed number is missing
bool read_orbit(const std::vector<std::string_view>& lines, bool version_2, BroadcastOrbit& orbit) {
  const std::size_t first = version_2 ? 22 : 23;
  const std::size_t rest = version_2 ? 3 : 4;
  std::array<std::array<double, 4>, 8> v{};
  for (std::size_t i = 0; i < 7; ++i) {
    for (std::size_t k = 0; k < (i == 0 ? 3U : 4U); ++k) {
      const std::optional<double> value =
          number(i == 0 ? part(lines[0], first + 19 * k, 19) : part(lines[i], rest + 19 * k, 19));
      if (value)
        v[i][k] = *value;
      else if (i < 5 || (i == 5 && k == 0) || (i == 6 && k == 1))
        return false;
    }
  }
  orbit.af0 = v[0][0], orbit.af1 = v[0][1], orbit.af2 = v[0][2];
  orbit.crs = v[1][1], orbit.delta_n = v[1][2], orbit.m0 = v[1][3];
  orbit.cuc = v[2][0], orbit.e = v[2][1], orbit.cus = v[2][2], orbit.sqrt_a = v[2][3];
  orbit.toe_of_week = v[3][0], orbit.cic = v[3][1], orbit.omega0 = v[3][2], orbit.cis = v[3][3];
  orbit.i0 = v[4][0], orbit.crc = v[4][1], orbit.omega = v[4][2], orbit.omega_dot = v[4][3];
  orbit.i_dot = v[5][0];
  if (!(orbit.toe_of_week >= 0.0 && orbit.toe_of_week < kSecondsPerWeek) || !(std::abs(v[6][1]) < 1e6)) return false;
  const auto health = static_cast<int>(v[6][1]);
  // Galileo: the lowest three bits are of E1; QZSS: the lowest is of another signal
  orbit.healthy = orbit.system == SatelliteSystem::kGalileo ? (health & 7) == 0
                  : orbit.system == SatelliteSystem::kQzss  ? (health & ~1) == 0
                                                            : health == 0;
  return true;
}

}  // namespace

void OrbitBook::add(const BroadcastOrbit& orbit) {
  constexpr std::size_t kMost = 100;  // of a satellite: four days
  std::vector<BroadcastOrbit>& all = orbits_[SatelliteName{orbit.system, orbit.number}.index()];
  for (BroadcastOrbit& known : all) {
    if (orbit.toe - known.toe == 0.0) {  // a bus repeats them
      known = orbit;
      return;
    }
  }
  if (all.size() == kMost) {
    all.erase(all.begin());
    --count_;
  }
  all.push_back(orbit);
  ++count_;
}

void OrbitBook::add(const std::string& path) {
  const std::string text = read_whole(path);
  digest_ = sha256(digest_ + text);
  std::size_t next = 0;
  long long line_number = 0;
  const auto line = [&](std::string_view& found) {
    if (!take_line(text, next, found)) return false;
    ++line_number;
    return true;
  };
  std::string first_fault;
  const auto lose = [&](const std::string& field, const std::string& what) {
    ++losses_.satellites;
    if (first_fault.empty()) first_fault = input_error(path, line_number, field, what).what();
    if (losses_.first.empty()) losses_.first = first_fault;
  };
  std::string_view head;
  bool version_2 = false;
  bool ended = false;
  while (!ended && line(head)) {
    const std::string_view label = trimmed(part(head, kLabel, 20));
    if (line_number == 1) {
      const std::optional<double> version = number(part(head, 0, 9));
      if (label != "RINEX VERSION / TYPE" || !version) throw input_error(path, 1, "", "is no RINEX file");
      if (!(*version >= 2.0 && *version < 4.0))
        throw input_error(path, 1, "",
                          "is RINEX of version " + std::string(trimmed(part(head, 0, 9))) + ": 2 and 3 are read");
      if (part(head, 20, 1) != "N")
        throw input_error(path, 1, "", "is a RINEX file, but not of GPS or mixed navigation");
      version_2 = *version < 3.0;
    }
    ended = label == "END OF HEADER";
  }
  if (line_number == 0) throw input_error(path, 0, "", "is empty");
  if (!ended) throw input_error(path, line_number, "END OF HEADER", "is missing");
  bool any = false;
  std::vector<std::string_view> lines;
  bool pending = line(head);
  while (pending) {
    const char letter = version_2 ? 'G' : head.empty() ? ' ' : head[0];
    if (!version_2 && (letter < 'A' || letter > 'Z')) {  // the rest of a message that was passed over
      pending = line(head);
      continue;
    }
    const std::string name = version_2 ? "G" + std::string(part(head, 0, 2)) : std::string(part(head, 0, 3));
    const std::optional<SatelliteName> satellite = satellite_name(name);
    lines.assign(1, head);
    std::string_view following;
    bool more = true;
    while (lines.size() < 8 && (more = line(following))) {
      if (!version_2 && !following.empty() && following[0] >= 'A' && following[0] <= 'Z') break;
      lines.push_back(following);
    }
    const bool cut = lines.size() < 8;
    if (satellite && lines.size() >= 7) {
      BroadcastOrbit orbit;
      orbit.system = satellite->system;
      orbit.number = satellite->number;
      std::array<std::optional<int>, 5> date;
      for (std::size_t i = 0; i < date.size(); ++i)
        date[i] = version_2 ? integer(part(head, 2 + 3 * i, 3))
                            : integer(i == 0 ? part(head, 3, 5) : part(head, 5 + 3 * i, 3));
      const std::optional<double> second = number(version_2 ? part(head, 17, 5) : part(head, 20, 3));
      int year = date[0].value_or(0);
      if (version_2) year += year < kFirstYear % 100 ? 2000 : 1900;
      const bool dated = date[0] && date[1] && date[2] && date[3] && date[4] && second && year >= kFirstYear &&
                         year < kEndYear && *date[1] >= 1 && *date[1] <= 12 && *date[2] >= 1 && *date[2] <= 31 &&
                         std::abs(*date[3]) < 25 && std::abs(*date[4]) < 61;
      if (dated && read_orbit(lines, version_2, orbit)) {
        const double behind = orbit.system == SatelliteSystem::kBeidou ? kBeidouBehind : 0.0;
        const GpsTime toc = gps_time(year, *date[1], *date[2], *date[3], *date[4], *second);
        GpsTime toe{toc.week, orbit.toe_of_week};
        if (toe - toc > 0.5 * kSecondsPerWeek) --toe.week;
        if (toe - toc < -0.5 * kSecondsPerWeek) ++toe.week;
        orbit.toc = toc + behind;
        orbit.toe = toe + behind;
        add(orbit);
        any = true;
      } else {
        lose(satellite->text(), "a message of its orbit that is cut or no number");
      }
    } else if (satellite) {
      lose(satellite->text(), "a message of its orbit that is cut");
    }
    if (cut && more) {
      head = following;
    } else {
      pending = line(head);
    }
  }
  if (!any)
    throw first_fault.empty() ? input_error(path, 0, "", "holds no orbit of GPS, Galileo, QZSS or BeiDou")
                              : Error(ExitCode::kInput, first_fault);
}

void OrbitBook::each(const std::function<void(const BroadcastOrbit&)>& visit) const {
  for (const auto& [satellite, orbits] : orbits_) {
    for (const BroadcastOrbit& orbit : orbits) visit(orbit);
  }
}

const BroadcastOrbit* OrbitBook::at(const SatelliteName& satellite, const GpsTime& time) const {
  const auto found = orbits_.find(satellite.index());
  if (found == orbits_.end()) return nullptr;
  const BroadcastOrbit* best = nullptr;
  double nearest = kOrbitLasts;
  for (const BroadcastOrbit& orbit : found->second) {
    const double off = std::abs(orbit.toe - time);
    if (!(off <= nearest)) continue;
    nearest = off;
    best = &orbit;
  }
  // an older message that calls it healthy is no excuse
  return best != nullptr && best->healthy ? best : nullptr;
}

}  // namespace trunnion::io
