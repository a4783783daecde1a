// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/memory.h"

#include <fstream>
#include <string>

namespace parts {

double available_memory() {
  std::ifstream in("/proc/meminfo");
  for (std::string name; in >> name;) {
    double kilobytes = 0;
    if (in >> kilobytes && name == "MemAvailable:") return kilobytes * 1024;
    in.clear();
    in.ignore(256, '\n');
  }
  return 0;
}

}  // namespace parts
