// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace parts::render {

/// @param what    the sentence's subject, as "A texture of 9 x 9" or "The views"
/// @param needed  bytes
/// @param free    bytes; nothing or 0: not known, and nothing is refused
/// @param remedy  what the user can do: "choose …"
/// @throws UserError  more is needed than is free
void check_memory(const std::string& what, double needed, std::optional<double> free, const std::string& remedy);

}  // namespace parts::render
