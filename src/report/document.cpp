// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/report/document.hpp"

#include <nlohmann/json.hpp>

namespace trunnion::report {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

bool is_number(const std::string& cell) {
  return !cell.empty() && cell.find_first_not_of("0123456789+-.eE%") == std::string::npos &&
         cell.find_first_of("0123456789") != std::string::npos;
}

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 16px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 62rem; padding: 1rem; color: #1a1a1a; background: #fff; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; border-bottom: 1px solid #ccc; }
.verdict { font-size: 1.15rem; font-weight: 600; padding: .6rem .8rem; border-left: .4rem solid; }
.good { border-color: #2a7d3f; background: #eef7f0; } .bad { border-color: #b3261e; background: #fdf0ef; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: .85rem; margin: .8rem 0; }
th, td { padding: .2rem .6rem; border-bottom: 1px solid #e3e3e3; text-align: left; }
td.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
figure { margin: 1rem 0; } figcaption { font-size: .85rem; color: #444; } figure svg { width: 100%; height: auto; }
@media (max-width: 40rem) { table { font-size: .75rem; } th, td { padding: .15rem .3rem; } }
@media print { body { font-size: 10pt; max-width: none; padding: 0; } h2 { break-after: avoid; } figure, tr { break-inside: avoid; }
  .wide { overflow: visible; } table { font-size: 8pt; } th, td { padding: .1rem .4rem; } figure svg { max-height: 20cm; } }
)";

}  // namespace

std::string to_html(const Document& document) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>" +
      escaped(document.title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<h1>" +
      escaped(document.title) + "</h1>\n<p class=\"verdict " + (document.good ? "good" : "bad") + "\">" +
      escaped(document.verdict) + "</p>\n";
  for (const Section& section : document.sections) {
    out += "<h2>" + escaped(section.title) + "</h2>\n";
    for (const std::string& paragraph : section.text) out += "<p>" + escaped(paragraph) + "</p>\n";
    for (const Picture& picture : section.pictures) {
      out += "<figure>\n" + (picture.svg.empty() ? "<p>" + escaped(picture.absent) + "</p>\n" : picture.svg) +
             "<figcaption>" + escaped(picture.title) + "</figcaption>\n</figure>\n";
    }
    for (const Table& table : section.tables) {
      out += "<div class=\"wide\"><table>\n<tr>";
      for (const std::string& cell : table.head) out += "<th>" + escaped(cell) + "</th>";
      out += "</tr>\n";
      for (const std::vector<std::string>& row : table.rows) {
        out += "<tr>";
        for (const std::string& cell : row)
          out += (is_number(cell) ? "<td class=\"n\">" : "<td>") + escaped(cell) + "</td>";
        out += "</tr>\n";
      }
      out += "</table></div>\n";
    }
  }
  return out + "</body>\n</html>\n";
}

std::string to_markdown(const Document& document) {
  const auto cell_text = [](const std::string& cell) {
    std::string out;
    for (const char c : cell) out += c == '|' ? "\\|" : std::string(1, c);
    return out;
  };
  std::string out = "# " + document.title + "\n\n**" + document.verdict + "**\n";
  for (const Section& section : document.sections) {
    out += "\n## " + section.title + "\n";
    for (const std::string& paragraph : section.text) out += "\n" + paragraph + "\n";
    for (const Picture& picture : section.pictures) out += "\n_Picture, in the HTML report: " + picture.title + "_\n";
    for (const Table& table : section.tables) {
      out += "\n|";
      for (const std::string& cell : table.head) out += " " + cell_text(cell) + " |";
      out += "\n|";
      for (std::size_t i = 0; i < table.head.size(); ++i) out += "---|";
      for (const std::vector<std::string>& row : table.rows) {
        out += "\n|";
        for (const std::string& cell : row) out += " " + cell_text(cell) + " |";
      }
      out += "\n";
    }
  }
  return out;
}

std::string to_json(const Document& document) {
  nlohmann::ordered_json tree = {{"format", "trunnion-report/1"},
                                 {"title", document.title},
                                 {"verdict", document.verdict},
                                 {"good", document.good}};
  for (const Section& section : document.sections) {
    nlohmann::ordered_json one = {{"title", section.title}, {"text", section.text}};
    for (const Table& table : section.tables) one["tables"].push_back({{"head", table.head}, {"rows", table.rows}});
    for (const Picture& picture : section.pictures) one["pictures"].push_back(picture.title);
    tree["sections"].push_back(one);
  }
  return tree.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace trunnion::report
