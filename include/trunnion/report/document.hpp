// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A report as plain records, and how it becomes one HTML file without network, Markdown, or JSON.

#pragma once

#include <string>
#include <vector>

namespace trunnion::report {

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< cells that are numbers are set to the right
};

/// An SVG, or, where there is none, why.
struct Picture {
  std::string title;
  std::string svg;
  std::string absent;
};

struct Section {
  std::string title;
  std::vector<std::string> text;  ///< paragraphs
  std::vector<Table> tables;
  std::vector<Picture> pictures;
};

struct Document {
  std::string title;
  std::string verdict;  ///< the first line that is read
  bool good = true;     ///< its colour
  std::vector<Section> sections;
};

/// One file: styles and pictures within, for screens from 360 px on and for paper.
std::string to_html(const Document& document);
/// Without the pictures, which are named.
std::string to_markdown(const Document& document);
/// Schema trunnion-report/1: titles, text and tables.
std::string to_json(const Document& document);

}  // namespace trunnion::report
