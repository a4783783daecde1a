// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "parts/base/files.h"

namespace parts::io {

/// What the suite itself put into a folder that users may put files into as well:
/// a file "manifest.json" there, with the bare names. Nothing else is ever
/// replaced or removed there.
using Manifest = std::set<std::string>;

std::filesystem::path manifest_path(const std::filesystem::path& folder);

/// @return nothing where there is none that can be read
std::optional<Manifest> read_manifest(const std::filesystem::path& folder);

void add_manifest(OutputFiles& files, const Manifest& names, const std::filesystem::path& folder);

}  // namespace parts::io
