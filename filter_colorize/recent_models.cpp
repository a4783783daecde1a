// SPDX-License-Identifier: GPL-3.0-or-later
#include "recent_models.h"

#include <filesystem>
#include <set>
#include <sstream>

namespace parts {
namespace {

namespace fs = std::filesystem;

/// Of everything that the models are made from: names, sizes and dates of their
/// files and of those beside them (materials, images).
std::string fingerprint(const io::ModelDatabase& database, const std::vector<render::View>& views,
                        const examples::ExampleOptions& o) {
  std::ostringstream out;
  out.precision(17);
  out << database.path() << '\n' << o.width << ' ' << o.height << ' ' << o.up.transpose() << ' ' << o.front.transpose();
  for (const render::View& view : views) out << ' ' << view.yaw << ',' << view.pitch;
  std::set<fs::path> folders;
  for (int i = 0; i < database.size(); ++i) {
    out << '\n' << database.file(i) << ' ' << database.matrix(i);
    folders.insert(fs::path(database.file(i)).parent_path());
  }
  std::set<std::string> files;
  std::error_code error;
  for (const fs::path& folder : folders)
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      if (!entry.is_regular_file(error)) continue;
      std::ostringstream file;
      file << entry.path().string() << ' ' << entry.file_size(error) << ' '
           << entry.last_write_time(error).time_since_epoch().count();
      files.insert(file.str());
    }
  for (const std::string& file : files) out << '\n' << file;
  return out.str();
}

}  // namespace

std::shared_ptr<examples::ClassModels> recent_models(const io::ModelDatabase& database,
                                                     const std::vector<render::View>& views,
                                                     const examples::ExampleOptions& options, Progress& progress) {
  struct Recent {
    std::string fingerprint;
    std::shared_ptr<examples::ClassModels> models;
    std::vector<std::string> said;
  };
  static Recent recent;  // the host runs one filter at a time
  std::string now = fingerprint(database, views, options);
  if (now != recent.fingerprint) {
    recent = {};
    std::vector<std::string> said;
    Progress reading([&](int percent, const char*) { return progress.at(percent / 100.), true; },
                     [&](const std::string& line) { said.push_back(line); });
    auto models = std::make_shared<examples::ClassModels>(database, views, options, reading);
    recent = {std::move(now), std::move(models), std::move(said)};
  }
  for (const std::string& line : recent.said) progress.log(line);
  return recent.models;
}

}  // namespace parts
