// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "parts/base/tasks.h"

namespace parts {
namespace {

void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

TEST(ParallelFor, CallsEveryIndexOnce) {
  for (long n : {0L, 1L, 2L, 7L, 100L, 100003L})
    for (int threads : {0, 1, 2, 5, 64}) {
      std::vector<int> calls(n, 0);
      parallel_for(n, threads, [&](long begin, long end) {
        ASSERT_LT(begin, end);
        for (long i = begin; i < end; ++i) ++calls[i];
      });
      EXPECT_EQ(std::accumulate(calls.begin(), calls.end(), 0L), n) << n << " on " << threads;
      EXPECT_EQ(std::count(calls.begin(), calls.end(), 1), n) << n << " on " << threads;
    }
}

TEST(ParallelFor, OneThreadIsTheCallingOneAndOnePiece) {
  int pieces = 0;
  parallel_for(1000, 1, [&](long begin, long end) {
    EXPECT_EQ(end - begin, 1000);
    ++pieces;
  });
  EXPECT_EQ(pieces, 1);
}

TEST(ParallelFor, UsesAnotherThread) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  std::atomic<bool> other{false};
  const auto caller = std::this_thread::get_id();
  for (int again = 0; again < 100 && !other; ++again)  // a busy machine may lend no second one at once
    parallel_for(64, 2, [&](long, long) {
      if (std::this_thread::get_id() != caller) other = true;
      pause();
    });
  EXPECT_TRUE(other);
}

TEST(ParallelFor, ThrowsTheExceptionOfTheLowestIndexOnAnyThreads) {
  for (int threads : {1, 2, 3, 8})
    for (int again = 0; again < 50; ++again) {
      std::string what;
      try {
        parallel_for(1000, threads, [&](long begin, long end) {
          for (long i = begin; i < end; ++i)
            if (i % 100 == 37) throw std::runtime_error(std::to_string(i));
        });
      } catch (const std::runtime_error& e) {
        what = e.what();
      }
      EXPECT_EQ(what, "37") << threads << " threads";
    }
}

TEST(ParallelFor, Nests) {
  std::vector<std::vector<int>> calls(40, std::vector<int>(500, 0));
  parallel_for(40, 4, [&](long begin, long end) {
    for (long row = begin; row < end; ++row)
      parallel_for(500, 4, [&](long first, long last) {
        for (long i = first; i < last; ++i) ++calls[row][i];
      });
  });
  for (const std::vector<int>& row : calls) EXPECT_EQ(std::count(row.begin(), row.end(), 1), 500);
}

TEST(ParallelFor, AnExceptionComesThroughNestedCalls) {
  EXPECT_THROW(parallel_for(8, 4, [](long, long) { parallel_for(8, 4, [](long, long) { throw UserError("No."); }); }),
               UserError);
}

TEST(ParallelFor, RunsFromSeveralThreadsAtOnce) {
  std::atomic<long> sum{0};
  std::vector<std::thread> callers;
  for (int t = 0; t < 4; ++t)
    callers.emplace_back([&] {
      for (int again = 0; again < 50; ++again) parallel_for(100, 3, [&](long begin, long end) { sum += end - begin; });
    });
  for (std::thread& t : callers) t.join();
  EXPECT_EQ(sum, 4 * 50 * 100);
}

TEST(RunTasks, RunsEachOnce) {
  for (int n : {0, 1, 2, 300})
    for (int threads : {1, 2, 7}) {
      Progress silent;
      std::vector<int> runs(n, 0);
      run_tasks(n, threads, silent, [&](int i, const Poll& poll) {
        poll();
        ++runs[i];
      });
      EXPECT_EQ(std::count(runs.begin(), runs.end(), 1), n) << n << " on " << threads;
    }
}

TEST(RunTasks, TheCallingThreadAloneSpeaksAndNeverBackwards) {
  for (int threads : {1, 2, 4}) {
    const auto caller = std::this_thread::get_id();
    std::vector<int> spoken;
    Progress progress([&](int percent, const char*) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      spoken.push_back(percent);
      return true;
    });
    progress.stage("Working", 20, 80);
    run_tasks(200, threads, progress, [](int, const Poll& poll) {
      pause();
      poll();
    });
    EXPECT_GE(spoken.size(), 2u);
    EXPECT_TRUE(std::is_sorted(spoken.begin(), spoken.end()));
    EXPECT_GE(spoken.front(), 20);
    EXPECT_LE(spoken.back(), 80);
  }
}

TEST(RunTasks, TheCallingThreadSpeaksWhileOnlyAnotherIsBusy) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> elsewhere{false}, heard{false};
  Progress progress([&](int, const char*) {
    if (elsewhere) heard = true;
    return true;
  });
  for (int again = 0; again < 100 && !elsewhere; ++again)
    run_tasks(2, 2, progress, [&](int, const Poll&) {
      if (std::this_thread::get_id() == caller) {
        pause();
        return;
      }
      elsewhere = true;
      for (int wait = 0; wait < 5000 && !heard; ++wait) pause();
    });
  if (!elsewhere) GTEST_SKIP() << "the machine lent no second thread";
  EXPECT_TRUE(heard);
}

TEST(RunTasks, CancelledBeforeItBegins) {
  for (int threads : {1, 2, 4}) {
    Progress progress([](int, const char*) { return false; });
    std::atomic<int> ended{0};
    EXPECT_THROW(run_tasks(1000, threads, progress,
                           [&](int, const Poll& poll) {
                             pause();
                             poll();
                             ++ended;
                           }),
                 Cancelled);
    EXPECT_LT(ended, 1000);
  }
}

TEST(RunTasks, CancelledWhileItRuns) {
  for (int threads : {1, 2, 4}) {
    std::atomic<int> running{0};
    int asked = 0;
    Progress progress([&](int, const char*) { return ++asked < 3; });
    EXPECT_THROW(run_tasks(4, threads, progress,
                           [&](int, const Poll& poll) {
                             struct Counted {
                               std::atomic<int>& n;
                               explicit Counted(std::atomic<int>& count) : n(count) { ++n; }
                               ~Counted() { --n; }
                             } const counted(running);
                             for (;;) {  // ends by the cancel alone
                               pause();
                               poll();
                             }
                           }),
                 Cancelled);
    EXPECT_EQ(running, 0) << "a body outlived the call on " << threads << " threads";
    EXPECT_EQ(asked, 3);
  }
}

TEST(RunTasks, AnExceptionStopsTheOthersAndComesOut) {
  for (int threads : {1, 2, 4}) {
    Progress silent;
    std::atomic<int> begun{0};
    try {
      run_tasks(100000, threads, silent, [&](int i, const Poll& poll) {
        ++begun;
        if (i == 5) throw UserError("The sixth.");
        pause();
        poll();
      });
      ADD_FAILURE() << "nothing thrown";
    } catch (const UserError& e) {
      EXPECT_STREQ(e.what(), "The sixth.");
    }
    EXPECT_LT(begun, 1000);
  }
}

TEST(RunTasks, NestsWithParallelFor) {
  Progress silent;
  std::vector<long> sums(30, 0);
  run_tasks(30, 4, silent, [&](int i, const Poll&) {
    std::vector<long> squares(1000);
    parallel_for(1000, 4, [&](long begin, long end) {
      for (long k = begin; k < end; ++k) squares[k] = k * i;
    });
    sums[i] = std::accumulate(squares.begin(), squares.end(), 0L);
  });
  for (int i = 0; i < 30; ++i) EXPECT_EQ(sums[i], 499500L * i);
}

TEST(RunTasks, NestsInItself) {
  Progress silent;
  std::atomic<int> runs{0};
  run_tasks(10, 4, silent, [&](int, const Poll&) {
    Progress inner;
    run_tasks(10, 4, inner, [&](int, const Poll&) { ++runs; });
  });
  EXPECT_EQ(runs, 100);
}

}  // namespace
}  // namespace parts
