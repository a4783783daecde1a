// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/sibling.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "parts/base/files.h"

namespace parts::io {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t more = c < 0x80 ? 0 : c >> 5 == 6 ? 1 : c >> 4 == 14 ? 2 : c >> 3 == 30 ? 3 : 4;
    if (more == 4 || i + more >= text.size()) return false;
    for (std::size_t k = 0; k < more; ++k)
      if ((static_cast<unsigned char>(text[++i]) & 0xC0) != 0x80) return false;
  }
  return true;
}

std::string from_latin1(const std::string& text) {
  std::string out;
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += char(0xC0 | byte >> 6);
      out += char(0x80 | (byte & 0x3F));
    }
  }
  return out;
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return !path.empty() && fs::exists(path, error);
}

/// That path, or one that differs from it in the case of its last name alone.
fs::path in_any_case(const fs::path& path) {
  if (is_there(path)) return path;
  std::vector<fs::path> alike;
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(path), error), end; !error && entry != end; entry.increment(error))
    if (lower(entry->path().filename().string()) == lower(path.filename().string())) alike.push_back(entry->path());
  if (alike.empty()) return {};
  return *std::min_element(alike.begin(), alike.end());
}

}  // namespace

fs::path named_beside(const fs::path& file, const std::string& name) {
  const fs::path folder = file.parent_path(), named = (folder / name).lexically_normal();
  if (is_there(named)) return named;
  std::string end = is_utf8(name) ? name : from_latin1(name);
  std::replace(end.begin(), end.end(), '\\', '/');
  for (;;) {
    const fs::path found = in_any_case((folder / end).lexically_normal());
    if (!end.empty() && !found.empty()) return found;
    const std::size_t slash = end.find('/');
    if (slash == end.npos) return named;
    end.erase(0, slash + 1);
  }
}

}  // namespace parts::io
