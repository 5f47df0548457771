// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where an input is wrong, in one form: "file:line: field: what".

#pragma once

#include <cstdint>
#include <string>

#include "trunnion/core/error.hpp"

namespace trunnion::io {

/// @param line counted from one; 0: the file as a whole. @param field may be empty
Error input_error(const std::string& file, long long line, const std::string& field, const std::string& what);

/// The same for binary files, at a byte offset.
Error input_error_at_byte(const std::string& file, long long byte, const std::string& field, const std::string& what);

/// A fingerprint as people quote it: "0x12aff17a21db298c".
std::string hexadecimal(std::uint64_t value);

/// Whether every character has the bytes that its first one promises.
bool is_utf_8(const std::string& text);

/// A name from a file as it may reach a terminal: control bytes, and those of no UTF-8, become '?'.
std::string printable(std::string name);

}  // namespace trunnion::io
