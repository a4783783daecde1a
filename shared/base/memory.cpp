// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "parts/base/files.h"

namespace parts {
namespace {

namespace fs = std::filesystem;
using Bytes = std::optional<double>;

Bytes least(Bytes a, Bytes b) {
  if (!a) return b;
  return b ? std::min(*a, *b) : a;
}

/// The number behind a word at the start of a line, as "MemAvailable: 1234 kB".
Bytes number_named(const fs::path& file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    double number = 0;
    if (words >> word && word == name && words >> number) return number;
  }
  return {};
}

/// Of a file that holds one number; nothing for "max".
Bytes number_in(const fs::path& file) {
  std::ifstream in(file);
  double number = 0;
  if (in >> number) return number;
  return {};
}

/// What is left below a limit; cached file contents that are not in use count as free.
Bytes left_in_group(const fs::path& group, const char* limit, const char* usage, const char* cached) {
  const Bytes most = number_in(group / limit), used = number_in(group / usage);
  if (!most || !used || *most > 1e18) return {};
  return std::max(0., *most - *used + number_named(group / "memory.stat", cached).value_or(0));
}

/// Of a control group and those that it lies in, as far as they are mounted.
Bytes left_in_groups(const fs::path& mount, const std::string& name, const char* limit, const char* usage,
                     const char* cached) {
  Bytes left = left_in_group(mount, limit, usage, cached);
  fs::path group = mount;
  for (const fs::path& part : fs::path(name).relative_path()) {
    group /= part;
    left = least(left, left_in_group(group, limit, usage, cached));
  }
  return left;
}

Bytes control_groups(const std::string& root) {
  std::ifstream in(root + "/proc/self/cgroup");
  const fs::path mounts = root + "/sys/fs/cgroup";
  Bytes left;
  for (std::string line; std::getline(in, line);) {  // "4:memory:/name" of version 1, "0::/name" of version 2
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string name = line.substr(second + 1);
    if (controllers == ",,") {
      for (const char* mount : {"", "unified"})
        left = least(left, left_in_groups(mounts / mount, name, "memory.max", "memory.current", "inactive_file"));
    } else if (controllers.find(",memory,") != controllers.npos) {
      left = least(left, left_in_groups(mounts / "memory", name, "memory.limit_in_bytes", "memory.usage_in_bytes",
                                        "total_inactive_file"));
    }
  }
  return left;
}

Bytes below_limit(int resource, Bytes used_kilobytes) {
  struct rlimit limit {};
  if (::getrlimit(__rlimit_resource_t(resource), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
  return std::max(0., double(limit.rlim_cur) - used_kilobytes.value_or(0) * 1024);
}

}  // namespace

std::optional<double> available_memory(const std::string& root) {
  Bytes left = number_named(root + "/proc/meminfo", "MemAvailable:");
  if (left) *left *= 1024;
  left = least(left, control_groups(root));
  const fs::path status = root + "/proc/self/status";
  left = least(left, below_limit(RLIMIT_AS, number_named(status, "VmSize:")));
  return least(left, below_limit(RLIMIT_DATA, number_named(status, "VmData:")));
}

UserError too_little_memory(const std::string& what, double needed, double free, const std::string& remedy) {
  return UserError(what + " needs about " + readable_size(needed) + " of memory, and " + readable_size(free) +
                   " are free; " + remedy + ".");
}

void check_memory(const std::string& what, double needed, std::optional<double> free, const std::string& remedy) {
  if (free && *free > 0 && needed > *free) throw too_little_memory(what, needed, *free, remedy);
}

}  // namespace parts
