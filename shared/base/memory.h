// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace parts {

/// Bytes that this process may still use without swapping: the least of what the
/// machine has free, what its control groups (version 1 or 2) leave it, and its
/// limits of address space and data (setrlimit). Nothing if nothing is known.
/// @param root  of the file system that /proc and /sys are read from; for tests
std::optional<double> available_memory(const std::string& root = "");

}  // namespace parts
