// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <system_error>
#include <thread>
#include <vector>

#include "parts/base/progress.h"

namespace parts {

/// Runs body(i, poll) for i in [0, n), each on any thread; the calling thread
/// works too and alone speaks to progress. A body calls poll() at least every
/// 0.1 s: it throws Cancelled once the user has cancelled. The first exception
/// is thrown again here after all threads have ended.
template <class Body>
void run_tasks(int n, int threads, Progress& progress, const Body& body) {
  using Clock = std::chrono::steady_clock;
  std::atomic<int> next{0}, done{0};
  std::atomic<bool> failed{false};
  std::exception_ptr error;  // the first one
  const auto fail = [&] {
    if (!failed.exchange(true)) error = std::current_exception();
  };
  Clock::time_point spoken = Clock::now();
  const auto speak = [&] {
    if (failed) throw Cancelled();
    if (Clock::now() - spoken < std::chrono::milliseconds(50)) return;
    progress.at(double(done) / n);
    spoken = Clock::now();
  };
  const auto work = [&](const std::function<void()>& poll) {
    try {
      for (int i = next++; i < n; i = next++) {
        poll();
        body(i, poll);
        ++done;
      }
    } catch (...) {
      fail();
    }
  };
  std::vector<std::thread> pool;
  pool.reserve(std::max(0, std::min(threads, n)));
  try {
    for (int t = 1; t < std::min(threads, n); ++t)
      pool.emplace_back(work, [&] {
        if (failed) throw Cancelled();
      });
  } catch (const std::system_error&) {
    // No more threads to be had: those that there are do all tasks.
  }
  work(speak);
  try {  // others may still be busy
    while (done < n && !failed) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      speak();
    }
  } catch (...) {
    fail();
  }
  for (std::thread& t : pool) t.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace parts
