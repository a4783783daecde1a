// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/io/manifest.h"

#include <nlohmann/json.hpp>

namespace parts::io {
namespace {

constexpr std::uint64_t kLongest = std::uint64_t(1) << 28;  // bytes
constexpr int kDeepest = 4;

bool is_bare(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == name.npos;
}

}  // namespace

std::filesystem::path manifest_path(const std::filesystem::path& folder) { return folder / "manifest.json"; }

std::optional<Manifest> read_manifest(const std::filesystem::path& folder) {
  using Json = nlohmann::json;
  try {
    const std::string text = InputFile(manifest_path(folder).string()).read_all(kLongest);
    const Json json = Json::parse(
        text, [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; }, true);
    Manifest names;
    for (const Json& name : json.at("files"))
      if (name.is_string() && is_bare(name.get<std::string>())) names.insert(name.get<std::string>());
    return names;
  } catch (const UserError&) {
    return {};
  } catch (const Json::exception&) {
    return {};
  }
}

void add_manifest(OutputFiles& files, const Manifest& names, const std::filesystem::path& folder) {
  const nlohmann::ordered_json json{{"about", "What \"Build Mapping Database\" made here and may replace or remove."},
                                    {"files", names}};
  files.add(manifest_path(folder), json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace parts::io
