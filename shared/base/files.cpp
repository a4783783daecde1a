// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <random>
#include <set>
#include <thread>

#include "parts/base/memory.h"

namespace parts {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPiece = std::size_t(1) << 24;  // read between two polls
constexpr std::size_t kFewFiles = 32;                 // are flushed one by one
constexpr const char *kDraftStart = ".parts-", *kDraftEnd = ".draft";

UserError unwritable(const fs::path& path, const std::string& what) {
  return UserError(what + " \"" + path.string() + "\" cannot be written; check its folder and the space left.");
}

std::string random_name() {
  std::random_device random;
  char name[40];
  std::snprintf(name, sizeof name, "%s%08x%08x%s", kDraftStart, unsigned(random()), unsigned(random()), kDraftEnd);
  return name;
}

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  explicit operator bool() const { return number_ >= 0; }
  operator int() const = delete;
  int get() const { return number_; }
  bool close() {  // some file systems say only now that the disk is full
    const int number = number_;
    number_ = -1;
    return ::close(number) == 0;
  }

 private:
  int number_;
};

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), std::size_t(1) << 30));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(std::size_t(written));
  }
  return true;
}

/// Nothing has the target's name, or a file has.
bool may_be_replaced(const fs::path& target) {
  std::error_code error;
  const fs::file_status there = fs::status(target, error);  // what a link names
  return !fs::exists(there) || fs::is_regular_file(there);
}

/// Writes a new file beside the target. @return its path; empty where it cannot be written
fs::path write_draft(const fs::path& target, std::string_view bytes) {
  const fs::path folder = folder_of(target);
  struct stat old {};
  const bool replaces = ::lstat(target.c_str(), &old) == 0 && S_ISREG(old.st_mode);
  for (int attempt = 0; attempt < 100; ++attempt) {
    fs::path draft = folder / random_name();
    Descriptor file(::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!file && errno == EEXIST) continue;
    if (!file) return {};
    if (replaces) ::fchmod(file.get(), old.st_mode & 0777);  // fails on file systems without modes
    const bool whole = write_all(file.get(), bytes);
    if (file.close() && whole) return draft;
    ::unlink(draft.c_str());
    return {};
  }
  return {};
}

/// A folder's one name.
fs::path only_name(const fs::path& folder) {
  std::error_code error;
  const fs::path whole = fs::canonical(folder, error);
  return error ? folder : whole;
}

bool flush_file(const fs::path& file) {
  const Descriptor open(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  return open && (::fsync(open.get()) == 0 || errno == EINVAL || errno == EROFS);
}

/// The names of a folder; best effort, as not every file system can.
void flush_folder(const fs::path& folder) {
  const Descriptor open(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (open) ::fsync(open.get());
}

}  // namespace

std::string lower_extension(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

bool ends_in(const fs::path& path, std::initializer_list<const char*> endings) {
  return std::find(endings.begin(), endings.end(), lower_extension(path)) != endings.end();
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

std::string readable_size(double bytes) {
  constexpr std::array<const char*, 5> units{"bytes", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (; bytes >= 999.5 && unit + 1 < units.size(); bytes /= 1000) ++unit;
  char text[48];
  std::snprintf(text, sizeof text, unit > 1 && bytes < 99.95 ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
  return text;
}

bool is_draft_name(const std::string& name) {
  const std::string start = kDraftStart, end = kDraftEnd;
  return name.size() == start.size() + 16 + end.size() && name.compare(0, start.size(), start) == 0 &&
         name.compare(name.size() - end.size(), end.size(), end) == 0;
}

InputFile::InputFile(const std::string& path, const std::string& what) : named_(what + " \"" + path + "\" ") {
  struct stat status {};
  const auto check = [&](bool good) {
    if (!good && (errno == ENOENT || errno == ENOTDIR))
      throw UserError(named_ + "does not exist; check its name and folder.");
    if (!good) throw UserError(named_ + "cannot be read; check that it may be opened.");
    if (!S_ISREG(status.st_mode))
      throw UserError(named_ + "cannot be read, as it is a folder, a pipe or a device; choose a file.");
  };
  check(::stat(path.c_str(), &status) == 0);  // opening a device may already do something
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  try {
    check(descriptor_ >= 0 && ::fstat(descriptor_, &status) == 0);
  } catch (...) {
    if (descriptor_ >= 0) ::close(descriptor_);
    throw;
  }
  size_ = std::uint64_t(status.st_size);
}

InputFile::~InputFile() { ::close(descriptor_); }

std::string InputFile::read(std::uint64_t from, std::size_t n) const {
  std::string bytes(from < size_ ? std::size_t(std::min<std::uint64_t>(n, size_ - from)) : 0, '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::pread(descriptor_, bytes.data() + done, bytes.size() - done, off_t(from + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw UserError(named_ + "cannot be read; check the disk that it lies on.");
    if (got == 0) break;  // it has become shorter
    done += std::size_t(got);
  }
  bytes.resize(done);
  return bytes;
}

std::string InputFile::read_all(std::uint64_t most, const Poll& poll) const {
  const std::uint64_t wanted = std::min(most, size_);
  const std::optional<double> free = available_memory();
  if (free && double(wanted) > *free)
    throw UserError(named_ + "has " + readable_size(double(wanted)) + ", and " + readable_size(*free) +
                    " of memory are free; make it smaller.");
  std::string bytes;
  bytes.reserve(std::size_t(wanted));
  while (bytes.size() < wanted) {
    if (poll) poll();
    const std::string piece = read(bytes.size(), std::size_t(std::min<std::uint64_t>(kPiece, wanted - bytes.size())));
    if (piece.empty()) break;
    bytes += piece;
  }
  return bytes;
}

FolderLock::FolderLock(const fs::path& folder, std::chrono::milliseconds patience)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  constexpr std::chrono::milliseconds kPause(5);
  const auto end = std::chrono::steady_clock::now() + patience;
  while (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && (errno == EINTR || errno == EWOULDBLOCK) &&
         std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(kPause);
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFiles::lock(const fs::path& folder) {
  locks_.try_emplace(only_name(folder), folder);  // once: the same run would wait for itself
}

void OutputFiles::check(const std::string& path, const std::string& what) {
  const fs::path draft = may_be_replaced(path) ? write_draft(path, "") : fs::path();
  if (draft.empty()) throw unwritable(path, what);
  ::unlink(draft.c_str());
}

void OutputFiles::make_folder(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path f = folder; !f.empty() && !fs::exists(f, error); f = f.parent_path()) missing.push_back(f);
  std::reverse(missing.begin(), missing.end());
  for (const fs::path& f : missing)
    if (fs::create_directory(f, error)) folders_.push_back(f);
  asked_.insert(folder);
  if (!fs::is_directory(folder, error))
    throw UserError("The folder \"" + folder.string() + "\" cannot be made; choose a place that may be written.");
}

void OutputFiles::add(const fs::path& path, std::string_view bytes, const std::string& what) {
  std::error_code error;
  const fs::path folder = folder_of(path);
  if (asked_.count(folder) && !fs::exists(folder, error)) make_folder(folder);  // a run that failed has taken it away
  const fs::path draft = may_be_replaced(path) ? write_draft(path, bytes) : fs::path();
  if (draft.empty()) throw unwritable(path, what);
  drafts_.push_back({path, draft, what});
  bytes_ += double(bytes.size());
}

bool OutputFiles::reserve(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (file) reserved_.push_back(path);
  if (!file && errno != EEXIST) throw unwritable(path, "The file");
  return bool(file);
}

/// All of a file system at once where there are many, which a disk does far quicker.
void OutputFiles::flush() const {
  if (drafts_.size() > kFewFiles) {
    std::set<fs::path> folders;
    for (const Draft& d : drafts_) folders.insert(folder_of(d.path));
    for (const fs::path& folder : folders) {
      const Descriptor open(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
      if (!open || ::syncfs(open.get()) != 0) throw unwritable(folder, "The folder");
    }
    return;
  }
  for (const Draft& d : drafts_)
    if (!flush_file(d.draft)) throw unwritable(d.path, d.what);
}

/// What was there before stays under another name until all are in place.
void OutputFiles::place(Draft& d) {
  struct stat old {};
  if (!may_be_replaced(d.path)) throw unwritable(d.path, d.what);
  if (drafts_.size() > 1 && ::lstat(d.path.c_str(), &old) == 0) {
    const fs::path before = folder_of(d.path) / random_name();
    if (::link(d.path.c_str(), before.c_str()) == 0 || ::rename(d.path.c_str(), before.c_str()) == 0)
      d.before = before;
    else
      throw unwritable(d.path, d.what);
  }
  if (::rename(d.draft.c_str(), d.path.c_str()) != 0) throw unwritable(d.path, d.what);
  d.placed = true;
}

void OutputFiles::undo() {
  for (auto d = drafts_.rbegin(); d != drafts_.rend(); ++d) {
    if (!d->before.empty())
      ::rename(d->before.c_str(), d->path.c_str());
    else if (d->placed)
      ::unlink(d->path.c_str());
    if (!d->before.empty()) ::unlink(d->before.c_str());  // the same file under two names is not renamed
    if (!d->placed) ::unlink(d->draft.c_str());
  }
  drafts_.clear();
}

void OutputFiles::commit() {
  try {
    flush();
    std::set<fs::path> targets;  // in one order, so that no two runs wait for each other
    for (const Draft& d : drafts_) targets.insert(only_name(folder_of(d.path)));
    for (const fs::path& folder : targets) lock(folder);
    for (Draft& d : drafts_) place(d);
  } catch (...) {
    undo();
    locks_.clear();
    throw;
  }
  std::set<fs::path> folders;
  for (const Draft& d : drafts_) {
    if (!d.before.empty()) ::unlink(d.before.c_str());
    folders.insert(folder_of(d.path));
  }
  for (const fs::path& file : removed_) ::unlink(file.c_str());
  for (const fs::path& folder : folders) flush_folder(folder);
  drafts_.clear(), folders_.clear(), asked_.clear(), reserved_.clear(), removed_.clear(), locks_.clear();
}

OutputFiles::~OutputFiles() {
  undo();
  for (const fs::path& file : reserved_) {
    struct stat there {};  // still the empty one
    if (::lstat(file.c_str(), &there) == 0 && S_ISREG(there.st_mode) && there.st_size == 0) ::unlink(file.c_str());
  }
  for (auto folder = folders_.rbegin(); folder != folders_.rend(); ++folder) ::rmdir(folder->c_str());
}

void write_file(const std::string& path, std::string_view bytes, const std::string& what) {
  OutputFiles file;
  file.add(path, bytes, what);
  file.commit();
}

bool write_cache_file(const std::string& path, std::string_view bytes) {
  const fs::path draft = may_be_replaced(path) ? write_draft(path, bytes) : fs::path();
  if (draft.empty()) return false;
  if (::rename(draft.c_str(), path.c_str()) == 0) return true;
  ::unlink(draft.c_str());
  return false;
}

}  // namespace parts
