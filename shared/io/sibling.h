// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace parts::io {

/// The place of a file that another file names, perhaps on another system
/// (backslashes, another case, Latin-1) or machine (an absolute path that is not
/// here): the same name, else ever shorter ends of it, in the file's own folder.
/// @return the first that is there; what is named itself, if none is
std::filesystem::path named_beside(const std::filesystem::path& file, const std::string& name);

}  // namespace parts::io
