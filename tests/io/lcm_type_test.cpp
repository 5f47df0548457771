// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_type.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/message_bytes.hpp"
#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::io {
namespace {

using testing::ElementsAre;

const char* const kBench = R"(
package bench;              // a comment
struct inner_t { const int32_t SIZE = 3, OTHER = 0x4; int8_t a; double b[3][2]; int16_t n; string names[n]; boolean ok; }
/* and
   another */
struct outer_t
{
    int64_t utime;
    inner_t one;
    int32_t m;
    inner_t many[m];
    byte raw[m][2];
    float f, g[2];
}
struct empty_t { }
struct hollow_t { empty_t nothing[5]; int32_t n; empty_t none[n]; int32_t last; }
)";

class LcmTypesTest : public testing::Test {
 protected:
  LcmTypesTest() { types_.add_text(kBench, "bench.lcm"); }
  LcmFieldReader reader(const std::string& type, const std::vector<std::string>& paths) const {
    return {types_, type, paths};
  }

  static void inner(MessageBytes& m, int a, std::initializer_list<const char*> names) {
    m.i8(a);
    for (int i = 0; i < 6; ++i) m.f64(10.0 * a + i);
    m.i16(static_cast<int>(names.size()));
    for (const char* name : names) m.text(name);
    m.i8(1);
  }
  [[nodiscard]] std::string outer() const {
    MessageBytes m(types_.fingerprint("bench.outer_t"));
    m.i64(1234567890123456789);
    inner(m, -7, {"x", "yy"});
    m.i32(2);
    inner(m, 1, {});
    inner(m, 2, {"zzz"});
    for (int i = 0; i < 4; ++i) m.i8(200 + i);
    m.f32(0.1F).f32(2.5F).f32(-3.0F);
    return m.bytes();
  }
  LcmTypes types_;
};

// What lcm-gen says of these types, as published by the projects that they are of.
TEST_F(LcmTypesTest, FingerprintsAreThoseOfLcmGen) {
  const auto of = [](const char* preset) {
    const MessageMap& map = message_preset(preset).map;
    return map.types->fingerprint(map.type);
  };
  EXPECT_EQ(of("bot_core.ins_t"), 0x88a7df61422b0840U);
  EXPECT_EQ(of("bot_core.kvh_raw_imu_batch_t"), 0x0851c5aef9bf4778U);
  EXPECT_EQ(of("bot_core.joint_state_t"), 0x3e377b4cebc593a4U);
  EXPECT_EQ(of("sensor_msgs.Imu"), 0x31ab205c8dd57aa8U);
  EXPECT_EQ(of("sensor_msgs.JointState"), 0xccefa8a492b967e3U);
  LcmTypes ours;
  ours.add(std::string(TRUNNION_SHARE) + "/../../src/bus/types");
  EXPECT_EQ(ours.fingerprint("trunnion_lcm.imu_t"), kImuFingerprint);
  EXPECT_EQ(ours.fingerprint("trunnion_lcm.imu_batch_t"), kImuBatchFingerprint);
  EXPECT_EQ(ours.fingerprint("trunnion_lcm.imu_counts_t"), kImuCountsFingerprint);
  EXPECT_EQ(ours.fingerprint("trunnion_lcm.encoder_t"), kEncoderFingerprint);
  for (const std::string& name : ours.names()) EXPECT_EQ(known_types()->fingerprint(name), ours.fingerprint(name));
  EXPECT_THAT(ours.with_fingerprint(kIndexFingerprint), ElementsAre("trunnion_lcm.index_t"));
}

TEST_F(LcmTypesTest, FingerprintsDoNotKnowTheNameOfATypeButThoseOfItsMembers) {
  LcmTypes types;
  types.add_text(
      "package a; struct v_t { double x, y, z; } package b; struct w_t { double x; double y, z; } struct u_t { double "
      "x, z, y; }",
      "t");
  EXPECT_EQ(types.fingerprint("a.v_t"), types.fingerprint("b.w_t"));
  EXPECT_NE(types.fingerprint("a.v_t"), types.fingerprint("b.u_t"));
  EXPECT_THAT(types.with_fingerprint(types.fingerprint("a.v_t")), ElementsAre("a.v_t", "b.w_t"));
}

TEST_F(LcmTypesTest, TakesFieldsByPath) {
  LcmFieldReader r =
      reader("bench.outer_t", {"utime", "one.b", "many.a", "many.names", "raw", "g[1]", "f", "m", "one.names[1]"});
  const std::string message = outer();  // texts are views into it
  ASSERT_TRUE(r.read(message));
  EXPECT_THAT(r.integers(0), ElementsAre(1234567890123456789));
  EXPECT_THAT(r.reals(1), ElementsAre(-70, -69, -68, -67, -66, -65));
  EXPECT_THAT(r.integers(2), ElementsAre(1, 2));
  EXPECT_THAT(r.texts(3), ElementsAre("zzz"));
  EXPECT_THAT(r.integers(4), ElementsAre(200, 201, 202, 203));
  EXPECT_THAT(r.reals(5), ElementsAre(-3.0));
  EXPECT_THAT(r.reals(6), ElementsAre(static_cast<double>(0.1F)));
  EXPECT_THAT(r.integers(7), ElementsAre(2));
  EXPECT_THAT(r.texts(8), ElementsAre("yy"));
}

TEST_F(LcmTypesTest, ElementsOfOneArrayMayBeTakenApart) {
  LcmFieldReader r = reader("bench.outer_t", {"g[1]", "g[0]", "g"});
  ASSERT_TRUE(r.read(outer()));
  EXPECT_THAT(r.reals(0), ElementsAre(-3.0));
  EXPECT_THAT(r.reals(1), ElementsAre(2.5));
  EXPECT_THAT(r.reals(2), ElementsAre(2.5, -3.0));
}

TEST_F(LcmTypesTest, TypesWithoutMembersTakeNoBytes) {
  LcmFieldReader r = reader("bench.hollow_t", {"last"});
  ASSERT_TRUE(r.read(MessageBytes(types_.fingerprint("bench.hollow_t")).i32(1000000000).i32(7).bytes()));
  EXPECT_THAT(r.integers(0), ElementsAre(7));
}

// Every message that is not whole is refused, whatever is asked of it.
TEST_F(LcmTypesTest, RefusesEveryOtherLength) {
  const std::string whole = outer();
  for (const auto& paths :
       {std::vector<std::string>{}, std::vector<std::string>{"g"}, std::vector<std::string>{"many.names", "raw"}}) {
    LcmFieldReader r = reader("bench.outer_t", paths);
    for (std::size_t length = 0; length < whole.size(); ++length)
      EXPECT_FALSE(r.read(whole.substr(0, length))) << length;
    EXPECT_TRUE(r.read(whole));
    EXPECT_FALSE(r.read(whole + '\0'));
    std::string other = whole;
    other[3] = static_cast<char>(other[3] ^ 1);
    EXPECT_FALSE(r.read(other));
  }
}

TEST_F(LcmTypesTest, RefusesCountsThatDoNotFit) {
  LcmTypes types;
  types.add_text("struct t { int32_t n; int32_t m; double x[n][m]; } struct u { int64_t n; t many[n]; }", "t");
  LcmFieldReader t(types, "t", {"x"});
  LcmFieldReader u(types, "u", {"many.x"});
  for (const std::int32_t n : {-1, 0x7fffffff, 1 << 30, std::numeric_limits<std::int32_t>::min()}) {
    EXPECT_FALSE(t.read(MessageBytes(t.fingerprint()).i32(n).i32(n).bytes())) << n;
    EXPECT_FALSE(t.read(MessageBytes(t.fingerprint()).i32(n).i32(1).f64(1).bytes())) << n;
    EXPECT_FALSE(u.read(MessageBytes(u.fingerprint()).i64(std::int64_t{n} * 2147483648).bytes())) << n;
  }
  EXPECT_TRUE(t.read(MessageBytes(t.fingerprint()).i32(0).i32(0x7fffffff).bytes()));  // none of many is none
  EXPECT_TRUE(u.read(MessageBytes(u.fingerprint()).i64(1).i32(1).i32(1).f64(4).bytes()));
  EXPECT_THAT(u.reals(0), ElementsAre(4.0));
}

TEST_F(LcmTypesTest, NamesWhatIsWrongWithAPath) {
  EXPECT_REFUSES(ExitCode::kInput, "'bench.outer_t' has no field 'gyro'; it has: utime, one, m, many, raw, f, g",
                 reader("bench.outer_t", {"gyro"}));
  EXPECT_REFUSES(ExitCode::kInput, "'one' is no number but a bench.inner_t", reader("bench.outer_t", {"one"}));
  EXPECT_REFUSES(ExitCode::kInput, "'utime' is a int64_t and has no fields", reader("bench.outer_t", {"utime.x"}));
  EXPECT_REFUSES(ExitCode::kInput, "'g' has 2 elements, not 3", reader("bench.outer_t", {"g[2]"}));
  EXPECT_REFUSES(ExitCode::kInput, "an index may stand at the end only", reader("bench.outer_t", {"many[0].a"}));
  EXPECT_REFUSES(ExitCode::kInput, "has no field 'g[x]'", reader("bench.outer_t", {"g[x]"}));
  EXPECT_REFUSES(ExitCode::kInput, "has no field ''", reader("bench.outer_t", {""}));
  EXPECT_REFUSES(ExitCode::kInput, "'bench.outer' is not defined; did you mean 'bench.outer_t'?",
                 reader("bench.outer", {}));
}

TEST_F(LcmTypesTest, NamesFileAndLineOfABadDefinition) {
  LcmTypes t;
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm:2: array size 'n' is no integer declared before",
                 t.add_text("\nstruct a { double x[n]; }", "a.lcm"));
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm:1: array size '0'", t.add_text("struct a { double x[0]; }", "a.lcm"));
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm:1: should have ';' before '}'", t.add_text("struct a { double x }", "a.lcm"));
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm:1: ends where", t.add_text("struct a { double", "a.lcm"));
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm:1: should have struct or package, has 'class'",
                 t.add_text("class a {};", "a.lcm"));
  t.add_text("struct ring { int32_t n; ring rings[n]; }", "a.lcm");
  EXPECT_REFUSES(ExitCode::kInput, "a.lcm:1: ring: contains itself", static_cast<void>(t.fingerprint("ring")));
  t.add_text("struct lacks { gone_t x; }", "a.lcm");
  EXPECT_REFUSES(ExitCode::kInput, "'gone_t' is not defined", static_cast<void>(t.fingerprint("lacks")));
  EXPECT_TRUE(t.with_fingerprint(1).empty());
  const TemporaryFolder folder;
  EXPECT_REFUSES(ExitCode::kInput, "cannot read", t.add(folder / "none"));
  static_cast<void>(folder.file("readme.txt", "no types"));
  EXPECT_REFUSES(ExitCode::kInput, "holds no .lcm file", t.add(folder / ""));
}

}  // namespace
}  // namespace trunnion::io
