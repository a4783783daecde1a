// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "parts/base/error.h"

namespace parts {

/// Bytes that this process may still use without swapping: the least of what the
/// machine has free, what its control groups (version 1 or 2) leave it, and its
/// limits of address space and data (setrlimit). Nothing if nothing is known.
/// @param root  of the file system that /proc and /sys are read from; for tests
std::optional<double> available_memory(const std::string& root = "");

/// The sentence that something needs more memory than there is.
/// @param what    its subject, as "A texture of 9 x 9" or "The views"
/// @param needed  bytes
/// @param free    bytes
/// @param remedy  what the user can do: "choose …"
UserError too_little_memory(const std::string& what, double needed, double free, const std::string& remedy);

/// @param free  bytes; nothing or 0: not known, and nothing is refused
/// @throws UserError  see too_little_memory(): more is needed than is free
void check_memory(const std::string& what, double needed, std::optional<double> free, const std::string& remedy);

}  // namespace parts
