// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string>

#include "parts/base/error.h"

namespace parts::test {

/// Where $PARTS_CORPUS names a folder, small files that tests read are kept there
/// for the fuzzers, by the reader (tests/fuzz/CMakeLists.txt).
inline void keep_for_corpus(const std::string& reader, const std::string& bytes) {
  const char* corpus = std::getenv("PARTS_CORPUS");
  if (!corpus || bytes.size() > 65536) return;
  const std::filesystem::path folder = std::filesystem::path(corpus) / reader;
  std::filesystem::create_directories(folder);
  std::ofstream(folder / std::to_string(std::hash<std::string>()(bytes)), std::ios::binary) << bytes;
}

/// A test with an empty folder of its own.
struct Folder : testing::Test {
  Folder() {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::temp_directory_path() /
             (std::string("parts_") + info.test_suite_name() + "_" + info.name() + "_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  ~Folder() override { std::filesystem::remove_all(folder); }

  std::string at(const std::string& name) const { return (folder / name).string(); }
  /// Writes a file, and the folders that it lies in. @return its path
  std::string put(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(at(name), std::ios::binary) << bytes;
    return at(name);
  }
  /// Everything in it, relative to it.
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      all.insert(std::filesystem::relative(entry.path(), folder).string());
    return all;
  }
  std::filesystem::path folder;
};

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The sentence with which a call fails; it is one.
template <class Call>
std::string sentence(const Call& call) {
  try {
    call();
  } catch (const UserError& e) {
    const std::string what = e.what();
    EXPECT_EQ(what.back(), '.') << what;
    return what;
  }
  ADD_FAILURE() << "no UserError";
  return {};
}

}  // namespace parts::test
