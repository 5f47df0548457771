// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/urdf.hpp"

#include <gtest/gtest.h>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/positions/twelve.hpp"

namespace trunnion::io {
namespace {

class Urdf : public testing::Test {
 protected:
  void SetUp() override { template_ = read_whole(std::string(TRUNNION_SHARE) + "/two_axis_table.urdf"); }
  RigFile read(const std::string& text, const std::vector<std::string>& wanted = {}) {
    return read_rig(folder_.file("rig.urdf", text), "azimuth", "pitch", wanted);
  }
  [[nodiscard]] std::string changed(const std::string& from, const std::string& to) const {
    std::string text = template_;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  TemporaryFolder folder_;
  std::string template_;
};

TEST_F(Urdf, TheTemplateIsTheCyclicFixture) {
  const RigFile rig = read(template_);
  EXPECT_EQ(rig.mounts, (std::vector<std::string>{"mount_1", "mount_2", "mount_3"}));
  for (int m = 0; m < 3; ++m)
    EXPECT_TRUE(rig.rig.mount[static_cast<std::size_t>(m)].C_pb.isApprox(cyclic_mount(m), 1e-15)) << m;
  EXPECT_NEAR(rig.limits[kPitch].lowest, -10.0 * kRadPerDeg, 1e-15);
  EXPECT_NEAR(rig.limits[kPitch].highest, 70.0 * kRadPerDeg, 1e-15);
  EXPECT_TRUE(rig.rig.geometry.C_to.isIdentity(1e-15));
}

TEST_F(Urdf, MountsComeInTheOrderAskedFor) {
  const RigFile rig = read(template_, {"mount_3", "mount_1"});
  EXPECT_EQ(rig.rig.mounts, 2);
  EXPECT_TRUE(rig.rig.mount[0].C_pb.isApprox(cyclic_mount(2), 1e-15));
}

// What urdfdom refuses, and what it lets through.
TEST_F(Urdf, RefusesEveryMalformation) {
  EXPECT_REFUSES(ExitCode::kInput, "not a usable URDF", read("<robot"));
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 50000; ++i) deep += "<a><!--</</-->";
  EXPECT_REFUSES(ExitCode::kInput, "more than 10000 elements", read(deep));
  EXPECT_REFUSES(ExitCode::kInput, "not a usable URDF", read(""));
  EXPECT_REFUSES(ExitCode::kInput, "joint 'pitch': lower limit above the upper one",
                 read(changed("lower=\"-0.17453292519943295\"", "lower=\"2\"")));
  EXPECT_REFUSES(ExitCode::kInput, "joint 'azimuth': has a zero axis",
                 read(changed("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>")));
  EXPECT_REFUSES(ExitCode::kInput, "link 'case_2': has two parent joints",
                 read(changed("<link name=\"case_1\"/>",
                              "<link name=\"case_1\"/><joint name=\"again\" type=\"fixed\"><parent "
                              "link=\"fixture\"/><child link=\"case_2\"/></joint>")));
  EXPECT_REFUSES(
      ExitCode::kInput, "not a usable URDF",
      read(changed("<limit lower=\"-0.17453292519943295\" upper=\"1.2217304763960306\" effort=\"50\" velocity=\"2\"/>",
                   "")));
  EXPECT_REFUSES(ExitCode::kInput, "robot: stands more than once", read(template_ + "<robot name=\"b\"/>"));
  EXPECT_REFUSES(ExitCode::kInput, "joint 'pitch': is missing",
                 read(changed("<joint name=\"pitch\"", "<joint name=\"tilt\"")));
  EXPECT_REFUSES(ExitCode::kInput, "joint 'pitch': is parallel to 'azimuth'",
                 read(changed("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 1\"/>")));
  EXPECT_REFUSES(ExitCode::kInput, "mount 'mount_9': is no fixed joint", read(template_, {"mount_9"}));
  EXPECT_REFUSES(ExitCode::kInput, "the rig has: mount_1, mount_2, mount_3", read(template_, {"mount_9"}));
  EXPECT_REFUSES(ExitCode::kInput, "should be revolute or continuous",
                 read(changed("name=\"azimuth\" type=\"continuous\"", "name=\"azimuth\" type=\"fixed\"")));
  // a closed loop: the base becomes a child of the fixture
  EXPECT_REFUSES(ExitCode::kInput, "not a usable URDF",
                 read(changed("<link name=\"case_1\"/>",
                              "<link name=\"case_1\"/><joint name=\"loop\" type=\"fixed\"><parent "
                              "link=\"fixture\"/><child link=\"base\"/></joint>")));
}

TEST_F(Urdf, AnAxisNeedNotBeOfUnitLength) {
  EXPECT_TRUE(read(changed("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 5\"/>")).rig.geometry.C_to.isIdentity(1e-15));
}

}  // namespace
}  // namespace trunnion::io
