// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/report/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "trunnion/report/picture.hpp"

namespace trunnion::report {
namespace {

using testing::HasSubstr;
using testing::Not;

Document document() {
  Document d;
  d.title = "Unit <6286> & \"friends\"";
  d.verdict = "Within limits";
  d.sections.push_back(
      {"Parameters", {"a < b"}, {{{"entry", "value"}, {{"gyro x | scale", "12.5"}, {"<script>", "-3e-05"}}}}, {}});
  d.sections.push_back({"Pictures", {}, {}, {{"a line", "", "No picture: gnuplot is not installed, or failed."}}});
  return d;
}

TEST(Document, HtmlIsWholeAndEscaped) {
  const std::string html = to_html(document());
  EXPECT_THAT(html, HasSubstr("<title>Unit &lt;6286&gt; &amp; &quot;friends&quot;</title>"));
  EXPECT_THAT(html, HasSubstr("<td>&lt;script&gt;</td><td class=\"n\">-3e-05</td>"));
  EXPECT_THAT(html, HasSubstr("No picture: gnuplot"));
  EXPECT_THAT(html, HasSubstr("width=device-width"));
  EXPECT_THAT(html, Not(HasSubstr("<script>")));
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, testing::EndsWith("</html>\n"));
}

TEST(Document, MarkdownHasTheTables) {
  const std::string markdown = to_markdown(document());
  EXPECT_THAT(markdown, HasSubstr("| entry | value |\n|---|---|\n| gyro x \\| scale | 12.5 |"));
  EXPECT_THAT(markdown, HasSubstr("**Within limits**"));
}

TEST(Document, JsonHasTheTables) {
  EXPECT_THAT(to_json(document()), HasSubstr("\"trunnion-report/1\""));
  EXPECT_THAT(to_json(document()), HasSubstr("gyro x | scale"));
}

TEST(Picture, IsAnSvgWithoutNetwork) {
  const Picture picture =
      gnuplot("line", data_block("d", {{0.0, 1.0}, {1.0, std::nan("")}, {2.0, 3.0}}) +
                          "plot $d using 1:2 with lines title " + quoted("mount_1 \"a\" {b}") + "\n");
  if (picture.svg.empty()) GTEST_SKIP() << picture.absent;
  EXPECT_THAT(picture.svg, testing::StartsWith("<svg"));
  EXPECT_THAT(picture.svg, Not(HasSubstr("href='http")));
  EXPECT_THAT(picture.svg, HasSubstr("mount_1"));
}

TEST(Picture, SaysSoWhereThereIsNone) {
  EXPECT_THAT(gnuplot("broken", "plot $nothing\n").absent, HasSubstr("No picture"));
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  const Picture picture = gnuplot("line", "plot sin(x)\n");
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(picture.svg.empty());
  EXPECT_THAT(picture.absent, HasSubstr("gnuplot is not installed"));
}

}  // namespace
}  // namespace trunnion::report
