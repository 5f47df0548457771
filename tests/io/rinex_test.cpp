// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// RINEX 2 and 3 as they should be, and as they come: cut, doubled, mixed up, of another version.

#include "trunnion/io/observation_reader.hpp"
#include "trunnion/io/orbit_book.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "io/rinex_text.hpp"
#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/antenna_epoch.hpp"

namespace trunnion::io {
namespace {

using ::testing::HasSubstr;

std::vector<SignalName> names(const std::vector<const char*>& texts) {
  std::vector<SignalName> signals;
  for (const char* text : texts) signals.push_back(SignalName::parse(text));
  return signals;
}

std::vector<ObservationEpoch> read(ObservationReader& reader) {
  std::vector<ObservationEpoch> epochs;
  for (ObservationEpoch epoch; reader.next(epoch);) epochs.push_back(epoch);
  return epochs;
}

TEST(GpsTime, CountsWeeksAsGpsDoes) {
  EXPECT_EQ(gps_time(1980, 1, 6, 0, 0, 0.0).week, 0);
  const GpsTime t = gps_time(2024, 6, 24, 8, 20, 0.5);  // as the receivers' own headers have it
  EXPECT_EQ(t.week, 2320);
  EXPECT_EQ(t.seconds, 116400.5);
  EXPECT_EQ(gps_time(2024, 3, 1, 0, 0, 0.0) - gps_time(2024, 2, 28, 0, 0, 0.0), 2.0 * 86400.0) << "a leap year";
  EXPECT_EQ(gps_time(2100, 3, 1, 0, 0, 0.0) - gps_time(2100, 2, 28, 0, 0, 0.0), 86400.0) << "none";
}

TEST(SignalName, KnowsItsWavelengthAndNoOthers) {
  EXPECT_NEAR(SignalName::parse("G1C").wavelength(), 0.190293672798, 1e-12);
  EXPECT_NEAR(SignalName::parse("C2I").wavelength(), 0.192039486310, 1e-12);
  EXPECT_NEAR(SignalName::parse("E5Q").wavelength(), 0.254828048791, 1e-12);
  for (const char* bad : {"", "G1", "R1C", "G9C", "G1c", "g1C", "G1CC", "E2C"})
    EXPECT_REFUSES(ExitCode::kUsage, "names no signal", SignalName::parse(bad));
}

TEST(ObservationReader, ReadsVersion3) {
  const TemporaryFolder folder;
  ObservationReader reader(folder.file("a.obs", observations_3()));
  std::string has;
  for (const SignalName& name : reader.available()) has += name.text() + " ";
  EXPECT_EQ(has, "G1C G2W E1C C2I ");
  EXPECT_NEAR(reader.approximate_position().x(), -3817680.9841, 1e-9);
  reader.choose(names({"G1C", "C2I"}));
  const auto epochs = read(reader);
  ASSERT_EQ(epochs.size(), 2U);
  EXPECT_EQ(epochs[0].time.week, 2320);
  EXPECT_EQ(epochs[1].time - epochs[0].time, 1.0);
  ASSERT_EQ(epochs[0].at.size(), 3U);
  const SignalObservation& g05 = epochs[0].at[0];
  EXPECT_EQ(g05.satellite.text(), "G05");
  EXPECT_EQ(g05.code, 20590792.555);
  EXPECT_EQ(g05.phase, 108205345.409);
  EXPECT_EQ(g05.doppler, -105.331);
  EXPECT_FALSE(g05.half_cycle);
  EXPECT_TRUE(epochs[0].at[1].half_cycle) << "loss of lock indicator 3";
  EXPECT_EQ(epochs[0].at[2].satellite.text(), "C23");
  EXPECT_EQ(epochs[0].at[2].signal, 1);
  EXPECT_EQ(reader.losses().epochs + reader.losses().satellites, 0);
}

TEST(ObservationReader, ReadsVersion2) {
  const TemporaryFolder folder;
  ObservationReader reader(folder.file("a.obs", observations_2()));
  reader.choose(names({"G1C", "G2W"}));
  const auto epochs = read(reader);
  ASSERT_EQ(epochs.size(), 2U);
  EXPECT_EQ(epochs[0].time.week, 2320);
  EXPECT_EQ(epochs[0].time.seconds, 116400.0);
  // thirteen satellites, in two lines of names; one has no L2; GLONASS is passed over
  EXPECT_EQ(epochs[0].at.size(), 12U + 11U);
  EXPECT_EQ(epochs[0].at[0].satellite.text(), "G01");
  EXPECT_EQ(epochs[0].at[0].code, 20000001.5);
  EXPECT_EQ(epochs[0].at[0].phase, 105000001.25);
  EXPECT_EQ(epochs[0].at[0].doppler, -1.5);
  EXPECT_EQ(epochs[0].at[1].signal, 1);
  EXPECT_EQ(epochs[0].at[1].code, 20000001.75) << "P2";
}

TEST(ObservationReader, PassesOverWhatIsCutAndSaysWhere) {
  const TemporaryFolder folder;
  const std::string whole = observations_3();
  const auto lost_of = [&](const std::string& text, std::size_t epochs_left) {
    ObservationReader reader(folder.file("cut.obs", text));
    reader.choose(names({"G1C"}));
    std::size_t epochs = 0;
    try {
      epochs = read(reader).size();
    } catch (const Error& e) {  // a short file: one line is one in ten
      return std::string(e.what());
    }
    EXPECT_EQ(epochs, epochs_left);
    return reader.losses().first;
  };
  // a line cut within a number is a number
  std::string cut = whole;
  cut.replace(cut.find("  20590792.555"), 14, "  2059");
  EXPECT_THAT(lost_of(cut, 2), HasSubstr("cut.obs:14: G05: has an observation that is cut or no number"));
  std::string words = whole;
  words.replace(words.find("108205345.409"), 9, "108x05345");
  EXPECT_THAT(lost_of(words, 2), HasSubstr("G05"));
  std::string twice = whole;
  twice.replace(twice.find("G07"), 3, "G05");
  EXPECT_THAT(lost_of(twice, 2), HasSubstr("is there twice"));
  std::string early = whole;
  early.replace(early.find("> 2024 06 24 08 20  1.0"), 23, "> 2024 06 24 08 19  1.0");
  EXPECT_THAT(lost_of(early, 1), HasSubstr("not later than the one before"));
  EXPECT_THAT(lost_of(whole.substr(0, whole.rfind("G05")), 2), HasSubstr("ends before its satellites"));
  std::string date = whole;
  date.replace(date.find("> 2024 06 24 08 20  0.0"), 23, "> 2024 16 24 08 20  0.0");
  EXPECT_THAT(lost_of(date, 1), HasSubstr("cut.obs:13: epoch: cannot be read"));
}

TEST(ObservationReader, RefusesWhatItDoesNotRead) {
  const TemporaryFolder folder;
  const auto open = [&](const std::string& text) { ObservationReader reader(folder.file("x.obs", text)); };
  EXPECT_REFUSES(ExitCode::kInput, "cannot read", ObservationReader("/nowhere/a.obs"));
  EXPECT_REFUSES(ExitCode::kInput, "is empty", open(""));
  EXPECT_REFUSES(ExitCode::kInput, "is no RINEX file", open("hello\n"));
  EXPECT_REFUSES(ExitCode::kInput, "not of observations", open(orbits_3()));
  EXPECT_REFUSES(ExitCode::kInput, "END OF HEADER: is missing", open(observations_3().substr(0, 700)));
  std::string text = observations_3();
  text.replace(5, 4, "4.00");
  EXPECT_REFUSES(ExitCode::kInput, "version 4.00: 2 and 3 are read", open(text));
  text = observations_3();
  text.replace(text.find("GPS         TIME OF FIRST OBS"), 3, "GLO");
  EXPECT_REFUSES(ExitCode::kInput, "its time is of GLO", open(text));
  EXPECT_REFUSES(ExitCode::kInput, "crx2rnx",
                 open("3.0                 COMPACT RINEX FORMAT                    CRINEX VERS   / TYPE\n"));
  ObservationReader reader(folder.file("y.obs", observations_3()));
  EXPECT_REFUSES(ExitCode::kInput, "it has G1C, G2W, E1C, C2I", reader.choose(names({"J1C"})));
}

TEST(OrbitBook, ReadsBothVersionsAndChoosesTheNearest) {
  const TemporaryFolder folder;
  OrbitBook book;
  book.add(folder.file("a.nav", orbits_3()));
  EXPECT_EQ(book.size(), 3U);
  const GpsTime at = gps_time(2024, 6, 24, 9, 30, 0.0);
  const BroadcastOrbit* const g05 = book.at({SatelliteSystem::kGps, 5}, at);
  ASSERT_NE(g05, nullptr);
  EXPECT_EQ(g05->toe.seconds, 122400.0);
  EXPECT_EQ(g05->e, 5.927642923780e-03);
  EXPECT_EQ(g05->af0, -1.774230040610e-04);
  EXPECT_EQ(g05->i_dot, -2.610823036973e-10);
  const BroadcastOrbit* const c23 = book.at({SatelliteSystem::kBeidou, 23}, at);
  ASSERT_NE(c23, nullptr);
  EXPECT_EQ(c23->toe.seconds, c23->toe_of_week + 14.0) << "its own time";
  EXPECT_EQ(book.at({SatelliteSystem::kGps, 7}, at), nullptr) << "unhealthy";
  EXPECT_EQ(book.at({SatelliteSystem::kGps, 5}, at + 5.0 * 3600.0), nullptr) << "stale";
  OrbitBook old;
  old.add(folder.file("b.nav", orbits_2()));
  const BroadcastOrbit* const same = old.at({SatelliteSystem::kGps, 5}, at);
  ASSERT_NE(same, nullptr);
  EXPECT_EQ(same->m0, g05->m0);
  EXPECT_EQ(same->toc - g05->toc, 0.0);
  EXPECT_EQ(satellite_at(*same, at).value().r, satellite_at(*g05, at).value().r);
}

TEST(OrbitBook, BelievesTheNewestMessageThatASatelliteIsUnhealthyAndKeepsOneOfEach) {
  OrbitBook book;
  BroadcastOrbit orbit;
  orbit.number = 3;
  orbit.toe = {2320, 7200.0};
  book.add(orbit);
  for (int i = 0; i < 1000; ++i) book.add(orbit);
  EXPECT_EQ(book.size(), 1U) << "a bus repeats them";
  orbit.toe = {2320, 14400.0};
  orbit.healthy = false;
  book.add(orbit);
  EXPECT_NE(book.at({SatelliteSystem::kGps, 3}, {2320, 7300.0}), nullptr);
  EXPECT_EQ(book.at({SatelliteSystem::kGps, 3}, {2320, 14300.0}), nullptr);
}

/// Files that were joined: other types from an event on.
TEST(ObservationReader, FollowsNewTypesWithinTheFile) {
  const TemporaryFolder folder;
  std::string text = observations_2();
  const std::size_t second = text.find("  1.0000000  0 13") - 16;
  text.insert(text.rfind('\n', second + 16) + 1,
              "                            4  1\n"
              "     6    C1    D1    L1    S1    P2    L2                  # / TYPES OF OBSERV \n");
  ObservationReader reader(folder.file("joined.obs", text));
  reader.choose(names({"G1C"}));
  const auto epochs = read(reader);
  ASSERT_EQ(epochs.size(), 2U);
  EXPECT_EQ(epochs[0].at[0].phase, 105000001.25);
  EXPECT_EQ(epochs[1].at[0].phase, -1.5) << "what stands in the third column now";
  EXPECT_EQ(epochs[1].at[0].doppler, 105000001.25);
}

TEST(OrbitBook, CountsWhatItCannotRead) {
  const TemporaryFolder folder;
  OrbitBook book;
  std::string text = orbits_3();
  text.replace(text.find("5.153635631561E+03"), 18, "5.1536356x1561E+03");
  book.add(folder.file("a.nav", text));
  EXPECT_EQ(book.size(), 2U);
  EXPECT_THAT(book.losses().first, HasSubstr("G05: a message of its orbit that is cut or no number"));
  EXPECT_REFUSES(ExitCode::kInput, "not of GPS or mixed navigation", book.add(folder.file("b.nav", observations_3())));
  EXPECT_REFUSES(ExitCode::kInput, "holds no orbit",
                 book.add(folder.file("c.nav", orbits_3().substr(0, orbits_3().find("G05")))));
}

TEST(AntennaEpoch, NamesSatellitesWithoutAnOrbit) {
  const TemporaryFolder folder;
  OrbitBook book;
  book.add(folder.file("a.nav", orbits_3()));
  ObservationReader reader(folder.file("a.obs", observations_3()));
  const auto signals = names({"G1C", "C2I"});
  reader.choose(signals);
  LeftOut left_out;
  ObservationEpoch epoch;
  ASSERT_TRUE(reader.next(epoch));
  const auto antenna = antenna_epoch(epoch, signals, book, left_out);
  EXPECT_EQ(antenna.count, 2) << "G05 and C23";
  EXPECT_EQ(antenna.at[1].group, 1);
  EXPECT_EQ(left_out.half_cycles, 1) << "G07";
  EXPECT_NEAR(antenna.at[0].range_rate, 105.331 * 0.190293672798, 1e-9);
  epoch.time = epoch.time + 86400.0;
  EXPECT_EQ(antenna_epoch(epoch, signals, book, left_out).count, 0);
  EXPECT_EQ(left_out.without_orbit.count("G05"), 1U);
}

}  // namespace
}  // namespace trunnion::io
