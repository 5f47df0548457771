// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "outputs.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "terminal.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

void print(const nlohmann::ordered_json& tree, const std::string& indent) {
  for (const auto& [key, value] : tree.items()) {
    if (value.is_object()) {
      std::printf("%s%s\n", indent.c_str(), key.c_str());
      print(value, indent + "  ");
    } else if (value.is_array()) {
      for (const auto& item : value)
        std::printf("%s%s: %s\n", indent.c_str(), key.c_str(), item.get<std::string>().c_str());
    } else if (value.is_number_float()) {
      std::printf("%s%-26s %s\n", indent.c_str(), key.c_str(), figure(value.get<double>(), 10).c_str());
    } else {
      std::printf("%s%-26s %s\n", indent.c_str(), key.c_str(),
                  value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
    }
  }
}

}  // namespace

void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  std::vector<std::filesystem::path> seen;
  for (const std::string& out : outputs) {
    if (out.empty()) continue;
    for (const std::string& in : inputs) {
      std::error_code error;
      if (!in.empty() && std::filesystem::equivalent(out, in, error) && !error)
        throw Error(ExitCode::kUsage, out + ": would overwrite an input");
    }
    const std::filesystem::path whole = std::filesystem::absolute(io::written_path(out));
    std::error_code unresolved;
    const std::filesystem::path resolved = std::filesystem::weakly_canonical(whole, unresolved);
    if (std::find(seen.begin(), seen.end(), resolved) != seen.end())
      throw Error(ExitCode::kUsage, out + ": two outputs in one file");
    seen.push_back(resolved);
    if (::access(whole.parent_path().c_str(), W_OK) != 0)
      throw Error(ExitCode::kInput, out + ": its folder cannot be written: " + std::strerror(errno));
  }
}

void print_summary(const nlohmann::ordered_json& tree) { print(tree, ""); }

std::string json_text(const nlohmann::ordered_json& tree) {
  return tree.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace trunnion::app
