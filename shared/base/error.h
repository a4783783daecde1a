// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace parts {

/// The input or the request cannot be served. what() is one sentence for the
/// user: what is wrong and what to do about it.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The user cancelled; nothing has been changed.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("Cancelled.") {}
};

}  // namespace parts
