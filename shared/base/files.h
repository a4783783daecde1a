// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "parts/base/error.h"

/// Every file that the suite reads or writes goes through here.
namespace parts {

/// The ending in lower case: ".obj" of "a/Head.OBJ", "" where there is none.
std::string lower_extension(const std::filesystem::path& path);

/// Whether the ending is one of these, given in lower case with their dots.
bool ends_in(const std::filesystem::path& path, std::initializer_list<const char*> endings);

/// The folder that a file lies in; "." where its name says none.
std::filesystem::path folder_of(const std::filesystem::path& file);

/// A number of bytes for a user: "353 kB", "12.5 MB", "2.1 GB".
std::string readable_size(double bytes);

/// Called now and then by what takes long; throws Cancelled to end it.
using Poll = std::function<void()>;

/// A regular file that is open for reading. Nothing else is: a pipe would block
/// for ever and a device has no end.
class InputFile {
 public:
  /// @param what  begins the sentences: "The file", "The project"
  /// @throws UserError  it is missing, no regular file, or may not be opened
  explicit InputFile(const std::string& path, const std::string& what = "The file");
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile();

  std::uint64_t size() const { return size_; }  ///< bytes, when it was opened
  /// At most n bytes from there on, fewer at the end.
  /// @throws UserError  the disk fails
  std::string read(std::uint64_t from, std::size_t n) const;
  /// The first `most` bytes, or all.
  /// @throws UserError  the disk fails, or they are more than the memory that is free
  std::string read_all(std::uint64_t most = UINT64_MAX, const Poll& poll = {}) const;

 private:
  std::string named_;  ///< begins its sentences
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Keeps other runs from changing the files of a folder at the same time, where
/// the file system knows locks; released at the end. Waits for half a minute at
/// most: who holds a lock longer has been stopped, or is no run of the suite.
class FolderLock {
 public:
  static constexpr std::chrono::milliseconds most_patience{30000};
  explicit FolderLock(const std::filesystem::path& folder, std::chrono::milliseconds patience = most_patience);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int descriptor_ = -1;
};

/// Files that appear together or not at all. Each is first a draft with a random
/// name of its own in the folder of its target, so that no file of the user, no
/// planted link and no other run stands in the way; what is not committed leaves
/// nothing behind.
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();

  /// Whether a file could be put there; says so before the work begins.
  /// @throws UserError  the folder cannot be written, or something that is no file has that name
  static void check(const std::string& path, const std::string& what = "The file");

  /// Makes a folder, and those that it lies in.
  /// @throws UserError  it cannot be made
  void make_folder(const std::filesystem::path& folder);
  /// Writes a draft. A link of that name will be replaced, not followed.
  /// @param what  begins the sentence, which names the path
  /// @throws UserError  not all of it could be written
  void add(const std::filesystem::path& path, std::string_view bytes, const std::string& what = "The file");
  /// Takes a name that nothing has yet for add(), also against other runs.
  /// @return false where something has it
  bool reserve(const std::filesystem::path& path);
  /// Keeps other runs from changing files of a folder until these are in place or
  /// given up; several folders in the order of their paths. See FolderLock.
  void lock(const std::filesystem::path& folder);
  /// A file that goes when the others have come; never fails.
  void remove(const std::filesystem::path& path) { removed_.push_back(path); }
  double bytes() const { return bytes_; }  ///< of all drafts
  /// Flushes all drafts to the disk and gives them their names; files of two runs
  /// do not mix.
  /// @throws UserError  one cannot take its place: then none has
  void commit();

 private:
  struct Draft {
    std::filesystem::path path, draft;
    std::string what;
    bool placed = false;
    std::filesystem::path before{};  ///< where the file is kept that was there
  };
  void flush() const;
  void place(Draft& draft);
  void undo();

  std::map<std::filesystem::path, FolderLock> locks_;
  std::vector<Draft> drafts_;
  double bytes_ = 0;
  std::vector<std::filesystem::path> folders_, reserved_, removed_;  ///< folders that were made, outer ones first
  std::set<std::filesystem::path> asked_;                            ///< of make_folder()
};

/// One such file. @throws UserError  it cannot be written; what was there is as it was
void write_file(const std::string& path, std::string_view bytes, const std::string& what = "The file");

/// One such file that may be lost in a power cut, as a cache may. @return false if it cannot be written
bool write_cache_file(const std::string& path, std::string_view bytes);

/// Whether a name is that of a draft, which a run that was killed may have left.
bool is_draft_name(const std::string& name);

}  // namespace parts
