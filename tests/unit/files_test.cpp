// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/files.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <set>
#include <thread>

#include "parts/base/memory.h"
#include "support/folder.h"

namespace parts {
namespace {

namespace fs = std::filesystem;
using test::contents;
using test::sentence;

struct Files : test::Folder {};

TEST(Names, EndingsAndFolders) {
  EXPECT_EQ(lower_extension("a/Head.B.OBJ"), ".obj");
  EXPECT_EQ(lower_extension("a.b/head"), "");
  EXPECT_TRUE(ends_in("X.PnG", {".jpg", ".png"}));
  EXPECT_FALSE(ends_in("png", {".png"}));
  EXPECT_EQ(folder_of("a"), ".");
  EXPECT_EQ(folder_of("/x/a"), "/x");
}

TEST(Names, SizesSayWhatTheyAre) {
  EXPECT_EQ(readable_size(12), "12 bytes");
  EXPECT_EQ(readable_size(353000), "353 kB");
  EXPECT_EQ(readable_size(12.54e6), "12.5 MB");
  EXPECT_EQ(readable_size(999.9e6), "1.0 GB");
  EXPECT_EQ(readable_size(250e9), "250 GB");
}

TEST_F(Files, OnlyRegularFilesAreOpened) {
  EXPECT_NE(sentence([&] { InputFile(at("none"), "The preset"); }).find("The preset \""), std::string::npos);
  EXPECT_NE(sentence([&] { InputFile(at("none")); }).find("does not exist"), std::string::npos);
  EXPECT_NE(sentence([&] { InputFile f(folder.string()); }).find("is a folder, a pipe or a device"), std::string::npos);
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  EXPECT_NE(sentence([&] { InputFile(at("pipe")); }).find("is a folder, a pipe or a device"), std::string::npos);
  EXPECT_NE(sentence([&] { InputFile("/dev/zero"); }).find("is a folder, a pipe or a device"), std::string::npos);
  put("a", "0123456789");
  const InputFile file(at("a"));
  EXPECT_EQ(file.size(), 10u);
  EXPECT_EQ(file.read(8, 5), "89");
  EXPECT_EQ(file.read(80, 5), "");
  EXPECT_EQ(file.read_all(), "0123456789");
  EXPECT_EQ(file.read_all(3), "012");
}

TEST_F(Files, ReadingIsBoundedByMemoryAndCanBeCancelled) {
  put("sparse", "");
  fs::resize_file(at("sparse"), std::uintmax_t(1) << 43);  // 8 TB that take no room
  const InputFile huge(at("sparse"));
  const std::string said = sentence([&] { huge.read_all(); });
  EXPECT_NE(said.find("8.8 TB"), std::string::npos) << said;
  EXPECT_EQ(huge.read(0, 4), std::string(4, '\0'));
  fs::resize_file(at("sparse"), 100 << 20);
  int polls = 0;
  const InputFile large(at("sparse"));
  EXPECT_THROW(large.read_all(UINT64_MAX,
                              [&] {
                                if (++polls == 3) throw Cancelled();
                              }),
               Cancelled);
  EXPECT_EQ(polls, 3);
}

TEST_F(Files, AppearTogetherOrNotAtAll) {
  put("old", "was here");
  fs::permissions(at("old"), fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  {
    OutputFiles files;
    files.make_folder(folder / "new/deep");
    files.add(at("old"), "now this");
    files.add(at("new/deep/a"), "a");
    EXPECT_EQ(contents(at("old")), "was here");
    EXPECT_FALSE(fs::exists(at("new/deep/a")));
  }
  EXPECT_EQ(names(), (std::set<std::string>{"old"})) << "what was not committed is gone, with its folders";
  OutputFiles files;
  files.make_folder(folder / "new/deep");
  files.add(at("old"), "now this");
  files.add(at("new/deep/a"), "a");
  put("doomed", "x");
  files.remove(at("doomed"));
  EXPECT_EQ(files.bytes(), 9);
  files.commit();
  EXPECT_EQ(names(), (std::set<std::string>{"old", "new", "new/deep", "new/deep/a"}));
  EXPECT_EQ(contents(at("old")), "now this");
  EXPECT_EQ(fs::status(at("old")).permissions() & fs::perms::all,
            fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
}

TEST_F(Files, AFailedCommitIsUndone) {
  put("a", "old a");
  OutputFiles files;
  files.add(at("a"), "new a");
  files.add(at("b"), "new b");
  files.add(at("c"), "new c");
  fs::create_directories(folder / "c/full");  // in the way, since it was looked at
  put("doomed", "stays");
  files.remove(at("doomed"));
  EXPECT_NE(sentence([&] { files.commit(); }).find("/c\" cannot be written"), std::string::npos);
  EXPECT_EQ(contents(at("a")), "old a");
  EXPECT_EQ(names(), (std::set<std::string>{"a", "c", "c/full", "doomed"}));
}

TEST_F(Files, UsersFilesAndLinksAreLeftAlone) {
  put("victim", "precious");
  for (const char* name : {"out.part.png", "out.png.part"}) {
    put(name, "the user's own");
    fs::create_symlink(at("victim"), at(std::string("link_to_") + name));
  }
  fs::create_symlink(at("victim"), at("out.png"));
  write_file(at("out.png"), "picture");
  EXPECT_EQ(contents(at("victim")), "precious") << "a link is replaced, not followed";
  EXPECT_EQ(contents(at("out.png")), "picture");
  EXPECT_FALSE(fs::is_symlink(at("out.png")));
  EXPECT_EQ(contents(at("out.part.png")), "the user's own");
  EXPECT_EQ(contents(at("out.png.part")), "the user's own");
}

TEST_F(Files, ThatCannotBeWritten) {
  EXPECT_NE(sentence([&] { write_file(at("no/such/a"), "x"); }).find("cannot be written"), std::string::npos);
  EXPECT_NE(sentence([&] { write_file(folder.string(), "x"); }).find("cannot be written"), std::string::npos);
  EXPECT_NE(sentence([&] { OutputFiles::check(at("no/a"), "The map"); }).find("The map"), std::string::npos);
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  EXPECT_NE(sentence([&] { write_file(at("pipe"), "x"); }).find("cannot be written"), std::string::npos);
  OutputFiles::check(at("a"));
  EXPECT_EQ(names(), (std::set<std::string>{"pipe"}));
  EXPECT_FALSE(write_cache_file(at("no/such/a"), "x"));
  EXPECT_TRUE(write_cache_file(at("a"), "x"));
}

TEST_F(Files, ANameIsReservedOnce) {
  {
    OutputFiles one, two;
    EXPECT_TRUE(one.reserve(at("t.png")));
    EXPECT_FALSE(two.reserve(at("t.png")));
    one.add(at("t.png"), "one");
    one.add(at("other"), "two");
  }
  EXPECT_TRUE(names().empty()) << "a reserved name is free again";
  OutputFiles files;
  EXPECT_TRUE(files.reserve(at("t.png")));
  files.add(at("t.png"), "one");
  files.commit();
  EXPECT_EQ(contents(at("t.png")), "one");
}

TEST_F(Files, ADiskThatIsFull) {
  fs::create_directory(folder / "tiny");
  if (::mount("tmpfs", at("tiny").c_str(), "tmpfs", 0, "size=64k") != 0) GTEST_SKIP() << "needs root, for a small disk";
  put("tiny/old", "whole");
  const std::string said = sentence([&] { write_file(at("tiny/old"), std::string(200000, 'x')); });
  OutputFiles files;
  files.add(at("tiny/old"), std::string(20000, 'x'));
  const std::string second = sentence([&] { files.add(at("tiny/b"), std::string(60000, 'x')); });
  const std::string old = contents(at("tiny/old"));
  files.commit();
  const std::string now = contents(at("tiny/old"));
  const auto count = std::distance(fs::directory_iterator(folder / "tiny"), fs::directory_iterator());
  ::umount(at("tiny").c_str());
  EXPECT_NE(said.find("cannot be written; check its folder and the space left."), std::string::npos);
  EXPECT_NE(second.find("/b\" cannot be written"), std::string::npos);
  EXPECT_EQ(old, "whole");
  EXPECT_EQ(now.size(), 20000u);
  EXPECT_EQ(count, 1);
}

TEST_F(Files, AFolderIsLockedByOneAtATime) {
  std::atomic<bool> released{false};
  auto first = std::make_unique<FolderLock>(folder);
  std::thread second([&] {
    const FolderLock lock(folder);
    EXPECT_TRUE(released);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  released = true;
  first.reset();
  second.join();
  const FolderLock nowhere(folder / "none");  // there is nothing to lock
  EXPECT_TRUE(names().empty());
}

TEST_F(Files, NobodyWaitsForEverForALock) {
  const FolderLock stopped(folder);
  const auto start = std::chrono::steady_clock::now();
  const FolderLock late(folder, std::chrono::milliseconds(50));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST_F(Files, OfTwoRunsDoNotMix) {
  put("a/1", "old");
  put("b/2", "old");
  auto other = std::make_unique<FolderLock>(folder / "b");
  std::atomic<bool> done{false};
  std::thread run([&] {
    OutputFiles files;
    files.lock(folder / "a");  // once more by commit()
    files.add(at("b/2"), "new");
    files.add(at("a/1"), "new");
    files.commit();
    done = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(done);
  EXPECT_EQ(contents(at("a/1")) + contents(at("b/2")), "oldold") << "placed beside the other run's";
  other.reset();
  run.join();
  EXPECT_EQ(contents(at("a/1")) + contents(at("b/2")), "newnew");
  const FolderLock free(folder / "a", std::chrono::milliseconds(0));
  EXPECT_EQ(names(), (std::set<std::string>{"a", "a/1", "b", "b/2"}));
}

TEST_F(Files, AFolderThatAnotherRunTookAwayIsMadeAgain) {
  OutputFiles files;
  {
    OutputFiles fails;
    fails.make_folder(folder / "out");
    files.make_folder(folder / "out");
  }
  ASSERT_FALSE(fs::exists(folder / "out"));
  files.add(at("out/file"), "here");
  files.commit();
  EXPECT_EQ(contents(at("out/file")), "here");
}

TEST_F(Files, ManyFilesAtOnce) {
  OutputFiles files;
  for (int i = 0; i < 100; ++i) files.add(at(std::to_string(i)), "x");
  files.commit();
  EXPECT_EQ(names().size(), 100u);
}

struct Memory : test::Folder {
  double free() const { return available_memory(folder.string()).value_or(-1); }
};

TEST_F(Memory, NothingIsKnownOfNothing) { EXPECT_FALSE(available_memory(folder.string())); }

TEST_F(Memory, OfTheMachineAndOfControlGroups) {
  put("proc/meminfo", "MemTotal: 9000000 kB\nMemFree: 1 kB\nMemAvailable: 8000000 kB\n");
  EXPECT_EQ(free(), 8192e6);
  put("proc/self/cgroup", "0::/user/job\n");
  put("sys/fs/cgroup/user/memory.max", "max\n");
  put("sys/fs/cgroup/user/memory.current", "100\n");
  put("sys/fs/cgroup/user/job/memory.max", "5000000\n");
  put("sys/fs/cgroup/user/job/memory.current", "3000000\n");
  put("sys/fs/cgroup/user/job/memory.stat", "anon 1\ninactive_file 400000\n");
  EXPECT_EQ(free(), 2400000);
  put("sys/fs/cgroup/user/memory.max", "1000100\n");
  EXPECT_EQ(free(), 1000000) << "a group that it lies in";
  put("proc/self/cgroup", "9:cpu,memory:/job\n1:name=systemd:/\n");
  put("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "700\n");
  put("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "900\n");
  EXPECT_EQ(free(), 0) << "none is not the same as not known";
  put("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(free(), 8192e6) << "no limit";
}

TEST_F(Memory, WhatIsNotKnownRefusesNothing) {
  EXPECT_NO_THROW(check_memory("A texture", 1e15, {}, "choose a smaller one"));
  EXPECT_NO_THROW(check_memory("A texture", 1e15, 0, "choose a smaller one"));
  EXPECT_NO_THROW(check_memory("A texture", 1e6, 1e6, "choose a smaller one"));
  EXPECT_EQ(sentence([] { check_memory("A texture", 3e9, 2e6, "choose a smaller one"); }),
            "A texture needs about 3.0 GB of memory, and 2.0 MB are free; choose a smaller one.");
}

TEST_F(Memory, OfThisProcess) {
  const auto free = available_memory();
  ASSERT_TRUE(free);
  EXPECT_GT(*free, 1e6);
#if !defined(__SANITIZE_ADDRESS__)
  const pid_t child = fork();
  if (child == 0) {
    const struct rlimit limit { 3000u << 20, 3000u << 20 };
    ::setrlimit(RLIMIT_AS, &limit);
    const auto left = available_memory();
    _exit(left && *left < (3000u << 20) && *left >= 0 ? 0 : 1);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
#endif
}

}  // namespace
}  // namespace parts
