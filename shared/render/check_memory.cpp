// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/render/check_memory.h"

#include <cstdio>

#include "parts/base/error.h"

namespace parts::render {

void check_memory(const std::string& what, double needed, std::optional<double> free, const std::string& remedy) {
  if (!free || !(*free > 0) || needed <= *free) return;
  char text[96];
  if (needed < 1e9)
    std::snprintf(text, sizeof text, "%.0f MB of memory, and %.0f MB are free", needed / 1e6, *free / 1e6);
  else
    std::snprintf(text, sizeof text, "%.1f GB of memory, and %.1f GB are free", needed / 1e9, *free / 1e9);
  throw UserError(what + " needs about " + text + "; " + remedy + ".");
}

}  // namespace parts::render
